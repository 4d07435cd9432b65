"""The gear case that the two-stage example writes: bores where the bearings are, its mass, its first mode."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dynamics.housings import (
    SPHEROIDAL_CAST_IRON,
    Bore,
    Foot,
    MeshedHousing,
    Plane,
    SeatBore,
    TetrahedralMesh,
    mesh_step,
    reduced_housing,
)
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.schemas.toml import toml_text

EXAMPLE = Path(__file__).parents[2] / "examples" / "two_stage"
ELEMENT_SIZE = 0.03
RINGS = {"input": (0.062, 0.016), "intermediate": (0.072, 0.015), "output": (0.11, 0.019)}
"""Diameter and width of the outer rings of 6206, 30207 and 30212, ISO 15 and ISO 355, m."""
POSITIONS = {
    "input, motor side": (0.0, 0.0, 0.015),
    "input, far side": (0.0, 0.0, 0.155),
    "intermediate, motor side": (0.0955, 0.0, 0.012),
    "intermediate, far side": (0.0955, 0.0, 0.158),
    "output, motor side": (0.0955, 0.149, 0.015),
    "output, far side": (0.0955, 0.149, 0.165),
}


@pytest.fixture(scope="module")
def step(tmp_path_factory):
    """The STEP file of the case, for the scene of the opened unit."""
    folder = tmp_path_factory.mktemp("case")
    scene: Any = OpenedUnit.of(read_rexs(EXAMPLE / "two_stage.rexs")).scene
    (folder / "scene.toml").write_text(toml_text(scene.model_dump(mode="json", exclude_none=True)), "utf-8")
    file = folder / "gear_case.step"
    command = [sys.executable, EXAMPLE / "gear_case.py", folder / "scene.toml", file]
    subprocess.run(command, check=True, capture_output=True)
    return file


@pytest.fixture(scope="module")
def mesh(step):
    """A coarse mesh of it: Delaunay's method alone leaves slivers at this size, which are refused."""
    return mesh_step(step, ELEMENT_SIZE)


def bores(mesh: TetrahedralMesh) -> tuple[SeatBore, ...]:
    """Return the bores about the bearings of the unit."""
    axis = (0.0, 0.0, 1.0)
    return tuple(SeatBore(name, Bore(at, axis, *RINGS[name.split(",")[0]])) for name, at in POSITIONS.items())


@pytest.fixture(scope="module")
def case(mesh):
    """The case on its feet with a few modes."""
    low = float(mesh.points[:, 1].min())
    feet = (Foot("pads", Plane((0.0, low, 0.0), (0.0, -1.0, 0.0))),)
    return reduced_housing(MeshedHousing(mesh, SPHEROIDAL_CAST_IRON, bores(mesh), feet, modes=4))


def test_bores_are_where_the_bearings_are(mesh):
    """All the way round, with the outer diameter of the bearing, over the width of its ring."""
    for seat in bores(mesh):
        wall = mesh.points[np.unique(seat.bore.triangles(mesh))] - np.array(seat.bore.position)
        radius = np.hypot(wall[:, 0], wall[:, 1])
        assert radius == pytest.approx(seat.bore.diameter / 2.0, rel=1e-6), seat.name
        assert wall.mean(axis=0) == pytest.approx(0.0, abs=0.2 * seat.bore.diameter), seat.name
        assert np.ptp(wall[:, 2]) == pytest.approx(seat.bore.length, rel=1e-6), seat.name


def test_it_stands_on_four_pads(mesh):
    low = float(mesh.points[:, 1].min())
    foot = mesh.points[np.unique(Plane((0.0, low, 0.0), (0.0, -1.0, 0.0)).triangles(mesh))]
    middle = (foot.min(axis=0) + foot.max(axis=0)) / 2.0
    corners = {tuple(np.sign(point[[0, 2]] - middle[[0, 2]]).astype(int)) for point in foot}
    assert corners == {(-1, -1), (-1, 1), (1, -1), (1, 1)}


def test_mass_and_first_mode_are_those_of_a_small_gear_case(case):
    assert 15.0 < case.body.mass < 60.0
    assert 500.0 < case.frequency[0] < 1200.0
    assert case.checks.volume < 1e-9


def test_a_force_across_a_bearing_moves_its_seat_by_a_micrometer_per_kilonewton(case):
    """And one along the shaft by more: it bends the end wall."""
    seats = case.motions
    compliance = np.diag(np.linalg.inv(case.stiffness[:seats, :seats])).reshape(-1, 5) * 1e9  # um/kN
    assert np.all((compliance[:, :2] > 0.3) & (compliance[:, :2] < 3.0))
    assert np.all(compliance[:, 2] > compliance[:, :2].max(axis=1))
