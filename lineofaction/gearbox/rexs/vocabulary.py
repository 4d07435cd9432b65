"""Words of REXS that say what a component is."""

from __future__ import annotations

import functools
import tomllib
from importlib.resources import files
from typing import Literal


@functools.cache
def words(name: Literal["descriptive_components", "bearing_types"]) -> frozenset[str]:
    """Return a list of `vocabulary.toml`."""
    table = tomllib.loads(files(__package__).joinpath("vocabulary.toml").read_text(encoding="utf-8"))
    return frozenset(table[name])
