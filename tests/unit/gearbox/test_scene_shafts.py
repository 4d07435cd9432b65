"""Shafts of a scene file, torques at their places, and meshes in closed form; what does not fit."""

import math
import tomllib
from dataclasses import replace
from typing import Any

import pytest
from changed_scenes import DROP, By, assert_refused, changed, changed_scene, check_refused
from repository import ROOT
from small_table import small_table

from dynamics import Inertia, Scene, hollow_cylinder
from dynamics.assembly.assemble import assemble
from fe_contact import STEEL
from lineofaction.gearbox.convert.scene import check_scene, dynamic_scene
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.subjects import scene_inputs

EXAMPLE = tomllib.loads((ROOT / "examples" / "flexible_shafts_scene.toml").read_text())
PAPER = tomllib.loads((ROOT / "examples" / "palermo_scene.toml").read_text())


def scene(
    changes: dict[str, Any] | None = None, example: dict[str, Any] = EXAMPLE, table: Any = None
) -> Scene:
    return changed_scene(example, changes or {}, {"mesh": table} if table else {})


def on(found: Scene) -> dict[str, bool]:
    entries = assemble(found).ledger.entries
    return {entry.part: entry.on for entry in entries if entry.effect == "flexible_shafts"}


def test_sections_are_in_si_and_torques_act_at_their_places():
    found = scene()
    sections = found.shafts[0].sections
    assert [s.length for s in sections] == pytest.approx([0.06, 0.065, 0.055])
    assert [s.outer_diameter for s in sections] == pytest.approx([0.032, 0.045, 0.04])
    assert [s.bore_diameter for s in sections] == pytest.approx([0.0, 0.012, 0.0])
    assert {(s.youngs_modulus, s.poissons_ratio, s.density) for s in sections} == {
        (STEEL.youngs_modulus, STEEL.poissons_ratio, STEEL.density)
    }
    assert (found.drives[0].position, found.loads[0].position) == pytest.approx((0.0, 0.26))
    assert on(found) == {"input": True, "output": True}
    middle = "shafts[0].sections[1]"
    soft = scene({f"{middle}.youngs_modulus_gpa": 110.0, f"{middle}.poissons_ratio": 0.2})
    assert soft.shafts[0].sections[1].youngs_modulus == pytest.approx(110e9)


def test_a_section_may_be_a_cone():
    ends = {"end_outer_diameter_mm": 40.0, "end_bore_diameter_mm": 8.0}
    found = scene({f"shafts[0].sections[0].{name}": value for name, value in ends.items()}).shafts[0]
    assert found.sections[0].outer_diameters == pytest.approx((0.032, 0.04))
    assert found.sections[0].bore_diameters == pytest.approx((0.0, 0.008))
    assert found.sections[1].outer_diameters == pytest.approx((0.045, 0.045))


def test_a_diameter_is_one_section_of_steel():
    paper = scene({"effects": DROP}, PAPER)
    (section,) = paper.shafts[0].sections
    assert (section.length, section.outer_diameter) == pytest.approx((0.2, 0.04))
    assert on(paper) == {"input": True, "output": True}
    assert on(scene(example=PAPER)) == {"input": False, "output": False}


def test_gravity_is_zero_unless_stated():
    assert scene().gravity == (0.0, 0.0, 0.0)
    assert scene({"gravity_m_per_s2": [0.0, -9.81, 0.0]}).gravity == (0.0, -9.81, 0.0)


def test_an_inertia_alone_is_a_rigid_shaft():
    own = {"mass_kg": 1.0, "polar_kg_m2": 2.0, "transverse_kg_m2": 3.0}
    found = scene({"shafts[0].sections": DROP, "shafts[0].inertia": own})
    assert found.shafts[0].inertia == Inertia(1.0, 2.0, 3.0)
    assert on(found) == {"input": False, "output": True}


def test_discs_have_an_inertia_or_are_of_steel():
    flywheel = {"name": "flywheel", "shaft": "input", "position_mm": 10.0}
    given = {"mass_kg": 2.0, "polar_kg_m2": 4e-3, "transverse_kg_m2": 2e-3}
    steel = {"outer_diameter_mm": 100.0, "width_mm": 20.0, "bore_diameter_mm": 40.0}
    half = {**flywheel, "name": "half", "cylinder": steel}
    found = scene({"discs": [{**flywheel, "inertia": given}, half]})
    first, second = found.discs
    assert (first.position, first.inertia) == (0.01, Inertia(2.0, 4e-3, 2e-3))
    assert second.inertia == hollow_cylinder(0.1, 0.02, 0.04)
    masses = [assemble(s).rotors[0].inertia.mass for s in (found, scene())]
    assert masses[0] - masses[1] == pytest.approx(2.0 + second.inertia.mass, rel=1e-12)


def disc(**fields: Any) -> By:
    steel = {"outer_diameter_mm": 100.0, "width_mm": 20.0}
    full = {"name": "disc", "shaft": "input", "position_mm": 10.0, "cylinder": steel}
    return By(discs=[{**full, **fields}])


def test_a_table_that_has_the_bending_of_its_shafts_leaves_them_rigid():
    table = small_table()
    ledger = [{"name": "shaft_deflection", "on": True}]
    bent = replace(table.metadata, effect_ledger=ledger)
    found = scene(table=replace(table, metadata=bent))
    assert found.meshes[0].bent_shafts
    assert on(found) == {"input": False, "output": False}
    assert not scene().meshes[0].bent_shafts


CYLINDER = {"outer_diameter_mm": 10.0, "width_mm": 5.0, "bore_diameter_mm": 10.0}
UNIT = {"mass_kg": 1.0, "polar_kg_m2": 1.0, "transverse_kg_m2": 1.0}


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("shafts[0].sections", By({"shafts[0].sections[2]": DROP})),
        ("shafts[0].diameter_mm", 40.0),
        ("shafts[0].sections", []),
        ("shafts[0].sections[0].bore_diameter_mm", 32.0),
        ("shafts[0].sections[0].end_bore_diameter_mm", 33.0),
        ("discs[0].shaft", disc(shaft="none")),
        ("discs[0].position_mm", disc(position_mm=1000.0)),
        ("discs[0].inertia", disc(inertia=UNIT)),
        ("discs[0].cylinder.bore_diameter_mm", disc(cylinder=CYLINDER)),
    ],
)
def test_shafts_that_cannot_be_are_one_fault_by_name(field, value):
    check_refused(EXAMPLE, field, value)


@pytest.mark.law
@pytest.mark.parametrize("kind", ["gears", "bushings", "discs"])
def test_a_part_beyond_an_end_of_its_shaft_is_a_fault_of_the_draft(kind):
    """Before any engine sees it; the ends themselves are on the shaft."""
    length = EXAMPLE["shafts"][0]["length_mm"]

    def placed(position):
        return validated(SceneInput, changed(EXAMPLE, disc() | {f"{kind}[0].position_mm": position}))

    for end in (0.0, length):
        placed(end)
    for beyond in (-0.1, length + 0.1):
        with assert_refused(f"{kind}[0].position_mm", "from 0 to 180 mm from its left end") as faults:
            placed(beyond)
        assert faults[0].value == beyond
        assert faults[0].suggestion == "Lengthen the shaft, or move what sits on it."


OSCILLATOR = tomllib.loads((ROOT / "examples" / "backlash_oscillator_scene.toml").read_text())
SPRING = "meshes[0].stiffness.stiffness_n_per_m"
RING = tomllib.loads((ROOT / "examples" / "lin_parker_planetary_scene.toml").read_text())


def test_gears_and_table_follow_from_the_fields():
    found = changed_scene(OSCILLATOR, {"meshes[0].stiffness.base_helix_angle_deg": 10.0})
    pinion, wheel = found.gears
    assert (pinion.teeth, wheel.teeth, pinion.face_width) == (20, 20, pytest.approx(0.02))
    assert (pinion.base_radius, wheel.base_radius) == pytest.approx((0.05, 0.05))
    assert (pinion.base_helix_angle, wheel.base_helix_angle) == pytest.approx(
        (math.radians(10.0), -math.radians(10.0))
    )
    table = found.meshes[0].table
    assert table.stiffness == pytest.approx(1e8)
    assert table.deflection[0, 0, 0, 0] == pytest.approx(2.487593e-6, rel=1e-6)


def test_a_ring_gear_is_larger_by_the_ratio_of_the_teeth():
    found = dynamic_scene(validated(SceneInput, RING), {})
    sun, planet, ring = found.gears[:3]
    assert (sun.teeth, planet.teeth, ring.teeth) == (27, 36, 99)
    assert (planet.base_radius, ring.base_radius) == pytest.approx((0.0504, 0.1386))
    assert [gear.internal for gear in (sun, planet, ring)] == [False, False, True]
    assert len(found.meshes) == 6


def test_a_service_takes_the_scene_as_it_is():
    given = validated(SceneInput, OSCILLATOR)
    assert scene_inputs(given) == {"scene": given.model_dump(mode="json")}
    assert given.with_database == []
    assert check_scene(given, {}).meshes[0].table.level.size == 2


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("meshes[0].case", By({"meshes[0].stiffness": DROP})),
        ("meshes[0].case", By({"meshes[0].database_hash": "0" * 64})),
        ("shafts[1].origin_mm", By({"meshes[0].stiffness.teeth": [20, 30]})),
        ("meshes[0].stiffness.teeth", By({"meshes[0].stiffness.internal": True})),
        (f"{SPRING}.value", By({SPRING: {"value": [-1.0]}})),
        (f"{SPRING}.amplitude", By({SPRING: {"value": [1e8], "amplitude": [1.0], "position": [0.0, 0.5]}})),
        (f"{SPRING}.position", By({SPRING: {"value": [1e8, 2e8], "position": [0.5, 0.0]}})),
        (f"{SPRING}.value", By({SPRING: {"value": [1e8, 2e8]}})),
        (f"{SPRING}.phase_deg", By({SPRING: {"value": [1e8], "amplitude": [1.0], "phase_deg": [1.0, 2.0]}})),
    ],
)
def test_what_is_no_mesh_is_one_fault_by_name(field, value):
    check_refused(OSCILLATOR, field, value)
