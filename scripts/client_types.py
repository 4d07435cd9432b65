"""Write the types of the client's processes from the registry and from what the studies say they return.

Usage: client_types.py lineofaction/client/processes.pyi
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from lineofaction.gearbox.registry import STUDIES, Study

HEAD = """# Written by scripts/client_types.py from lineofaction.gearbox.registry: do not edit.
# fmt: off
# ruff: noqa: E501 (a line for each parameter)
from collections.abc import Callable, Sequence
from typing import Any, Concatenate, Literal, ParamSpec, TypeVar

{imports}

P = ParamSpec("P")
T = TypeVar("T")
F = TypeVar("F", bound=Figures)

def _offered(figures: type[F]) -> Callable[[Callable[Concatenate[Any, P], T]], Offered[P, T, F]]: ...

class Processes(Surface):
    @_offered(TableFigures)
    def analyze(self, case: CaseLike) -> SteDatabase: ...
    @_offered(RunFigures)
    def simulate(self, scene: SceneLike) -> RunResult: ...
"""
OWN = {
    "from dynamics.results import RunResult",
    "from fe_contact.ste import SteDatabase",
    "from lineofaction.gearbox.subjects import CaseLike, SceneLike, StudyLike",
    "from lineofaction.client.process import Offered",
    "from lineofaction.client.surface import Surface",
    "from lineofaction.gearbox.schemas.figures import Figures, RunFigures, TableFigures",
}
SUBJECTS = {"case": "CaseLike", "scene": "SceneLike", "case or scene": "CaseLike | SceneLike"}


def stub() -> str:
    """Return the types of all processes."""
    methods = "".join(method(study) for study in STUDIES.values())
    kinds = {kind for study in STUDIES.values() for kind in classes(study.run.file.result)}
    kinds |= {study.answer for study in STUDIES.values()}
    lines = {f"from {kind.__module__} import {kind.__name__} as {alias(kind)}" for kind in kinds}
    imports = "\n".join(sorted(lines | OWN))
    return HEAD.format(imports=imports) + methods


def alias(kind: type) -> str:
    """Return the name of a class among those of all packages."""
    package = kind.__module__.removeprefix("lineofaction.").partition(".")[0]
    return f"{package.title().replace('_', '')}{kind.__name__}"


def classes(kind: Any) -> list[type]:
    """Return the classes that a type is made of."""
    parts = get_args(kind)
    inner = [each for part in parts for each in classes(part)]
    return inner if parts else [kind] if isinstance(kind, type) else []


def method(study: Study) -> str:
    """Return the declaration of a study."""
    parts = ["self", f"{study.argument}: {SUBJECTS[study.subject]}"]
    parts += [f"study: StudyLike{' = ...' if study.bare else ''}"] if study.from_file else []
    if study.inputs.model_fields and not study.from_file:
        parts += ["*", *(option(name, field) for name, field in study.inputs.model_fields.items())]
    lines = "".join(f"        {part},\n" for part in parts)
    result = written(study.run.file.result, "tuple")
    return f"    @_offered({alias(study.answer)})\n    def {study.package}(\n{lines}    ) -> {result}: ...\n"


def option(name: str, field: FieldInfo) -> str:
    """Return the parameter of a field; lists are any sequence."""
    return f"{name}: {written(field.annotation, 'Sequence')}{'' if field.is_required() else ' = ...'}"


def written(kind: Any, row: str) -> str:
    """Write a type; a tuple of any length is a `row`."""
    origin, parts = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return written(parts[0], row)
    if origin in (Union, UnionType):
        return " | ".join(written(part, row) for part in parts)
    if origin is tuple:
        further = ", ..." if row == "tuple" else ""
        return f"{row}[{written(parts[0], row)}{further}]"
    if origin is Literal:
        return f"Literal[{', '.join(map(repr, parts))}]".replace("'", '"')
    if kind is NoneType:
        return "None"
    return kind.__name__ if kind.__module__ == "builtins" else alias(kind)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(stub(), encoding="utf-8")
