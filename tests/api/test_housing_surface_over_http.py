"""The surface of housings before anything is computed: where it stands, its size, and what files try."""

import base64
import subprocess
import sys
import time
from itertools import permutations
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from housing_solid import housing, write_block
from whole_service import whole_service

from lineofaction.gearbox.schemas.file_content import FileContentInput

ROUTE = "/v1/scenes/housing-surface"
LOW, HIGH = [-40.0, -40.0, 85.0], [120.0, 40.0, 115.0]
MANY = """
import sys, gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
for i in range(int(sys.argv[2])):
    for k in range(int(sys.argv[2])):
        occ.addBox(10 * i, 10 * k, 0, 10, 10, 5 + (7 * i + 3 * k) % 11)
boxes = occ.getEntities(3)
occ.fuse(boxes[:1], boxes[1:])
occ.synchronize()
gmsh.write(sys.argv[1])
"""
"""Towers of unlike heights as one solid."""


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    found = whole_service(tmp_path_factory.mktemp("service"))
    yield found
    found.app.state.context.reader.stop()
    found.app.state.context.live.stop()


@pytest.fixture(scope="module")
def client(served):
    return TestClient(served.app, headers=served.headers)


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    return write_block(tmp_path_factory.mktemp("step") / "block.step")


def solid(name: str, content: bytes, **fields: Any) -> dict[str, Any]:
    """Return a housing of the content of a file."""
    field = "step_file" if name.endswith(("step", "stp")) else "mesh_file"
    own = {"step_file": None, field: FileContentInput.packed(name, content).model_dump()}
    if field == "mesh_file":
        own |= {"element_size_mm": None, "mesh_unit": "mm"}
    return housing(**own | fields)


def drawn(client: TestClient, *housings: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points (mm), normals and facets."""
    answer = client.post(ROUTE, json={"housings": list(housings)})
    assert answer.status_code == 200, answer.text
    surface = answer.json()["surface"]
    place, normal = (unpacked(surface[name], "<f4") for name in ("place_mm", "normal"))
    return place, normal, unpacked(surface["facets"], "<u4")


def unpacked(text: str, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), kind).reshape(-1, 3)


def volume(place: np.ndarray, facets: np.ndarray) -> float:
    a, b, c = np.moveaxis(place[facets].astype(float), 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6.0)


@pytest.mark.law
def test_the_surface_of_a_solid_closes_around_its_volume(client, block):
    place, normal, facets = drawn(client, solid("block.step", block.read_bytes()))
    np.testing.assert_allclose([place.min(axis=0), place.max(axis=0)], [LOW, HIGH], atol=1e-3)
    bores = 2 * np.pi * 20.0**2 * 30.0
    np.testing.assert_allclose(volume(place, facets), 160.0 * 80.0 * 30.0 - bores, rtol=0.01)
    edges = np.sort(facets[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert set(np.unique(edges, axis=0, return_counts=True)[1]) == {2}, "each edge is of two facets"
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, atol=1e-6)
    assert len(facets) <= 20_000


@pytest.mark.law
def test_a_surface_stands_where_its_housing_does(client, block):
    content = block.read_bytes()
    rest, _, facets = drawn(client, solid("block.step", content))
    fields = {"origin_mm": [10.0, 20.0, 30.0], "x_axis": [0.0, 1.0, 0.0], "z_axis": [1.0, 0.0, 0.0]}
    moved, _, _ = drawn(client, solid("block.step", content, **fields))
    x, y, z = rest.T
    np.testing.assert_allclose(moved, np.stack([z + 10.0, x + 20.0, y + 30.0], axis=1), atol=1e-3)
    both, _, pairs = drawn(client, solid("a.step", content), solid("b.step", content, **fields))
    assert pairs.max() == len(both) - 1
    np.testing.assert_allclose(volume(both, pairs), 2.0 * volume(rest, facets), rtol=0.01)


CUBE = [(x, y, z) for z in (0, 100) for y in (0, 100) for x in (0, 100)]
FIVE = [(1, 2, 3, 5), (4, 2, 3, 8), (6, 2, 5, 8), (7, 3, 5, 8), (2, 3, 5, 8)]


def mesh_of(points: Any, cells: Any) -> bytes:
    nodes = "".join(f"{k}, {x:.9g}, {y:.9g}, {z:.9g}\n" for k, (x, y, z) in enumerate(points, 1))
    elements = "".join(f"{k}, {', '.join(map(str, cell))}\n" for k, cell in enumerate(cells, 1))
    return f"*NODE\n{nodes}*ELEMENT, TYPE=C3D4\n{elements}".encode()


def test_a_mesh_gives_its_surface_and_matrices_give_none(client):
    place, _, facets = drawn(client, solid("cube.inp", mesh_of(CUBE, FIVE)))
    assert (len(place), len(facets)) == (8, 12)
    in_m = solid("m.inp", mesh_of(1e-3 * np.array(CUBE), FIVE), mesh_unit="m", origin_mm=[0.0, 0.0, 1.0])
    np.testing.assert_allclose(drawn(client, in_m)[0], place + np.eye(3)[2], rtol=1e-6)
    rows = np.diag([1e8] * 3).tolist()
    matrices = {"name": "case", "bushings": ["input left"], "stiffness_matrix": rows}
    assert client.post(ROUTE, json={"housings": [matrices]}).json() == {"surface": None}


def test_equal_files_are_read_once(client, served, block, monkeypatch):
    own = solid("block.step", block.read_bytes(), origin_mm=[1.0, 2.0, 3.0])
    first = client.post(ROUTE, json={"housings": [own]})
    monkeypatch.setattr(served.app.state.context.reader, "ask", None)
    again = client.post(ROUTE, json={"housings": [own | {"modes": 7}]})
    assert again.content == first.content


STEP = b"ISO-10303-21;\n"
FAR = [(x + 2e7, y, z) for x, y, z in CUBE]
ATTACKS = {
    "empty": (solid("case.step", b""), "housings[0].step_file"),
    "only its beginning": (solid("case.step", STEP), "housings[0].step_file"),
    "a program": (solid("case.step", b"#!/bin/sh\nrm -rf /\n"), "housings[0].step_file"),
    "zeros": (solid("case.step", STEP + bytes(100_000)), "housings[0].step_file"),
    "no mesh": (solid("case.inp", b"\0\1\2"), "housings[0].mesh_file.cells"),
    "hexahedra": (
        solid("case.inp", mesh_of(CUBE, [(1, 2, 4, 3, 5, 6, 8, 7)]).replace(b"C3D4", b"C3D8")),
        "housings[0].mesh_file.cells",
    ),
    "another file": (solid("case.inp", b"*INCLUDE, INPUT=/etc/passwd\n"), "housings[0].mesh_file"),
    "no nodes": (solid("case.inp", mesh_of(CUBE[:3], FIVE)), "housings[0].mesh_file"),
    "no numbers": (solid("case.inp", mesh_of([(np.nan, 0, 0), *CUBE[1:]], FIVE)), "housings[0].mesh_file"),
    "far away": (solid("case.inp", mesh_of(FAR, FIVE)), "housings[0].mesh_file.place_mm"),
    "huge": (
        solid("case.inp", mesh_of([(1e200 * x, y, z) for x, y, z in CUBE], FIVE)),
        "housings[0].mesh_file.place_mm",
    ),
    "tiny": (solid("case.inp", mesh_of(1e-3 * np.array(CUBE), FIVE)), "housings[0].mesh_file.size_mm"),
}


@pytest.mark.parametrize(("own", "field"), ATTACKS.values(), ids=ATTACKS)
def test_a_file_that_is_no_solid_is_refused_by_its_field(client, own, field):
    answer = client.post(ROUTE, json={"housings": [own]})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["field"] == field, answer.text


def test_a_step_file_is_refused_cut_off_or_with_two_solids(client, block, tmp_path):
    whole = block.read_bytes()
    two = write_block(tmp_path / "two.step", "two").read_bytes()
    huge = whole.replace(b"CARTESIAN_POINT('',(-40.", b"CARTESIAN_POINT('',(-1.E300")
    assert huge != whole
    for content in (whole[: len(whole) // 2], two, huge):
        answer = client.post(ROUTE, json={"housings": [solid("case.step", content)]})
        assert answer.status_code == 422, answer.text
        assert answer.json()["errors"][0]["field"].startswith("housings[0].step_file"), answer.text
    damaged = solid("case.step", whole)
    damaged["step_file"]["content"] = damaged["step_file"]["content"][:1000]
    assert client.post(ROUTE, json={"housings": [damaged]}).status_code == 422


def test_many_faces_are_drawn_by_fewer_triangles(client, tmp_path):
    """Of some 500 faces as STEP; of 40 800 triangles as a mesh."""
    step = tmp_path / "towers.step"
    subprocess.run([sys.executable, "-c", MANY, str(step), "10"], check=True, capture_output=True)
    begun = time.perf_counter()
    place, _, facets = drawn(client, solid("towers.step", step.read_bytes()))
    assert time.perf_counter() - begun < 30.0
    assert 500 < len(facets) <= 20_000
    np.testing.assert_allclose(np.ptp(place, axis=0)[:2], [100.0, 100.0], atol=0.5)
    plate = solid("plate.inp", mesh_of(*plate_of(100)))
    place, _, facets = drawn(client, plate)
    assert 5_000 < len(facets) <= 20_000
    np.testing.assert_allclose(np.ptp(place, axis=0), [1000.0, 1000.0, 10.0], atol=10.0)
    _, _, shared = drawn(client, *[plate | {"name": name} for name in "abcd"])
    assert 5_000 < len(shared) <= 20_000


def plate_of(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and tetrahedra of a plate of so many cubes of 10 mm along both edges, six in each."""
    number = np.arange(1, 2 * (count + 1) ** 2 + 1).reshape(count + 1, count + 1, 2)
    points = 10.0 * np.stack(np.indices(number.shape), axis=-1).reshape(-1, 3)
    cells = []
    for order in permutations(range(3)):
        steps = np.vstack([np.zeros((1, 3), dtype=int), np.cumsum(np.eye(3, dtype=int)[list(order)], axis=0)])
        cells.append([number[a : count + a, b : count + b, c : 1 + c].ravel() for a, b, c in steps])
    return points, np.concatenate(np.moveaxis(cells, 1, 2))
