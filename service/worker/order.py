"""Messages between the service and a worker: the order, the progress, the outcome."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

from service.project import COMMON


class Progress(Protocol):
    """Reports the fraction done of a stage, and of the whole work where its cost was predicted."""

    def __call__(self, stage: str, fraction: float, whole: float | None = None, /) -> None:
        """Report both, from 0 to 1; without `whole` it follows from the shares that the process declares."""


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
        Where results and the compliance cache are, to read.
    memory_limit_mb : int, optional
        Memory the work may have, MB.
    database_url : str, optional
        Where the index of results is, if not in the data directory.
    results_url : str, optional
        Where the files of results are, if not in the data directory.
    results_keys : tuple of str, optional
        Access key and secret of that place; they come here, as workers inherit none.
    scheduler : str, optional
        Address of the scheduler whose workers do the tasks, if the service has one.
    project : str, optional
        Whose results the work may read.
    """

    entry: str
    inputs: dict[str, Any]
    key: str
    workspace: Path
    data_directory: Path
    memory_limit_mb: int | None = None
    database_url: str | None = None
    results_url: str | None = None
    scheduler: str | None = None
    project: str = COMMON
    results_keys: tuple[str, str] | None = None

    def line(self) -> bytes:
        """Return the order as one line of JSON."""
        facts = asdict(self) | {"workspace": str(self.workspace), "data_directory": str(self.data_directory)}
        return json.dumps(facts).encode() + b"\n"

    @classmethod
    def from_line(cls, line: bytes) -> WorkOrder:
        """Read the line of an order."""
        facts = json.loads(line)
        facts["workspace"], facts["data_directory"] = Path(facts["workspace"]), Path(facts["data_directory"])
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
