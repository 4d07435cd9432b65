"""How much one server process does at once, within the files that the system lets it open."""

from __future__ import annotations

from dataclasses import dataclass

import structlog

from host import most_open_files
from lineofaction.gearbox.problems import BadInput

_MOST_CONNECTIONS = 800
_LEAST_CONNECTIONS = 32
_OTHER_FILES = 192
"""Kept for all else: up to four files in each of the 40 threads of handlers, pipes to workers, the rest."""
_FILES_OF_A_WORKER = 4
RAISE = "Raise the limit of the process (ulimit -n, LimitNOFILE= of systemd)."

logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class Capacity:
    """What one server process bears.

    Attributes
    ----------
    connections : int
        Open HTTP connections on which requests are under way.
    """

    connections: int = _MOST_CONNECTIONS

    @property
    def comfortable_connections(self) -> int:
        """Connections beyond which the one that has been idle for longest makes room."""
        return self.connections * 5 // 8

    @property
    def requests(self) -> int:
        """Requests answered at once, and bodies awaited at once."""
        return self.connections // 2

    @property
    def share(self) -> int:
        """Requests of one caller answered at once, and bodies awaited, where its key says nothing else."""
        return self.requests // 4


def capacity(workers: int) -> Capacity:
    """Return what this process bears beside so many workers of its own.

    Raises
    ------
    BadInput
        It may open too few files to serve at all.
    """
    files = most_open_files()
    kept = _OTHER_FILES + _FILES_OF_A_WORKER * workers
    if files - kept < _LEAST_CONNECTIONS:
        bound = f"at least {kept + _LEAST_CONNECTIONS}, and {kept + _MOST_CONNECTIONS} for all connections"
        raise BadInput.of("open files", int(files), bound, RAISE)
    bearable = Capacity(int(min(files - kept, _MOST_CONNECTIONS)))
    if bearable.connections < _MOST_CONNECTIONS:
        facts = {"connections": bearable.connections, "requests": bearable.requests, "share": bearable.share}
        logger.warning("limits lowered", open_files=int(files), **facts, remedy=RAISE)
    return bearable
