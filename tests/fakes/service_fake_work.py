"""The work of the fake process; imports little, as its worker starts often."""

import logging
import os
import resource
import subprocess
import time
from pathlib import Path

from bounds import below
from fe_contact.cache_reads import COMPLIANCE_READS
from fe_contact.errors import InputError, MeshError
from service.version import solver_version
from service.worker.order import Product, Progress, WorkOrder

SECRET = "the text of a defect"
_TEXT, _NONCE = 20, 20


def work(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    wish = order.inputs["wish"]
    with (order.data_directory / f"started_{order.key[:8]}").open("a") as stream:
        stream.write(f"{os.getpid()} {os.nice(0)} {os.environ['OMP_NUM_THREADS']}\n")
    progress("first", 0.5)
    _misbehave(order, wish["mode"])
    progress("first", 1.0)
    file = order.workspace / "result.nc"
    if wish["mode"] == "slow":
        _write_slowly(file, slow_content(wish["text"]), progress)
        return (Product(order.key, "database", file),)
    if wish["mode"] == "sign":
        time.sleep(0.3)
        file.write_text(f"{wish['text']} by {solver_version()}")
        return (Product(order.key, "database", file),)
    progress("second", 1.0)
    left = order.workspace / "left"
    file.write_text(left.read_text() if left.exists() else wish["text"])
    return (Product(order.key, "database", file),)


def named(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Make a file with the name of the result, whatever the inputs are."""
    progress("named", 1.0)
    file = order.workspace / "result.nc"
    file.write_text(order.key)
    return (Product(order.key, "database", file),)


def slow_content(text: str) -> bytes:
    """Return a result of slow work, 200 kB: another for each attempt, so that a second one shows."""
    return _repeated(text, os.urandom(_NONCE // 2).hex().encode())


def is_slow_content(content: bytes, text: str) -> bool:
    """Whether this is one whole result of slow work for a text."""
    return content == _repeated(text, content[_TEXT : _TEXT + _NONCE])


def _repeated(text: str, nonce: bytes) -> bytes:
    return (text.encode().ljust(_TEXT, b".") + nonce) * 5_000


def _write_slowly(file: Path, content: bytes, progress: Progress) -> None:
    """Take a second or so, with part of the result on disk all the time."""
    pieces = 25
    size = len(content) // pieces
    with file.open("wb", buffering=0) as stream:
        for n in range(pieces):
            stream.write(content[n * size : (n + 1) * size])
            progress("second", n / pieces)
            time.sleep(0.04)


def _misbehave(order: WorkOrder, mode: str) -> None:
    if mode == "hang" or (mode == "hang_thrice" and _starts(order) <= 3):
        grandchild = subprocess.Popen(["sleep", "600"])
        (order.data_directory / f"grandchild_{order.key[:8]}").write_text(str(grandchild.pid))
        time.sleep(600)
    if mode == "burn":
        subprocess.run(["sh", "-c", "while :; do :; done"], check=True)
    if mode == "die" or (mode == "die_once" and _first_time(order)):
        os._exit(7)
    if mode == "leave_and_die" and _first_time(order):
        (order.workspace / "left").write_text("left behind")
        os._exit(7)
    if mode == "abort":
        os.abort()
    if mode == "hog":
        _hold = bytearray(300 << 20)
    if mode == "full":
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
    if mode == "warn":
        logging.getLogger("service.queue").warning("the cluster is %s", "away")
    if mode == "condense":
        for hit in (False, True, False):
            COMPLIANCE_READS.note(hit=hit)
    _raise(mode)


def _raise(mode: str) -> None:
    if mode == "mesh":
        raise MeshError("element 7 has a negative Jacobian")
    if mode == "input":
        bound = below(0.07, "m", "the root diameter")
        raise InputError("pinion.bore_diameter", 0.095, bound, "Lower the bore.")
    if mode == "defect":
        raise RuntimeError(SECRET)


def _first_time(order: WorkOrder) -> bool:
    return _starts(order) == 1


def _starts(order: WorkOrder) -> int:
    return len((order.data_directory / f"started_{order.key[:8]}").read_text().splitlines())
