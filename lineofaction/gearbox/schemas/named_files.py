"""Files by the names that a case or a scene has for them."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

from lineofaction.gearbox.problems import BadInput

Find: TypeAlias = Callable[[str, str], Path]
"""Function from the name of a file and the field with that name to the path of the file; raises `BadInput`.
"""
_FOLDERS = re.compile(r"[/\\]")
Table = dict[str, Any]
_LARGEST_FILE = 16_000_000


def in_folder(folder: Path) -> Find:
    """Return a function that finds files by their names relative to a folder."""
    return lambda name, _field: folder / name


def base_name(name: str) -> str:
    """Return the name of a file without its folders, of any system."""
    return _FOLDERS.split(name)[-1]


def read_text(path: Path, name: str) -> str:
    """Return the text of a file; raises `BadInput` with the name that its caller has for it."""
    try:
        if path.stat().st_size > _LARGEST_FILE:
            raise BadInput.of("file", name, f"at most {_LARGEST_FILE} bytes", "Is this the right file?")
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise BadInput.of("file", name, "a text file in UTF-8", "Is this the right file?") from None
    except OSError as error:
        reason = error.strerror or "unreadable"
        raise BadInput.of("file", name, "a readable file", f"{reason}. Check the path.") from None
