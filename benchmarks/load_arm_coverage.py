"""Do the stated errors of the load arm cover a finer solution? Drawn pairs over the face, two meshes."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.assessed import QUANTITIES, STATED, Assessed, coverage_figures
from benchmarks.drawn_pairs import assessed_pairs, fresh_pairs
from benchmarks.error_coverage import LEVELS
from benchmarks.figures import Figure
from benchmarks.finest_solution import FACE_POSITIONS
from benchmarks.pair_cases import PairCase
from fe_contact import analyze
from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import load_arm
from fe_contact.planning.discretization import FINER_SLICES
from fe_contact.planning.plan import make_plan, patch_rules
from fe_contact.ste.curve_errors import all_sources
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import FloatArray

SUBJECTS = {
    "load arm, pairs its constants were set on": assessed_pairs,
    "load arm, other pairs": fresh_pairs,
}
_COVERAGE, _SAMPLES = 95.0, 4096


def figures() -> list[Figure]:
    """Return the coverage."""
    return [row for name in SUBJECTS for row in coverage_figures(assessed(name), name, _COVERAGE)]


@cache
def assessed(subject: str) -> tuple[Assessed, ...]:
    """Hold every pair over the face at every level against the mesh fine in the most slices."""
    found: list[Assessed] = []
    for case in SUBJECTS[subject]():
        if case.pair.base_helix_angle or case.options:
            with tempfile.TemporaryDirectory() as folder:
                found += assess(case, Path(folder))
    return tuple(found)


def assess(case: PairCase, cache: Path, levels: Sequence[str] = LEVELS) -> list[Assessed]:
    """Hold the tables of a pair against the finer solution."""
    true, found = _finer(case, cache), []
    for level in levels:
        table = analyze(case.pair, normal_forces=case.forces, cache=cache, level=level, **case.options)
        value = _quantities(table.position, table.load_arm[:, :, 0, 0])
        stated = all_sources(table.load_arm_error[..., 0, 0])[list(STATED)]
        found.append(Assessed(case.name, level, np.abs(value), stated, np.abs(value - true)))
    return found


def _finer(case: PairCase, cache: Path) -> FloatArray:
    checked = check_request(case.pair, *case.request(level="fine"))
    request = checked.request
    plan = make_plan(request.pair, request.load, request.options, checked.model)
    made = plan.discretization.in_slices(FINER_SLICES[-1])  # type: ignore[union-attr]
    patch, _, _ = patch_rules(request.pair, float(plan.load[-1]), made)
    contact = pair_contact(request.pair, replace(plan, discretization=made, patch=patch), cache)
    (place,) = operating_points(request.scene, request.choices, contact).places
    position = np.arange(FACE_POSITIONS) / FACE_POSITIONS
    return _quantities(position, load_arm(contact.pair, *place.solve(position, request.load)))


def _quantities(position: FloatArray, arms: FloatArray) -> FloatArray:
    """Return mean, peak-to-peak and harmonics (5, loads) of arms (P, loads), m."""
    even = interpolate(Axis(position, 1.0), arms, np.arange(_SAMPLES) / _SAMPLES)
    lines = 2.0 * np.abs(np.fft.rfft(even, axis=0)[1 : len(QUANTITIES) - 1]) / _SAMPLES
    return np.stack([even.mean(axis=0), np.ptp(even, axis=0), *lines])
