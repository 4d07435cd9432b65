"""``loa work``."""

from __future__ import annotations

import signal
import threading
from contextlib import closing
from types import FrameType

from service.cli.interrupt import leave
from service.cli.log import log_to_standard_error
from service.directories import keep_private
from service.queue.machinery import job_machinery
from service.settings import Settings, load_settings
from service.store import DirectoryLock
from service.store.schema import shown
from service.worker.catalogue import default_registry


def run_work(**options: object) -> None:
    """Run jobs until stopped by SIGTERM or SIGINT; workers end with the scheduler."""
    settings = load_settings(**options)
    keep_private()
    log_to_standard_error()
    lock = DirectoryLock(settings.data_directory)
    lock.acquire()
    stopped = threading.Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    try:
        _work(settings, stopped)
    finally:
        lock.release()
    leave()


def _work(settings: Settings, stopped: threading.Event) -> None:
    """Run jobs until `stopped`."""
    with closing(job_machinery(settings, default_registry())) as machinery:
        machinery.scheduler.start()
        try:
            print(f"lineofaction works for {shown(machinery.engine)}", flush=True)  # noqa: T201 (command line)
            stopped.wait()
        finally:
            machinery.scheduler.stop()
