"""One case of the sweep: a table that obeys the conditions of contact, within the time it was predicted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from fe_contact.analysis import analyze
from fe_contact.analysis.studies.warm_up import warm_up
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import SteDatabase
from lineofaction.hardcases.scene import HardScene, Measured
from lineofaction.hardcases.soundness import LARGEST_RESIDUAL, MOST_ITERATIONS
from lineofaction.hardcases.sweep.random_request import Kind, random_request

_SLACK = 3.0
"""How many times its predicted time a case may take, on a host that is busy with other things."""
_START = 3.0
"""Seconds on top: a prediction knows no start-up and no compilation."""
_HANGS = 3600.0
"""Elapsed seconds after which a case counts as hanging; the longest take minutes of CPU time."""


def sweep_case(kind: Kind, seed: int) -> HardScene:
    """Return one random case as a scene."""
    return HardScene(
        f"{kind}_{seed}",
        "sweep",
        "Anything may come.",
        "A converged table with residuals below tolerance, within its predicted time, or one clear refusal.",
        partial(measure, kind, seed),
        _HANGS,
    )


def measure(kind: Kind, seed: int) -> Sequence[Measured]:
    """Compute the table that `seed` picks; what a process does once is done before."""
    warm_up(across_face=kind == "face")
    pair, arguments = random_request(kind, seed)
    return assessed(pair, arguments)


def assessed(pair: ParallelAxes, arguments: Mapping[str, Any]) -> Sequence[Measured]:
    """Analyze a pair and assess the table by what every table must obey."""
    table = analyze(pair, **arguments)
    receipt = table.metadata.receipt
    predicted = float(receipt["prediction"]["cpu_seconds"])
    spent = float(receipt["cpu_seconds"])
    return (
        Measured("failed points", float(table.n_failed), most=0.0),
        Measured("points", float(table.status.size)),
        Measured("largest residual", float(receipt["residuals_max"]), most=LARGEST_RESIDUAL),
        Measured("most iterations", float(receipt["newton_iterations_max"]), most=MOST_ITERATIONS),
        Measured("values that are no numbers", float(_none(table)), most=0.0),
        Measured("least growth of STE with load, relative", _growth(table), least=0.0),
        Measured("load shares off one", float(np.abs(table.load_share.sum(axis=-1) - 1.0).max()), most=1e-9),
        Measured("least load share", float(table.load_share.min()), least=-1e-12),
        Measured("force at lift-off, N", _force_at_lift_off(table), most=0.0),
        Measured("CPU time, s", spent, most=_SLACK * predicted + _START),
        Measured("predicted CPU time, s", predicted),
        Measured("points whose contact outgrew its patch", float(receipt["patch_outgrown_points"])),
    )


def _none(table: SteDatabase) -> int:
    """Count values that are no numbers."""
    names = (
        "static_transmission_error",
        "tangent_compliance",
        "no_load_transmission_error",
        "load_share",
        "face_centroid",
        "max_pressure",
    )
    return sum(int(np.count_nonzero(~np.isfinite(getattr(table, name)))) for name in names)


def _growth(table: SteDatabase) -> float:
    """Return the least growth of STE from load to load over the elastic deflection."""
    lift_off = table.no_load_transmission_error[:, None]
    elastic = np.concatenate([lift_off, table.static_transmission_error], axis=1) - lift_off
    return float((np.diff(elastic, axis=1) / elastic[:, -1:]).min())


def _force_at_lift_off(table: SteDatabase) -> float:
    """Return the largest force that the table gives where the flanks just touch, N."""
    deflection = table.no_load_transmission_error[:, 0, 0]
    return float(np.max(table.force_at(table.position, deflection).force))
