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
        """Report both, from 0 to 1; without `total` it follows from the shares that the process declares."""


@dataclass(frozen=True)
class WorkOrder:
    """One computation for one child process: ``"module:function"`` to call with normalized inputs.

    The workspace is of this computation alone: another attempt after a worker died finds what that one left.
    The compliance cache is in the data directory. `stored` are the files of the stored results that the work
    reads, by their hashes, `scheduler` the address of the Dask scheduler whose workers may do its tasks.
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
        fields["workspace"], fields["data_directory"] = (
            Path(fields["workspace"]),
            Path(fields["data_directory"]),
        )
        fields["stored"] = {key: Path(file) for key, file in fields["stored"].items()}
        return cls(**fields)


@dataclass(frozen=True)
class Product:
    """A file the work made, to be moved into the store under `key`.

    `warnings` are those of what it was made from; None: those of the order's case, or in the file already.
    `headline` is what a list of jobs shows of it.
    """

    key: str
    kind: str
    file: Path
    warnings: list[dict[str, Any]] | None = None
    headline: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Outcome:
    """The end of a worker: its products, or the failure in words for the user and the faults of the input.

    `unexpected`: a defect, the text of the exception is in the log only. `died`: the child ended after it had
    begun, which is worth another attempt. `lost`: what ran it ended, or it never began: no fault of the work.
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
