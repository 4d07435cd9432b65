"""Messages between the service and a worker: the order, the progress, the outcome."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol


class Progress(Protocol):
    """Reports the fraction done of a stage, and of the whole work where its cost was predicted."""

    def __call__(self, stage: str, fraction: float, whole: float | None = None, /) -> None:
        """Report both, from 0 to 1; without `whole` it follows from the shares that the process declares."""


PARTS = "parts"
"""The file in a workspace by which a child says that it gives tasks to the cluster."""


@dataclass(frozen=True)
class WorkOrder:
    """One computation for one child process.

    Attributes
    ----------
    entry : str
        ``"module:function"`` to call.
    inputs : dict
        Normalized inputs.
    key : str
        Name of the result.
    workspace : Path
        Directory of this computation alone; removed afterwards. Another attempt after a worker died finds
        what that one left.
    data_directory : Path
        Where the compliance cache is.
    memory_limit_mb : int, optional
        Memory the work may have, MB.
    stored : dict of str to Path
        Files of the stored results that the work reads, by their hashes.
    scheduler : str, optional
        Address of the scheduler whose workers do the tasks, if the service has one.
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
        facts = json.loads(line)
        facts["workspace"], facts["data_directory"] = Path(facts["workspace"]), Path(facts["data_directory"])
        facts["stored"] = {key: Path(file) for key, file in facts["stored"].items()}
        return cls(**facts)


@dataclass(frozen=True)
class Product:
    """A file the work made, to be moved into the store under `key`.

    `warnings` are those of what it was made from; None: those of the order's case, or in the file already.
    """

    key: str
    kind: str
    file: Path
    warnings: list[dict[str, Any]] | None = None


@dataclass(frozen=True)
class Outcome:
    """The end of a worker.

    Attributes
    ----------
    products : tuple[Product, ...]
        What it made; empty if it failed.
    failure : str
        Why there is none, in words for the user; empty if there are products.
    faults : tuple[dict, ...]
        What was wrong with the input, if that was the cause.
    unexpected : bool
        A defect: the text of the exception is in the log only.
    died : bool
        The process ended without an outcome; worth another attempt.
    """

    products: tuple[Product, ...] = ()
    failure: str = ""
    faults: tuple[dict[str, Any], ...] = ()
    unexpected: bool = False
    died: bool = False

    @property
    def name(self) -> str:
        """One word for the log."""
        if self.died:
            return "died"
        if self.unexpected:
            return "defect"
        return "failed" if self.failure else "done"
