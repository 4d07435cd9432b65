"""The finest discretisation that can be afforded: what error estimates and tolerances are held against."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.honesty_cases import HonestyCase
from fe_contact.analysis import check_request
from fe_contact.analysis.pair_contact import PairContact, pair_contact
from fe_contact.analysis.request import Checked
from fe_contact.analysis.table_places import table_places
from fe_contact.geometry import Toothing
from fe_contact.mesh import SectorRecipe
from fe_contact.planning import FaceDiscretisation, Plan, PlaneDiscretisation, make_plan
from fe_contact.planning.discretisation import Discretisation
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import FloatArray

PLANE_FACTOR, SLICES = 1.5, 31
PLANE_POSITIONS, FACE_POSITIONS = 512, 256
_SAMPLES = 4096


@dataclass(frozen=True)
class Quantities:
    """Mean, peak-to-peak and first harmonic by load, m."""

    mean: FloatArray
    peak_to_peak: FloatArray
    first_harmonic: FloatArray

    @property
    def rows(self) -> FloatArray:
        """All of them, (3, loads)."""
        return np.stack([self.mean, self.peak_to_peak, self.first_harmonic])


def finest(case: HonestyCase, cache: Path, model: str | None = None) -> Quantities:
    """Solve a case on meshes finer than "fine", or in more slices, at many positions.

    `model` "3d" takes three dimensions where the case itself asks for the plane: aligned spur pairs, for
    which the mesh of the level fine is enough beside what the plane leaves out.
    """
    options: dict[str, Any] = {name: value for name, value in case.options.items() if name != "positions"}
    options |= {"model": model} if model else {}
    checked = check_request(case.pair, normal_forces=case.forces, level="fine", **options)
    plan = finest_plan(checked, finer=model is None)
    return solved_finely(checked, pair_contact(checked.request.pair, plan, cache))


def finest_plan(checked: Checked, *, finer: bool = True) -> Plan:
    """Plan a request of the level fine on meshes, or in slices, beyond it."""
    request = checked.request
    plan = make_plan(request.pair, request.load, request.accuracy, checked.model)
    if not finer:
        return plan
    return replace(plan, discretisation=_finer(plan.discretisation, plan.bodies(request.pair)))


def solved_finely(checked: Checked, contact: PairContact) -> Quantities:
    """Solve the one place of a request at many positions."""
    request = checked.request
    (place,) = table_places(request.scene, request.choices, contact).places
    flat = isinstance(contact.plan.discretisation, PlaneDiscretisation)
    position = np.arange(count := PLANE_POSITIONS if flat else FACE_POSITIONS) / count
    curve = place.solve(position, request.load)[1].deflection
    even = interpolate(Axis(position, 1.0), curve, np.arange(_SAMPLES) / _SAMPLES)
    lines = 2.0 * np.abs(np.fft.rfft(even, axis=0)[1]) / _SAMPLES
    return Quantities(even.mean(axis=0), np.ptp(curve, axis=0), lines)


def _finer(made: Discretisation, bodies: tuple[Toothing, Toothing]) -> Discretisation:
    """Return a discretisation beyond "fine"."""
    if isinstance(made, FaceDiscretisation):
        return made.in_slices(SLICES)
    one, two = (recipe.refined(PLANE_FACTOR) for recipe in made.recipes)
    solids = None
    if made.finite_width is not None:
        solids = (_fine_solid(bodies[0]), _fine_solid(bodies[1]))
    return replace(made, recipes=(one, two), finite_width=solids)


def _fine_solid(gear: Toothing) -> SectorRecipe:
    """Return solids of half the face with elements of 0.6 of the usual size and one more layer."""
    recipe = SectorRecipe.even_load(gear)
    sizes = ("flank_size", "tip_size", "depth_size", "depth_limit", "body_size", "body_limit")
    return replace(recipe, layers=4, **{name: 0.6 * getattr(recipe, name) for name in sizes})
