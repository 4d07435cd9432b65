"""Messages between the service and a worker: the order, the progress, the outcome."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol

PARTS = "parts"
"""Name of the file in a workspace that marks a child which gives tasks to the cluster."""


class Progress(Protocol):
    """Reports the fraction done of a stage, and of the whole work where its cost was predicted."""

    def __call__(self, stage: str, fraction: float, total: float | None = None, /) -> None:
        """Report both, from 0 to 1; without `total` the declared shares of the stages give the whole."""


@dataclass(frozen=True)
class WorkOrder:
    """One computation for one child process: ``"module:function"`` to call with normalized inputs.

    The workspace belongs to this computation alone: an attempt after the death of a worker finds the files of
    the attempt before. The compliance cache is in the data directory. `stored` maps the hashes of stored
    results that the work reads to their files. `scheduler` is the address of the Dask scheduler whose workers
    may do its tasks.
    """

    entry: str
    inputs: dict[str, Any]
    key: str
    workspace: Path
    data_directory: Path
    memory_limit_mb: int | None = None
    scheduler: str | None = None
    stored: dict[str, Path] = field(default_factory=dict)

    def line(self) -> bytes:
        """Return the order as one line of JSON."""
        return json.dumps(asdict(self), default=str).encode() + b"\n"

    @classmethod
    def from_line(cls, line: bytes) -> WorkOrder:
        """Read the line of an order."""
        fields = json.loads(line)
        for name in ("workspace", "data_directory"):
            fields[name] = Path(fields[name])
        fields["stored"] = {key: Path(file) for key, file in fields["stored"].items()}
        return cls(**fields)


@dataclass(frozen=True)
class Product:
    """A file that the work made, to be moved into the store under `key`.

    `warnings` are those of its inputs; None: the order's case has them, or the file itself. `headline` is
    what a list of jobs shows of it.
    """

    key: str
    kind: str
    file: Path
    warnings: list[dict[str, Any]] | None = None
    headline: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Outcome:
    """The end of a worker: its products, or the failure in words for the user and the faults of the input.

    `unexpected`: a defect, the text of the exception is in the log only. `died`: the child ended after its
    work had begun; another attempt is made. `lost`: the work never began, or its executor ended, which is not
    counted as an attempt.
    """

    products: tuple[Product, ...] = ()
    failure: str = ""
    faults: tuple[dict[str, Any], ...] = ()
    unexpected: bool = False
    died: bool = False
    lost: bool = False

    @property
    def name(self) -> str:
        """One word for the log."""
        if self.lost:
            return "lost"
        if self.died:
            return "died"
        if self.unexpected:
            return "defect"
        return "failed" if self.failure else "done"
