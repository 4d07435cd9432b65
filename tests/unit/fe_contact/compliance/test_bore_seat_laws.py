"""What the seat of the bore does to the flank compliance: exact turns, limits, symmetry."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from compliance_gears import HELICAL, SPUR, coarse

import fe_contact.compliance.cyclic_compliance as flow
from fe_contact.compliance import FlankCompliance3D, flank_compliance_3d
from fe_contact.compliance.condensed_gear import _probe_loads
from fe_contact.compliance.sector_stiffness import _face_mass
from fe_contact.geometry import BoreSeat, Gear, seat_compliance
from fe_contact.mesh import ClampedBore, bore_support, swept_sector
from fe_contact.mesh.sector_grid import SectorGrid


def solved(gear: Gear, reach: int | None = None) -> FlankCompliance3D:
    return flank_compliance_3d(gear, coarse(gear), reach=reach)


def moved(compliance: FlankCompliance3D, tooth: int = 0) -> float:
    """Mean displacement of the flank of a tooth under an even pressure of unit force on tooth 0, m/N."""
    loads = _probe_loads(compliance.s, compliance.z, compliance.index, compliance.s_form)[:, 0]
    return float(loads @ compliance.block(tooth, 0) @ loads / loads.sum() ** 2)


def turned(gear: Gear) -> float:
    """Mean displacement of all flanks under the load on one of them."""
    found = solved(gear, reach=4)
    return sum(moved(found, j) for j in range(-4, 5)) / 9


@pytest.mark.parametrize("gear", [SPUR, HELICAL], ids=["spur", "helical"])
@pytest.mark.parametrize("modulus", [1e12, 1e13])
def test_a_tangential_seat_adds_the_turn_of_a_rigid_body(gear: Gear, modulus: float) -> None:
    """r_b^2 cos^2(beta_b) / (2 pi r^3 b k_t), all else rigid."""
    soft = replace(gear, seat=BoreSeat(tangential_foundation=modulus))
    cosine = math.cos(gear.base_helix_angle)
    added = turned(soft) - turned(gear)
    tolerance = 2e-3 if gear.helix_angle else 2e-6
    assert added == pytest.approx(seat_compliance(soft) * cosine**2, rel=tolerance)
    assert moved(solved(soft)) - moved(solved(gear)) > added


def test_a_stiffening_seat_becomes_the_clamped_bore_at_the_rate_one_over_k() -> None:
    rigid = moved(solved(SPUR))
    left = [moved(solved(replace(SPUR, seat=BoreSeat(k, k, k)))) - rigid for k in (1e15, 1e16, 1e17)]
    assert left[1] / left[0] == pytest.approx(0.1, rel=0.1)
    assert left[2] / left[1] == pytest.approx(0.1, rel=0.02)
    assert left[2] < 1e-4 * rigid


def test_every_direction_that_gives_way_makes_the_gear_softer() -> None:
    gives = [
        BoreSeat(),
        BoreSeat(1e13),
        BoreSeat(1e13, 1e13),
        BoreSeat(1e13, 1e13, 1e13),
        BoreSeat(1e13, 5e12, 1e13),
    ]
    found = [solved(replace(HELICAL, seat=seat)).blocks[0] for seat in gives]
    for stiffer, softer in pairwise(found):
        assert np.linalg.eigvalsh(softer - stiffer).min() > -1e-12 * np.abs(softer).max()
        assert np.trace(softer) > np.trace(stiffer) * (1.0 + 1e-4)


def test_a_narrower_seat_is_softer_and_one_off_the_middle_tilts() -> None:
    wide, half, aside, mirrored = (
        solved(replace(SPUR, seat=BoreSeat(width=w, offset=z)))
        for w, z in ((None, 0.0), (10e-3, 0.0), (10e-3, 4e-3), (10e-3, -4e-3))
    )
    assert moved(wide) < moved(half) < moved(aside)
    assert moved(aside) == pytest.approx(moved(mirrored), rel=1e-10)
    image = mirrored.mirrored()
    assert image.z == pytest.approx(aside.z, abs=1e-15)
    assert np.abs(image.blocks - aside.blocks).max() < 1e-10 * np.abs(aside.blocks).max()
    assert np.array_equal(wide.blocks, solved(SPUR).blocks)


@pytest.mark.parametrize("rigid", [True, False])
def test_checks_hold_on_every_seat(rigid: bool) -> None:
    modulus = None if rigid else 3e13
    seat = BoreSeat(modulus, 2e13, modulus, width=8e-3, offset=3e-3)
    checks = solved(replace(HELICAL, seat=seat)).checks
    assert checks.residual < 1e-11
    assert checks.reciprocity < 1e-13
    assert checks.bore_moment < 1e-11
    assert checks.energy < 1e-11


def test_a_left_hand_gear_keeps_its_seat_on_its_side() -> None:
    left = replace(HELICAL, helix_angle=-HELICAL.helix_angle, seat=BoreSeat(1e13, 1e13, 1e13, 8e-3, 3e-3))
    found = solved(left)
    assert left.right_handed().seat.offset == -3e-3
    for z in left.seat.ends(20e-3):
        assert np.abs(found.z - z).min() < 1e-15
    keys = {
        flow.compliance_key_3d(g, coarse(g), 2, bore_support(g.right_handed()))
        for g in (left, left.right_handed(), HELICAL)
    }
    assert len(keys) == 2


def test_a_seat_holds_the_planes_between_its_ends() -> None:
    gear = replace(SPUR, seat=BoreSeat(None, 1e13, None, width=10e-3))
    grid, recipe = SectorGrid(body_rows=3, tooth_rows=2, land=1, across=2), coarse(SPUR)
    sector = swept_sector(grid, 20e-3, recipe, bore_support(gear))
    z = np.repeat(sector.layers.ends, 2)[:-1]
    z[1::2] = 0.5 * (sector.layers.ends[1:] + sector.layers.ends[:-1])
    held = np.full((len(z), 3), False)
    for plane in range(len(z)):
        nodes = sector.nodes[plane, grid.bore]
        held[plane] = (sector.freedoms[nodes[nodes >= 0]] == -1).all(axis=0) & (nodes >= 0).any()
    seated = np.abs(z) < 5e-3 + 1e-9
    exists = (sector.nodes[:, grid.bore] >= 0).any(axis=1)
    assert np.array_equal(held, (seated & exists)[:, None] & [True, False, True])
    length = sum(b.thickness * b.elements.size for b in sector.batches if b.seat) / grid.columns
    assert length == pytest.approx(10e-3, rel=1e-12)
    assert bore_support(SPUR) == ClampedBore()


def test_face_functions_share_the_area_and_keep_its_moments() -> None:
    mass = _face_mass()
    assert mass.sum() == pytest.approx(4.0, rel=1e-14)
    x = np.array([-1.0, 1.0, -1.0, 1.0, 0.0, 0.0, -1.0, 1.0])
    assert x @ mass @ x == pytest.approx(4.0 / 3.0, rel=1e-14)
    assert x**2 @ mass @ x**2 == pytest.approx(4.0 / 5.0, rel=1e-14)
    assert np.linalg.eigvalsh(mass).min() > 0.0
