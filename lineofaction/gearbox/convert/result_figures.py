"""The figures of a stored file, as JSON, by the kind of the result."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lineofaction.gearbox.convert.runs import run_json
from lineofaction.gearbox.convert.stamp import WARNINGS, stamped
from lineofaction.gearbox.registry import study_of


def figures_of(kind: str, file: Path) -> dict[str, Any]:
    """Return what a stored file of a run or a study says, its warnings included."""
    study = study_of(kind)
    figures = run_json(file) if study is None else study.run.facts(study.run.file.read(file))
    return figures | {WARNINGS: stamped(file)}
