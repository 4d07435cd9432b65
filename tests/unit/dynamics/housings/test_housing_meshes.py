"""Meshes of housings: made here, of other programs, and their surfaces."""

import builtins
import re
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import meshio
import meshlane
import numpy as np
import pytest
from foreign_meshes import FOREIGN_MESHES
from foreign_netcdf import SECRET, write_canary
from lattice_meshes import box, tube

from dynamics.errors import InputError, SolveError
from dynamics.housings import (
    GRAY_CAST_IRON,
    Bore,
    BoundedPlane,
    Box,
    Foot,
    Group,
    MeshedHousing,
    Plane,
    SeatBore,
    mesh_step,
    read_mesh,
    write_surface,
)
from dynamics.housings.assembled_housing import mass_and_stiffness
from dynamics.housings.drawn_surface import DrawnSurface, drawn_mesh
from dynamics.housings.mesh_files import element_shape
from dynamics.housings.reduction import reduce_housing
from dynamics.mesh_content import check_mesh_content
from host import missing_protections

# Meshes of housings from files and from STEP: the same by every format, one clear error for a bad one.


MESH = tube(0.12, 0.08, 0.1, (8, 1, 2))
MILLIMETERS = 1000.0 * MESH.points
FOOT = np.flatnonzero(MESH.points[:, 2] == 0.0)


def write_nastran(path: Path) -> None:
    """Grid points in large fields, CTETRA with ten nodes in small ones."""
    lines = ["BEGIN BULK"]
    for number, (x, y, z) in enumerate(MILLIMETERS.tolist(), 1):
        lines += [f"GRID*   {number:16d}{'':16}{x:16.9f}{y:16.9f}*", f"*       {z:16.9f}"]
    for number, nodes in enumerate((MESH.tetrahedra + 1).tolist(), 1):
        fields = [f"{entry:8d}" for entry in (number, 1, *nodes)]
        lines += ["CTETRA  " + "".join(fields[:8]) + "+", "+       " + "".join(fields[8:])]
    path.write_text("\n".join([*lines, "ENDDATA", ""]), encoding="ascii")


def written(path: Path) -> Path:
    if path.suffix == ".bdf":
        write_nastran(path)
        return path
    sets = {"foot": FOOT} if path.suffix == ".inp" else {}
    whole = meshio.Mesh(MILLIMETERS, [("tetra10", MESH.tetrahedra)], point_sets=sets)
    whole.write(path, file_format={".msh": "gmsh", ".inp": "abaqus", ".vtu": "vtu"}[path.suffix])
    return path


@pytest.mark.parametrize("suffix", [".msh", ".inp", ".vtu", ".bdf"])
def test_a_mesh_has_the_same_matrices_by_every_format(tmp_path, suffix):
    back = read_mesh(written(tmp_path / f"tube{suffix}"), "mm")
    assert back.points == pytest.approx(MESH.points, abs=1e-11)
    for found, expected in zip(*(mass_and_stiffness(m, GRAY_CAST_IRON) for m in (back, MESH)), strict=True):
        assert abs(found - expected).max() < 1e-8 * abs(expected).max()


def test_a_node_set_is_a_foot(tmp_path):
    back = read_mesh(written(tmp_path / "tube.inp"), "mm")
    base = Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)).triangles(back)
    assert np.array_equal(Group("foot").triangles(back), base)
    assert len(base) == 16
    with pytest.raises(InputError, match="foot"):
        Group("feet").triangles(back)


def test_physical_groups_of_triangles_keep_their_names(tmp_path):
    base = Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)).triangles(MESH)
    cells = [("tetra10", MESH.tetrahedra), ("triangle6", base)]
    numbers = [np.full(len(data), kind) for kind, (_, data) in enumerate(cells, 1)]
    whole = meshio.Mesh(
        MILLIMETERS,
        cells,
        cell_data={"gmsh:physical": numbers, "gmsh:geometrical": numbers},
        field_data={"foot": np.array([2, 2])},
    )
    whole.write(tmp_path / "tube.msh", file_format="gmsh22")
    back = read_mesh(tmp_path / "tube.msh", "mm")
    assert np.array_equal(Group("foot").triangles(back), base)


WRITE_GROUPS = """
import sys, gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.addBox(0, 0, 0, 100, 80, 60)
gmsh.model.occ.synchronize()
gmsh.option.setNumber("Mesh.MeshSizeMin", 40)
gmsh.option.setNumber("Mesh.SaveAll", int(sys.argv[2] == "all"))
gmsh.model.mesh.generate(3)
gmsh.model.addPhysicalGroup(2, [1], 7, "left")
gmsh.model.addPhysicalGroup(2, [1, 5], 9, "left and base")
gmsh.model.addPhysicalGroup(3, [1], 20, "body")
gmsh.write(sys.argv[1])
gmsh.finalize()
"""


def test_a_face_in_two_physical_groups_is_in_both(tmp_path):
    """gmsh 4.1 lists all groups of a face; the number of its elements is the first group's."""
    file = tmp_path / "box.msh"
    subprocess.run([sys.executable, "-c", WRITE_GROUPS, str(file), "groups"], check=True)
    mesh = read_mesh(file, "mm")
    left = Plane((0.0, 0.0, 0.0), (-1.0, 0.0, 0.0)).triangles(mesh)
    base = Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)).triangles(mesh)
    assert len(Group("left").triangles(mesh)) == len(left) > 0
    assert len(Group("left and base").triangles(mesh)) == len(left) + len(base)


def test_elements_without_a_group_beside_others_are_refused_with_what_to_save(tmp_path):
    file = tmp_path / "box.msh"
    subprocess.run([sys.executable, "-c", WRITE_GROUPS, str(file), "all"], check=True)
    with pytest.raises(InputError, match=r"Mesh\.SaveAll = 0") as caught:
        read_mesh(file, "mm")
    assert (caught.value.field, caught.value.value) == ("mesh_file", "box.msh")


def test_linear_tetrahedra_of_either_hand_get_nodes_in_the_middle_of_their_edges(tmp_path):
    straight = box((0.1, 0.1, 0.1), (2, 2, 2))
    corners = straight.tetrahedra[:, :4].copy()
    corners[::2] = corners[::2][:, [1, 0, 2, 3]]
    used, corners = np.unique(corners, return_inverse=True)
    meshio.Mesh(straight.points[used], [("tetra", corners.reshape(-1, 4))]).write(tmp_path / "box.vtu")
    back = read_mesh(tmp_path / "box.vtu", "m")
    assert len(back.points) == len(straight.points)
    mass, _ = mass_and_stiffness(back, GRAY_CAST_IRON)
    assert mass.sum() == pytest.approx(GRAY_CAST_IRON.density * 1e-3, rel=1e-12)


def test_a_regular_tetrahedron_is_the_best_shape():
    points = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
    assert element_shape(type(MESH)(points, np.array([[0, 2, 1, 3, *6 * [0]]]))) == pytest.approx([1.0])


def abaqus_file(folder: Path, blocks: int = 2, placed: bool = False, parts: int = 1) -> Path:
    """Write the tube with nodes in blocks; in parts of the same numbers, placed 500 mm apart."""
    rows = [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in enumerate(MILLIMETERS.tolist(), 1)]
    cells = [", ".join(map(str, (n, *nodes))) for n, nodes in enumerate((MESH.tetrahedra + 1).tolist(), 1)]
    size = -(-len(rows) // blocks)
    nodes = [line for k in range(0, len(rows), size) for line in ("*NODE", *rows[k : k + size])]
    lines = [*nodes, "*ELEMENT, TYPE=C3D10", *cells]
    if placed:
        bodies = [line for k in range(parts) for line in (f"*PART, NAME=p{k}", *lines, "*END PART")]
        instances = [
            line
            for k in range(parts)
            for line in (f"*INSTANCE, NAME=i{k}, PART=p{k}", f"{10 + 500 * k}., 20., 30.", "*END INSTANCE")
        ]
        lines = [*bodies, "*ASSEMBLY, NAME=all", *instances, "*END ASSEMBLY"]
    file = folder / "case.inp"
    file.write_text("\n".join(["*HEADING", *lines, ""]))
    return file


@pytest.mark.parametrize("placed", [False, True])
def test_all_nodes_of_an_abaqus_file_are_read(tmp_path, placed):
    expected = MESH.points + placed * np.array([0.01, 0.02, 0.03])
    assert read_mesh(abaqus_file(tmp_path, placed=placed), "mm").points == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("parts", [1, 2])
def test_meshio_misplaces_parts_of_abaqus_without_a_word(tmp_path, parts, capsys):
    """The reason of the extra abaqus: when meshio reads these files, meshlane can go."""
    file = abaqus_file(tmp_path, blocks=1, placed=True, parts=parts)
    found, expected = meshio.abaqus.read(file), meshlane.abaqus.read(file)
    assert capsys.readouterr() == ("", "")
    assert found.points == pytest.approx(MILLIMETERS), "where their instance does not place them"
    shifts = [np.array([10.0 + 500.0 * k, 20.0, 30.0]) for k in range(parts)]
    assert expected.points == pytest.approx(np.vstack([MILLIMETERS + shift for shift in shifts]))
    assert sum(len(block.data) for block in found.cells) == parts * len(MESH.tetrahedra)


def test_a_mesh_of_abaqus_names_the_extra_that_reads_it(tmp_path, monkeypatch):
    file = abaqus_file(tmp_path)
    monkeypatch.setitem(sys.modules, "meshlane", None)
    for read in (read_mesh, drawn_mesh):
        with pytest.raises(InputError, match=r"extra abaqus.*pip install 'lineofaction\[abaqus\]'") as caught:
            read(file, "mm")
        assert (caught.value.field, caught.value.value) == ("mesh_file", "case.inp")


def folded() -> meshio.Mesh:
    points = MILLIMETERS.copy()
    points[MESH.tetrahedra[0, 4]] = points[MESH.tetrahedra[0, 3]]
    return meshio.Mesh(points, [("tetra10", MESH.tetrahedra)])


def sliver() -> meshio.Mesh:
    flat = box((0.1, 0.1, 1e-5), (1, 1, 1))
    return meshio.Mesh(1000.0 * flat.points, [("tetra10", flat.tetrahedra)])


def two_parts() -> meshio.Mesh:
    both = np.vstack([MILLIMETERS, MILLIMETERS + 500.0])
    return meshio.Mesh(both, [("tetra10", np.vstack([MESH.tetrahedra, MESH.tetrahedra + len(MILLIMETERS)]))])


def hexahedra() -> meshio.Mesh:
    return meshio.Mesh(100.0 * np.random.default_rng(0).random((8, 3)), [("hexahedron", np.arange(8)[None])])


@pytest.mark.parametrize(
    ("mesh", "unit", "field"),
    [
        (folded, "mm", "mesh_file.elements"),
        (sliver, "mm", "mesh_file.shape"),
        (two_parts, "mm", "mesh_file.parts"),
        (hexahedra, "mm", "mesh_file.cells"),
        (lambda: meshio.Mesh(MILLIMETERS, [("tetra10", MESH.tetrahedra)]), "m", "mesh_file.size"),
        (lambda: meshio.Mesh(MILLIMETERS, [("tetra10", MESH.tetrahedra)]), "inch", "unit"),
    ],
)
def test_a_bad_mesh_is_refused_by_name(tmp_path, mesh, unit, field):
    mesh().write(tmp_path / "bad.vtu")
    with pytest.raises(InputError) as caught:
        read_mesh(tmp_path / "bad.vtu", unit)
    assert caught.value.field == field


@pytest.mark.parametrize("name", ["absent.vtu", "damaged.vtu", "damaged.msh", "damaged.inp", "housing.stl"])
def test_a_file_that_is_no_mesh_is_one_clear_error(tmp_path, name):
    if name != "absent.vtu":
        (tmp_path / name).write_bytes(b"\x00\x01 no mesh")
    with pytest.raises(InputError) as caught:
        read_mesh(tmp_path / name, "mm")
    assert caught.value.field.startswith("mesh_file")


WRITE_STEP = """
import sys, gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
block = occ.addBox(0, 0, 0, 120, 80, 60)
bores = [(3, occ.addCylinder(x, -1, 30, 0, 82, 0, radius)) for x, radius in ((35, 20), (85, 15))]
cut, _ = occ.cut([(3, block)], bores)
if sys.argv[2:] == ["two"]:
    occ.addBox(500, 0, 0, 10, 10, 10)
occ.synchronize()
gmsh.write(sys.argv[1])
gmsh.finalize()
"""


def write_step(path: Path, *options: str) -> Path:
    subprocess.run([sys.executable, "-c", WRITE_STEP, str(path), *options], check=True, capture_output=True)
    return path


def bore(x: float, diameter: float) -> Bore:
    return Bore((x, 0.02, 0.03), (0.0, 1.0, 0.0), diameter, 0.04)


def test_a_step_file_is_meshed_and_its_bores_are_seats(tmp_path):
    mesh = mesh_step(write_step(tmp_path / "block.step"), 0.025)
    assert mesh.points.max(axis=0) == pytest.approx([0.12, 0.08, 0.06], rel=1e-6)
    for x, diameter in ((0.035, 0.04), (0.085, 0.03)):
        wall = mesh.points[np.unique(bore(x, diameter).triangles(mesh))]
        radius = np.hypot(wall[:, 0] - x, wall[:, 2] - 0.03)
        assert radius == pytest.approx(
            diameter / 2.0, rel=1e-6
        )  # mid-side nodes too: they follow the surface
    with pytest.raises(InputError, match=r"diameter of 0\.04") as caught:
        bore(0.035, 0.05).triangles(mesh)
    assert caught.value.field == "diameter"
    corner = BoundedPlane(Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), Box((-1.0, -1.0, -1.0), (0.06, 1.0, 1.0)))
    seats = (SeatBore("left", bore(0.035, 0.04)), SeatBore("right", bore(0.085, 0.03)))
    found = reduce_housing(MeshedHousing(mesh, GRAY_CAST_IRON, seats, (Foot("half", corner),), modes=4))
    exact = 0.12 * 0.08 * 0.06 - np.pi * 0.08 * (0.02**2 + 0.015**2)
    assert found.body.mass == pytest.approx(GRAY_CAST_IRON.density * exact, rel=2e-4)
    assert found.checks.volume < 1e-9
    assert found.seats[1].axes == pytest.approx(
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    )


def test_a_bore_shorter_than_the_elements_of_its_wall_is_a_fault_of_its_length():
    """Two layers of 50 mm: a length of 30 mm holds none, whatever the diameter says."""
    short = Bore((0.0, 0.0, 0.05), (0.0, 0.0, 1.0), 0.08, 0.03)
    with pytest.raises(InputError, match=r"elements up to 0\.05 m along the axis") as caught:
        short.triangles(MESH)
    assert (caught.value.field, caught.value.value) == ("length", 0.03)
    with pytest.raises(InputError, match=r"has a diameter of 0\.08 m") as wrong:
        Bore((0.0, 0.0, 0.05), (0.0, 0.0, 1.0), 0.09, 0.1).triangles(MESH)
    assert wrong.value.field == "diameter"
    assert "(0% is)" not in str(wrong.value)


def test_without_a_size_elements_fit_the_wall(tmp_path):
    step = write_step(tmp_path / "block.step")
    assert mesh_step(step).freedoms > mesh_step(step, 0.1).freedoms


@pytest.mark.parametrize(
    ("code", "complaint"),
    [
        ("raise ValueError('bytes of the file')", "mesher: ended with exit code 1. Heal"),
        ("""print('{"error": "Surface mesh failed"}')""", "Surface mesh failed"),
        ("import sys; sys.exit('std::bad_alloc')", "larger element_size"),
        ("import time; time.sleep(60)", "no answer within 0.5 s"),
    ],
)
def test_a_mesher_that_fails_says_why(tmp_path, code, complaint):
    step = tmp_path / "any.step"
    step.write_text("")
    with pytest.raises(SolveError, match=complaint):
        mesh_step(step, 0.01, seconds=0.5 if "sleep" in code else 60.0, command=(sys.executable, "-c", code))


def test_a_step_file_with_two_solids_or_none_is_refused(tmp_path):
    with pytest.raises(InputError) as caught:
        mesh_step(write_step(tmp_path / "two.step", "two"), 0.05)
    assert (caught.value.field, caught.value.value) == ("step_file.solids", 2)
    for name in ("absent.step", "block.iges"):
        with pytest.raises(InputError, match="step_file"):
            mesh_step(tmp_path / name)


def test_the_example_of_the_documentation_runs(tmp_path, monkeypatch):
    text = (Path(__file__).parents[4] / "docs" / "theory" / "housing.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    write_step(tmp_path / "housing.step")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LINEOFACTION_CACHE", str(tmp_path / "cache"))
    found: dict = {}
    exec(block, found)
    assert found["cover"].shape == (2, 3, 10)
    assert len(list((tmp_path / "cache").glob("*.nc"))) == 1


@pytest.mark.skipif(bool(missing_protections()), reason="this system does not confine processes")
@pytest.mark.parametrize("command", [read_mesh, mesh_step])
def test_a_reader_that_is_led_elsewhere_reaches_nothing(tmp_path, monkeypatch, command):
    """Whatever a library makes of a file: here it reads a canary beside it and says what is in it."""
    canary = tmp_path / "canary"
    canary.write_text("canary")
    libraries = tmp_path / "libraries"
    for name in ("meshio", "gmsh"):
        (libraries / name).mkdir(parents=True)
        (libraries / name / "__init__.py").write_text(f"raise RuntimeError(open({str(canary)!r}).read())")
    monkeypatch.syspath_prepend(str(libraries))
    (tmp_path / "any.step").write_text("")
    (tmp_path / "any.msh").write_text("")
    arguments: tuple[Any, ...] = (
        (tmp_path / "any.msh", "mm") if command is read_mesh else (tmp_path / "any.step",)
    )
    with pytest.raises((InputError, SolveError)) as refused:
        command(*arguments)
    assert "canary" not in str(refused.value)


# Meshes that lead to other files are refused where they are read and where they are sent.


LATER = ("pieces in other files", "a mesh of another program", "geometry in place of a mesh")
"""Those that name files where their reader looks for none."""


@pytest.fixture
def opened(monkeypatch):
    files: list[str] = []
    plain = builtins.open

    def recorded(file, *options, **others):
        files.append(str(file))
        return plain(file, *options, **others)

    monkeypatch.setattr(builtins, "open", recorded)
    return files


@pytest.mark.parametrize("name", FOREIGN_MESHES)
def test_it_is_refused_unread(tmp_path, opened, name):
    """The refusal tells neither the other file, nor a folder, nor the words of a parser."""
    canary = write_canary(tmp_path)
    suffix, content = FOREIGN_MESHES[name]
    file = tmp_path / f"housing{suffix}"
    file.write_bytes(content(canary))
    caught: list[Exception] = []

    def read():
        with pytest.raises(InputError) as refusal:
            read_mesh(file, "mm")
        caught.append(refusal.value)

    reading = threading.Thread(target=read, daemon=True)
    reading.start()
    reading.join(5.0)
    assert str(canary) not in opened
    (refusal,) = caught
    assert (refusal.field, refusal.value) == ("mesh_file", file.name)
    assert SECRET.decode() not in str(refusal) and str(tmp_path) not in str(refusal)


@pytest.mark.parametrize("name", [name for name in FOREIGN_MESHES if name not in LATER])
def test_its_content_tells_before_it_is_read(tmp_path, name):
    suffix, content = FOREIGN_MESHES[name]
    with pytest.raises(InputError, match=r"other files|document type|ENDDATA"):
        check_mesh_content(f"housing{suffix}", content(tmp_path))


def test_words_that_look_like_it_are_no_matter(tmp_path):
    """Comments and names; a text in Latin-1."""
    text = "** INCLUDE in a comment, \xfc\n*HEADING\nincluded\n*NODE\n1, 0, 0, 0\n*NSET, NSET=INCLUDE\n1\n"
    check_mesh_content("a.inp", text.encode("latin-1"))
    check_mesh_content("a.bdf", b"BEGIN BULK\n$ INCLUDE 'a'\nGRID,1,,0.,0.,0.\nENDDATA\n")
    (tmp_path / "a.inp").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError, match="tetrahedra"):  # it is read, and has none
        read_mesh(tmp_path / "a.inp", "mm")


# Files of a housing's surface, as other programs read them.


def test_a_reader_finds_quadratic_triangles_with_their_fields(tmp_path):
    mesh = box((0.3, 0.2, 0.1), (2, 2, 1))
    nodes, triangles = np.unique(mesh.surface, return_inverse=True)
    points, triangles = mesh.points[nodes], triangles.reshape(-1, 6)
    file = tmp_path / "mode.vtu"
    write_surface(file, points, triangles, {"motion": 2.0 * points, "size": points[:, 0]})
    found = meshio.read(file)
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


def test_what_cannot_be_written_leaves_no_file(tmp_path):
    mesh = box((0.3, 0.2, 0.1), (1, 1, 1))
    with pytest.raises(ValueError, match="len"):
        write_surface(tmp_path / "mode.vtu", mesh.points, mesh.surface, {"motion": np.zeros((2, 3))})
    assert list(tmp_path.iterdir()) == []


def test_a_coarse_surface_of_a_box_keeps_its_edges_and_its_volume():
    sides = (0.2, 0.1, 0.06)
    mesh = box(sides, (20, 12, 7))
    fine = DrawnSurface(mesh.points, mesh.surface[:, :3])
    drawn, kept = fine.reduced(1000)
    assert len(fine.facets) > 1500
    assert 900 < len(drawn.facets) <= 1000
    np.testing.assert_array_equal(drawn.points, fine.points[kept])
    np.testing.assert_allclose(np.ptp(drawn.points, axis=0), sides, rtol=1e-12)
    assert volume_of(drawn) == pytest.approx(np.prod(sides), rel=1e-9)


def test_no_facet_of_a_coarse_surface_is_a_line():
    sides = np.array([0.2, 0.1, 0.06])
    cells = (40, 20, 12)
    mesh = box((0.2, 0.1, 0.06), cells)
    inside = (mesh.points > 1e-9) & (mesh.points < sides - 1e-9)
    moved = np.random.default_rng(1).uniform(-0.45, 0.45, mesh.points.shape) * sides / cells
    fine = DrawnSurface(mesh.points + np.where(inside, moved, 0.0), mesh.surface[:, :3])
    for maximum in (300, 600, 1000):
        drawn, _ = fine.reduced(maximum)
        one, two, three = np.moveaxis(drawn.points[drawn.facets], 1, 0)
        assert np.linalg.norm(np.cross(two - one, three - one), axis=1).min() > 1e-12, "m^2"


@pytest.fixture
def thin_wall():
    """A closed case with a wall of 2 mm."""
    outer, inner = box((0.2, 0.1, 0.06), (40, 20, 12)), box((0.196, 0.096, 0.056), (41, 21, 13))
    on_outside, facets = np.unique(outer.surface[:, :3], return_inverse=True)
    on_inside, turned = np.unique(inner.surface[:, :3][:, ::-1], return_inverse=True)
    points = np.concatenate([outer.points[on_outside], inner.points[on_inside] + 2e-3])
    every = np.concatenate([facets.ravel(), turned.ravel() + len(on_outside)])
    return DrawnSurface(points, every.reshape(-1, 3))


def volume_of(surface: DrawnSurface) -> float:
    one, two, three = np.moveaxis(surface.points[surface.facets], 1, 0)
    return float(np.sum(np.cross(one, two) * three) / 6.0)


@pytest.mark.parametrize("maximum", [600, 1000, 2000])
def test_both_skins_of_a_thin_wall_are_kept_apart(thin_wall, maximum):
    """Facets are 5 to 10 times as wide as the wall: none joins its skins, nor does it thicken."""
    drawn, _ = thin_wall.reduced(maximum)
    assert 0.9 * maximum < len(drawn.facets) <= maximum < len(thin_wall.facets)
    end = np.abs(drawn.points - 0.5 * np.array([0.2, 0.1, 0.06])) - 0.5 * np.array([0.2, 0.1, 0.06])
    inside = (end.max(axis=1) < -1e-3)[drawn.facets]
    assert np.array_equal(inside.any(axis=1), inside.all(axis=1))
    assert volume_of(drawn) == pytest.approx(volume_of(thin_wall), rel=1e-3)


def test_a_coarse_surface_lies_on_the_fine_one():
    """Facets of a tube are off its circles by the sagitta of what is left around them, no more."""
    mesh = tube(0.12, 0.1, 0.04, (200, 3, 10))
    drawn, _ = DrawnSurface(mesh.points, mesh.surface[:, :3]).reduced(1000)
    assert 900 < len(drawn.facets) <= 1000
    middle = drawn.points[drawn.facets].mean(axis=1)
    off = np.column_stack([
        *(np.abs(np.hypot(middle[:, 0], middle[:, 1]) - radius) for radius in (0.05, 0.06)),
        *(np.abs(middle[:, 2] - end) for end in (0.0, 0.04)),
    ]).min(axis=1)  # fmt: skip
    assert off.max() < 0.06 * (1.0 - np.cos(np.pi / 40)), "m: of 40 chords around"
    assert volume_of(drawn) == pytest.approx(np.pi * (0.06**2 - 0.05**2) * 0.04, rel=5e-3)


def test_what_hangs_together_in_no_surface_is_refused(tmp_path):
    rng = np.random.default_rng(3)
    soup = np.array([rng.choice(40, 4, replace=False) for _ in range(400)])
    meshio.Mesh(rng.uniform(size=(40, 3)), [("tetra", soup)]).write(tmp_path / "soup.vtu")
    with pytest.raises(InputError) as caught:
        drawn_mesh(tmp_path / "soup.vtu", "m", maximum=100)
    assert caught.value.field == "mesh_file.facets"


def test_a_thin_wall_is_seen_from_outside(thin_wall):
    """Whichever of its sides comes first."""
    sides, wall = np.array([0.2, 0.1, 0.06]), 2e-3
    for order in (1, -1):
        drawn, _ = DrawnSurface(thin_wall.points, thin_wall.facets[::order]).reduced(1500)
        one, two, three = np.moveaxis(drawn.points[drawn.facets], 1, 0)
        across = 0.5 * np.cross(two - one, three - one)
        for axis in range(3):
            at_end = np.all(drawn.points[drawn.facets][..., axis] > sides[axis] - 0.5 * wall, axis=1)
            outwards = across[at_end, axis]
            assert outwards[outwards > 0.0].sum() > 0.8 * np.prod(np.delete(sides, axis))
