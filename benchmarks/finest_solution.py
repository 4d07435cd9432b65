"""The finest solution of a pair that can be afforded: the reference of stated errors and tolerances."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.assessed import HARMONICS
from benchmarks.pair_cases import PairCase
from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.geometry import Toothing
from fe_contact.mesh import SectorRecipe
from fe_contact.planning.discretization import (
    FINER_SLICES,
    Discretization,
    FaceDiscretization,
    PlaneDiscretization,
)
from fe_contact.planning.plan import Plan, make_plan, patch_rules
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import FloatArray

FINER, SLICES = 1.5, FINER_SLICES[-1]
"""Element size of the level fine over that of the finest solution, and its number of slices."""
PLANE_POSITIONS, FACE_POSITIONS = 512, 128
_SAMPLES, _FEW = 4096, 50


def finest(case: PairCase, cache: Path) -> FloatArray:
    """Return mean, peak-to-peak and three harmonics (5, loads) in m.

    On elements and layers `FINER` times as fine as those of the level fine, over the face in `SLICES` slices,
    at many positions.
    """
    checked = check_request(case.pair, *case.request(level="fine"))
    return solved_finely(checked, pair_contact(checked.request.pair, finest_plan(checked), cache))


def finest_plan(checked: Checked) -> Plan:
    """Plan a request of the level fine on meshes, or in slices, beyond it."""
    request = checked.request
    plan = make_plan(request.pair, request.load, request.options, checked.model)
    made = _finer(plan.discretization, plan.bodies(request.pair))
    patch, _, _ = patch_rules(request.pair, float(plan.load[-1]), made)
    return replace(plan, discretization=made, patch=patch)


def solved_finely(checked: Checked, contact: PairContact) -> FloatArray:
    """Return the quantities (5, loads) in m of the one place of a request at many positions."""
    request = checked.request
    (place,) = operating_points(request.scene, request.choices, contact).places
    flat = isinstance(contact.plan.discretization, PlaneDiscretization)
    position = np.arange(count := PLANE_POSITIONS if flat else FACE_POSITIONS) / count
    curves = place.solve(position, request.load)[1].deflection
    return np.stack([_quantities(position, curve) for curve in curves.T], axis=1)


def _quantities(position: FloatArray, curve: FloatArray) -> FloatArray:
    """Return the quantities (5,) of one curve (P,) in m; its neighbors stand in for a position that failed.

    Raises
    ------
    RuntimeError
        More than one in `_FEW` positions failed.
    """
    solved = np.isfinite(curve)
    if np.sum(~solved) * _FEW > curve.size:
        raise RuntimeError(f"{np.sum(~solved)} of {curve.size} positions of the finest solution failed")
    even = interpolate(Axis(position[solved], 1.0), curve[solved], np.arange(_SAMPLES) / _SAMPLES)
    lines = 2.0 * np.abs(np.fft.rfft(even)[1 : HARMONICS + 1]) / _SAMPLES
    return np.array([even.mean(), np.ptp(even), *lines])


def _finer(made: Discretization, bodies: tuple[Toothing, Toothing]) -> Discretization:
    """Return a discretization beyond "fine"."""
    if isinstance(made, FaceDiscretization):
        first, second = (recipe.scaled(1.0 / FINER) for recipe in made.recipes)
        return replace(made, recipes=(first, second)).in_slices(SLICES)
    one, two = (recipe.refined(FINER) for recipe in made.recipes)
    solids = None
    if made.finite_width is not None:
        solids = (_fine_solid(bodies[0]), _fine_solid(bodies[1]))
    return replace(made, recipes=(one, two), finite_width=solids)


def _fine_solid(gear: Toothing) -> SectorRecipe:
    """Return solids of half the face with elements of 0.6 of the usual size and one more layer."""
    return replace(SectorRecipe.even_load(gear).scaled(0.6), layers=4)
