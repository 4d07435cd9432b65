"""A browser without a driver: scripts run in its page through a pipe, responses are not stored.

A driver of browser tests has every response kept in the process of the page, to hand it out later: memory
that grows with each answer though the page has let it go.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from select import select
from typing import Any

_END = b"\0"
_CHUNK, _PATIENCE_S = 1 << 20, 120.0
_OWN = re.compile(r"^Pss_(?:Anon|Shmem):\s+(\d+)", re.MULTILINE)
"""Pattern of the lines of anonymous and shared memory. Mapped files are left out: their share falls as
another browser of the machine maps them too.
"""


class BareBrowser:
    """Commands of the DevTools protocol to a browser and to its one page."""

    def __init__(self, writes: int, reads: int) -> None:
        self._writes, self._reads = writes, reads
        self._count, self._read = 0, b""
        self._page = ""

    def page(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Return the result of a command to the page."""
        return self._sent(method, parameters, {"sessionId": self._page})

    def whole(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Return the result of a command to the browser."""
        return self._sent(method, parameters, {})

    def _sent(self, method: str, parameters: dict[str, Any], to: dict[str, str]) -> dict[str, Any]:
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        os.write(self._writes, json.dumps(message | to).encode() + _END)
        while (answer := self._next()).get("id") != self._count:
            pass  # an event
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        result: dict[str, Any] = answer["result"]
        return result

    def _next(self) -> dict[str, Any]:
        while _END not in self._read:
            if not select([self._reads], [], [], _PATIENCE_S)[0]:
                raise TimeoutError(f"nothing from the browser for {_PATIENCE_S:g} s")
            if not (chunk := os.read(self._reads, _CHUNK)):
                raise RuntimeError("the browser has ended")
            self._read += chunk
        message, _, self._read = self._read.partition(_END)
        read: dict[str, Any] = json.loads(message)
        return read

    def open(self, address: str, size: dict[str, int], before: str = "() => {}") -> None:
        """Open the page, a function called before all of its own."""
        target = self.whole("Target.createTarget", url="about:blank")["targetId"]
        self._page = self.whole("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.page("Emulation.setDeviceMetricsOverride", **size, deviceScaleFactor=1, mobile=False)
        self.page("Performance.enable")
        self.page("Page.enable")
        self.page("Page.addScriptToEvaluateOnNewDocument", source=f"({before})()")
        self.page("Page.navigate", url=address)

    def evaluate(self, function: str) -> Any:
        """Return the result of a function of the page, or of its promise."""
        call = f"({function})()"
        found = self.page("Runtime.evaluate", expression=call, awaitPromise=True, returnByValue=True)
        if problem := found.get("exceptionDetails"):
            raise RuntimeError(problem.get("exception", problem).get("description", problem["text"]))
        return found["result"].get("value")

    def memory_mb(self) -> tuple[float, float]:
        """Return the heap of scripts after a collection, and what all processes hold without files, MB."""
        self.page("HeapProfiler.collectGarbage")
        metrics = self.page("Performance.getMetrics")["metrics"]
        heap = next(entry["value"] for entry in metrics if entry["name"] == "JSHeapUsedSize")
        pids = [entry["id"] for entry in self.whole("SystemInfo.getProcessInfo")["processInfo"]]
        return heap / 1e6, sum(map(_own_mb, pids))


def _own_mb(pid: int) -> float:
    """Return the memory of a process with its part of shared memory, MB; 0 if it ended."""
    with suppress(OSError):
        text = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii")
        return sum(map(int, _OWN.findall(text))) / 1024.0
    return 0.0


@contextmanager
def bare_browser(path: str, flags: Sequence[str], profile: Path) -> Iterator[BareBrowser]:
    """Run a browser, its profile in a folder."""
    (takes, writes), (reads, gives) = os.pipe(), os.pipe()
    # it reads commands from its descriptor 3, and answers to 4
    own = f'exec "$@" --remote-debugging-pipe 3<&{takes} 4>&{gives}'
    command = ["bash", "-c", own, "bash", path, *flags, f"--user-data-dir={profile}", "about:blank"]
    process = subprocess.Popen(command, pass_fds=(takes, gives), stderr=subprocess.DEVNULL)
    for end in (takes, gives):
        os.close(end)
    try:
        yield BareBrowser(writes, reads)
    finally:
        process.terminate()
        process.wait(timeout=30.0)
        for end in (writes, reads):
            os.close(end)
