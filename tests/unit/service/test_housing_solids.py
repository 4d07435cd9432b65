"""Housings of a scene by the file of their solid: reduced as in Python, once, and refused by name."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from housing_solid import housed_scene, write_block

from dynamics.housing_modes import (
    GRAY_CAST_IRON,
    Bore,
    Foot,
    MeshedHousing,
    ModalDamping,
    Plane,
    ReducedHousing,
    SeatBore,
    kept,
    mesh_step,
    reduced_housing,
)
from service.cli.scene_tables import tabled_scene
from service.client.portable import scene_of
from service.convert.scene import TabledScene


@pytest.fixture(scope="module")
def step(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The STEP file of the block."""
    return write_block(tmp_path_factory.mktemp("solid") / "block.step")


@pytest.fixture
def folder(tmp_path: Path, step: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the STEP file, and caches of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "block.step").write_bytes(step.read_bytes())
    return tmp_path


def tabled(folder: Path, **fields: Any) -> TabledScene:
    """Return the scene of a file as the command line makes it."""
    file = folder / "scene.json"
    file.write_text(json.dumps(housed_scene(folder, **fields)))
    return tabled_scene(*scene_of(file), None, lambda _stage, _fraction: None)


def in_python(folder: Path) -> ReducedHousing:
    """Return the reduction of the block by the library."""
    centers = {"input left": (0.0, 0.0, 0.1), "output left": (0.08, 0.0, 0.1)}
    seats = tuple(SeatBore(name, Bore(at, (0.0, 0.0, 1.0), 0.04, 0.03)) for name, at in centers.items())
    feet = (Foot("base", Plane((0.0, -0.04, 0.0), (0.0, -1.0, 0.0))),)
    mesh, points = mesh_step(folder / "block.step", 0.025), {"cover": (0.04, 0.04, 0.1)}
    damping = ModalDamping((0.005,))
    return reduced_housing(MeshedHousing(mesh, GRAY_CAST_IRON, seats, feet, points, 4, damping))


def test_a_scene_on_a_step_file_is_that_on_its_file_of_modes(folder: Path) -> None:
    """To the last bit: matrices, surface, points; the scene is self-contained then."""
    own = tabled(folder)
    in_python(folder).to_netcdf(folder / "case.nc")
    source = dict.fromkeys(("step_file", "material", "modes", "element_size_mm", "seats", "feet", "points"))
    of_file = tabled(folder, **source, modes_file="case.nc")
    (ours,), (theirs,) = own.scene.housings, of_file.scene.housings
    for name in ("bushings", "mass", "stiffness", "damping", "seat_positions", "modal_coordinates"):
        assert getattr(ours, name) == getattr(theirs, name), name
    case, other = own.housings["case"], of_file.housings["case"]
    np.testing.assert_array_equal(case.surface.motion, other.surface.motion)
    np.testing.assert_array_equal(case.points[0].motion, other.points[0].motion)
    assert case.frequency[0] == pytest.approx(other.frequency[0], rel=0.0, abs=0.0)
    assert of_file.inputs.housings[0].modes_file is None


def test_the_second_time_a_housing_comes_from_the_cache(folder: Path, monkeypatch) -> None:
    """Neither meshed nor reduced again; another number of modes is."""
    first = tabled(folder).housings["case"]
    monkeypatch.setattr(kept, "reduce_housing", lambda _: pytest.fail("reduced again"))
    again = tabled(folder).housings["case"]
    np.testing.assert_array_equal(first.surface.motion, again.surface.motion)
    with pytest.raises(pytest.fail.Exception, match="reduced again"):
        tabled(folder, modes=5)
