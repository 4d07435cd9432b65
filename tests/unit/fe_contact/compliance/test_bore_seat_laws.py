"""What seat and key of the bore do to the flank compliance: exact turns, limits, symmetry."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse as sp
from compliance_gears import HELICAL, SPUR, coarse, moved, whole_gear

import fe_contact.compliance.cyclic_compliance as flow
from fe_contact.compliance import FlankCompliance3D, flank_compliance_3d
from fe_contact.compliance.deformation_3d import deformed_solids
from fe_contact.compliance.factorization import factorise
from fe_contact.compliance.keyed_bore import _key_points
from fe_contact.compliance.seat_stiffness import face_mass
from fe_contact.compliance.sector_stiffness import twist
from fe_contact.compliance.unit_root_stress import unit_root_stress_3d
from fe_contact.contact.face_assembly import KeyedFlanks
from fe_contact.contact.face_patch import FaceGrid, add_compliance, face_loads
from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import BoreSeat, Gear, Key, seat_compliance
from fe_contact.mesh import ClampedBore, bore_support, quad_sector, swept_sector
from fe_contact.mesh.sector_grid import SectorGrid


def solved(gear: Gear, reach: int | None = None) -> FlankCompliance3D:
    return flank_compliance_3d(gear, coarse(gear), reach=reach)


def turned(gear: Gear) -> float:
    """Mean displacement of all flanks under the load on one of them."""
    found = solved(gear, reach=4)
    return sum(moved(found, j) for j in range(-4, 5)) / 9


@pytest.mark.parametrize("gear", [SPUR, HELICAL], ids=["spur", "helical"])
@pytest.mark.parametrize("modulus", [1e12, 1e13])
def test_a_tangential_seat_adds_the_turn_of_a_rigid_body(gear, modulus):
    """r_b^2 cos^2(beta_b) / (2 pi r^3 b k_t), all else rigid."""
    soft = replace(gear, seat=BoreSeat(tangential_foundation=modulus))
    cosine = math.cos(gear.base_helix_angle)
    added = turned(soft) - turned(gear)
    tolerance = 2e-3 if gear.helix_angle else 2e-6
    assert added == pytest.approx(seat_compliance(soft) * cosine**2, rel=tolerance)
    assert moved(solved(soft)) - moved(solved(gear)) > added


def test_a_stiffening_seat_becomes_the_clamped_bore_at_the_rate_one_over_k():
    rigid = moved(solved(SPUR))
    left = [moved(solved(replace(SPUR, seat=BoreSeat(k, k, k)))) - rigid for k in (1e15, 1e16, 1e17)]
    assert left[1] / left[0] == pytest.approx(0.1, rel=0.1)
    assert left[2] / left[1] == pytest.approx(0.1, rel=0.02)
    assert left[2] < 1e-4 * rigid


def test_every_direction_that_gives_way_makes_the_gear_softer():
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


def test_a_narrower_seat_is_softer_and_one_off_the_middle_tilts():
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
def test_checks_hold_on_every_seat(rigid):
    modulus = None if rigid else 3e13
    seat = BoreSeat(modulus, 2e13, modulus, width=8e-3, offset=3e-3)
    checks = solved(replace(HELICAL, seat=seat)).checks
    assert checks.residual < 1e-11
    assert checks.reciprocity < 1e-13
    assert checks.bore_moment < 1e-11
    assert checks.energy < 1e-11


def test_a_left_hand_gear_keeps_its_seat_on_its_side():
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


def test_a_seat_holds_the_planes_between_its_ends():
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


def test_face_functions_share_the_area_and_keep_its_moments():
    mass = face_mass()
    assert mass.sum() == pytest.approx(4.0, rel=1e-14)
    x = np.array([-1.0, 1.0, -1.0, 1.0, 0.0, 0.0, -1.0, 1.0])
    assert x @ mass @ x == pytest.approx(4.0 / 3.0, rel=1e-14)
    assert x**2 @ mass @ x**2 == pytest.approx(4.0 / 5.0, rel=1e-14)
    assert np.linalg.eigvalsh(mass).min() > 0.0


GEARS = pytest.mark.parametrize("gear", [SPUR, HELICAL], ids=["spur", "helical"])
MODULUS = 1e13
SEAT = BoreSeat(5e13, MODULUS, 5e13)


def keyed(gear: Gear, width: float = 4e-3, angle: float = 0.3, **change: float) -> Gear:
    return replace(gear, seat=replace(SEAT, key=Key(width, angle), **change))


def solved_keyed(gear: Gear, reach: int = 2) -> FlankCompliance3D:
    return flank_compliance_3d(gear, coarse(gear), reach=reach)


@pytest.mark.law
@GEARS
def test_a_key_around_the_whole_bore_is_the_seat_all_round(gear):
    seat, key = (solved_keyed(g) for g in (replace(gear, seat=SEAT), keyed(gear, math.pi * 12e-3, 1.0)))
    scale = np.abs(seat.blocks).max()
    for tooth, other in ((0, 0), (2, 0), (-1, 1), (-2, -2)):
        assert np.abs(key.block(tooth, other) - seat.block(tooth, other)).max() < 1e-11 * scale


@pytest.mark.law
@GEARS
def test_equals_the_solution_of_the_whole_gear(gear):
    """All teeth in one sparse factorisation, the key's foundation assembled into it."""
    held = keyed(gear)
    _, sector, number, matrix = whole_gear(held, coarse(held), bore_support(held))
    points = _key_points(held, sector, twist(held))
    local = np.concatenate([sector.key_bore, sector.left[sector.key_cut]])
    at = number[points.sector, local[points.number]]
    shares = (points.shares[:, :, None] * points.shares[:, None, :]).ravel()
    key = (shares, (np.repeat(at, 8, axis=1).ravel(), np.tile(at, (1, 8)).ravel()))
    matrix = sp.csc_array(matrix + sp.coo_array(key, shape=matrix.shape))
    found = solved_keyed(held)
    for other in (0, 1):
        loads = np.zeros((matrix.shape[0], len(sector.flank)))
        loads[number[other, sector.flank], np.arange(len(sector.flank))] = 1.0
        direct = factorise(matrix, block=1)(loads)
        for tooth in (-1, 0, 2):
            expected = direct[number[tooth, sector.flank]]
            assert np.abs(found.block(tooth, other) - expected).max() < 1e-8 * np.abs(expected).max()


@GEARS
def test_a_key_one_pitch_further_is_the_same_one_tooth_on(gear):
    pitch = 2.0 * math.pi / gear.teeth
    here, there = (solved_keyed(keyed(gear, angle=angle)) for angle in (0.3, 0.3 + pitch))
    scale = np.abs(here.blocks).max()
    for tooth, other in ((0, 0), (1, 0), (-1, 1)):
        shifted = there.block(tooth + 1, other + 1)
        assert np.abs(here.block(tooth, other) - shifted).max() < 1e-10 * scale
        assert np.abs(here.block(tooth, other) - here.block(other, tooth).T).max() < 1e-12 * scale
    assert abs(moved(here) / moved(there) - 1.0) > 1e-3


def test_a_soft_or_narrow_key_lets_the_gear_turn():
    seat = solved_keyed(replace(SPUR, seat=SEAT))
    narrow, wide = (solved_keyed(keyed(SPUR, width)) for width in (3e-3, 9e-3))
    for stiffer, softer in ((seat, wide), (wide, narrow)):
        values = np.linalg.eigvalsh(softer.block(0, 0) - stiffer.block(0, 0))
        assert values[0] > -1e-11 * values[-1]
        assert moved(softer) > 1.05 * moved(stiffer)
    # r_b^2 / (r^2 w b k): the difference between two soft keys is that of their turns.
    soft, softer = (moved(solved_keyed(keyed(SPUR, tangential_foundation=k))) for k in (2e9, 1e9))
    turn = SPUR.base_radius**2 / (6e-3**2 * 4e-3 * 20e-3) * (1.0 / 1e9 - 1.0 / 2e9)
    assert softer - soft == pytest.approx(turn, rel=1e-6)


@pytest.mark.parametrize("angle", [0.0, 2.0, math.pi, -1.0])
@GEARS
def test_the_key_has_its_area_and_its_place(gear, angle):
    held = replace(
        keyed(gear, angle=angle), seat=replace(keyed(gear, angle=angle).seat, width=10e-3, offset=4e-3)
    )
    section = quad_sector(held, coarse(held))
    sector = swept_sector(section.grid, held.face_width, coarse(held), bore_support(held))
    points = _key_points(held, sector, twist(held))
    weight = points.shares.sum(axis=1) ** 2 / MODULUS
    assert weight.sum() == pytest.approx(4e-3 * 10e-3, rel=1e-12)
    nodes = np.zeros((sector.size, 3))
    planes, columns = np.nonzero(sector.nodes >= 0)
    z = np.repeat(sector.layers.ends, 2)[:-1]
    z[1::2] = 0.5 * (sector.layers.ends[1:] + sector.layers.ends[:-1])
    around = np.arctan2(-section.points[:, 0], section.points[:, 1])
    freedom = sector.freedoms[sector.nodes[planes, columns], 1]
    nodes[freedom] = np.stack([around[columns] + twist(held) * z[planes], z[planes], z[planes] ** 2], axis=1)
    local = np.concatenate([sector.key_bore, sector.left[sector.key_cut]])
    at = nodes[local[points.number]]
    at[..., 0] += 2.0 * math.pi / held.teeth * points.sector
    turned = np.exp(1j * at[..., 0])
    share = points.shares / points.shares.sum(axis=1, keepdims=True)
    mean = weight @ (share * np.angle(turned * np.exp(-1j * angle))).sum(axis=1) / weight.sum()
    assert mean == pytest.approx(0.0, abs=1e-12)
    assert weight @ (share * at[..., 1]).sum(axis=1) / weight.sum() == pytest.approx(4e-3, rel=1e-12)


def test_contact_sees_the_key_as_the_blocks_do():
    found = solved_keyed(keyed(HELICAL))
    grid, tooth = FaceGrid(found.s, found.z, found.index), np.array([-1, 0, 0, 2])
    middle = 0.5 * (found.s_form + found.s_tip) + np.array([[0.0], [-1e-4], [3e-4], [0.0]])
    low = np.array([-8e-3, -2e-3, 4e-3, 0.0])
    loads = face_loads(grid, middle, np.full((4, 1), 1e-3), np.zeros((4, 1)), low, low + 3e-3)
    forces = np.zeros((4, found.index.max() + 1))
    for i in range(4):
        np.add.at(forces[i], loads.nodes[i, : loads.used[i]], loads.forces[i, : loads.used[i]])
    out, order = np.zeros((1, 4, 4)), grid.freedom[grid.freedom >= 0]
    wide = np.concatenate([found.blocks, np.zeros((1, *found.blocks[0].shape))])
    at = np.array([[0, 0, 0, 0], [0, 1, 2, 3]])
    add_compliance(wide, order, tooth, loads, at, np.ones((1, 4)), out)
    out = out[0] + KeyedFlanks(found.key_rows, found.key_core, True).compliance(tooth, loads)
    for i, j in ((0, 0), (1, 2), (0, 1), (3, 1)):
        assert out[i, j] == pytest.approx(forces[i] @ found.block(tooth[i], tooth[j]) @ forces[j], rel=1e-10)
    alone = KeyedFlanks(found.key_rows, found.key_core, False).compliance(tooth, loads)
    assert np.array_equal(alone != 0.0, tooth[:, None] == tooth)


def test_the_other_hand_and_the_cache_keep_the_key(tmp_path):
    left = replace(keyed(HELICAL), helix_angle=-HELICAL.helix_angle)
    recipe = coarse(left)
    fresh, kept = (flank_compliance_3d(left, recipe, reach=1, cache=tmp_path) for _ in range(2))
    assert kept.from_cache
    assert np.array_equal(kept.block(0, 1), fresh.block(0, 1))
    right = flank_compliance_3d(left.right_handed(), recipe, reach=1)
    planes = right.index[::-1]
    order = planes[planes >= 0]
    assert (
        np.abs(fresh.block(1, 0) - right.block(1, 0)[np.ix_(order, order)]).max()
        < 1e-14 * np.abs(right.blocks).max()
    )
    with pytest.raises(KeyError):
        fresh.block(3, 3)


def test_impossible_keys_are_refused_by_name():
    with pytest.raises(InfeasibleGeometry) as misfit:
        keyed(SPUR, 40e-3)
    assert misfit.value.field == "seat.key.width"
    with pytest.raises(InputError) as stress:
        unit_root_stress_3d(keyed(SPUR), coarse(SPUR))
    assert stress.value.field == "seat.key"
    with pytest.raises(InputError) as shape:
        deformed_solids(keyed(SPUR), coarse(SPUR), [{0: np.zeros(1)}])
    assert shape.value.field == "seat.key"
