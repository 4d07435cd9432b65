"""Cost of a receipt: runs with cached compliance, full and minimal receipts by turns in one process."""

from __future__ import annotations

import math
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from benchmarks.figures import Figure
from fe_contact import Gear, GearPair, analyze
from fe_contact.analysis.studies.frontier import warm_up

SUBJECT = "receipts, compliance cached"
TARGET = 30.0
"""Largest cost of error estimates and effect ledger together, per cent of the run."""
STAGES = ("error estimate", "effect ledger")
_SPUR = Gear(teeth=20, normal_module=4e-3, face_width=20e-3, bore_diameter=30e-3)
_HELIX = math.radians(12.0)
_TORQUES = np.linspace(20.0, 240.0, 12)


class ReceiptCase(NamedTuple):
    """A table, and how many turns it is made in."""

    name: str
    pair: GearPair
    asked: dict[str, Any]
    turns: int


def cases() -> tuple[ReceiptCase, ...]:
    """Return one table and one curve of each model, positions adaptive and fixed."""
    spur, helical = GearPair(_SPUR, _SPUR, 80e-3), _helical()
    grid = {"torques": 2.0 * _TORQUES, "positions": 64, "misalignments": np.linspace(-20e-6, 20e-6, 5)}
    return (
        ReceiptCase("20/20 spur, one load, adaptive positions", spur, {"torques": [100.0]}, 40),
        ReceiptCase("20/20 spur, 12 loads, adaptive positions", spur, {"torques": _TORQUES}, 30),
        ReceiptCase(
            "39/40 helical, draft, one load, adaptive positions",
            helical,
            {"torques": [200.0], "level": "draft"},
            5,
        ),
        ReceiptCase("20/20 spur, 64 x 12", spur, {"torques": _TORQUES, "positions": 64}, 60),
        ReceiptCase("39/40 helical, draft, 64 x 12 x 5", helical, grid | {"level": "draft"}, 9),
    )


def _helical() -> GearPair:
    """Return the pair of helical gears."""
    gears = (
        Gear(
            teeth=teeth,
            normal_module=2.5e-3,
            face_width=30e-3,
            bore_diameter=60e-3,
            helix_angle=helix,
        )
        for teeth, helix in ((39, _HELIX), (40, -_HELIX))
    )
    return GearPair(*gears, 0.5 * 79 * 2.5e-3 / math.cos(_HELIX))


def figures() -> list[Figure]:
    """Return the costs of error estimates and ledger of each run."""
    warm_up(across_face=True)
    with tempfile.TemporaryDirectory() as folder:
        return [figure for case in cases() for figure in _case(case, Path(folder))]


def _case(case: ReceiptCase, cache: Path) -> list[Figure]:
    """Measure one case: medians of CPU times, since what else the machine does only adds to them."""
    spent: dict[str, list[float]] = {name: [] for name in ("full", "minimal", *STAGES)}
    for turn in range(case.turns + 1):
        for receipt in ("full", "minimal"):
            began = time.process_time()
            table = analyze(case.pair, cache=cache, receipt=receipt, **case.asked)
            if turn:  # the first one fills the cache
                spent[receipt].append(time.process_time() - began)
            for stage in STAGES if turn and receipt == "full" else ():
                spent[stage].append(table.metadata.receipt["stages"][stage]["cpu_seconds"])
    whole, minimal, errors, ledger = (median(found) for found in spent.values())
    of_errors = 100.0 * errors / (whole - ledger)
    subject = f"{SUBJECT}: {case.name}"
    return [
        Figure(subject, "minimal receipt", 1e3 * minimal, "ms"),
        Figure(subject, "error estimates, part of a run with them", of_errors, "%", TARGET),
        Figure(subject, "error estimates and ledger, part", 100.0 * (1.0 - minimal / whole), "%", TARGET),
    ]
