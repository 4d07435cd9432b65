"""A housing from a STEP file: where it stands is found by its bores; seats, foot, and what is refused."""

import json
import tomllib
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from command_line import loa
from housing_solid import housed_scene, housing, write_block

from dynamics.housings import Bore
from lineofaction.gearbox.convert.placement import Placement
from lineofaction.gearbox.convert.solid_housings import reduced_housings
from lineofaction.gearbox.from_step.placement import best_seating, placed_bore, seated
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import file_of
from lineofaction.gearbox.schemas import read_model
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_text

BEARINGS = {
    "input left": (0.0, 0.0, 0.015),
    "input right": (0.0, 0.0, 0.155),
    "middle left": (0.0955, 0.0, 0.012),
    "middle right": (0.0955, 0.0, 0.158),
    "output left": (0.0955, 0.149, 0.015),
    "output right": (0.0955, 0.149, 0.165),
}
AT = {name: np.array(at) for name, at in BEARINGS.items()}


def rotation(vector: Sequence[float]) -> np.ndarray:
    """Return the rotation about a vector by its length (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = np.array(vector) / angle
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * skew @ skew


def bores_of(places: Sequence[np.ndarray], length: float = 0.016) -> list[Bore]:
    return [Bore(tuple(map(float, at)), (0.0, 0.0, 1.0), 0.062, length) for at in places]


def moved(bores: Sequence[Bore], placement: Placement) -> list[Bore]:
    """Return bores in the frame of a file that stands so: the way back."""
    back = Placement(placement.axes.T, -placement.axes.T @ placement.origin)
    return [placed_bore(bore, back) for bore in bores]


def bolts() -> list[Bore]:
    """Return holes of bolts along a flange: many, and many of them as far apart as shafts."""
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    ring = [0.13 * np.array([np.cos(a), np.sin(a), 0.0]) + [0.05, 0.07, 0.08] for a in angles]
    return bores_of(ring, 0.01)


@pytest.mark.law
@pytest.mark.parametrize("seed", range(5))
def test_a_file_that_is_turned_and_moved_is_put_back(seed):
    rng = np.random.default_rng(seed)
    stands = Placement(rotation(rng.uniform(-2.0, 2.0, 3)), rng.uniform(-1.0, 1.0, 3))
    held = best_seating(moved([*bores_of(list(AT.values())), *bolts()], stands), AT)
    assert held.placement.axes == pytest.approx(stands.axes, abs=1e-9)
    assert held.placement.origin == pytest.approx(stands.origin, abs=1e-9)
    assert held.bores.keys() == AT.keys()
    for name, bore in held.bores.items():
        assert bore.position == pytest.approx(BEARINGS[name], abs=1e-9)


def test_a_file_in_the_frame_of_the_scene_stays_there():
    held = best_seating(bores_of(list(AT.values())), AT)
    assert held.placement.fields == {}


def test_the_bore_is_the_one_that_the_bearing_is_in():
    """Of a stepped one the step about the bearing; a wider one behind it is none of its business."""
    step, behind = (
        Bore((0.0, 0.0, 0.02), (0.0, 0.0, -1.0), 0.062, 0.02),
        bores_of([np.array([0, 0, 0.05])], 0.04),
    )
    held = seated([*behind, step], {"own": np.array([0.0, 0.0, 0.018]), "far": np.zeros(3)}, Placement())
    assert dict(held.bores) == {"own": step}


@pytest.mark.law
def test_a_unit_that_fits_in_several_ways_is_refused_with_each_of_them():
    """Two shafts with their bearings in two planes: each way that is offered seats all bearings."""
    two = {name: at for name, at in AT.items() if not name.startswith("output")}
    even = {name: np.array([at[0], 0.0, 0.0 if "left" in name else 0.2]) for name, at in two.items()}
    bores = moved(bores_of(list(even.values())), Placement(np.eye(3), np.array([0.1, 0.2, 0.3])))
    with pytest.raises(BadInput) as caught:
        best_seating(bores, even)
    fault = caught.value.faults[0]
    assert fault.field == "step_file"
    assert "4 are equally good" in fault.bound
    ways = fault.suggestion.removeprefix("Choose: ").removesuffix(".").split("; or ")
    assert len(ways) == 4
    for way in ways:
        assert seated(bores, even, typed(way)).bores.keys() == even.keys()


def typed(way: str) -> Placement:
    """Return the placement that options say."""
    words = way.split()
    said = {
        name: np.array(json.loads(f"[{value}]")) for name, value in zip(words[::2], words[1::2], strict=True)
    }
    x, z = said.get("--x-axis", np.eye(3)[0]), said.get("--z-axis", np.eye(3)[2])
    return Placement.of(x, z, said.get("--origin-mm", np.zeros(3)))


@pytest.mark.parametrize("names", [(), ("input left", "input right"), ("input left", "output left")])
def test_too_few_bores_place_nothing(names):
    bores = moved(bores_of([AT[name] for name in names]), Placement(np.eye(3), np.array([0.1, 0.0, 0.0])))
    with pytest.raises(BadInput, match="step_file") as caught:
        best_seating(bores, AT)
    assert "--origin-mm" in caught.value.faults[0].suggestion


# The verb, on a block with two bores of one bearing each.


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    return write_block(tmp_path_factory.mktemp("block") / "block.step")


@pytest.fixture
def scene(tmp_path):
    """A scene file with a comment and without a housing."""
    table: dict[str, Any] = {k: v for k, v in housed_scene(tmp_path).items() if k != "housings"}
    file = tmp_path / "scene.toml"
    file.write_text(f"# of the test bench\n{toml_text(table)}")
    return file


def test_the_scene_has_the_housing_that_one_would_write(block, scene, tmp_path):
    """Seats, foot and material as by hand; the file keeps its comment, and the STEP file goes along."""
    output = tmp_path / "housed.toml"
    ended = loa("housing", scene, block, "--material", "gray_cast_iron", "-o", output)
    assert ended.exit_code == 0, ended.output
    assert "stands on 1 face of" in ended.output
    text = output.read_text()
    assert text.startswith("# of the test bench\n")
    (part,) = tomllib.loads(text)["housings"]
    by_hand = housing()
    assert part["seats"] == by_hand["seats"]
    assert part["material"] == by_hand["material"]
    assert part["feet"][0]["normal"] == by_hand["feet"][0]["normal"]
    assert part["feet"][0]["point_mm"][1] == by_hand["feet"][0]["point_mm"][1]
    assert "origin_mm" not in part
    assert (tmp_path / "block.step").read_bytes() == block.read_bytes()
    again = loa("housing", output, block, "--material", "cast_aluminum", "--stands-on", "+y", "-o", output)
    assert "in place of the housing housing" in again.output
    (other,) = read_model(SceneInput, output).housings
    assert (other.name, other.feet[0].normal) == ("housing", (0.0, 1.0, 0.0))


def test_without_an_output_it_shows_and_writes_nothing(block, scene, tmp_path):
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    ended = loa("housing", scene, block, "--material", "gray_cast_iron", "--json")
    facts = json.loads(ended.stdout)
    exact = 160.0 * 80.0 * 30.0 - 2.0 * np.pi * 20.0**2 * 30.0
    assert facts["mass_kg"] == pytest.approx(7200.0 * 1e-9 * exact, rel=1e-9)
    assert facts["foot_area_mm2"] == pytest.approx(160.0 * 30.0, rel=1e-9)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_the_scene_of_a_folder_is_written_in_place(block, scene, tmp_path):
    """It keeps comments and other parts, also where the housing is replaced; no other scene appears."""
    folder = InputFile(scene.parent)
    for material in ("gray_cast_iron", "cast_aluminum"):
        before = tomllib.loads(scene.read_text())
        ended = loa("housing", tmp_path, block, "--material", material)
        assert ended.exit_code == 0, ended.output
        after = tomllib.loads(scene.read_text())
        (part,) = after.pop("housings")
        assert (part["material"], part["step_file"]) == (material, "block.step")
        assert after == {name: own for name, own in before.items() if name != "housings"}
        assert scene.read_text().startswith("# of the test bench\n")
        assert file_of(folder, "scene").path == scene
    assert (tmp_path / "block.step").read_bytes() == block.read_bytes()


def test_a_revision_takes_the_place_of_the_file_of_the_folder(block, scene, tmp_path):
    revised = tmp_path / "sent" / "block.step"
    revised.parent.mkdir()
    revised.write_text(block.read_text() + "\n")
    for step in (block, revised):
        ended = loa("housing", tmp_path, step, "--material", "gray_cast_iron")
        assert ended.exit_code == 0, ended.output
        assert (tmp_path / "block.step").read_bytes() == step.read_bytes()
        assert [part["step_file"] for part in tomllib.loads(scene.read_text())["housings"]] == ["block.step"]


@pytest.mark.parametrize(
    ("off", "length", "size"), [(3.0, 24.0, None), (5.0, 20.0, None), (7.0, 16.0, None), (11.0, 8.0, 5.33)]
)
def test_the_housing_that_is_written_is_one_that_is_reduced(block, scene, tmp_path, off, length, size):
    """Of a bearing off the middle of its bore of 30 mm; elements of the wall are up to 10 mm long."""
    table = tomllib.loads(scene.read_text())
    for bushing in table["bushings"]:
        bushing["position_mm"] += off
    scene.write_text(toml_text(table))
    ended = loa("housing", scene, block, "--material", "gray_cast_iron", "-o", tmp_path / "housed.toml")
    assert ended.exit_code == 0, ended.output
    (part,) = tomllib.loads((tmp_path / "housed.toml").read_text())["housings"]
    assert [seat["bore_length_mm"] for seat in part["seats"]] == [length, length]
    assert part.get("element_size_mm") == size
    assert ("as fine as the shortest" in ended.output) == (size is not None)
    reduced = reduced_housings(read_model(SceneInput, tmp_path / "housed.toml"), None)
    assert reduced["housing"].seats[0].position[2] == pytest.approx(1e-3 * (100.0 + off))


def test_a_bearing_at_the_end_of_its_bore_is_refused_by_name(block, scene, tmp_path):
    table = tomllib.loads(scene.read_text())
    table["bushings"][1]["position_mm"] += 13.5
    scene.write_text(toml_text(table))
    ended = loa("housing", scene, block, "--material", "gray_cast_iron", "-o", tmp_path / "housed.toml")
    assert ended.exit_code == 2
    words = " ".join(ended.stderr.split())
    assert 'bearing "output left"' in words and "evenly in at least 7.85 mm of its bore, which is 30" in words
    assert not (tmp_path / "housed.toml").exists()


def test_a_bearing_in_no_bore_is_the_first_line(block, scene, tmp_path):
    table = tomllib.loads(scene.read_text())
    table["bushings"].append(table["bushings"][0] | {"name": "outboard", "position_mm": 150.0})
    scene.write_text(toml_text(table))
    ended = loa("housing", scene, block, "--material", "gray_cast_iron", "--origin-mm", "0,0,0")
    assert ended.output.splitlines()[0].startswith("warning (left_out): left out of the scene: outboard")


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--material", "iron"), "--material"),
        (("--material", "gray_cast_iron", "--stands-on", "down"), "--stands-on"),
        (("--material", "gray_cast_iron", "--origin-mm", "0,0"), "--origin-mm"),
        (("--material", "gray_cast_iron", "--origin-mm", "nan,0,0"), "--origin-mm"),
        (("--material", "gray_cast_iron", "--origin-mm", "0,0,500"), "--origin-mm"),
        (("--material", "gray_cast_iron", "--x-axis", "0,0,0"), "--x-axis"),
        (("--material", "gray_cast_iron", "--x-axis", "1,0,1"), "--x-axis"),
        (("--material", "gray_cast_iron", "-o", "absent/scene.toml"), "output"),
    ],
)
def test_what_is_typed_wrong_is_named(block, scene, options, complaint):
    ended = loa("housing", scene, block, *options)
    assert ended.exit_code == 2
    assert f"error: {complaint}" in ended.output


HOSTILE = {
    "empty": b"",
    "no STEP": b"#!/bin/sh\nexit 0\n",
    "cut off": b"ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('",
    "no solid": b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n",
    "itself": b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=MANIFOLD_SOLID_BREP('',#1);\nENDSEC;\n",
    "zeros": bytes(100_000),
}


@pytest.mark.parametrize("attack", HOSTILE)
def test_a_hostile_file_is_one_error_and_writes_nothing(scene, tmp_path, attack):
    file, output = tmp_path / "in" / "case.step", tmp_path / "out.toml"
    file.parent.mkdir()
    file.write_bytes(HOSTILE[attack])
    ended = loa("housing", scene, file, "--material", "gray_cast_iron", "-o", output)
    assert ended.exit_code in (1, 2), ended.output
    assert ended.output.startswith("error: ")
    assert "Traceback" not in ended.output
    assert not output.exists()


def test_another_step_file_of_the_name_is_not_overwritten(block, scene, tmp_path):
    (tmp_path / "block.step").write_text("of somebody else")
    output = tmp_path / "housed.toml"
    ended = loa("housing", scene, block, "--material", "gray_cast_iron", "-o", output)
    assert ended.exit_code == 2
    assert "free for the STEP file" in ended.output
    assert (tmp_path / "block.step").read_text() == "of somebody else"
    assert not output.exists()
