"""Bores and planes of the solid in a STEP file: what they are, however the file stands and is split."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from dynamics.errors import InputError, SolveError
from dynamics.housings import step_solid

WRITE = """
import sys, gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
occ = gmsh.model.occ
block = [(3, occ.addBox(0, 0, 0, 120, 80, 60))]
boss = [(3, occ.addCylinder(60, 40, 60, 0, 0, 20, 12))]
halves = [(3, occ.addCylinder(x, -1, 30, 0, 82, 0, 15, angle=3.141592653589793)) for x in [85]]
other = occ.copy(halves)
occ.rotate(other, 85, 0, 30, 0, 1, 0, 3.141592653589793)
step = [(3, occ.addCylinder(35, -1, 30, 0, 41, 0, 20)), (3, occ.addCylinder(35, 39, 30, 0, 42, 0, 10))]
slot = [(3, occ.addCylinder(0, -1, 0, 0, 82, 0, 8))]
cut, _ = occ.cut(occ.fuse(block, boss)[0], halves + other + step + slot)
if sys.argv[2:] == ["turned"]:
    occ.rotate(cut, 0, 0, 0, 0.3, -0.5, 0.8, 1.234)
    occ.translate(cut, 300, -50, 900)
if sys.argv[2:] == ["two"]:
    occ.addBox(500, 0, 0, 10, 10, 10)
occ.synchronize()
gmsh.write(sys.argv[1])
gmsh.finalize()
"""
"""A block with a split bore, a stepped bore, a boss on top, and a quarter of a bore along an edge."""
EDGE = np.pi * 8e-3**2 / 4.0
VOLUME = 0.08 * (0.12 * 0.06 - np.pi * 15e-3**2 - EDGE) + np.pi * (
    0.02 * 12e-3**2 - 0.04 * (20e-3**2 + 10e-3**2)
)


def write(file: Path, *options: str) -> Path:
    subprocess.run([sys.executable, "-c", WRITE, str(file), *options], check=True, capture_output=True)
    return file


@pytest.fixture(scope="module")
def solid(tmp_path_factory):
    return step_solid(write(tmp_path_factory.mktemp("step") / "block.step"))


def test_bores_are_those_that_are_round_and_hollow(solid):
    """Halves are one; the boss and the quarter along an edge are none."""
    found = sorted((bore.diameter, bore.length, *bore.position) for bore in solid.bores)
    assert np.array(found) == pytest.approx(
        np.array(
            [
                (0.02, 0.04, 0.035, 0.06, 0.03),
                (0.03, 0.08, 0.085, 0.04, 0.03),
                (0.04, 0.04, 0.035, 0.02, 0.03),
            ]
        ),
        abs=1e-9,
    )
    for bore in solid.bores:
        assert np.abs(bore.axis) == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)


def test_volume_surface_and_planes_are_those_of_the_drawing(solid):
    assert solid.volume == pytest.approx(VOLUME, rel=1e-9)
    down = [face for face in solid.planes if face.plane.normal[2] < -0.9]
    assert [face.area for face in down] == pytest.approx([0.08 * (0.12 - 8e-3)], rel=1e-9)
    flat = sum(face.area for face in solid.planes)
    round_ = np.pi * (0.08 * 0.03 + 0.04 * 0.06 + 0.02 * 0.024 + 0.08 * 4e-3)
    assert flat + round_ == pytest.approx(solid.surface, rel=1e-9)
    assert [face.area for face in solid.planes] == sorted((f.area for f in solid.planes), reverse=True)
    normals = sum(np.array(face.plane.normal) * face.area for face in solid.planes)
    assert normals == pytest.approx([0.08 * 8e-3, 0.0, 0.08 * 8e-3], abs=1e-9)  # closed by the edge's


@pytest.mark.law
def test_a_turned_file_has_the_same_bores(solid, tmp_path):
    turned = step_solid(write(tmp_path / "turned.step", "turned"))
    assert turned.volume == pytest.approx(solid.volume, rel=1e-9)
    assert turned.surface == pytest.approx(solid.surface, rel=1e-6)

    def sizes(of):
        return np.array(sorted((bore.diameter, bore.length) for bore in of.bores))

    def distances(of):
        middle = np.array([bore.position for bore in sorted(of.bores, key=lambda bore: bore.diameter)])
        return np.linalg.norm(middle[:, None] - middle, axis=-1)

    assert sizes(turned) == pytest.approx(sizes(solid), abs=1e-8)
    assert distances(turned) == pytest.approx(distances(solid), abs=1e-8)


def test_what_is_not_one_solid_is_refused(tmp_path):
    with pytest.raises(InputError) as caught:
        step_solid(write(tmp_path / "two.step", "two"))
    assert (caught.value.field, caught.value.value) == ("step_file.solids", 2)
    for name in ("absent.step", "block.iges"):
        with pytest.raises(InputError, match="step_file"):
            step_solid(tmp_path / name)
    (tmp_path / "text.step").write_text("no STEP file")
    with pytest.raises((InputError, SolveError)):
        step_solid(tmp_path / "text.step")
