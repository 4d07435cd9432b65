"""Bearings and housing of a REXS file in its scene: stiffnesses, axes, the matrix of the casing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lineofaction.gearbox.from_rexs.opened import opened
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.rexs.model import Document
from tests.fakes.opened_unit import said, scene_of
from tests.fakes.rexs_stage import relation
from tests.fakes.rexs_unit import (
    CASING,
    ROOT,
    two_stages,
)


def test_a_rigid_bearing_is_stiff_and_a_floating_one_free_along_the_axis() -> None:
    document = two_stages(
        {31: {"radial_stiffness": 1e23, "axial_stiffness": 1e23, "bending_stiffness": 1e15}}
    )
    first, second = scene_of(document).bushings[:2]
    assert (first.radial_stiffness_n_per_m, first.axial_stiffness_n_per_m) == (1e10, 1e10)
    assert first.stiffness_matrix is not None and first.stiffness_matrix[3][3] == 1e7
    assert (second.radial_stiffness_n_per_m, second.axial_stiffness_n_per_m) == (2e8, 0.0)
    assert said(opened(document), 31, "radial_stiffness")[1].startswith("1e+23 N/m means rigid")


def test_a_bearing_without_any_stiffness_is_defaulted_and_said() -> None:
    unit = opened(two_stages({32: {"radial_stiffness": None}}))
    assert said(unit, 32, "radial_stiffness")[0] == "defaulted"


def test_a_stiffness_at_the_operating_point_turns_from_u_v_w_to_x_y_z() -> None:
    # axial 1, across v 2, across w 3 (1e8 N/m), about v 4 (1e7 N mm/rad), v with the rotation about w
    values = {"f_u_d_u": 1e8, "f_v_d_v": 2e8, "f_w_d_w": 3e8, "m_v_rot_v": 4e7, "m_w_rot_w": 5e7}
    values |= {"f_v_rot_w": 1e5, "m_w_d_v": 1e5}
    stated = {f"operating_point_stiffness_{name}": value for name, value in values.items()}
    matrix = scene_of(two_stages({31: stated})).bushings[0].stiffness_matrix
    assert matrix is not None
    expected = np.diag([2e8, 3e8, 1e8, 4e4, 5e4])
    expected[0, 4] = expected[4, 0] = 1e5
    assert np.array(matrix) == pytest.approx(expected, rel=1e-12, abs=1e-6)


def housed(matrix: Any) -> Document:
    """Return the unit with an elastic casing under both bearings of the input shaft, and a free point."""
    more = {
        50: ("assembly_group", place_of_group() | {"reduced_static_stiffness_matrix": matrix}),
        **{51 + point: ("reduction_point", {}) for point in range(3)},
    }
    roles = [
        ("reference", {"origin": CASING, "referenced": 50}),
        *(("assembly", {"assembly": 50, "part": 51 + point}) for point in range(3)),
        ("reference", {"origin": 51, "referenced": 32}),
        ("reference", {"origin": 53, "referenced": 31}),
    ]
    further = [relation(2000 + n, kind, **row) for n, (kind, row) in enumerate(roles)]
    return two_stages(more=more, further=further)


def place_of_group() -> dict[str, Any]:
    """Return the axes of the casing's assembly group: u of the group along v of the unit."""
    axes = {"u_axis_vector": (0.0, 1.0, 0.0), "w_axis_vector": (0.0, 0.0, 1.0)}
    return {"support_vector": (0.0, 0.0, 0.0), "reference_component_for_position": ROOT} | axes


def test_a_housing_matrix_turns_into_the_axes_of_the_scene() -> None:
    # per point u, v, w in N/mm, rotations in N mm/rad; the middle point carries nothing
    matrix = np.kron(np.eye(3), np.diag([1e5, 2e5, 3e5, 1e9, 2e9, 3e9]))
    matrix[0, 12] = matrix[12, 0] = -2e4
    scene = scene_of(housed(tuple(map(tuple, matrix.tolist()))))
    (housing,) = scene.housings
    assert housing.bushings == ("concept_bearing 32", "concept_bearing 31")
    stiffness = np.array(housing.stiffness_matrix)
    # u of the group is v of the unit, x of the scene; its v is -u, -z; its w is w, y
    assert np.diag(stiffness)[:6] == pytest.approx([1e8, 3e8, 2e8, 1e6, 3e6, 2e6])
    assert stiffness[0, 6] == pytest.approx(-2e7)


def test_points_of_a_housing_that_carry_nothing_follow_free_of_force() -> None:
    # springs k from the first point over the free one to the third: k / 2 between those
    matrix = np.zeros((18, 18))
    for a, b in ((0, 6), (6, 12)):
        matrix[np.ix_([a, b], [a, b])] += 1e5 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    (housing,) = scene_of(housed(tuple(map(tuple, matrix.tolist())))).housings
    x = np.array(housing.stiffness_matrix)[np.ix_([0, 6], [0, 6])]
    assert x == pytest.approx(0.5e8 * np.array([[1.0, -1.0], [-1.0, 1.0]]))


EXAMPLE = Path(__file__).parents[3] / "examples" / "two_stage" / "two_stage.rexs"


def test_the_example_opens_with_bearings_by_geometry_on_its_housing() -> None:
    document = read_rexs(EXAMPLE)
    unit, scene = opened(document), scene_of(document)
    assert not [line for line in unit.lines if line.fate == "refused"]
    (housing,) = scene.housings
    assert housing.bushings == tuple(bearing.name for bearing in scene.rolling_bearings)
    assert len(scene.rolling_bearings) == 6 and scene.bushings == ()
    assert [case.torque_n_m for case in unit.load_cases] == [160.0, 120.0, 80.0, 40.0]
    assert [case.share for case in unit.load_cases] == [0.05, 0.15, 0.5, 0.3]
    (load,) = scene.loads
    assert load.torque_n_m == pytest.approx((80.0 * 63.0 / 25.0 * 74.0 / 21.0,), rel=1e-12)
    balls, rollers = scene.rolling_bearings[:2], scene.rolling_bearings[2:]
    assert [bearing.locating for bearing in balls] == ["both", "none"]
    assert all(bearing.roller is not None for bearing in rollers)
    assert np.sign([row.contact_angle_deg for bearing in rollers if (row := bearing.roller)]).tolist() == [
        -1,
        1,
        -1,
        1,
    ]
    matrix = np.array(housing.stiffness_matrix)
    assert np.linalg.eigvalsh(matrix)[0] > 0.0 and np.array_equal(matrix, matrix.T)
