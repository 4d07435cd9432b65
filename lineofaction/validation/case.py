"""A validation case: the TOML file that says whose numbers they are and how ours are computed.

Anybody may write such a file, so it names no more than it needs: a verb that reads one file and writes none,
or a function that is made for such cases; data by a path inside of known folders; results by public names.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.model import BoundaryModel, Listed
from lineofaction.gearbox.schemas.reading import read_table, validated

FOLDER = Path(__file__).parent / "cases"
CASES: Mapping[str, Path] = {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}
"""Files of the cases that come with the program, by name."""
TREE = Path(__file__).parents[2]
"""Folder that holds the packages: of a clone also examples and recorded curves."""
REFERENCE = "LOA_FZG_REFERENCE"
"""Environment variable that names a folder of data which may not be shipped."""
VERB = r"^((geometry|modes|response|deflect|plan) (CASE|examples(/\w+)*/\w+\.toml))?$"
FUNCTION = r"^((lineofaction\.validation\.computed\.\w+|fe_contact\.geometry):[a-z]\w*)?$"
INSIDE = r"^(\w[\w-]*/)*(\w[\w.-]*)?$"
"""`VERB`, `FUNCTION`, `INSIDE`: Patterns of a verb, of a function, and of a path that stays in its folder."""
PUBLIC = r"^[A-Za-z0-9-][^.]*(\.[A-Za-z0-9-][^.]*)*$"
"""Pattern of names with dots, none of which begins with an underscore."""
_Text = Annotated[str, Field(max_length=2000)]


class Compared(BoundaryModel):
    """A row of a case: their number, and where ours stands in what is computed."""

    quantity: _Text
    value: Annotated[str, Field(pattern=r"^[-+]?\d{1,12}(\.\d{0,12})?(e[-+]?\d{1,2})?$")]
    """Value of theirs as it is printed: without `error` it is good to half of its last digit."""
    key: Annotated[str, Field(pattern=PUBLIC, max_length=200)]
    """Names or indices that lead to our value, with dots."""
    unit: _Text = ""
    error: Annotated[float, Field(ge=0.0)] | None = None
    error_key: Annotated[str, Field(pattern=f"{PUBLIC}|^$", max_length=200)] = ""
    """Place of our error; of an estimate with value and error it is left out."""
    factor: float = 1.0
    """Factor from our unit to theirs."""
    why: _Text = ""


class ValidationCase(BoundaryModel):
    """Statements of a file, of which exactly one of `verb` and `function` computes our numbers."""

    name: str
    title: _Text
    source: _Text
    licence: _Text
    assumed: Listed[_Text]
    """Assumptions that the comparison rests on, a sentence each."""
    verb: Annotated[str, Field(pattern=VERB)] = ""
    """Verb of `loa` and its file; CASE stands for a file with the text of `case`."""
    function: Annotated[str, Field(pattern=FUNCTION)] = ""
    """Module and function of this program, as ``fe_contact.geometry:iso6336_stiffness``."""
    arguments: Mapping[str, Any] = Field(default_factory=dict)
    case: Annotated[str, Field(max_length=100_000)] = ""
    """Text of a case file: the file of a verb, or the first argument of a function, a pair."""
    data: Annotated[str, Field(pattern=INSIDE)] = ""
    """File of others that the function reads; it is looked for where the case is run."""
    compared: Listed[Compared] = ()
    """Rows; empty where the function returns them from the data."""
    causes: Mapping[str, str] = Field(default_factory=dict)
    """Causes of differences by quantity, of rows that come from the data."""
    measured: bool = False
    """Whether their numbers were measured."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if bool(self.verb) == bool(self.function):
            raise BadInput.of("function", None, "given, or verb instead", "Exactly one of them.")
        return self

    @property
    def data_file(self) -> Path | None:
        """The file of others; None where it is not found."""
        named = os.environ.get(REFERENCE)
        folders = [Path(named)] if named else []
        folders += [TREE, TREE.parent / "shared/reference/fzg", Path.cwd()]
        return next((file for folder in folders if (file := folder / self.data).is_file()), None)


def read_case(path: Path) -> ValidationCase:
    """Read a case from its file; raises `BadInput` with every field at fault."""
    table = read_table(path)
    if "name" in table:
        raise BadInput.of("name", table["name"], "left out: the name of the file is that of the case")
    return validated(ValidationCase, {"name": path.stem, **table})
