"""Faults: in the words and units of the reader, by the line of the file, and no more than are of use."""

import json
import math
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from command_line import loa
from pydantic import BaseModel, ValidationError
from repository import EXAMPLES

from bounds import Bound, FieldName, Quantity, SiNote, Text, above, at_least, at_most, below, exactly, from_to
from dynamics.errors import InputError as DynamicsInputError
from dynamics.errors import SolveError as DynamicsSolveError
from fe_contact.errors import InputError, MeshError
from lineofaction.gearbox.convert.errors import translated
from lineofaction.gearbox.input_file import InputFile, Override
from lineofaction.gearbox.problems import BadInput, Fault, JobFailed
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.schemas.fault_lines import line_of_field
from lineofaction.gearbox.schemas.faults import model_in
from lineofaction.gearbox.schemas.gear import GearInput
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from service.schemas.examples import CASE, SCENE

JAM = Text.of("Without backlash: ", FieldName("center_distance"), " = ", Quantity(0.0802, "m"), ".")
TOO_HIGH = InputError("pinion.modification.tip_relief", 2e-3, at_most(1e-3))


def test_advice_names_other_fields_as_its_reader_knows_them():
    error = InputError("center_distance", 0.08, at_least(0.0802, "m"), JAM)
    assert str(error).endswith("Without backlash: center_distance = 0.0802 m.")
    found = translated(error)
    assert isinstance(found, BadInput)
    assert found.faults[0].suggestion == "Without backlash: pair.center_distance_mm = 80.2 mm."


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (
            InputError("pinion.face_width", -0.025, above(0.0), SiNote("In m: 25 mm is 0.025.")),
            "pair.pinion.face_width_mm = -25.0: must be above 0",
        ),
        (InputError("wheel.helix_angle", 0.5236, "0 rad"), "pair.helix_angle_deg = "),
        (
            InputError("pinion.modification.tip_relief_length", 0.05, from_to(0.0, 0.00636)),
            "pair.pinion.tip_relief_length_mm = 50.0: must be from 0 to 6.36",
        ),
        (
            InputError(
                "pinion.material.youngs_modulus",
                0.0,
                above(0.0),
                Text.of("Steel is ", Quantity(2.1e11, "Pa"), "."),
            ),
            "pair.pinion.material.youngs_modulus_gpa = 0.0: must be above 0. Steel is 210 GPa.",
        ),
        (InputError("torques[2]", 1.0, above(2.0)), "load.torque_n_m[2] = 1.0: must be above 2"),
        (InputError("misalignments[1]", 3e-5, "0"), "errors.misalignment_um[1] = 30.0: must be 0"),
        (
            InputError("misalignments", [0.0, 3e-5], "[0.0] for a plane model"),
            "errors.misalignment_um = [0.0, 30.0]: must be [0.0]",
        ),
        (InputError("effects.magic", "on", "known"), "effects.magic = 'on': must be known"),
        (
            DynamicsInputError("bushings[0].radial_stiffness", -1.0, at_least(0.0)),
            "bushings[0].radial_stiffness_n_per_m = -1.0: must be at least 0",
        ),
        (
            DynamicsInputError("gears[1].bore_diameter", 0.09, below(0.08, "m", "the outer diameter")),
            "gears[1].bore_diameter_mm = 90.0: must be below the outer diameter 80 mm",
        ),
        (DynamicsInputError("duration", -1.0, at_least(0.0)), "run.duration_s = -1.0"),
        (
            DynamicsInputError("planets[0].angles[1]", math.pi, below(math.pi / 2.0, "rad")),
            "planets[0].angles_deg[1] = 180.0: must be below 90 deg",
        ),
        (
            InputError("variables (high)", {"pinion.tip_relief": 2e-3}, Text.of("bounds with ", TOO_HIGH)),
            "variables (high) = {'pinion.tip_relief_um': 2000.0}: must be bounds with "
            "pair.pinion.tip_relief_um = 2000.0: must be at most 1000",
        ),
        (
            DynamicsInputError("meshes[0].driven", Quantity(math.pi / 6.0, "rad"), "of the other hand"),
            "meshes[0].driven = '30 deg': must be of the other hand",
        ),
    ],
)
def test_errors_come_back_in_the_users_words_and_units(error, said):
    found = translated(error)
    assert isinstance(found, BadInput)
    assert str(found).startswith(said)


@pytest.mark.parametrize(
    ("bound", "shown"),
    [
        (from_to(0.01, 0.02), "from 10 to 20"),
        (above(0.0), "above 0"),
        (Bound(0.01, 0.02, high_open=True), "from 10 to below 20"),
        (Bound(0.01, 0.02, low_open=True, high_open=True), "above 10 and below 20"),
        (at_least(0.001), "at least 1"),
        (exactly(0.0305), "30.5"),
        (below(0.07, "m", "the root diameter"), "below the root diameter 70 mm"),
        (Text.of("larger: the tips cut ", Quantity(1.2e-5, "m"), " deep"), "larger: the tips cut 12 µm deep"),
        (Text.of("at a place ", from_to(0.0, 0.02, "m")), "at a place from 0 mm to 20 mm"),
        ("smaller: the contact ratio is 0.93, below 1", "smaller: the contact ratio is 0.93, below 1"),
        ("a finite number", "a finite number"),
    ],
)
def test_numbers_of_a_bound_are_converted_by_what_they_are(bound, shown):
    found = translated(InputError("center_distance", 0.08, bound))
    assert isinstance(found, BadInput)
    assert found.faults[0].bound == shown


def test_suggestions_never_explain_si_to_someone_who_does_not_use_it():
    found = translated(InputError("pinion.face_width", -0.025, above(0.0), SiNote("In m: 25 mm is 0.025.")))
    assert found is not None and "In m" not in str(found) and "Face width b, in mm" in str(found)


@pytest.mark.parametrize("error", [MeshError("no mesh"), DynamicsSolveError("no equilibrium")])
def test_failures_are_failures(error):
    assert isinstance(translated(error), JobFailed)


def test_what_the_libraries_do_not_raise_on_purpose_is_not_translated():
    assert translated(ZeroDivisionError("0")) is None


SPUR = EXAMPLES / "palermo_spur_20_20.toml"


def fields(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from fields(inner, f"{path}.{name}".lstrip("."))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for index, inner in enumerate(value):
            yield from fields(inner, f"{path}[{index}]")
    else:
        yield path, path.rpartition(".")[2]


@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.toml")), ids=lambda file: file.stem)
def test_every_field_of_an_example_is_found_in_a_line_that_names_it(file):
    text = file.read_text(encoding="utf-8")
    lines = text.splitlines()
    seen: dict[str, int] = {}
    for path, name in fields(tomllib.loads(text)):
        number = line_of_field(text, path)
        assert number is not None, path
        if name in lines[number - 1]:
            own = lines[number - 1].split("=")[0].strip() == name
            assert not own or number not in seen.values(), path  # a line of its own
            seen[path] = number if own else -1
        else:  # of an inline table, which begins further up
            table = path.removesuffix(f".{name}").rpartition(".")[2].partition("[")[0]
            assert table in lines[number - 1], path
    assert len([number for number in seen.values() if number > 0]) > 0.5 * len(seen)


def test_texts_and_lists_of_several_lines_hide_what_looks_like_a_field():
    text = (
        'a = """\nb = 1\n[c]\n"""\nd = [\n  1,\n  2, # ]\n]\n"e f" = 3\n'
        "[c]\nb = 4\n[[g.h]]\nx = 1\n[[g.h]]\nx = 2\n"
    )
    expected = {"a": 1, "d": 5, "c.b": 11, "g.h[0].x": 13, "g.h[1].x": 15, "c.missing": 10, "b": None}
    # names in quotes may end like an index or a path
    expected |= {"c.x]": 10, "c.x[": 10, "c.x.": 10, "c.x\n": 10, "c.[0]": 10, "]": None}
    assert {path: line_of_field(text, path) for path in expected} == expected


def changed(tmp_path: Path, old: str, new: str) -> Path:
    text = SPUR.read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "case.toml"
    file.write_text(text.replace(old, new), encoding="utf-8")
    return file


def errors(*arguments: object) -> list[str]:
    done = loa(*arguments)
    assert done.exit_code == 2
    return done.stderr.strip().splitlines()


def test_a_value_out_of_bounds_a_wrong_name_and_an_impossible_gear_name_their_line(tmp_path):
    wrong = changed(tmp_path, "[pair.wheel]\nteeth = 20", "[pair.wheel]\nteeth = 3")
    (line,) = errors("plan", wrong)
    assert line.startswith("error: pair.wheel.teeth = 3: must be")
    assert line.endswith(f" ({wrong}:16)")
    misspelled = changed(tmp_path, "poissons_ratio", "poisons_ratio")
    (line,) = errors("plan", misspelled)
    assert line.endswith(f"Did you mean poissons_ratio? ({misspelled}:22)")
    impossible = changed(
        tmp_path, "bore_diameter_mm = 40.0\n\n[pair.wheel]", "bore_diameter_mm = 75.0\n[pair.wheel]"
    )
    for verb in ("plan", "geometry", "flank"):
        (line,) = errors(verb, impossible)
        assert line.startswith("error: pair.pinion.bore_diameter_mm = 75.0"), verb
        assert line.endswith(f" ({impossible}:13)"), verb


def suggestion(model: type[BoundaryModel], table: dict[str, Any], *path: str | int) -> str:
    """Return the suggestion on an unknown field of a valid table; `path` leads to the field."""
    spoiled = json.loads(json.dumps(table))  # in which no two gears are one object
    place = spoiled
    for part in path[:-1]:
        place = place[part]
    place[path[-1]] = 1.0
    with pytest.raises(BadInput) as error:
        validated(model, spoiled)
    (fault,) = error.value.faults
    assert fault.bound == "left out: there is no such field here"
    return fault.suggestion


@pytest.mark.parametrize(
    ("path", "said"),
    [
        (("pair", "pinion", "helix_angle_deg"), "helix_angle_deg is a field of [pair]."),
        (("load", "teeth"), "teeth is a field of [pair.pinion] and [pair.wheel]."),
        (("load", "pair"), "pair is a field of the top level, outside of all tables."),
        (("pair", "pinion", "tip_releif_um"), "Did you mean tip_relief_um?"),
        (("load", "xyzzy"), "Known here: torque_n_m, normal_force_n."),
    ],
)
def test_an_unknown_field_of_a_case_is_said_to_be_where_it_is_known(path, said):
    assert suggestion(Case, CASE, *path) == said


@pytest.mark.parametrize(
    ("path", "said"),
    [
        (("shafts", 0, "driver"), "driver is a field of [[meshes]]."),
        (("meshes", 0, "case", "pair", "wheel", "helix_angle_deg"), "... of [meshes.case.pair]."),
        (("outputs", "shaft"), "Known here: sample_rate_hz, "),  # too many tables have a shaft
    ],
)
def test_an_unknown_field_of_a_scene_is_said_to_be_where_it_is_known(path, said):
    assert said.removeprefix("...") in suggestion(SceneInput, SCENE, *path)


def test_of_many_fields_the_nearest_are_listed_and_where_all_are():
    text = suggestion(Case, CASE, "pair", "pinion", "number_of_teeth")
    nearest = re.fullmatch(r"Nearest of \d+ here: (.*)\. All are in docs/case-file\.md\.", text)
    assert nearest and len(names := nearest[1].split(", ")) == 12
    assert "teeth" in names and set(names) < set(GearInput.model_fields)


def tables(model: type[BaseModel]) -> Iterator[type[BaseModel]]:
    yield model
    for info in model.model_fields.values():
        if (inner := model_in(info.annotation)) is not None:
            yield from tables(inner)


def test_the_manual_that_a_table_names_has_all_its_fields():
    wide = {
        table
        for model in (Case, SceneInput, *(study.inputs for study in STUDIES.values()))
        for table in tables(model)
        if len(table.model_fields) > 12
    }
    for table in wide:
        manual = (EXAMPLES.parent / table.MANUAL).read_text(encoding="utf-8")
        missing = [name for name in table.model_fields if not re.search(rf"\b{name}\b", manual)]
        assert not missing, table
    assert len(wide) > 8


def test_a_line_that_is_no_toml_is_shown_with_what_is_expected(tmp_path):
    (line,) = errors("plan", changed(tmp_path, 'level = "standard"', "level = standard"))
    assert "= 'level = standard': must be well-formed TOML, which line 29 is not" in line
    assert "a text in quotes" in line


def test_a_value_that_was_set_is_in_no_line():
    with pytest.raises(BadInput) as error:
        read_model(Case, InputFile(SPUR, (Override("pair.pinion.teeth", 2.5),)))
    assert [fault.location for fault in error.value.faults] == [""]


def test_json_over_http_stays_as_it_was(tmp_path):
    with pytest.raises(BadInput) as error:
        read_model(Case, changed(tmp_path, "teeth = 20", "teeth = 2.5"))
    assert set(error.value.faults[0].as_json()) == {"field", "value", "bound", "suggestion"}


MANY = 100_000
SPOILED: dict[str, tuple[type[BoundaryModel], dict[str, Any]]] = {
    "unknown fields": (Case, CASE | {f"field{number}": 0 for number in range(MANY)}),
    "texts for numbers": (Case, CASE | {"load": {"torque_n_m": ["a"] * MANY}}),
    "texts for rows": (Case, {"pair": {"pinion": {"flank_grid": {"removed_um": [["a"] * 500] * MANY}}}}),
    "tables without fields": (SceneInput, SCENE | {"shafts": [{}] * MANY}),
    "texts for tables": (SceneInput, SCENE | {"shafts": [""] * MANY}),
    "names of effects": (SceneInput, SCENE | {"effects": {f"effect{number}": 0 for number in range(MANY)}}),
}


@pytest.mark.parametrize("kind", SPOILED)
def test_a_search_ends_while_it_finds(kind):
    model, data = SPOILED[kind]
    with pytest.raises(ValidationError) as caught:
        model.model_validate(data)
    assert 1 <= caught.value.error_count() <= 100


def test_each_of_some_tables_is_told_its_faults():
    shafts = [{"name": 1, "length": 2.0}] * 12
    with pytest.raises(BadInput) as caught:
        validated(SceneInput, SCENE | {"shafts": shafts})
    fields = {fault.field for fault in caught.value.faults}
    assert {f"shafts[{number}].{field}" for number in range(12) for field in ("name", "length")} <= fields


def test_a_list_that_is_too_long_is_told_its_length_though_its_tables_are_wrong():
    with pytest.raises(BadInput) as caught:
        validated(SceneInput, SCENE | {"shafts": [{}] * 1001})
    (fault,) = caught.value.faults
    assert (fault.field, fault.bound) == ("shafts", "a list of at most 1000")


@pytest.mark.parametrize(
    "value", [[], {}, [1, "a", [None, {}]], {"a": {"b": [1.5, True]}, 2: "c"}, [[[]]], "text", None, (1,)]
)
def test_a_short_value_is_shown_as_it_is(value):
    shown = str(Fault("field", value, "another"))
    assert shown == f"field = {'nothing' if value is None else repr(value)}: must be another"


def test_of_a_long_value_the_beginning_is_shown():
    value = {"numbers": list(range(1000)), "texts": ["a" * 1000]}
    assert f"field = {repr(value)[:200]}...: must" in str(Fault("field", value, "another"))


def test_a_name_as_long_as_a_body_is_not_told_whole():
    with pytest.raises(BadInput) as caught:
        validated(Case, CASE | {"x" * 1_000_000: 1})
    assert len(str(caught.value)) < 1000


def test_what_is_bounded_once_is_not_bounded_again():
    """The description of the API was too deep to be written: each use of a model had wrapped it once more."""

    class Part(BoundaryModel):
        names: tuple[str, ...]

    class Whole(BoundaryModel):
        first: Part
        others: tuple[Part, ...]

    class Uses(BoundaryModel):
        whole: Whole

    def bounds(node):
        """Return the most functions that see the data of one schema in turn."""
        if not isinstance(node, dict) or node.get("type") != "function-before":
            return 0
        return 1 + bounds(node["schema"])

    schemas: list[Any] = [Uses.__pydantic_core_schema__]
    deepest = 0
    while schemas:
        node = schemas.pop()
        if isinstance(node, dict):
            deepest = max(deepest, bounds(node))
            schemas += node.values()
        elif isinstance(node, list | tuple):
            schemas += node
    assert deepest == 1
