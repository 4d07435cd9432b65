"""``--set`` and its shorthands: a value on the command line does what it does in the file."""

from pathlib import Path
from typing import Any

import pytest
import typer
from command_line import loa, printed
from repository import EXAMPLES

from lineofaction.cli.commands import app
from lineofaction.gearbox.input_file import InputFile, Override
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, read_model, read_table
from lineofaction.gearbox.schemas.scene import SceneInput

SPUR, SCENE = EXAMPLES / "palermo_spur_20_20.toml", EXAMPLES / "palermo_scene.toml"
TAKES_FILES = ("analyze", "geometry", "export", "plan", "simulate", "submit", *STUDIES.keys() - {"listen"})


def read(*settings: str, file: Path = SPUR, model: Any = Case) -> Any:
    return read_model(model, InputFile(file, tuple(Override.of(text) for text in settings)))


def changed(old: str, new: str, tmp_path: Path) -> Case:
    text = SPUR.read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "case.toml"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    return read_model(Case, file)


@pytest.mark.parametrize(
    ("settings", "old", "new"),
    [
        (("pair.normal_module_mm=4.1",), "normal_module_mm = 4.0", "normal_module_mm = 4.1"),
        (("pair.pinion.teeth=21",), "teeth = 20", "teeth = 21"),
        (
            ("load.torque_n_m=[10, 20]",),
            "[10, 20, 35, 50, 75, 100, 130, 165, 200, 260, 330, 400]",
            "[10, 20]",
        ),
        (("load.torque_n_m[1]=15",), "[10, 20,", "[10, 15,"),
        (("accuracy.level=draft",), 'level = "standard"', 'level = "draft"'),
        (("accuracy.level=",), 'level = "standard"', ""),
        (("effects.corner_contact=on",), "[accuracy]", '[effects]\ncorner_contact = "on"\n[accuracy]'),
        (
            ("pair.pinion.tip_relief_um=20", "pair.pinion.tip_relief_length_mm=1.5"),
            "[pair.pinion] # the driving gear",
            "[pair.pinion]\ntip_relief_um = 20\ntip_relief_length_mm = 1.5",
        ),
    ],
)
def test_a_value_that_is_set_is_one_in_the_file(settings, old, new, tmp_path):
    assert read(*settings) == changed(old, new, tmp_path)
    assert read(*settings) != read()


def test_a_later_value_prevails_and_the_file_stays_as_it_is():
    before = SPUR.read_bytes()
    assert read("pair.pinion.teeth=21", "pair.pinion.teeth=22").pair.pinion.teeth == 22
    assert SPUR.read_bytes() == before


def test_parts_of_a_scene_are_named_as_in_a_study():
    table = read_table(SCENE)
    name = table["shafts"][1]["name"]
    one = read(f"shafts.{name}.diameter_mm=45", file=SCENE, model=SceneInput)
    assert [shaft.diameter_mm == 45.0 for shaft in one.shafts] == [False, True]
    every = read("shafts.*.diameter_mm=45", file=SCENE, model=SceneInput)
    assert all(shaft.diameter_mm == 45.0 for shaft in every.shafts)
    entry = read("shafts[1].diameter_mm=45", file=SCENE, model=SceneInput)
    assert entry == one
    bushing = read("bushings.input left.position_mm=5", file=SCENE, model=SceneInput).bushings[0]
    assert (bushing.name, bushing.position_mm) == ("input left", 5.0)


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("pair.pinion.tip_releif_um=20", "Did you mean tip_relief_um?"),
        ("pair.pinon.teeth=20", "Did you mean pinion?"),
        ("pair.pinion.teeth=2.5", "pair.pinion.teeth = 2.5: must be an integer from 4 to 2000"),
        ("accuracy.level=coarse", "one of 'draft', 'standard' or 'fine'"),
        ("load.torque_n_m[12]=20", "an entry of a list: torque_n_m has 12"),
        ("pair.normal_module_mm.x=20", "inside a table, which 4.0 is not"),
        ("teeth", "of the form PATH=VALUE"),
        ("pair..teeth=20", "of the form PATH=VALUE"),
    ],
)
def test_one_error_names_field_bound_and_what_to_try(setting, words):
    done = loa("plan", SPUR, "--set", setting)
    assert done.exit_code == 2
    assert words in done.stderr
    assert done.stderr.count("error:") == 1


def test_a_part_that_is_not_in_the_scene_is_refused_with_those_that_are():
    with pytest.raises(BadInput, match=r'there is no "nope". Known here: '):
        read("shafts.nope.diameter_mm=45", file=SCENE, model=SceneInput)


@pytest.mark.parametrize("value", ["1\nteeth = 5", "[[a]]", "{a = 1", '"open'])
def test_what_is_no_toml_value_is_a_text(value):
    assert Override.of(f"a.b={value}").value == value.strip()


def test_shorthands_take_the_place_of_what_they_exclude():
    def planned(*options):
        return printed("plan", SPUR, *options)

    assert planned("--level", "fine")["choice"]["level"] == "fine"
    by_tolerance = planned("--tolerance", 0.2)
    assert (
        by_tolerance["choice"]
        == planned("--set", "accuracy.tolerance=0.2", "--set", "accuracy.level=")["choice"]
    )
    few = planned("--torque", "50,100")["prediction"]
    assert few == planned("--set", "load.torque_n_m=[50, 100]")["prediction"]
    assert few["cpu_seconds"] < planned()["prediction"]["cpu_seconds"]


def commands() -> dict[str, Any]:
    group = typer.main.get_command(app)
    context = typer.Context(group)
    return {name: group.get_command(context, name) for name in group.list_commands(context)}


def test_every_verb_that_takes_a_case_or_a_scene_has_the_option_once():
    found = commands()
    assert set(TAKES_FILES) <= set(found)
    for name in TAKES_FILES:
        spellings = [option for parameter in found[name].params for option in parameter.opts]
        assert spellings.count("--set") == 1, name
        assert len(spellings) == len(set(spellings)), name


def test_a_file_that_is_no_case_takes_no_values(tmp_path):
    done = loa("export", tmp_path / "ste.nc", "-o", tmp_path / "x.fmu", "--set", "pair.pinion.teeth=21")
    assert done.exit_code == 2
    assert "only a case or a scene file takes values" in done.stderr
