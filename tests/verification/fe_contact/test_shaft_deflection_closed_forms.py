"""Shaft deflection against closed forms: slices that are springs of their own on a gear that tilts."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from fe_contact import Gear, GearPair
from fe_contact.contact import (
    ContactModel,
    ContactProblem,
    PatchRule,
    Slices,
    contact_candidates,
    solve_contact,
    with_compliances,
)
from fe_contact.effects.shaft_deflection import _SeatCompliance, _ShaftCompliance
from fe_contact.geometry import Shaft

SOURCE = "thin slices on a beam, closed form"
WIDTH, STIFFNESS, COUNT = 20e-3, 15e9, 200  # m, N/m per m of face, slices
RIGID = 2e-17
"""2 (1 - nu^2)/(pi E) in 1/Pa of bodies a hundred thousand times stiffer than steel: next to no approach.

Forces follow from the local approach, a difference of motions: the stiffer the bodies, the more rounding.
"""
GEAR = Gear(teeth=20, normal_module=4e-3, face_width=WIDTH, bore_diameter=40e-3)
PAIR = GearPair(GEAR, GEAR, 80e-3)


def loaded(
    seats: tuple[_SeatCompliance | None, _SeatCompliance | None], force: np.ndarray, rigid: float = RIGID
):
    """Deflection and line load of one pair at the pitch point, at each normal force."""
    slices = Slices.of_pair(PAIR, COUNT, 1)
    candidates = contact_candidates(PAIR, ContactModel(), np.zeros(1), PatchRule(1e-3, 1e-4), slices)
    # one point a slice that moves with its own slice alone: no curve through the means of its neighbors
    candidates = dataclasses.replace(candidates, blend=np.eye(COUNT))
    only = candidates.pair == 0
    gap = np.where(only, candidates.gap, np.inf)
    candidates = candidates.touching(dataclasses.replace(candidates.touch, gap=gap))
    springs = np.eye(only.size)[None] / (STIFFNESS * WIDTH / COUNT)
    problem = ContactProblem(candidates, springs, 1.0 / (math.pi * rigid), rigid, rigid)
    model = ContactModel(compliances=(_ShaftCompliance(*seats),))
    solution = solve_contact(with_compliances(PAIR, problem, model), force)
    assert solution.converged
    return solution.deflection[0], solution.force[0][:, only] / (WIDTH / COUNT)


def closed_form(seats: tuple[_SeatCompliance, ...]) -> tuple[float, float]:
    """Deflection per force and K_Hbeta where the whole face carries.

    With the line load q = c (d - u - v z), force c b (d - u), moment -c v b^3/12, and u, v from the seats.
    """
    translation, coupling, tilt = (
        sum(getattr(seat, name) for seat in seats) for name in ("translation", "coupling", "tilt")
    )
    inertia = STIFFNESS * WIDTH**3 / 12.0
    slope = coupling / (1.0 + tilt * inertia)  # v per force
    deflection = translation - coupling * slope * inertia + 1.0 / (STIFFNESS * WIDTH)
    return deflection, 1.0 + STIFFNESS * abs(slope) * 0.5 * WIDTH**2


@pytest.mark.parametrize("position", [0.03, 0.06, 0.1, 0.13, 0.22])
def test_tilting_shafts_load_one_end_in_proportion_to_the_load(position, record_figure):
    """K_Hbeta above 1, the same at every load: misalignment grows with it."""
    shaft = Shaft(length=0.2, diameter=0.045, position=position, bearing_stiffness=5e8)
    seats = (
        _SeatCompliance.of_shaft(shaft),
        _SeatCompliance.of_shaft(dataclasses.replace(shaft, diameter=0.06)),
    )
    force = np.array([300.0, 3000.0, 30000.0])
    deflection, load = loaded(seats, force)
    per_force, k_h_beta = closed_form(seats)
    found = load.max(axis=1) / load.mean(axis=1)
    record_figure(f"K_Hbeta, gear at {1e3 * position:g} of 200 mm", float(found[1]), k_h_beta, "-", SOURCE)
    assert load.min() > 0.0
    assert deflection == pytest.approx(per_force * force, rel=1e-5, abs=0.0)
    # the middle of the last slice stands half of its own width from its end
    assert found - 1.0 == pytest.approx(
        np.full(3, (k_h_beta - 1.0) * (1.0 - 1.0 / COUNT)), rel=1e-4, abs=1e-9
    )
    # the end nearer to a bearing gives way less; a gear beside them loads its inner end
    assert (np.argmax(load[1]) > COUNT / 2) == (0.1 < position < 0.2) or position == 0.1


def test_load_grows_uneven_the_further_the_gear_stands_from_the_middle():
    uneven = []
    for position in (0.1, 0.08, 0.06, 0.05):
        seat = _SeatCompliance.of_shaft(Shaft(length=0.2, diameter=0.04, position=position))
        _, load = loaded((seat, None), np.array([3000.0]))
        uneven.append(load.max() / load.mean())
    assert uneven[0] == pytest.approx(1.0, abs=1e-9)
    assert np.all(np.diff(uneven) > 0.01)


def test_partial_contact_satisfies_its_own_tilt():
    """Where the tilt lifts part of the face off, the load that is left bends the shaft to that tilt."""
    seat = _SeatCompliance(translation=1e-8, coupling=1e-6, tilt=1e-5)
    deflection, load = loaded((seat, None), np.array([2000.0]), rigid=0.05 * RIGID)
    z = Slices.of_pair(PAIR, COUNT).center
    slice_force = load[0] * WIDTH / COUNT
    force, moment = slice_force.sum(), slice_force @ z
    u, v = seat.translation * force + seat.coupling * moment, seat.coupling * force + seat.tilt * moment
    expected = np.maximum(STIFFNESS * (deflection[0] - u - v * z), 0.0)
    assert 0.1 < np.mean(load[0] > 0.0) < 0.9
    assert force == pytest.approx(2000.0, rel=1e-9)
    assert load[0] == pytest.approx(expected, rel=1e-6, abs=1e-6 * load.max())
