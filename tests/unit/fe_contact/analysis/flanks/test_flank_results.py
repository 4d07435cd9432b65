"""Flank results: laws of the load distribution over positions, pairs and slices."""

import dataclasses
import math

import numpy as np
import pytest
from analysis_requests import point_request
from numpy.typing import ArrayLike

from fe_contact import FlankModification, Gear, GearPair, analyze, contact_pattern, flank_results
from fe_contact.hertz import contact_modulus, relative_radius

pytestmark = pytest.mark.usefixtures("coarse_sectors")

FORCE = 2000.0
NO_CORNERS = {"corner_contact": "off"}


def spur(**changes: object) -> Gear:
    values = {"teeth": 20, "normal_module": 4e-3, "face_width": 25e-3, "bore_diameter": 40e-3} | changes
    return Gear(**values)


def spur_pair(**modification: float) -> GearPair:
    return GearPair(spur(modification=FlankModification(**modification)), spur(), 80e-3)


def helical_pair() -> GearPair:
    pinion = Gear(19, 3e-3, 20e-3, 30e-3, helix_angle=math.radians(20.0))
    return GearPair(pinion, dataclasses.replace(pinion, teeth=26, helix_angle=-pinion.helix_angle))


def solved(pair: GearPair, at: ArrayLike | None = None, **options: object):
    options = {"normal_force": FORCE, "model": "3d", "level": "draft"} | options
    return flank_results(pair, *point_request(**options), at=at)


def test_the_line_load_along_the_contact_lines_is_the_force():
    """Integral of F' over the length dz / cos(beta_b), on the line of action; torque at the tip edges."""
    pair = helical_pair()
    found = solved(pair, misalignment=20e-6, effects=NO_CORNERS)
    length = found.slice_width / math.cos(pair.base_helix_angle)
    assert (found.line_load * length).sum(axis=(1, 2)) == pytest.approx(FORCE, rel=1e-9)
    assert found.face_load.mean(axis=1) * pair.face_width == pytest.approx(FORCE, rel=1e-9)
    corners = solved(pair, misalignment=20e-6)
    assert (corners.force * corners.lever).sum(axis=(1, 2)) == pytest.approx(FORCE, rel=1e-9)
    assert np.any(corners.lever[corners.force > 0.0] != 1.0)


@pytest.mark.law
def test_the_pressure_is_hertz_of_the_line_load_on_the_line_of_action():
    """p0^2 = F' E* / (pi R) with R in the normal section from the roll lengths of both flanks."""
    pair = helical_pair()
    found = solved(pair, effects=NO_CORNERS)
    radius = relative_radius(found.roll_length_1, found.roll_length_2) / math.cos(pair.base_helix_angle)
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    path, reach = pair.path_of_contact, 0.5 * found.slice_width * abs(math.tan(pair.base_helix_angle))
    inside = (found.roll_length_1 > path.start + reach) & (found.roll_length_1 < path.end - reach)
    carried = found.force > 0.0
    expected = found.line_load * modulus / (math.pi * radius)
    whole = carried & inside  # the line does not end in the stretch
    assert whole.sum() > 0.9 * carried.sum()
    assert found.pressure[whole] ** 2 == pytest.approx(expected[whole], rel=1e-9)
    assert np.all(found.pressure[carried] ** 2 >= expected[carried] * (1.0 - 1e-9))
    assert np.all(found.pressure[~carried] == 0.0)
    both = (found.roll_length_1 + found.roll_length_2)[found.on_path]
    assert both == pytest.approx(pair.common_tangent, rel=1e-12)
    assert np.all(found.force[~found.on_path] == 0.0)


def test_it_is_the_same_solution_as_the_table():
    pair, skew = helical_pair(), 15e-6
    found = solved(pair, misalignment=skew, at=np.arange(16) / 16)
    table = analyze(
        pair,
        normal_forces=[FORCE],
        misalignments=[skew],
        model="3d",
        level="draft",
        positions=16,
    )
    assert found.deflection == pytest.approx(table.static_transmission_error[:, 0, 0, 0], rel=1e-12, abs=0.0)
    assert found.load_centroid == pytest.approx(table.face_centroid[:, 0, 0, 0], rel=1e-9, abs=1e-15)
    clear, edge = table.max_pressure[:, 0, 0, 0], table.edge_pressure[:, 0, 0, 0]
    assert found.clear_pressure.max(axis=(1, 2)) == pytest.approx(clear, rel=1e-12)
    assert found.edge_pressure == pytest.approx(edge.max(), rel=1e-12)
    assert found.pressure.max(axis=(1, 2)) == pytest.approx(np.maximum(clear, edge), rel=1e-12)


def test_an_aligned_spur_pair_carries_alike_on_both_sides():
    found = solved(spur_pair())
    assert found.force == pytest.approx(found.force[:, :, ::-1], rel=1e-6, abs=1e-9 * FORCE)
    assert found.load_centroid == pytest.approx(0.0, abs=1e-9)


def test_the_gap_closes_where_load_is_carried_and_far_ends_stay_rigid():
    found = solved(spur_pair(helix_crowning=60e-6), misalignment=30e-6)
    carried = found.force > 0.0
    assert np.all(found.gap[carried] == 0.0)
    assert np.all(found.gap[~carried] > 0.0)
    assert np.any(np.isfinite(found.gap[~carried]))
    # A hundredth of the load bends little: the flanks stay apart by crowning less the STE.
    found = solved(spur_pair(helix_crowning=100e-6), normal_force=20.0, at=0.0)
    alone = int(np.flatnonzero(found.pair == 0)[0])
    rigid = 100e-6 * (2.0 * found.face_position / 25e-3) ** 2
    expected = rigid[[0, -1]] - found.deflection[0]
    assert found.gap[0, alone, [0, -1]] == pytest.approx(expected, rel=0.01)


@pytest.mark.law
def test_face_load_factors_are_one_of_equal_load_and_grow_with_misalignment():
    """A slice twice as loaded as it would be is what the factor says."""
    found = solved(spur_pair(), at=[0.0])
    even = dataclasses.replace(found, force=np.where(found.on_path, 1.0, 0.0))
    assert even.face_load_factor == pytest.approx(1.0, rel=1e-12)
    assert even.mean_face_load_factor == pytest.approx(1.0, rel=1e-12)
    assert even.line_load_factor == pytest.approx(1.0, rel=1e-12)
    carrying = even.pair_line_load_factor[np.isfinite(even.pair_line_load_factor)]
    assert carrying == pytest.approx(1.0, rel=1e-12)
    slices = found.face_position.size
    uneven = even.force.copy()
    uneven[:, :, 0] *= 2.0
    doubled = dataclasses.replace(even, force=uneven)
    assert doubled.face_load_factor == pytest.approx(2.0 * slices / (slices + 1), rel=1e-12)
    # Its sign: the gap grows with the face position, so the load moves to the other side.
    found = [solved(helical_pair(), misalignment=skew) for skew in (0.0, 10e-6, 20e-6, 40e-6)]
    factors = [one.mean_face_load_factor for one in found]
    assert factors[0] < 1.25
    assert np.all(np.diff(factors) > 0.1)
    assert np.all(np.diff([one.line_load_factor.mean() for one in found]) > 0.0)
    assert np.all(np.diff([one.load_centroid.mean() for one in found]) < 0.0)
    mirrored = solved(spur_pair(), misalignment=-20e-6)
    straight = solved(spur_pair(), misalignment=20e-6)
    assert mirrored.face_load_factor == pytest.approx(straight.face_load_factor, rel=1e-6)


def test_the_contact_pattern_holds_the_largest_pressures():
    pair = spur_pair()
    found = solved(pair, misalignment=15e-6)
    for gear, roll in (("pinion", found.roll_length_1), ("wheel", found.roll_length_2)):
        pattern = contact_pattern(found, gear)
        assert pattern.pressure.max() == found.pressure.max()
        assert pattern.pressure.max(axis=0) == pytest.approx(found.pressure.max(axis=(0, 1)), rel=1e-12)
        # no cell is skipped between the places that carry load
        assert np.all(pattern.pressure[:, 0] > 0.0)
        reached = roll[found.force > 0.0]
        half = 0.5 * (pattern.roll_length[1] - pattern.roll_length[0])
        assert pattern.roll_length[0] - half <= reached.min() * (1.0 + 1e-12)
        assert pattern.roll_length[-1] + half >= reached.max() * (1.0 - 1e-12)
    relieved = solved(
        spur_pair(tip_relief=40e-6, tip_relief_length=1.5e-3), effects=NO_CORNERS, normal_force=500.0
    )
    pattern = contact_pattern(relieved)
    assert np.all(pattern.pressure[-1] == 0.0)
    assert np.all(pattern.pressure[len(pattern.roll_length) // 2] > 0.0)


def test_the_plane_model_is_one_slice_whose_single_contact_is_one_cell():
    found = solved(spur_pair(), model="plane_strain")
    assert found.face_position.size == 1
    assert found.face_load_factor == pytest.approx(1.0, rel=1e-12)
    found = solved(spur_pair(), model="plane_strain", at=0.0)
    pattern = contact_pattern(found)
    assert pattern.pressure == pytest.approx(np.array([[found.pressure.max()]]))
