"""Last published figures, subject by subject: ``docs/lab/benchmarks.json``."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.figures import Figure


@dataclass(frozen=True)
class Measured:
    """One subject's figures, the day and the machine they were taken on."""

    day: str
    machine: dict[str, str]
    figures: tuple[Figure, ...]


def read_record(path: Path) -> dict[str, Measured]:
    """Return the subjects of the file; none if there is no file."""
    if not path.exists():
        return {}
    content = json.loads(path.read_text(encoding="utf-8"))
    return {
        name: Measured(part["day"], part["machine"], tuple(Figure(**figure) for figure in part["figures"]))
        for name, part in content.items()
    }


def write_record(path: Path, record: Mapping[str, Measured], order: Sequence[str]) -> None:
    """Write the subjects in that order; subjects no longer known are dropped."""
    kept = {name: asdict(record[name]) for name in order if name in record}
    path.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
