"""Rings closed by a few harmonics against rings of which every harmonic is solved."""

from dataclasses import replace

import numpy as np
import pytest
from compliance_gears import HELICAL, SPUR, coarse, relative

from fe_contact.compliance import flank_compliance_3d
from fe_contact.compliance.condensed_gear import CondensedTooth, condensed_tooth, free_turn
from fe_contact.compliance.cyclic_harmonics import TurningLoads
from fe_contact.compliance.cyclic_ring import FreeTurn, close_ring
from fe_contact.compliance.tooth_reach import usual_reach
from fe_contact.geometry import BoreSeat, Gear, GearBlank, Key, RingGear, Toothing
from fe_contact.mesh import quad_sector
from fe_contact.mesh.bore_support import bore_support
from model_studies.stage_clock import StageClock

MANY = replace(SPUR, teeth=120, bore_diameter=380e-3)
THIN = Gear(120, 4e-3, 20e-3, 100e-3, helix_angle=0.3, blank=GearBlank(5e-3, 5e-3, 120e-3))
KEYED = replace(HELICAL, teeth=40, bore_diameter=100e-3, seat=BoreSeat(1e13, 2e13, 1e13, key=Key(12e-3)))
GEARS = {
    "few teeth": replace(HELICAL, teeth=17),
    "solid": replace(HELICAL, teeth=41, bore_diameter=60e-3),
    "many teeth": MANY,
    "thin rim and web": THIN,
    "internal": RingGear(90, 4e-3, 20e-3, 440e-3, helix_angle=0.3, addendum_coefficient=0.8),
    "keyed": KEYED,
}


def condensed(gear: Toothing) -> tuple[CondensedTooth, np.ndarray, FreeTurn | None]:
    recipe = coarse(gear, layers=8)
    section = quad_sector(gear, recipe)
    tooth, loads = condensed_tooth(gear, section, recipe, bore_support(gear), StageClock())
    return tooth, loads, free_turn(section, tooth.sector)


def solved_harmonics(monkeypatch: pytest.MonkeyPatch, size: int) -> list[int]:
    """Return a list that gets the number of each harmonic that is solved on all freedoms of a cut."""
    numbers: list[int] = []
    genuine = TurningLoads.solve

    def counted(ring, number):
        if len(ring.across) == size:
            numbers.append(number)
        return genuine(ring, number)

    monkeypatch.setattr(TurningLoads, "solve", counted)
    return numbers


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("name", GEARS)
def test_blocks_are_as_exact_as_stated(name, monkeypatch, request):
    gear = GEARS[name]
    tooth, loads, free = condensed(gear)
    solved = solved_harmonics(monkeypatch, tooth.condensed.cut_size)

    def ring():
        return close_ring(tooth.condensed, gear.teeth, usual_reach(gear), loads, free)

    found = ring()
    assert len(solved) <= 8  # of any number of teeth
    request.getfixturevalue("exact_ring")
    exact = ring()
    assert exact.error < 1e-12
    flank = slice(0, len(tooth.sector.flank))
    largest = np.abs(tooth.condensed.flank[flank, flank]).max()
    error = np.abs(found.blocks - exact.blocks)[:, flank, flank].max() / largest
    assert 1e-3 * found.error < error < found.error <= 1e-6


@pytest.mark.law
def test_a_key_adds_no_error(request):
    """The update by the key is made of displacements that are as exact as the blocks."""

    def blocks():
        found = flank_compliance_3d(KEYED, coarse(KEYED, layers=8), reach=2)
        return np.stack([found.block(tooth, other) for tooth, other in ((0, 0), (2, 1), (-1, 1))])

    found = blocks()
    request.getfixturevalue("exact_ring")
    exact = blocks()
    assert 1e-10 < relative(found, exact) < 1e-6
