"""Exported meshes come back as they were."""

from __future__ import annotations

from pathlib import Path

import meshlane
import numpy as np
import pytest

from fe_contact.errors import InputError
from fe_contact.geometry import Gear
from fe_contact.mesh import GearMesh
from fe_contact.mesh.export import HUB, cell_teeth, write_cells


def export(mesh: GearMesh, path: Path) -> None:
    bore = np.zeros(len(mesh.points))
    bore[mesh.bore_nodes] = 1.0
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    of_points = {"bore": bore, "height": mesh.points[:, 1].copy()}
    write_cells(path, points, mesh.triangles, of_points, {"tooth": cell_teeth(mesh).astype(float)})


def test_round_trip(tmp_path: Path, gear_and_mesh: tuple[Gear, GearMesh]) -> None:
    _, mesh = gear_and_mesh
    export(mesh, tmp_path / "gear.vtu")
    back = meshlane.read(tmp_path / "gear.vtu")
    assert np.array_equal(back.points[:, :2], mesh.points)
    assert np.array_equal(back.cells_dict["triangle6"], mesh.triangles)
    assert np.array_equal(back.point_data["height"], mesh.points[:, 1])
    assert np.flatnonzero(back.point_data["bore"]).tolist() == sorted(mesh.bore_nodes.tolist())
    teeth = set(np.unique(back.cell_data["tooth"][0]).astype(int).tolist())
    assert teeth == set(mesh.teeth.tolist()) | ({HUB} if mesh.hub is not None else set())


def test_another_suffix_is_refused(tmp_path: Path, gear_and_mesh: tuple[Gear, GearMesh]) -> None:
    with pytest.raises(InputError, match=r"\.vtu"):
        export(gear_and_mesh[1], tmp_path / "gear.stl")
