"""Effects are named once; what is neglected or off is said wherever there is a place for it."""

import ast
import inspect
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_gear, with_mesh
from repository import ROOT

from dynamics import CoastFlank, Scene, TimeLaw, simulate
from dynamics.assembly import assemble
from dynamics.effects import EFFECTS as OF_DYNAMICS
from dynamics.influence import decide_effects, estimate_influences
from fe_contact import FlankModification, Gear, GearPair, PitchDeviation, Shaft, SteDatabase, analyze
from fe_contact.analysis.request import request
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS as OF_CONTACT
from fe_contact.types import Json

PRODUCT = ("dynamics", "fe_contact", "model_studies", "lineofaction", "service")
EXAMPLES = (
    "lineofaction/hardcases/",
    "service/page/example_cases.py",
    "service/schemas/answer_examples.py",
    "service/schemas/examples.py",
)
WORDS = {"axial", "backlash", "friction", "lateral", "misalignment", "tilt"}
"""Effects whose names are directions or quantities too: refused where an effect is chosen or looked up."""
REMAINS = {
    ("dynamics/simulation/documents.py", "flexible_shafts"): "heading of the case that a result echoes",
    ("fe_contact/planning/discretization.py", "finite_width"): "key of the hash by which tables are stored",
    ("fe_contact/ste/curve_errors.py", "finite_width"): "source of an error in stored tables",
    ("lineofaction/gearbox/convert/scene.py", "shaft_deflection"): "the ledger of a stored table",
}
CHOSEN_BY = ("choices", "decision", "effect", "effects", "ledger", "neglected", "turned_on")


def files_of(effects: Sequence[object]) -> set[Path]:
    return {Path(inspect.getfile(type(effect))).resolve() for effect in effects}


def parents(tree: ast.AST) -> dict[ast.AST, ast.AST]:
    return {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}


def chooses(node: ast.Constant, above: dict[ast.AST, ast.AST]) -> bool:
    """Whether a word stands where an effect is chosen: looked up in choices or a ledger, or compared."""
    parent = above[node]
    if isinstance(parent, ast.Call) and isinstance(parent.func, ast.Attribute):
        return ast.unparse(parent.func.value).split(".")[-1] in CHOSEN_BY
    if isinstance(parent, ast.Subscript):
        return ast.unparse(parent.value).split(".")[-1] in CHOSEN_BY
    if isinstance(parent, ast.Compare):
        return ast.unparse(parent.left).split(".")[-1] in CHOSEN_BY
    holder = above.get(parent)
    if isinstance(parent, ast.Dict) and isinstance(holder, ast.keyword):
        return holder.arg in CHOSEN_BY
    if isinstance(parent, ast.Dict) and isinstance(holder, ast.Assign):
        return ast.unparse(holder.targets[0]) in CHOSEN_BY
    return False


def excused(node: ast.AST, above: dict[ast.AST, ast.AST]) -> bool:
    """Whether a name is an example, in a list of exports, or what an effect is asked for by."""
    while node in above:
        node = above[node]
        if isinstance(node, ast.keyword) and node.arg == "examples":
            return True
        if isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] == "named":
            return True
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return True
    return False


def named_in(source: str, names: set[str], classes: set[str]) -> Iterator[tuple[int, str]]:
    if not re.search(rf"""["']({"|".join(names)})["']|\b({"|".join(classes)})\b""", source):
        return  # parsing takes a hundred times as long
    tree = ast.parse(source)
    above = parents(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and "effects" in (node.module or "").split("."):
            yield from ((node.lineno, alias.name) for alias in node.names if alias.name in classes)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in names:
            choosing = node.value not in WORDS or chooses(node, above)
            if choosing and not excused(node, above):
                yield node.lineno, node.value


def all_named() -> list[tuple[str, int, str]]:
    """Return every place in the product where an effect is named outside its file and the registry."""
    effects = (*OF_DYNAMICS, *OF_CONTACT)
    names, classes = {effect.name for effect in effects}, {type(effect).__name__ for effect in effects}
    own = files_of(effects) | {ROOT / package / "effects/registry.py" for package in PRODUCT}
    places = []
    for package in PRODUCT:
        for file in sorted((ROOT / package).rglob("*.py")):
            path = file.relative_to(ROOT).as_posix()
            if file.resolve() not in own and not path.startswith(EXAMPLES):
                places += [(path, *place) for place in named_in(file.read_text(), names, classes)]
    return places


@pytest.mark.law
def test_no_effect_is_named_outside_its_file_and_the_registry():
    places = all_named()
    assert [place for place in places if (place[0], place[2]) not in REMAINS] == []
    assert {(path, name) for path, _, name in places} == set(REMAINS)


@pytest.mark.parametrize(
    "line",
    [
        'if scene.effects.get("axial") == "off": pass',
        'ledger.on("backlash", mesh)',
        'found = [entry for entry in entries if entry.effect == "friction"]',
        'run(effects={"tilt": "on"})',
        'names = ["gyroscopic"]',
        "from dynamics.effects.gyroscopic import Gyroscopic",
    ],
)
def test_each_way_to_name_an_effect_is_seen(line):
    names = {effect.name for effect in OF_DYNAMICS}
    assert list(named_in(line, names, {"Gyroscopic"}))


def test_what_effects_of_the_contact_bring_is_brought_once():
    brought = [effect.brings for effect in OF_CONTACT if effect.brings]
    assert len(set(brought)) == len(brought)
    switches = {"across_face", "corner_contact", "finite_width"}
    assert switches <= set(brought) & set(vars(ContactModel()))


def test_what_effects_of_dynamics_add_is_added_once():
    added = [addition for effect in OF_DYNAMICS for addition in effect.adds]
    assert len(set(added)) == len(added)


GEAR = Gear(teeth=20, normal_module=4e-3, face_width=20e-3, bore_diameter=40e-3)
MODIFIED = FlankModification(
    tip_relief=5e-6, tip_relief_length=1e-3, helix_crowning=5e-6, tip_rounding=0.1e-3
)
ERRING = PitchDeviation((4e-6, *([0.0] * 19)))
SHAFT = Shaft(length=0.2, diameter=0.04, position=0.06)
ALL_OVER_THE_FACE = GearPair(
    replace(GEAR, modification=MODIFIED, pitch_deviation=ERRING), GEAR, shafts=(SHAFT, None)
)
IN_THE_PLANE = GearPair(replace(GEAR, modification=MODIFIED.along_profile), GEAR)
SCENES: dict[str, tuple[GearPair, Json]] = {
    "plane": (IN_THE_PLANE, {}),
    "face": (ALL_OVER_THE_FACE, {"misalignments": [20e-6], "pitches": 2}),
}


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def table(scene: str, cache: Path, effects: dict[str, str]) -> SteDatabase:
    pair, asked = SCENES[scene]
    asked = {"normal_forces": [1000.0, 3000.0], "level": "draft", "positions": 8} | asked
    return analyze(pair, **asked, effects=effects, receipt="minimal", cache=cache, on_violation="report")


def arrays(found: SteDatabase) -> Iterator[tuple[str, np.ndarray]]:
    for name, values in vars(found).items():
        if isinstance(values, np.ndarray):
            yield name, values


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("scene", list(SCENES))
@pytest.mark.parametrize("name", [effect.name for effect in OF_CONTACT])
def test_a_table_with_an_effect_off_is_that_of_a_build_without_it(scene, name, cache, monkeypatch):
    if scene == "face" and name == "face_load_distribution":
        pytest.skip("no plane holds what acts across the face")
    off = table(scene, cache, {name: "off"})
    remaining = tuple(effect for effect in OF_CONTACT if effect.name != name)
    monkeypatch.setattr(request, "EFFECTS", remaining)
    without = table(scene, cache, {})
    assert name not in {entry["name"] for entry in without.metadata.effect_ledger}
    compared = 0
    for field, values in arrays(without):
        np.testing.assert_array_equal(getattr(off, field), values, err_msg=field)
        compared += values.size
    assert compared > 100


def test_the_registry_goes_with_the_request():
    """A module that reads the registry by itself would escape the test above."""
    folder = Path(request.__file__).parent
    reading = {file.stem for file in folder.rglob("*.py") if "EFFECTS" in file.read_text()}
    assert reading - {"ablation", "condensed_lookup", "sensitivity"} == {"request"}  # those read names


RPM = np.pi / 30.0
SERIES = ("dynamic_transmission_error", "mesh_force", "coast_force", "bearing_force", "drive_torque")


def everything() -> Scene:
    """A helical pair at speed with a coast flank: lateral, axial, tilting, spinning, parting."""
    scene = gear_pair_scene(
        spring_table(4e8, 20e-6), speed=TimeLaw.constant(30000.0 * RPM), torque=5.0, duration=0.004
    )
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.3), 1, base_helix_angle=-0.3)
    bushings = tuple(replace(bushing, axial_stiffness=1e8) for bushing in scene.bushings)
    scene = replace(scene, bushings=bushings, on_violation="report")
    return with_mesh(scene, coast=CoastFlank(backlash=10e-6, thickness=0.48))


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("name", [effect.name for effect in OF_DYNAMICS])
def test_a_run_with_an_effect_off_is_that_of_a_build_without_it(name, monkeypatch):
    scene = everything()
    off = simulate(replace(scene, effects={name: "off"}))
    remaining = tuple(effect for effect in OF_DYNAMICS if effect.name != name)
    monkeypatch.setattr(assemble, "EFFECTS", remaining)
    without = simulate(scene)
    assert name not in {entry["effect"] for entry in without.effect_ledger["entries"]}
    assert off.freedom == without.freedom
    for series in (
        "dynamic_transmission_error",
        "mesh_force",
        "coast_force",
        "bearing_force",
        "drive_torque",
    ):
        np.testing.assert_array_equal(getattr(off, series), getattr(without, series), err_msg=series)
    assert off.statistics == without.statistics


def test_a_run_with_an_effect_neglected_for_a_tolerance_is_that_of_a_build_without_it(monkeypatch):
    whole = everything()
    scene = replace(whole, drives=(replace(whole.drives[0], speed=TimeLaw.constant(40.0 * RPM)),))
    decision = decide_effects(replace(scene, tolerance=0.05))
    assert "gyroscopic" in estimate_influences(scene)
    off = simulate(replace(scene, tolerance=0.05))
    left = {entry["effect"] for entry in off.effect_ledger["entries"] if not entry["on"]}
    assert set(decision.neglected) <= left
    assert "gyroscopic" in left
    remaining = tuple(effect for effect in OF_DYNAMICS if effect.name not in left)
    monkeypatch.setattr(assemble, "EFFECTS", remaining)
    without = simulate(scene)
    for series in SERIES:
        np.testing.assert_array_equal(getattr(off, series), getattr(without, series), err_msg=series)
    assert off.statistics == without.statistics


def test_the_scene_has_most_effects_on():
    entries = simulate(everything()).effect_ledger["entries"]
    on = {entry["effect"] for entry in entries if entry["on"]}
    assert on >= {"lateral", "axial", "tilt", "gyroscopic", "backlash"}
