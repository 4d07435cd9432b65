"""REXS files: every form gives the model back, upgrades rename and keep; the same bytes at every time."""

from dataclasses import replace

import pytest
from small_rexs import small_document, small_model

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import parsed, read_rexs, serialized
from lineofaction.gearbox.rexs.model import Attribute, Component, Document, LoadCase, LoadSpectrum, Model
from lineofaction.gearbox.rexs.upgrade import NEWEST, VERSIONS, Change, upgrade

FORMS = ("a.rexs", "a.rexsj", "a.rexsz", "a.rexs.zip")
FORMS_IN_TURN = ("a.rexs", "a.rexsj", "a.rexsz", "a.rexs")


@pytest.mark.parametrize("name", FORMS)
def test_every_form_gives_the_model_back(name):
    model = small_model()
    assert parsed(serialized(Document(model), name)).model == model


@pytest.mark.parametrize("name", FORMS)
def test_the_same_model_is_the_same_bytes(name):
    assert serialized(Document(small_model()), name) == serialized(Document(small_model()), name)


def test_the_forms_in_turn_give_the_model_back():
    document = Document(small_model())
    for name in FORMS_IN_TURN:
        document = parsed(serialized(document, name))
    assert document == Document(small_model())


def test_the_form_is_known_by_the_content_not_the_name(tmp_path):
    path = tmp_path / "model.txt"
    for name in FORMS:
        path.write_bytes(b"" if name.endswith(("z", "p")) else b"\xef\xbb\xbf")
        with path.open("ab") as stream:
            stream.write(serialized(Document(small_model()), name))
        assert read_rexs(path).model == small_model()


def test_an_archive_keeps_the_files_beside_the_model():
    document = small_document()
    assert parsed(serialized(document, "a.rexsz")) == document
    with pytest.raises(BadInput, match="archive"):
        serialized(document, "a.rexs")


def test_json_holds_one_spectrum():
    model = small_model()
    two = replace(model, spectra=(*model.spectra, replace(model.spectra[0], id=2)))
    assert parsed(serialized(Document(two), "a.rexs")).model == two
    with pytest.raises(BadInput, match="2 spectra"):
        serialized(Document(two), "a.rexsj")


def test_a_load_case_of_json_has_the_types_of_the_components():
    text = serialized(Document(small_model()), "a.rexsj").decode()
    head, mark, cases = text.partition('"load_spectrum"')
    shorter = head + mark + cases.replace('"type": "shaft",', "", 1)
    assert shorter != text
    assert parsed(shorter.encode()).model == small_model()


def model_of(version: str, *components: Component) -> Model:
    return Model(version, "a", "1", "d", components=components)


def upgraded(version: str, kind: str, attribute: Attribute, to: str) -> tuple[Attribute, tuple[Change, ...]]:
    model, changes = upgrade(model_of(version, Component(1, kind, (attribute,))), to)
    return model.components[0].attributes[0], changes


CATALOGUE = "rolling_bearing_with_catalog_geometry"
BEARING = (
    Attribute("name", "string", "6205"),
    Attribute("dynamic_capacity", "floating_point", 14.8, "kN"),
    Attribute("clearance_class", "enum", "C3"),
    Attribute("lever_arm_of_axial_force", "floating_point", 1.0, "mm"),
)
STEEL = (
    Attribute("name", "string", "steel"),
    Attribute("elastic_modulus", "floating_point", 2.06e5, "N / mm^2"),
)
FLANK = (Attribute("normal_pressure_angle", "floating_point", 20.0, "°"),)
OLD = (
    Component(1, CATALOGUE, BEARING),
    Component(2, "material", STEEL),
    Component(3, "flank_geometry", FLANK),
)


def test_names_and_spellings_follow_the_changelogs():
    model, _ = upgrade(model_of("1.0", *OLD))
    assert model.version == NEWEST
    bearing, material, _ = model.components
    assert [attribute.id for attribute in bearing.attributes] == [
        "catalogue_designation",
        "radial_dynamic_load_rating",
        "radial_clearance_class",
        "lever_arm_of_axial_force",
    ]
    assert material.attributes[0].id == "name"
    assert (material.attributes[1].unit, material.attributes[1].value) == ("MPa", 2.06e5)


def test_what_is_gone_is_kept_and_said():
    model, changes = upgrade(model_of("1.0", *OLD))
    flank, angle = model.components[2], model.components[2].attributes[0]
    assert (flank.type, angle.id, angle.value, angle.unit) == (
        "flank_geometry",
        "normal_pressure_angle",
        20.0,
        "deg",
    )
    kept = {(change.version, change.location, change.item) for change in changes if change.unchanged}
    assert ("1.1", "component 1", "lever_arm_of_axial_force") in kept
    assert ("1.3", "component 3", "flank_geometry") in kept


@pytest.mark.parametrize("start", VERSIONS)
def test_in_steps_is_as_at_once_and_again_changes_nothing(start):
    model = model_of(start, *OLD, *small_model().components)
    whole, changes = upgrade(model)
    stepped, collected = model, ()
    for version in VERSIONS:
        stepped, some = upgrade(stepped, version)
        collected += some
    assert (stepped, collected) == (whole, changes)
    assert upgrade(whole) == (whole, ())


def test_components_of_load_cases_are_upgraded_too():
    part = Component(1, CATALOGUE, (Attribute("radial_backlash", "floating_point", 1.0, "mum"),))
    spectrum = LoadSpectrum(1, (LoadCase(1, (part,)),), (part,))
    model, changes = upgrade(Model("1.0", "a", "1", "d", spectra=(spectrum,)), "1.1")
    assert model.spectra[0].cases[0].components[0].attributes[0].id == "operating_radial_bearing_clearance"
    assert [change.location for change in changes] == [
        "load spectrum 1, load case 1, component 1",
        "load spectrum 1, accumulation, component 1",
    ]


def test_a_value_of_an_enum_is_renamed():
    kept = Attribute("basis", "enum", "food-grade")
    attribute, changes = upgraded("1.7", "lubricant", kept, NEWEST)
    assert attribute.value == "food_grade"
    assert not changes[0].unchanged


def test_a_unit_of_another_quantity_is_kept_and_said():
    width = Attribute("load_distribution_along_face_width", "floating_point_array", (1.0,), "N")
    attribute, changes = upgraded("1.3", "cylindrical_stage", width, "1.4")
    assert attribute == width
    assert changes[0].unchanged and "N / mm" in changes[0].text


def test_a_single_entry_becomes_a_value_and_several_are_kept():
    name, old = "diameter_where_profile_slope_amount_is_specified", "floating_point_array"
    one, _ = upgraded("1.7", "profile_slope", Attribute(name, old, (50.0,), "mm", "float64"), NEWEST)
    assert (one.kind, one.value, one.code) == ("floating_point", 50.0, None)
    two, changes = upgraded("1.7", "profile_slope", Attribute(name, old, (50.0, 60.0), "mm"), NEWEST)
    assert two.value == (50.0, 60.0) and changes[0].unchanged


def test_a_name_that_is_taken_is_not_given_twice():
    both = (
        Attribute("dynamic_capacity", "floating_point", 1.0, "kN"),
        Attribute("radial_dynamic_load_rating", "floating_point", 2.0, "kN"),
    )
    model, changes = upgrade(model_of("1.0", Component(1, CATALOGUE, both)), "1.1")
    assert model.components[0].attributes == both
    assert changes[0].unchanged


def test_2_0_is_2_0_0_and_others_are_refused():
    assert upgrade(model_of("2.0", *OLD)) == (model_of("2.0", *OLD), ())
    with pytest.raises(BadInput, match=r"1\.0, 1\.1"):
        upgrade(model_of("2.1", *OLD))
