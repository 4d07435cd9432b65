"""Write the types of the client's methods of studies from the registry.

Usage: client_studies.py service/client/studies.pyi
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from service.client.study_method import FORMS, study_method
from service.registry import STUDIES, Study

HEAD = """# Written by scripts/client_studies.py from service.registry: do not edit.
# fmt: off
# ruff: noqa: E501 (a line for each parameter)
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from service.client.jobs import JobClient
from service.client.portable import CaseLike, SceneLike
from service.client.status import Watch

class Studies(JobClient):
"""
SUBJECTS = {"case": "CaseLike", "scene": "SceneLike", "case or scene": "CaseLike | SceneLike"}


def stub() -> str:
    """Return the types of all methods."""
    return HEAD + "".join(method(study, ending) for study in STUDIES.values() for ending in FORMS)


def method(study: Study, ending: str) -> str:
    """Return a method of a study."""
    parts = [f"{study.argument}: {SUBJECTS[study.subject]}"]
    parts += ["study: Mapping[str, Any]"] if study.from_file else []
    parts += ["progress: Watch | None = None"]
    if study.inputs.model_fields and not study.from_file:
        parts += ["*", *(option(name, field) for name, field in study.inputs.model_fields.items())]
    lines = "".join(f"        {part},\n" for part in ("self", *parts))
    result = "Path" if ending else "dict[str, Any]"
    return f"    def {study_method(study, ending).__name__}(\n{lines}    ) -> {result}: ...\n"


def option(name: str, field: FieldInfo) -> str:
    """Return the parameter of a field."""
    return f"{name}: {written(field.annotation)}{'' if field.is_required() else ' = ...'}"


def written(kind: Any) -> str:
    """Write a type; lists are any sequence."""
    origin, parts = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return written(parts[0])
    if origin in (Union, UnionType):
        return " | ".join(written(part) for part in parts)
    if origin is tuple:
        return f"Sequence[{written(parts[0])}]"
    if origin is Literal:
        return f"Literal[{', '.join(map(repr, parts))}]".replace("'", '"')
    return "None" if kind is NoneType else str(kind.__name__)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(stub(), encoding="utf-8")
