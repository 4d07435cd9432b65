"""A key holds the gear at one place of its bore: the exact update against independent solutions."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from compliance_gears import HELICAL, SPUR, coarse

from fe_contact.compliance import FlankCompliance3D, flank_compliance_3d
from fe_contact.compliance.condensed_gear import _probe_loads
from fe_contact.compliance.deformation_3d import deformed_solids
from fe_contact.compliance.keyed_bore import _key_points
from fe_contact.compliance.ring_2d import factorise
from fe_contact.compliance.sector_stiffness import sector_stiffness, twist
from fe_contact.compliance.unit_root_stress import unit_root_stress_3d
from fe_contact.contact.assembly import _KeyedFlanks
from fe_contact.contact.face_patch import FaceGrid, add_compliance, face_loads
from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import BoreSeat, Gear, Key
from fe_contact.mesh import bore_support, quad_sector, swept_sector

GEARS = pytest.mark.parametrize("gear", [SPUR, HELICAL], ids=["spur", "helical"])
MODULUS = 1e13
SEAT = BoreSeat(5e13, MODULUS, 5e13)


def keyed(gear: Gear, width: float = 4e-3, angle: float = 0.3, **change: float) -> Gear:
    return replace(gear, seat=replace(SEAT, key=Key(width, angle), **change))


def solved(gear: Gear, reach: int = 2) -> FlankCompliance3D:
    return flank_compliance_3d(gear, coarse(gear), reach=reach)


def moved(compliance: FlankCompliance3D, tooth: int = 0) -> float:
    """Mean displacement of the flank of a tooth under an even pressure of unit force on it, m/N."""
    loads = _probe_loads(compliance.s, compliance.z, compliance.index, compliance.s_form)[:, 0]
    return float(loads @ compliance.block(tooth, tooth) @ loads / loads.sum() ** 2)


@GEARS
def test_a_key_around_the_whole_bore_is_the_seat_all_round(gear: Gear) -> None:
    seat, key = (solved(g) for g in (replace(gear, seat=SEAT), keyed(gear, math.pi * 12e-3, 1.0)))
    scale = np.abs(seat.blocks).max()
    for tooth, other in ((0, 0), (2, 0), (-1, 1), (-2, -2)):
        assert np.abs(key.block(tooth, other) - seat.block(tooth, other)).max() < 1e-11 * scale


@pytest.mark.law
@GEARS
def test_equals_the_solution_of_the_whole_gear(gear: Gear) -> None:
    """All teeth in one sparse factorisation, the key's foundation assembled into it."""
    held = keyed(gear)
    recipe, section = coarse(held), quad_sector(held, coarse(held))
    sector = swept_sector(section.grid, held.face_width, recipe, bore_support(held))
    stiffness = sector_stiffness(held, section, sector)
    teeth, size = held.teeth, sector.size
    own = np.setdiff1d(np.arange(size), sector.left)
    number = np.full((teeth, size + 1), -1)
    number[:, own] = np.arange(teeth * len(own)).reshape(teeth, -1)
    number[:, sector.left] = np.roll(number[:, sector.right], -1, axis=0)
    rows, columns, entries = [], [], []
    values = stiffness.matrices[stiffness.of_element]
    for j in range(teeth):
        dofs = number[j][sector.element_freedoms]
        i, k = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
        free = (i >= 0) & (k >= 0)
        rows, columns = [*rows, i[free]], [*columns, k[free]]
        entries.append(values[free])
    points = _key_points(held, sector, twist(held))
    local = np.concatenate([sector.key_bore, sector.left[sector.key_cut]])
    at = number[points.sector, local[points.number]]
    rows.append(np.repeat(at, 8, axis=1).ravel())
    columns.append(np.tile(at, (1, 8)).ravel())
    entries.append((points.shares[:, :, None] * points.shares[:, None, :]).ravel())
    coo = (np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns)))
    matrix = sp.csc_array(sp.coo_array(coo))
    found = solved(held)
    for other in (0, 1):
        loads = np.zeros((matrix.shape[0], len(sector.flank)))
        loads[number[other, sector.flank], np.arange(len(sector.flank))] = 1.0
        direct = factorise(matrix, block=1)(loads)
        for tooth in (-1, 0, 2):
            expected = direct[number[tooth, sector.flank]]
            assert np.abs(found.block(tooth, other) - expected).max() < 1e-8 * np.abs(expected).max()


@GEARS
def test_a_key_one_pitch_further_is_the_same_one_tooth_on(gear: Gear) -> None:
    pitch = 2.0 * math.pi / gear.teeth
    here, there = (solved(keyed(gear, angle=angle)) for angle in (0.3, 0.3 + pitch))
    scale = np.abs(here.blocks).max()
    for tooth, other in ((0, 0), (1, 0), (-1, 1)):
        shifted = there.block(tooth + 1, other + 1)
        assert np.abs(here.block(tooth, other) - shifted).max() < 1e-10 * scale
        assert np.abs(here.block(tooth, other) - here.block(other, tooth).T).max() < 1e-12 * scale
    assert abs(moved(here) / moved(there) - 1.0) > 1e-3


def test_a_key_that_leaves_no_gap_is_stiffer_than_any_other() -> None:
    seat = solved(replace(SPUR, seat=SEAT))
    narrow, wide = (solved(keyed(SPUR, width)) for width in (3e-3, 9e-3))
    for stiffer, softer in ((seat, wide), (wide, narrow)):
        values = np.linalg.eigvalsh(softer.block(0, 0) - stiffer.block(0, 0))
        assert values[0] > -1e-11 * values[-1]
        assert moved(softer) > 1.05 * moved(stiffer)


def test_a_soft_key_lets_the_gear_turn_as_a_rigid_body() -> None:
    """r_b^2 / (r^2 w b k): the difference between two soft keys is that of their turns."""
    soft, softer = (moved(solved(keyed(SPUR, tangential_foundation=k))) for k in (2e9, 1e9))
    turn = SPUR.base_radius**2 / (6e-3**2 * 4e-3 * 20e-3) * (1.0 / 1e9 - 1.0 / 2e9)
    assert softer - soft == pytest.approx(turn, rel=1e-6)


@pytest.mark.parametrize("angle", [0.0, 2.0, math.pi, -1.0])
@GEARS
def test_the_key_has_its_area_and_its_place(gear: Gear, angle: float) -> None:
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


def test_contact_sees_the_key_as_the_blocks_do() -> None:
    found = solved(keyed(HELICAL))
    grid, tooth = FaceGrid(found.s, found.z, found.index), np.array([-1, 0, 0, 2])
    middle = 0.5 * (found.s_form + found.s_tip) + np.array([[0.0], [-1e-4], [3e-4], [0.0]])
    low = np.array([-8e-3, -2e-3, 4e-3, 0.0])
    loads = face_loads(grid, middle, np.full((4, 1), 1e-3), np.zeros((4, 1)), low, low + 3e-3)
    forces = np.zeros((4, found.index.max() + 1))
    for i in range(4):
        np.add.at(forces[i], loads.nodes[i, : loads.used[i]], loads.forces[i, : loads.used[i]])
    out = np.zeros((4, 4))
    wide = np.concatenate([found.blocks, np.zeros((1, *found.blocks[0].shape))])
    add_compliance(wide, tooth, loads, np.ones(4), out)
    out += _KeyedFlanks(found.key_rows, found.key_core, True).compliance(tooth, loads)
    for i, j in ((0, 0), (1, 2), (0, 1), (3, 1)):
        assert out[i, j] == pytest.approx(forces[i] @ found.block(tooth[i], tooth[j]) @ forces[j], rel=1e-10)
    alone = _KeyedFlanks(found.key_rows, found.key_core, False).compliance(tooth, loads)
    assert np.array_equal(alone != 0.0, tooth[:, None] == tooth)


def test_the_other_hand_and_the_cache_keep_the_key(tmp_path: Path) -> None:
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


def test_impossible_keys_are_refused_by_name() -> None:
    with pytest.raises(InfeasibleGeometry) as misfit:
        keyed(SPUR, 40e-3)
    assert misfit.value.field == "seat.key.width"
    with pytest.raises(InputError) as stress:
        unit_root_stress_3d(keyed(SPUR), coarse(SPUR))
    assert stress.value.field == "seat.key"
    with pytest.raises(InputError) as shape:
        deformed_solids(keyed(SPUR), coarse(SPUR), [{0: np.zeros(1)}])
    assert shape.value.field == "seat.key"
