"""A validation case: the TOML file that says whose numbers they are and how ours are computed."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput

FOLDER = Path(__file__).parent / "cases"
CASES: Mapping[str, Path] = {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}
"""Files of the cases that come with the program, by name."""
TREE = Path(__file__).parents[2]
"""Folder that holds the packages: of a clone also examples and recorded curves."""
REFERENCE = "LOA_FZG_REFERENCE"
"""Environment variable that names a folder of data which may not be shipped."""


@dataclass(frozen=True)
class Compared:
    """A row of a case: their number, and where ours stands in what is computed."""

    quantity: str
    value: str
    """Number of others as it is printed: without `error` it is good to half of its last digit."""
    key: str
    """Names or indices that lead to our value, with dots."""
    unit: str = ""
    error: float | None = None
    error_key: str = ""
    """Place of our error; of an estimate with value and error it is left out."""
    factor: float = 1.0
    """Factor from our unit to theirs."""
    why: str = ""


@dataclass(frozen=True)
class ValidationCase:
    """Content of a file. Exactly one of `verb` and `function` computes our numbers."""

    name: str
    title: str
    source: str
    licence: str
    assumed: tuple[str, ...]
    """Assumptions of the comparison, a sentence each."""
    verb: str = ""
    """Verb of `loa` with its arguments; CASE stands for a file with the text of `case`."""
    function: str = ""
    """Module and function of this program, as ``fe_contact.geometry:iso6336_stiffness``."""
    arguments: Mapping[str, Any] = field(default_factory=dict)
    case: str = ""
    """Text of a case file: the file of a verb, or the argument `pair` of a function."""
    data: str = ""
    """File of others that the function reads; it is looked for where the case is run."""
    compared: tuple[Compared, ...] = ()
    """Rows; empty where the function returns them from the data."""
    causes: Mapping[str, str] = field(default_factory=dict)
    """Causes of differences by quantity, of rows that come from the data."""
    measured: bool = False
    """Whether their numbers were measured."""

    @property
    def data_file(self) -> Path | None:
        """The file of others; None where it is not found."""
        named = os.environ.get(REFERENCE)
        folders = [Path(named)] if named else []
        folders += [TREE, TREE.parent / "shared/reference/fzg", Path.cwd()]
        return next((file for folder in folders if (file := folder / self.data).is_file()), None)


def read_case(path: Path) -> ValidationCase:
    """Read a case from its file; raises `BadInput` with the field at fault."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise BadInput.of("case", str(path), f"a readable TOML file: {error}") from error
    _refuse_fields(path, ValidationCase, {"name": "", **table})
    if bool(table.get("verb")) == bool(table.get("function")):
        raise BadInput.of(f"{path.name}: function", None, "given, or verb instead", "Exactly one of them.")
    rows = table.pop("compared", [])
    for row in rows:
        _refuse_fields(path, Compared, row)
    assumed = tuple(table.pop("assumed"))
    return ValidationCase(path.stem, assumed=assumed, compared=tuple(Compared(**r) for r in rows), **table)


def _refuse_fields(path: Path, kind: type[Any], table: Mapping[str, Any]) -> None:
    known = {entry.name: entry for entry in fields(kind)}
    for name in table:
        if name not in known:
            raise BadInput.of(f"{path.name}: {name}", table[name], f"one of {', '.join(known)}")
    for name, entry in known.items():
        if entry.default is MISSING and entry.default_factory is MISSING and name not in table:
            raise BadInput.of(f"{path.name}: {name}", None, "given")
