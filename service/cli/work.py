"""``loa work``."""

from __future__ import annotations

import signal
import threading
from types import FrameType

from service.cli.log import log_to_standard_error
from service.jobs.catalogue import default_registry
from service.jobs.machinery import job_machinery
from service.settings import load_settings
from service.store import DirectoryLock
from service.store.schema import shown


def run_work(**given: object) -> None:
    """Run jobs until stopped by SIGTERM or SIGINT; workers end with the scheduler."""
    settings = load_settings(**given)
    log_to_standard_error()
    lock = DirectoryLock(settings.data_directory)
    lock.acquire()
    stopped = threading.Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    machinery = job_machinery(settings, default_registry())
    machinery.scheduler.start()
    try:
        print(f"lineofaction works for {shown(machinery.engine)}", flush=True)  # noqa: T201 (command line)
        stopped.wait()
    finally:
        machinery.scheduler.stop()
        machinery.engine.dispose()
        lock.release()
