"""Do the stated errors of largest pressure and K_Hbeta in searches cover a finer solution? Drawn pairs."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.drawn_pairs import fresh_pairs, in_plane
from benchmarks.error_coverage import LEVELS
from benchmarks.figures import Figure
from benchmarks.finest_solution import FACE_POSITIONS, PLANE_POSITIONS
from benchmarks.pair_cases import PairCase
from fe_contact import analyze
from fe_contact.microgeometry.confirmed_figures import confirmed_figures
from fe_contact.microgeometry.design_study import DesignSpace, design_study
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.scatter import NO_SCATTER
from fe_contact.options import AnalysisOptions, Run
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.types import FloatArray
from model_studies.stage_clock import StageClock

SUBJECT = "errors of limits in searches, ten drawn pairs"
NAMES = {"largest pressure": "pressure", "K_Hbeta": "face_load_factor"}
COVERAGE, POSITIONS, ROUNDING = 95.0, 64, 1e-9


class Held(NamedTuple):
    """A figure at L loads: stated and true errors in parts of it (L,)."""

    name: str
    stated: FloatArray
    true: FloatArray


def figures() -> list[Figure]:
    """Return how many errors are not covered, and by how much they exceed the true ones."""
    found, rows = list(assessed()), []
    for name in NAMES:
        parts = [(each.stated, each.true) for each in found if each.name == name]
        stated, true = (np.concatenate(each) for each in zip(*parts, strict=True))
        missed = 100.0 * float(np.mean(true > stated + ROUNDING))
        acting = true > ROUNDING
        ratio = float(np.median(stated[acting] / true[acting]))
        rows += [
            Figure(SUBJECT, f"{name}: not covered, of {true.size}", missed, "%", 100.0 - COVERAGE),
            Figure(SUBJECT, f"{name}: median stated over true", ratio, "times"),
            Figure(SUBJECT, f"{name}: median stated", 100.0 * float(np.median(stated)), "%"),
            Figure(SUBJECT, f"{name}: largest true", 100.0 * float(true.max()), "%"),
        ]
    return rows


def assessed() -> Iterator[Held]:
    """Hold designs on two meshes against the mesh fine in the most slices, at more positions."""
    for case in fresh_pairs():
        with tempfile.TemporaryDirectory() as folder:
            yield from _assessed(case, Path(folder))


def _assessed(case: PairCase, cache: Path) -> Iterator[Held]:
    fine = _evaluator(case, "fine", PLANE_POSITIONS if in_plane(case) else FACE_POSITIONS, cache)
    made = fine.contact.plan.discretization
    if isinstance(made, FaceDiscretization):
        fine = replace(fine, contact=fine.contact.in_slices(made.max_slices))
    finer = fine.evaluate({})
    for level in LEVELS:
        own = _evaluator(case, level, POSITIONS, cache)
        if in_plane(case):  # handovers are steep: a table has positions beside them
            table = analyze(case.pair, normal_forces=case.forces, cache=cache, level=level, **case.options)
            own = own.at(table.position)
        stated = confirmed_figures(own, {}, cache)
        for name, limited in NAMES.items():
            value, error, true = (
                getattr(of, each)[0]
                for of, each in ((stated, limited), (stated, f"{limited}_error"), (finer, limited))
            )
            yield Held(name, error / value, np.abs(true / value - 1.0))


def _evaluator(case: PairCase, level: str, positions: int, cache: Path) -> Evaluator:
    options = dict(case.options)
    (skew,) = options.pop("misalignments", (0.0,))
    space = DesignSpace(case.pair, {}, NO_SCATTER, skew, positions, AnalysisOptions(level=level, **options))
    torques = [float(case.pair.torque(force)) for force in case.forces]
    return design_study(space, torques, (), StageClock(), Run(cache=cache)).evaluator
