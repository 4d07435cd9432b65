"""``loa work``."""

from __future__ import annotations

import signal
import threading
from contextlib import closing
from functools import partial
from types import FrameType

from prometheus_client import generate_latest

from host.directories import keep_private
from lineofaction.cli.interrupt import leave
from lineofaction.cli.log import log_to_standard_error
from lineofaction.cli.managed import announce_management, managed
from service.management.registry import process_registry
from service.management.vitals import Vitals
from service.queue.machinery import job_machinery
from service.settings import Settings, load_settings
from service.store import DirectoryLock
from service.store.deployment import Deployment
from service.store.schema import shown
from service.store.write_check import WriteCheck
from service.tracing.tracer import tracer
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
        engine, store, scheduler = machinery.engine, machinery.store, machinery.scheduler
        writes = WriteCheck(Deployment(engine, store))
        registry = process_registry(engine, store, writes, scheduler, settings)
        with managed(settings, Vitals(scheduler, writes), partial(generate_latest, registry)) as where:
            scheduler.start()
            try:
                print(f"lineofaction works for {shown(engine)}", flush=True)  # noqa: T201 (command line)
                announce_management(where)
                stopped.wait()
            finally:
                scheduler.stop()
                tracer().flush()
