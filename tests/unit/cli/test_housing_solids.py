"""Housings of a scene by the file of their solid: reduced as in Python, once, refused by name; their cost."""

import json
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from command_line import loa
from declared_figures import check_declared
from housing_solid import SEAT, housed_scene, housing, write_block, write_housed_scene

from dynamics.housings import (
    GRAY_CAST_IRON,
    Bore,
    BoundedPlane,
    Box,
    Foot,
    MaterialDamping,
    MeshedHousing,
    ModalDamping,
    Mount,
    Plane,
    ReducedHousing,
    SeatBore,
    mesh_step,
    reduced_housing,
)
from dynamics.housings import cached_reduction as kept
from dynamics.work_cost import WorkCost
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.gearbox.convert import solid_housings
from lineofaction.gearbox.convert.scene import TabledScene, check_scene
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.schemas import read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.study.scenes import VariedScene, places_of
from lineofaction.gearbox.subjects import scene_of
from lineofaction.report.drawing.tables import amount, cost_tables

SOURCE = dict.fromkeys(("step_file", "material", "modes", "element_size_mm", "seats", "feet", "points"))
LOSS = 0.02
LOW, HIGH = [-50.0, -35.0, 80.0], [130.0, 45.0, 120.0]
SIDES = [
    {"name": f"side {s}", "point_mm": [40.0 + 80.0 * s, 0.0, 0.0], "normal": [s, 0.0, 0.0]}
    | {"low_mm": LOW, "high_mm": HIGH}
    for s in (-1, 1)
]


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """A folder with the STEP file of the block, and the cache of its mesh."""
    folder = tmp_path_factory.mktemp("solid")
    write_block(folder / "block.step")
    return folder


@pytest.fixture
def folder(tmp_path, shared, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(shared / "cache"))
    (tmp_path / "block.step").write_bytes((shared / "block.step").read_bytes())
    return tmp_path


def tabled(folder: Path, **fields: Any) -> TabledScene:
    """Return the scene of a file as the command line makes it."""
    file = folder / "scene.json"
    file.write_text(json.dumps(housed_scene(folder, **fields)))
    return tabled_scene(*scene_of(file), None, lambda _stage, _fraction: None)


def in_python(folder: Path, damping=None, mount: Mount | None = None) -> ReducedHousing:
    centers = {"input left": (0.0, 0.0, 0.1), "output left": (0.08, 0.0, 0.1)}
    seats = tuple(SeatBore(name, Bore(at, (0.0, 0.0, 1.0), 0.04, 0.03)) for name, at in centers.items())
    feet = [Foot("base", Plane((0.0, -0.04, 0.0), (0.0, -1.0, 0.0)), mount)]
    if mount is not None:
        box = Box(tuple(1e-3 * v for v in LOW), tuple(1e-3 * v for v in HIGH))
        sides = {s: Plane((0.04 + 0.08 * s, 0.0, 0.0), (s, 0.0, 0.0)) for s in (-1, 1)}
        feet += [Foot(f"side {s}", BoundedPlane(plane, box), mount) for s, plane in sides.items()]
    mesh, points = mesh_step(folder / "block.step", 0.025), {"cover": (0.04, 0.04, 0.1)}
    damping = damping or ModalDamping((0.005,))
    return reduced_housing(MeshedHousing(mesh, GRAY_CAST_IRON, seats, tuple(feet), points, 4, damping))


def assert_same(one: ReducedHousing, other: ReducedHousing) -> None:
    for name in ("mass", "stiffness", "damping", "frequency"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    np.testing.assert_array_equal(one.surface.motion, other.surface.motion)
    np.testing.assert_array_equal(one.points[0].motion, other.points[0].motion)


@pytest.mark.law
def test_a_scene_on_a_step_file_is_that_on_its_file_of_modes(folder):
    """To the last bit: matrices, surface, points; the scene is self-contained then."""
    own = tabled(folder)
    in_python(folder).to_netcdf(folder / "case.nc")
    of_file = tabled(folder, **SOURCE, modes_file="case.nc")
    (ours,), (theirs,) = own.scene.housings, of_file.scene.housings
    for name in ("bushings", "mass", "stiffness", "damping", "seat_positions", "modal_coordinates"):
        assert getattr(ours, name) == getattr(theirs, name), name
    assert_same(own.housings["case"], of_file.housings["case"])
    assert of_file.inputs.housings[0].modes_file is None


def test_mounts_and_a_loss_factor_reach_the_housing(folder):
    rates = {"mount_stiffness_n_per_m": [2e7, 5e7, 3e7], "mount_damping_n_s_per_m": [2e3, 5e3, 3e3]}
    feet = [housing()["feet"][0] | rates, *(part | rates for part in SIDES)]
    mount = Mount(*(tuple(map(tuple, np.diag(values).tolist())) for values in rates.values()))
    assert_same(
        tabled(folder, feet=feet, loss_factor=LOSS).housings["case"],
        in_python(folder, MaterialDamping(LOSS), mount),
    )


@pytest.mark.law
def test_a_mesh_file_is_the_same_housing_in_either_unit(folder):
    """Written in text or binary, turned and moved: columns of `turn` are the axes of the file."""
    expected = tabled(folder).housings["case"]
    mesh = mesh_step(folder / "block.step", 0.025)
    turn = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    away = (mesh.points - [0.01, 0.02, 0.03]) @ turn
    meshio.Mesh(1e3 * mesh.points, [("tetra10", mesh.tetrahedra)]).write(folder / "a.inp", "abaqus")
    meshio.Mesh(away, [("tetra10", mesh.tetrahedra)]).write(folder / "b.vtu", "vtu")
    step = {"step_file": None, "element_size_mm": None}
    placed = {"origin_mm": [10.0, 20.0, 30.0], "x_axis": turn[:, 0].tolist(), "z_axis": turn[:, 2].tolist()}
    for found in (
        tabled(folder, **step, mesh_file="a.inp", mesh_unit="mm"),
        tabled(folder, **step, mesh_file="b.vtu", mesh_unit="m", **placed),
    ):
        reduced = found.housings["case"]
        assert reduced.frequency == pytest.approx(expected.frequency, rel=1e-6)
        assert reduced.points[0].position == pytest.approx(expected.points[0].position, abs=1e-8)


def test_the_second_time_a_housing_comes_from_the_cache(folder, monkeypatch):
    """Neither meshed nor reduced again; another number of modes is."""
    first = tabled(folder).housings["case"]
    monkeypatch.setattr(kept, "mesh_step", lambda *_: pytest.fail("meshed again"))
    monkeypatch.setattr(kept, "reduce_housing", lambda _: pytest.fail("reduced again"))
    assert_same(first, tabled(folder).housings["case"])
    with pytest.raises(pytest.fail.Exception, match="reduced again"):
        tabled(folder, modes=5)
    with pytest.raises(pytest.fail.Exception, match="meshed again"):
        tabled(folder, element_size_mm=30.0)


def test_what_a_reduction_takes_is_told_before_it_begins_and_kept(folder, monkeypatch):
    monkeypatch.setattr("dynamics.work_cost.ANNOUNCED", 0.0)
    told: list[str] = []
    file = folder / "scene.json"
    file.write_text(json.dumps(housed_scene(folder, modes=7)))
    first, again = (
        tabled_scene(*scene_of(file), None, lambda stage, _: told.append(stage)).housings["case"].cost
        for _ in range(2)
    )
    (words,) = (stage for stage in told if "; " in stage)
    assert words.startswith("housing; case: about ") and words.endswith(" GB")
    assert told.index(words) < len(told) - 1
    assert first == again and first.seconds > 0.0 and first.predicted_bytes > 0.0


def test_a_study_reduces_a_housing_anew_where_a_factor_changes_it(folder, monkeypatch):
    """A loss factor changes the damping alone; a load leaves the housing as it is."""
    own = tabled(folder, loss_factor=LOSS)
    paths = ("housings.case.loss_factor", "loads.brake.torque_n_m")
    places = {path: places_of(own.inputs, "path", path) for path in paths}
    written = own.inputs.model_dump_json()
    varied = VariedScene(written, own.databases, places, str(folder.parent / "study"))
    (plain,), (loaded,) = (varied.scene(at).housings for at in ({}, {paths[1]: 50.0}))
    assert plain == loaded == own.scene.housings[0]
    monkeypatch.setattr(solid_housings, "reduced_housing", lambda *_: pytest.fail("reduced again"))
    assert varied.scene({paths[1]: 60.0}).housings == (plain,)
    monkeypatch.undo()
    (damped,) = varied.scene({paths[0]: 2.0 * LOSS}).housings
    np.testing.assert_allclose(damped.damping, 2.0 * np.array(plain.damping), rtol=0.0, atol=1e-9 * 1e6)
    assert damped.stiffness == plain.stiffness


SEATS = [{"bearing": name, **SEAT} for name in ("input left", "output left")]
FOOT = housing()["feet"][0]
WRONG: dict[str, tuple[dict[str, Any], str, str]] = {
    "no feet": ({"feet": []}, "housings[0].feet", "held"),
    "no seats": ({"seats": []}, "housings[0].seats", "bearing"),
    "no material": ({"material": None}, "housings[0].material", "gray_cast_iron"),
    "no such material": ({"material": "wood"}, "housings[0].material", "table"),
    "no such bearing": ({"seats": [SEATS[0], {"bearing": "x", **SEAT}]}, "housings[0].bushings[1]", "output"),
    "no bore there": (
        {"seats": [SEATS[0] | {"bore_diameter_mm": 44.0}, SEATS[1]]},
        "housings[0].seats[0].bore_diameter_mm",
        "diameter of 40 mm",
    ),
    "too long a bore": (
        {"seats": [SEATS[0], SEATS[1] | {"bore_length_mm": 90.0}]},
        "housings[0].seats[1].bore_diameter_mm",
        "80 mm, 0 mm, 100 mm",
    ),
    "too short a bore": (
        {"seats": [SEATS[0] | {"bore_length_mm": 3.0}, SEATS[1]]},
        "housings[0].seats[0].bore_length_mm",
        "elements up to 10 mm along the axis",
    ),
    "no foot there": (
        {"feet": [FOOT | {"point_mm": [0, 0, 0]}]},
        "housings[0].feet[0].point_mm",
        "-40 mm to",
    ),
    "a foot by half": (
        {"feet": [{"name": "a", "normal": [0, 1, 0]}]},
        "housings[0].feet[0].point_mm",
        "normal",
    ),
    "one mount that lets it turn": (
        {"feet": [FOOT | {"mount_stiffness_n_per_m": [1e7, 1e7, 1e7]}]},
        "housings[0].feet",
        "three feet",
    ),
    "feet that share an edge": (
        {"feet": [FOOT, SIDES[0] | {"low_mm": None, "high_mm": None}]},
        "housings[0].feet[1]",
        "one face",
    ),
    "a foot of nothing": ({"feet": [{"name": "a"}]}, "housings[0].feet[0].point_mm", "group"),
    "no point there": (
        {"points": [{"name": "far", "position_mm": [400.0, 0.0, 0.0]}]},
        "housings[0].points[0].position_mm",
        "mm away",
    ),
    "a file that is not there": ({"step_file": "none.step"}, "housings[0].step_file", "exists"),
    "no STEP file": ({"step_file": "scene.json"}, "housings[0].step_file", ".stp"),
    "text in place of STEP": ({"step_file": "text.step"}, "housings[0].step_file", "ISO-10303-21"),
    "two files": ({"mesh_file": "text.inp"}, "housings[0].step_file", "one"),
    "a mesh without a unit": (
        {"step_file": None, "element_size_mm": None, "mesh_file": "text.inp"},
        "housings[0].mesh_unit",
        '"mm"',
    ),
    "no mesh in it": (
        {"step_file": None, "element_size_mm": None, "mesh_file": "text.inp", "mesh_unit": "mm"},
        "housings[0].mesh_file.cells",
        "tetrahedra",
    ),
    "a mesh of several files": (
        {"step_file": None, "element_size_mm": None, "mesh_file": "more.inp", "mesh_unit": "mm"},
        "housings[0].mesh_file",
        "INCLUDE",
    ),
    "the wrong unit": (
        {"step_file": None, "element_size_mm": None, "mesh_file": "block.inp", "mesh_unit": "m"},
        "housings[0].mesh_file.size_mm",
        "unit of the mesh",
    ),
    "skew axes": ({"x_axis": [1.0, 0.0, 0.5]}, "housings[0].x_axis", "perpendicular"),
    "matrices too": ({"mass_matrix": np.eye(10).tolist()}, "housings[0].mass_matrix", "stiffness_matrix"),
    "a solid of matrices": (
        {**SOURCE, "bushings": ["input left"], "stiffness_matrix": np.eye(3).tolist(), "modes": 3},
        "housings[0].modes",
        "step_file",
    ),
    "two solids": ({"step_file": "two.step"}, "housings[0].step_file.solids", "one solid"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_solid_that_cannot_be_is_one_fault_by_name(folder, name):
    fields, field, words = WRONG[name]
    (folder / "text.step").write_text("no solid")
    (folder / "text.inp").write_text("*HEADING\nno mesh\n")
    (folder / "more.inp").write_text("*HEADING\n*Include, input=/etc/passwd\n")
    if name == "two solids":
        write_block(folder / "two.step", "two")
    if name == "the wrong unit":
        mesh = mesh_step(folder / "block.step", 0.025)
        meshio.Mesh(1e3 * mesh.points, [("tetra10", mesh.tetrahedra)]).write(folder / "block.inp", "abaqus")
    with pytest.raises(BadInput) as caught:
        tabled(folder, **fields)
    (fault,) = caught.value.faults
    assert fault.field == field
    assert words in f"{fault.bound} {fault.suggestion}"
    assert "/tmp" not in str(caught.value).replace(str(folder), "")


def test_what_fails_is_said_with_the_name_of_the_housing(folder):
    (folder / "broken.step").write_text("ISO-10303-21;\nEND-ISO-10303-21;\n")
    with pytest.raises(JobFailed, match=r'housing "case": mesher: .*Heal the geometry'):
        tabled(folder, step_file="broken.step")


def test_a_damaged_content_is_refused_at_the_request(folder):
    """Of what came over HTTP, without meshing it."""
    (folder / "scene.json").write_text(json.dumps(housed_scene(folder)))
    whole = read_model(SceneInput, folder / "scene.json").model_dump(mode="json")
    for content in ("not Base64", "AAAA", whole["housings"][0]["step_file"]["content"][:400]):
        whole["housings"][0]["step_file"]["content"] = content
        scene = validated(SceneInput, json.loads(json.dumps(whole)))
        with pytest.raises(BadInput) as caught:
            check_scene(scene, {"mesh": tabled_facts(folder)})
        assert caught.value.faults[0].field == "housings[0].step_file.content"


def tabled_facts(folder: Path):
    from fe_contact.ste import SteDatabase  # noqa: PLC0415

    return SteDatabase.from_netcdf(folder / "mesh.nc").geometry


STUDIES: dict[str, tuple[str, ...]] = {
    "modes": (),
    "response": ("--speed-rpm", "1500:3000:750", "--orders", "2"),
    "steady": ("--speed-rpm", "1500", "--no-branch"),
    "noise": ("--speed-rpm", "1500:3000:750", "--orders", "2", "--no-band", "--no-boundary-elements"),
}
COST = vars(WorkCost(24.6, 1.07e9, 25.1, None))


@pytest.fixture(scope="module")
def two_bores(tmp_path_factory):
    return write_housed_scene(tmp_path_factory.mktemp("costs"), modes=6)


@pytest.mark.parametrize("study", list(STUDIES))
def test_figures_and_report_state_the_cost_of_the_reduction(two_bores, study, monkeypatch):
    """The same from the cache: what was measured once."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(two_bores / "cache"))
    report = two_bores / f"{study}.html"
    costs = []
    for more in (("--json",), ("--json", "-o", str(report))):
        result = loa(study, two_bores / "scene.json", *STUDIES[study], *more)
        assert result.exit_code == 0, result.stderr
        answer: dict[str, Any] = json.loads(result.stdout)
        check_declared(study, answer)
        costs.append(answer["reduction_cost"]["case"])
    assert costs[0] == costs[1]
    for name in ("predicted_cpu_seconds", "predicted_bytes", "cpu_seconds"):
        assert costs[0][name] > 0.0
    assert "case: reduction" in report.read_text("utf-8")


def test_the_table_has_prediction_beside_measurement():
    facts = {"seconds": {"response": 0.5, "sound": 0.25}, "reduction_cost": {"case": COST}}
    (table,) = cost_tables(facts)
    assert table.rows == (("case: reduction", "25", "25", "-", "1.1"),)
    radiation = {"case": {"model_name": "monopoles", "cost": COST | {"seconds": 61.5, "bytes": 2e8}}}
    (table,) = cost_tables(facts | {"radiation": radiation})
    assert table.rows[1] == ("case: monopoles, all frequencies", "62", "25", "0.20", "1.1")
    assert cost_tables({"seconds": {}}) == ()


def test_less_than_a_thousandth_is_not_written_out():
    assert (amount(1.2e-7), amount(None), amount(0.0123)) == ("< 0.001", "-", "0.012")
