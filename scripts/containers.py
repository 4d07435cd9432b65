"""What the checks of the image share: podman, a free port, a verdict, a table to compare."""

from __future__ import annotations

import socket
import subprocess
import time
from pathlib import Path

import httpx2
import numpy as np

from fe_contact.analysis.analyze import ste_database
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.convert.case import analysis_options, case_json, check_case, table_axes
from lineofaction.gearbox.schemas import Case, read_model

CASE = Path("examples/palermo_spur_20_20.toml")
START_S, READY_S, STOP_S = 60.0, 3.0, 5.0
_SAME = 1e-9  # of a table computed here: another Python, the same libraries


def podman(*words: str) -> str:
    """Return what a command of podman prints."""
    return subprocess.run(["podman", *words], check=True, capture_output=True, text=True).stdout.strip()


def tried(*words: str) -> subprocess.CompletedProcess[str]:
    """Run a command of podman that may fail."""
    return subprocess.run(["podman", *words], check=False, capture_output=True, text=True)


def assess(what: str, figure: object, *, good: bool) -> bool:
    """Print one line of the verdict."""
    print(f"{'ok  ' if good else 'FAIL'}  {what}: {figure}", flush=True)
    return good


def free_port() -> int:
    """Return a port nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def await_answer(url: str) -> float:
    """Return the seconds until a path answered with 200; raise TimeoutError if it does not."""
    begin = time.monotonic()
    while time.monotonic() - begin < START_S:
        try:
            if httpx2.get(url).status_code == 200:
                return time.monotonic() - begin
        except httpx2.TransportError:
            pass
        time.sleep(0.05)
    raise TimeoutError(f"{url} did not answer within {START_S:g} s")


def the_case() -> Case:
    """Return the case of the checks."""
    return read_model(Case, CASE)


def same_table(client: LineOfActionClient, case: Case) -> bool:
    """Assess a table computed in containers against one computed here."""
    here = ste_database(check_case(case), table_axes(case), analysis_options(case), case=case_json(case))
    there = client.analyze(case)
    ours, theirs = (np.asarray(t.to_xarray()["static_transmission_error"]) for t in (here, there))
    apart = float(np.max(np.abs(theirs - ours)) / np.max(np.abs(ours)))
    return assess(f"table off the one computed here (below {_SAME:g})", f"{apart:.1e}", good=apart < _SAME)
