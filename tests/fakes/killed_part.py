"""One process of a service that is killed and started again."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from running_service import PATIENCE_S


@dataclass
class Part:
    """A process that does a role on a socket; `revived` counts starts after it had ended by itself."""

    role: str
    environment: Mapping[str, str]
    log: Path
    descriptor: int | None = None
    process: subprocess.Popen[bytes] | None = None
    revived: int = 0

    def start(self) -> None:
        script = str(Path(__file__).with_name("fake_process.py"))
        listener = [] if self.descriptor is None else [str(self.descriptor)]
        fds = () if self.descriptor is None else (self.descriptor,)
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                [sys.executable, script, self.role, *listener],
                env=self.environment,
                stdout=log,
                stderr=log,
                pass_fds=fds,
            )

    def revive(self) -> None:
        """Start it again if it has ended, as a supervisor does."""
        if self.process is not None and self.process.poll() is not None:
            self.revived += 1
            self.start()

    @property
    def pid(self) -> int:
        assert self.process is not None
        return self.process.pid

    def heeds_stops(self) -> bool:
        """Whether it has come so far that it handles SIGTERM: one killed a moment ago may be starting."""
        status = Path(f"/proc/{self.pid}/status").read_text()
        caught = int(status.partition("SigCgt:")[2].split()[0], 16)
        return bool(caught >> (signal.SIGTERM - 1) & 1)

    def send(self, number: signal.Signals) -> None:
        assert self.process is not None
        self.process.send_signal(number)

    def end(self, number: signal.Signals) -> int:
        assert self.process is not None
        self.process.send_signal(number)
        return self.process.wait(timeout=PATIENCE_S)
