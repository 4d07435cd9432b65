"""The warm process: it has imported and compiled the code of workers, and forks a worker on request.

Started as ``python -m host.children.fork_server DESCRIPTOR WORK MODULE ...`` in a session of its own. It
imports the modules and does what their `warm_up` does, if they have one; then it says so, and obeys one
request after the other: fork a child that does the `work` of the module WORK on given descriptors, reap one.
It has no threads, reads no order and no caller's data. It ends when its starter closes the socket or is gone.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import socket
import sys
import traceback
from collections.abc import Callable
from typing import Any, NoReturn, TypeAlias

from host.sessions import lead_session, reap

Work: TypeAlias = Callable[[int], None]
"""Function that a child runs; it answers on a descriptor."""

READY = b"ready"
MESSAGE_BYTES = 1 << 16
DESCRIPTORS = 3
"""Number of the descriptors of a child: orders, channel and log."""


def main() -> None:
    """Warm up, then serve requests until the starter is gone."""
    channel = socket.socket(fileno=int(sys.argv[1]))
    work: Work = importlib.import_module(sys.argv[2]).work
    for name in sys.argv[3:]:
        try:
            getattr(importlib.import_module(name), "warm_up", lambda: None)()
        except Exception:  # noqa: BLE001 (the log has it; the job that needs it says so)
            traceback.print_exc()
    gc.collect()
    gc.freeze()  # what is here is shared by all children: collections shall not touch it
    channel.send(READY)
    while True:
        message, descriptors, _, _ = socket.recv_fds(channel, MESSAGE_BYTES, DESCRIPTORS)
        if not message:
            return
        channel.send(json.dumps(_obeyed(json.loads(message), descriptors, channel, work)).encode())


def _obeyed(request: dict[str, Any], descriptors: list[int], channel: socket.socket, work: Work) -> Any:
    """Fork a child and return its id, or reap one and return how it ended."""
    if "reap" in request:
        return reap(request["reap"])
    # the child closes its end of this pipe once it leads a session; `os.read` below waits for that
    wait_end, child_end = os.pipe()
    try:
        _flush()
        if (pid := os.fork()) == 0:
            channel.close()
            os.close(wait_end)
            _become_worker(descriptors, request["workspace"], child_end, work)
        os.close(child_end)
        os.read(wait_end, 1)  # from now on the group of the child can be killed
        return pid
    except OSError as error:
        os.close(child_end)
        return {"errno": error.errno, "strerror": error.strerror}
    finally:
        for descriptor in (wait_end, *descriptors):
            os.close(descriptor)


def _become_worker(descriptors: list[int], workspace: str, child_end: int, work: Work) -> NoReturn:
    """Run this fork as a worker until its end; close `child_end` once it leads its session."""
    code = 1
    try:
        lead_session()
        os.close(child_end)
        orders, answers, log = descriptors
        for source, target in ((orders, 0), (log, 1), (log, 2)):
            os.dup2(source, target)
        os.close(orders)
        os.close(log)
        os.chdir(workspace)
        work(answers)
        code = 0
    except SystemExit as end:
        sys.stderr.write(f"{end}\n")
    except BaseException:  # noqa: BLE001 (nothing may return into the loop of the parent)
        traceback.print_exc()
    finally:
        _flush()
        os._exit(code)


def _flush() -> None:
    """Empty the buffers of standard output and error, which a fork would write once more."""
    sys.stdout.flush()
    sys.stderr.flush()


if __name__ == "__main__":
    main()
