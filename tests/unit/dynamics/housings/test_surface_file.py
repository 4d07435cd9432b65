"""Files of a housing's surface, as other programs read them."""

from __future__ import annotations

from pathlib import Path

import meshlane
import numpy as np
import pytest
from lattice_meshes import box

from dynamics.housings import write_surface


def test_a_reader_finds_quadratic_triangles_with_their_fields(tmp_path: Path) -> None:
    mesh = box((0.3, 0.2, 0.1), (2, 2, 1))
    nodes, triangles = np.unique(mesh.surface, return_inverse=True)
    points, triangles = mesh.points[nodes], triangles.reshape(-1, 6)
    file = tmp_path / "mode.vtu"
    write_surface(file, points, triangles, {"motion": 2.0 * points, "size": points[:, 0]})
    found = meshlane.read(file)
    (cells,) = found.cells
    assert cells.type == "triangle6"
    np.testing.assert_array_equal(found.points, points)
    np.testing.assert_array_equal(found.point_data["motion"], 2.0 * points)
    np.testing.assert_array_equal(found.point_data["size"], points[:, 0])
    for corner, middle in enumerate((3, 4, 5)):  # VTK: mid-side nodes of edges 01, 12, 20
        ends = found.points[cells.data[:, [corner, (corner + 1) % 3]]].mean(axis=1)
        np.testing.assert_allclose(found.points[cells.data[:, middle]], ends, atol=1e-12)
    assert [each.name for each in tmp_path.iterdir()] == ["mode.vtu"]
    (plain := tmp_path / "plain").write_text("made as every file")
    assert file.stat().st_mode == plain.stat().st_mode


def test_what_cannot_be_written_leaves_no_file(tmp_path: Path) -> None:
    mesh = box((0.3, 0.2, 0.1), (1, 1, 1))
    with pytest.raises(ValueError, match="len"):
        write_surface(tmp_path / "mode.vtu", mesh.points, mesh.surface, {"motion": np.zeros((2, 3))})
    assert list(tmp_path.iterdir()) == []
