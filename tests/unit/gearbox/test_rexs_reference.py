"""Tables, example files and written files against what REXS publishes, and cases of the examples."""

import json
import math
import re
import time
import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path

import jsonschema_rs
import numpy as np
import pytest
from lxml import etree
from opened_unit import deflection_of_unit
from rexs_reference import (
    SCHEMAS,
    STEPS,
    attributes_of,
    entry_kind,
    examples,
    kinds_to_list,
    names_at,
    needs_reference,
    other_changes,
    owners,
    parsed_schema,
    reference,
    step_of,
)
from rexs_stage import STAGE, stage_unit
from rexs_unit import MOTOR, two_stages
from small_rexs import small_document, small_model
from small_table import small_table

from dynamics.deflection import BearingLoad
from fe_contact.ste import Metadata
from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.from_rexs.gear_unit import BEARINGS, COUPLINGS, GearUnit
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.from_rexs.scene_parts import BearingPart
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.rexs.files import parsed, read_rexs, serialized
from lineofaction.gearbox.rexs.model import Document
from lineofaction.gearbox.rexs.upgrade import upgrade
from lineofaction.gearbox.rexs.values import KINDS, kind_of
from lineofaction.gearbox.rexs.vocabulary import terms, units
from lineofaction.gearbox.schemas.case import PairInput
from lineofaction.gearbox.to_rexs.bearing import bearing_results
from lineofaction.gearbox.to_rexs.deflection import deflected
from lineofaction.gearbox.to_rexs.stage import exported

pytestmark = needs_reference
PACKAGE = Path(__file__).parents[3] / "lineofaction" / "gearbox" / "rexs"
COUNTS = {
    "FVA-Industriegetriebe_2_stufig_1-6.rexs": 49,
    "FVA-Industriegetriebe_2stufig_1-4.rexs": 49,
    "FVA_Planetary_stage_-_Minus_gearing_1.1.rexs": 97,
    "FVA_Planetary_stage_-_Minus_gearing_1.1.rexsj": 97,
    "FVA_Planetary_stage_-_Minus_gearing_1.1.rexsz": 97,
    "SEW_3-stage_cylindrical_gearbox_1.0.rexs": 86,
}
FORMS_IN_TURN = ("a.rexs", "a.rexsj", "a.rexsz", "a.rexs")


@pytest.mark.parametrize(("old", "new"), STEPS)
def test_a_step_says_what_the_changelog_says(old, new):
    stored = tomllib.loads((PACKAGE / "steps" / f"{old}_to_{new}.toml").read_text("utf-8"))
    assert stored == step_of(old, new)
    assert not other_changes(old, new)


@pytest.mark.parametrize("version", SCHEMAS)
def test_the_changelogs_lead_from_the_first_schema_to_each(version):
    listed = parsed_schema(version).iterfind("attributes/attribute")
    assert names_at(version) == {entry.get("numericId"): entry.get("attributeId") for entry in listed}


@pytest.mark.parametrize("version", SCHEMAS)
def test_the_kind_of_every_attribute_follows_from_its_text(version):
    examples_of = {
        "floating_point": ["1.5"],
        "boolean": ["true"],
        "string": ["word"],
        "date_time": ["2024-01-01"],
    }
    wrong = []
    for name, (kind, _, values) in attributes_of(version).items():
        entry = entry_kind(kind)
        texts = values or examples_of.get(
            entry, ["7"] if entry in ("integer", "reference_component") else ["word"]
        )
        wrong += [(name, kind, text) for text in texts if kind_of(name, [text]) != entry]
    known = {
        ("bevel_cone_orientation", "integer"),
        ("cyclic_overloading_type_fkm_2012", "integer"),
    }  # an enum since
    assert {(name, kind) for name, kind, _ in wrong} <= known


def test_the_kinds_are_those_of_the_schemas():
    stored = tomllib.loads((PACKAGE / "kinds.toml").read_text("utf-8"))
    assert {kind: set(names) for kind, names in stored.items()} == kinds_to_list()
    assert set(stored) <= set(KINDS)


def test_the_words_are_those_of_the_schemas():
    types = {
        str(part.get("componentId"))
        for version in SCHEMAS
        for part in parsed_schema(version).iterfind("components/component")
    }
    assert terms("descriptive_components") < types
    assert terms("bearing_types") == set(attributes_of("2.0.0")["bearing_type"][2])


def test_the_units_are_those_of_the_schemas():
    named = {
        unit.get("name") for version in SCHEMAS for unit in parsed_schema(version).iterfind("units/unit")
    }
    assert set(units()) - {""} == named


def test_the_quantities_are_those_of_the_newest_schema():
    known = attributes_of("2.0.0")
    table = tomllib.loads((PACKAGE / "quantities.toml").read_text("utf-8"))
    steps = [tomllib.loads(path.read_text("utf-8")) for path in sorted((PACKAGE / "steps").glob("*.toml"))]
    renamed = {old: new for step in steps for old, new in step["attributes"]["renamed"].items()}
    for unit, names in table.items():
        newest = [name if name in known else renamed[name] for name in names]  # writers use older names, too
        assert {known[name][1] for name in newest} == {unit}
        assert {entry_kind(known[name][0]) for name in newest} <= {"floating_point", "integer"}


def test_every_example_is_tried():
    assert [path.name for path in examples()] == sorted(COUNTS)


@pytest.mark.parametrize("path", examples(), ids=lambda path: path.name)
def test_an_example_is_read_whole_within_a_second(path):
    start = time.process_time()
    document = read_rexs(path)
    upgraded, _ = upgrade(document.model)
    assert time.process_time() - start < 1.0
    assert len(document.model.components) == len(upgraded.components) == COUNTS[path.name]
    assert sum(len(part.attributes) for _, part in document.model.all_components()) == _attributes_in(path)


@pytest.mark.parametrize("path", examples(), ids=lambda path: path.name)
def test_an_example_goes_through_all_forms(path):
    original = document = read_rexs(path)
    for name in FORMS_IN_TURN:
        document = parsed(serialized(document, name))
        assert document == original


@pytest.mark.parametrize("path", examples(), ids=lambda path: path.name)
def test_an_upgraded_example_has_names_of_the_newest_version(path):
    read = read_rexs(path).model
    model, changes = upgrade(read)
    newest, own = set(names_at("2.0.0").values()), set(names_at(read.version).values())
    kept = {(change.location, change.item) for change in changes if change.unchanged}
    gone = {place for place, item in kept for part in model.components if item == part.type}
    left = {
        (place, attribute.id)
        for place, part in model.all_components()
        for attribute in part.attributes
        if attribute.id in own - newest and place not in gone
    }
    assert left <= kept


@pytest.mark.parametrize("path", examples(), ids=lambda path: path.name)
def test_what_is_written_of_an_example_is_valid(path):
    document = read_rexs(path)
    assert_valid(document)
    assert_valid(Document(upgrade(document.model)[0]))


def test_a_stage_with_results_is_valid():
    document = Document(stage_unit().model)
    cases = StageCase.all_of(GearUnit(document.model), {})
    table = replace(small_table(), metadata=Metadata(case=case_json(cases[0].case)))
    written = exported(document, cases, [table])
    assert_valid(written)
    known = attributes_of("2.0.0")
    (stage,) = [part for part in written.model.components if part.id == STAGE]
    results = [entry for entry in stage.attributes if entry.origin and not entry.id.startswith("custom_")]
    assert {(entry.id, entry.kind, entry.unit) for entry in results} == {
        (entry.id, *known[entry.id][:2]) for entry in results
    }
    assert len(results) == 4


def with_load_case() -> Document:
    return two_stages(cases=[{MOTOR: ("external_load", {"torque_around_u_axis": 50.0})}])


@pytest.mark.parametrize("make", [two_stages, with_load_case])
def test_a_deflection_is_valid_and_its_attributes_belong_to_their_components(make):
    document = make()
    unit = OpenedUnit.of(document)
    written = deflected(document, unit, deflection_of_unit(unit))
    assert_valid(written)
    known, owned = attributes_of("2.0.0"), owners("2.0.0")
    names = set()
    for _, part in written.model.all_components():
        for entry in part.attributes:
            if entry.origin == "calculated" and not entry.id.startswith("custom_"):
                assert (entry.kind, entry.unit) == known[entry.id][:2]
                assert part.type in owned[entry.id]
                names.add(entry.id)
    assert len(names) == 25 + 5 + 4  # of bearings, shafts, stages


def test_every_kind_of_bearing_has_the_attributes_of_results():
    load = BearingLoad("", "", 0.0, np.ones(5), 1.0, np.ones(5), np.ones(5), np.ones(5))
    owned = owners("2.0.0")
    for entry in bearing_results(BearingPart(1, np.eye(3), shaft_inside=True), load):
        assert {*BEARINGS, *COUPLINGS} <= owned[entry.id]


def test_what_is_written_of_every_form_is_valid():
    assert_valid(Document(small_model()))
    assert small_document().files


def assert_valid(document: Document) -> None:
    """Validate both forms against the published schemas, as they are but for the three numbers of 2.0.0."""
    schema, rules = _schemas()
    schema.assertValid(etree.fromstring(serialized(document, "a.rexs")))
    two_numbers = re.sub(r"^2\.0\.0$", "2.0", document.model.version)
    text = serialized(Document(replace(document.model, version=two_numbers)), "a.rexsj")
    rules.validate(json.loads(text))


@cache
def _schemas() -> tuple[etree.XMLSchema, jsonschema_rs.Draft7Validator]:
    rules = json.loads(reference("schema/rexs-file.json").read_text("utf-8"))
    schema = etree.XMLSchema(etree.parse(reference("schema/rexs-file.xsd")))
    return schema, jsonschema_rs.Draft7Validator(rules)


def _attributes_in(path: Path) -> int:
    """Return how many attributes a file has, counted without reading it as a model."""
    if path.suffix == ".rexsj":
        return sum(
            len(part["attributes"]) for part in json.loads(path.read_text("utf-8"))["model"]["components"]
        )
    if path.suffix == ".rexsz":
        path = path.with_suffix(".rexs")
    return path.read_bytes().count(b"<attribute ")


INDUSTRIAL = {(27, 51, 21.0): 1, (23, 34, -10.0): 1}
PLANETARY = {(17, 22, 0.0): 3, (22, 61, 0.0): 3}
SEW = {(23, 67, 30.0): 1, (13, 76, -10.0): 1, (14, 87, 10.0): 1}
STAGES = {"FVA-I": INDUSTRIAL, "FVA_P": PLANETARY, "SEW_3": SEW}
"""Teeth and helix angle of the driver, and the number of stages that are alike, by the name of the file."""
EXAMPLES = pytest.mark.parametrize("path", examples(), ids=lambda path: path.name)


@cache
def unit_of(path: object) -> tuple[GearUnit, tuple[StageCase, ...]]:
    unit = GearUnit(upgrade(read_rexs(path).model)[0])
    return unit, StageCase.all_of(unit, {})


@EXAMPLES
def test_every_stage_has_its_case(path):
    _, cases = unit_of(path)
    found = {
        (pair.pinion.teeth, pair.wheel.teeth, pair.helix_angle_deg): 1 + len(case.equal)
        for case in cases
        for pair in [case.case.pair]
    }
    assert found == STAGES[path.name[:5]]
    assert len({case.name for case in cases}) == len(cases)


@EXAMPLES
def test_shifts_and_center_distances_of_a_file_agree(path):
    # A shift of the wrong sign or a wrong mate would open or jam the flanks by some tenths of a module.
    for stage in unit_of(path)[1]:
        pair = gear_pair(stage.case)
        assert abs(pair.transverse_base_backlash) <= 2e-4 * pair.pinion.normal_module


@EXAMPLES
def test_the_contact_ratio_is_the_textbooks(path):
    for stage in unit_of(path)[1]:
        ratio = gear_pair(stage.case).transverse_contact_ratio
        assert ratio == pytest.approx(contact_ratio(stage.case.pair), rel=1e-9)
        assert 1.1 < ratio < 2.0


def contact_ratio(pair: PairInput) -> float:
    """Return epsilon_alpha by tip diameters and center distance (ISO 21771-1)."""
    sign = -1.0 if pair.wheel.internal else 1.0
    cosine = math.cos(math.radians(pair.helix_angle_deg))
    pressure = math.atan(math.tan(math.radians(pair.normal_pressure_angle_deg)) / cosine)
    module = pair.normal_module_mm / cosine
    gears = ((pair.pinion.teeth, pair.pinion.tip_diameter_mm), (pair.wheel.teeth, pair.wheel.tip_diameter_mm))
    bases = [0.5 * teeth * module * math.cos(pressure) for teeth, _ in gears]
    rolls = [
        math.sqrt((0.5 * (tip or 0.0)) ** 2 - base**2) for (_, tip), base in zip(gears, bases, strict=True)
    ]
    working = math.acos(abs(bases[0] + sign * bases[1]) / pair.center_distance_mm)
    length = rolls[0] + sign * rolls[1] - sign * pair.center_distance_mm * math.sin(working)
    return length / (math.pi * module * math.cos(pressure))


@EXAMPLES
def test_each_gear_stage_and_flank_is_used(path):
    unit, _ = unit_of(path)
    kinds = ("cylindrical_gear", "ring_gear", "cylindrical_stage", "cylindrical_gear_flank", "flank_geometry")
    fates = [line.fate for line in unit.account.lines() if line.kind in kinds and not line.item]
    assert set(fates) <= {"taken", "derived"}
