"""Cost of the 64 x 12 x 5 table of a helical pair, and of a new curve from cached compliance."""

from __future__ import annotations

import tempfile

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_CODE = """
import dataclasses, math, resource
from pathlib import Path
from fe_contact import FlankModification, Gear, GearPair, analyze
def cpu():
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(u.ru_utime + u.ru_stime for u in used)
pinion = Gear(
    teeth=39, normal_module=3e-3, face_width=25e-3, bore_diameter=60e-3,
    helix_angle=math.radians(26.0), profile_shift_coefficient=0.46846,
)
wheel = dataclasses.replace(pinion, teeth=40, helix_angle=-pinion.helix_angle)
pair = GearPair(pinion, wheel, 134.5e-3)
loads = [500.0 * k for k in range(1, 13)]
skew = [0.0, 15e-6, 30e-6, 45e-6, 60e-6]
common = dict(positions=64, level={level!r}, cache=Path({cache!r}))
def table():
    start = cpu()
    database = analyze(pair, normal_forces=loads, misalignments=skew, **common)
    return cpu() - start, database
from fe_contact.compliance import predict_cost
from fe_contact.mesh import SectorRecipe
predicted = sum(predict_cost(g, getattr(SectorRecipe, {level!r})(g)).seconds for g in (pinion, wheel))
cold, database = table()
stages = database.metadata.receipt["stages"]
spent = stages["compliance"]["cpu_seconds"]
assessing = 100 * stages["error estimate"]["cpu_seconds"] / cold
cached, _ = table()
crowned = dataclasses.replace(pinion, modification=FlankModification(helix_crowning=5e-6))
start = cpu()
analyze(GearPair(crowned, wheel, 134.5e-3), normal_forces=[6000.0], **common)
fresh = cpu() - start
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.plan import make_plan
import numpy as np
axes, options = TableAxes(normal_forces=[6000.0]), AnalysisOptions(level={level!r})
asked = check_request(GearPair(crowned, wheel, 134.5e-3), axes, options)
plan = make_plan(pair, asked.request.load, asked.request.options, asked.model)
contact = pair_contact(pair, plan, Path({cache!r}))
position, load = np.arange(64) / 64, np.array([6000.0])
contact.solve(asked.model, position, load)
start = cpu()
contact.solve(asked.model, position, load)
curve = cpu() - start
aligned = database.curve(force=6000.0, misalignment=0.0)
mean, ripple = aligned.mean, aligned.peak_to_peak
measured = {{
    "prediction": predicted / spent, "assessing": assessing,
    "cold": cold, "cached": cached, "fresh": fresh, "curve": curve, "failed": database.n_failed,
    "peak": database.metadata.receipt["peak_memory_bytes"],
    "mean_error": 100 * mean.error / mean.value, "ripple_error": 100 * ripple.error / ripple.value,
}}
"""
_TARGETS = {"draft": 25.0, "standard": 60.0}


def figures() -> list[Figure]:
    """Return the figures of both levels."""
    return [figure for level in _TARGETS for figure in _level(level)]


def _level(level: str) -> list[Figure]:
    """Measure one level in a process with compiled loops and an empty cache of compliances."""
    _run(level)  # may compile
    run = _run(level)
    subject = f"39/40 helical pair, 64 x 12 x 5 table, {level}"
    return [
        Figure(
            subject,
            "cold: meshes, finite elements, contact, error estimate",
            run["cold"],
            "CPU s",
            _TARGETS[level],
        ),
        Figure(subject, "compliance: predicted over spent", run["prediction"], "-"),
        Figure(subject, "error estimates, in parts of the cold run", run["assessing"], "%", 30.0),
        Figure(subject, "with cached compliance", run["cached"], "CPU s", 3.0),
        Figure(subject, "a new crowning: a database of 64 positions", run["fresh"], "CPU s"),
        Figure(
            subject, "a new crowning: a curve of 64 positions, compliance in hand", run["curve"], "CPU s", 0.1
        ),
        Figure(subject, "failed", run["failed"], "points", 0.0),
        Figure(subject, "peak memory", run["peak"] / 2**30, "GiB", 3.0),
        Figure(subject, "own error estimate of the mean at 6 kN", run["mean_error"], "%"),
        Figure(subject, "own error estimate of peak-to-peak at 6 kN", run["ripple_error"], "%"),
    ]


def _run(level: str) -> dict[str, float]:
    """One process with an empty cache of compliances."""
    with tempfile.TemporaryDirectory() as cache:
        return measure(_CODE.format(level=level, cache=cache))
