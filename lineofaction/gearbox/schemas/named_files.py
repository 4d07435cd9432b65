"""Where the files are that a case or scene names: beside its own file, or sent together with its text."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

Find: TypeAlias = Callable[[str, str], Path]
"""From the name of a file and the field that has it to where it is; raises `BadInput`."""
_FOLDERS = re.compile(r"[/\\]")


def beside(folder: Path) -> Find:
    """Return what finds files by their names relative to a folder."""
    return lambda name, _field: folder / name


def own_name(name: str) -> str:
    """Return the name of a file without its folders, of any system."""
    return _FOLDERS.split(name)[-1]
