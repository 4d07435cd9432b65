"""A worker whose service is killed without warning ends with all its children."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from running_service import lives, until

SERVICE = """
import sys
from pathlib import Path
from running_service import bench
from service_stand_ins import REGISTRY
machine = bench(Path(sys.argv[1]), REGISTRY)
machine.scheduler.start()
machine.submit(mode="hang")
machine.scheduler._thread.join()
"""


def test_kill_minus_nine_leaves_no_orphan(tmp_path: Path) -> None:
    root = Path(__file__).parents[3]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(root), os.environ["PYTHONPATH"]])}
    service = subprocess.Popen([sys.executable, "-c", SERVICE, str(tmp_path)], env=environment)
    try:
        until(lambda: any(f.read_text() for f in tmp_path.glob("grandchild_*")))
        sleeper = int(next(tmp_path.glob("grandchild_*")).read_text())
        child = int(next(tmp_path.glob("started_*")).read_text().split()[0])
        assert lives(sleeper) and lives(child)
    finally:
        os.kill(service.pid, signal.SIGKILL)
        service.wait()
    until(lambda: not lives(sleeper) and not lives(child))
