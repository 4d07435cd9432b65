"""Every bound of every number of cases and scenes, at every entry point: field, value, a bound that holds."""

import copy
import json
import math
import warnings
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any

import pytest
from bad_scenes import good_scene
from bound_walk import HIGH, LONGEST_CHAIN, LOW, Trial, chains, dotted, is_field, next_typed
from changed_scenes import DROP, changed
from toml_text import toml_text

from bounds import Kind, RefusedValue
from dynamics.bearings import Bushing
from dynamics.forces import RollingContact
from dynamics.joints import Coupling
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.meshes.stiffness_table import straight_table
from dynamics.scene import Integration, Outputs
from dynamics.shafts import BeamSection, GearBody, Inertia, hollow_cylinder
from dynamics.shafts import Shaft as TurningShaft
from fe_contact.flank.drawing_starts import DrawingStarts
from fe_contact.geometry import BoreSeat, FlankModification, Gear, GearBlank, GearPair, Key, RingGear, Shaft
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.checked_case import check_case
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.problems import BadInput, Fault
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.declared import figures
from lineofaction.gearbox.schemas.scene import SceneInput
from service.schemas.examples import SCENE

Table = dict[str, Any]
GEAR: Table = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0}
BODY: Table = {
    "shaft": {"length_mm": 200.0, "diameter_mm": 40.0, "position_mm": 60.0},
    "blank": {"rim_thickness_mm": 8.0, "web_thickness_mm": 10.0, "hub_diameter_mm": 45.0},
    "seat": {"tangential_foundation_n_per_mm3": 1e4, "width_mm": 20.0, "key": {"width_mm": 12.0}},
    "material": {},
}
FLANK: Table = {
    "tip_relief_um": 20.0,
    "tip_relief_length_mm": 1.0,
    "root_relief_um": 10.0,
    "root_relief_length_mm": 1.0,
    "end_relief_um": 5.0,
    "end_relief_length_mm": 2.0,
    "pitch_deviation_um": [0.0, 3.0, *[0.0] * 18],
    "flank_grid": {
        "roll_length_mm": [4.0, 20.0],
        "face_position_mm": [-12.5, 12.5],
        "removed_um": [[0.0, 0.0], [5.0, 7.0]],
    },
}
EXTERNAL: Table = {
    "pair": {
        "normal_module_mm": 4.0,
        "center_distance_mm": 80.2,
        "pinion": GEAR | BODY | FLANK,
        "wheel": GEAR,
    },
    "material": {},
    "load": {"torque_n_m": [10.0, 100.0]},
    "errors": {"misalignment_um": [0.0, 30.0], "center_distance_change_mm": [-0.1, 0.1]},
    "accuracy": {"tolerance": 0.01},
}
RING: Table = {
    "teeth": 60,
    "face_width_mm": 25.0,
    "internal": True,
    "rim_diameter_mm": 280.0,
    "addendum_coefficient": 0.75,
}
INTERNAL: Table = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 79.8, "pinion": GEAR, "wheel": RING},
    "load": {"normal_force_n": [100.0, 1000.0]},
    "accuracy": {"time_budget_s": 10.0},
}
DEPEND_ON_OTHERS = (
    *(
        "center_distance_mm",
        "face_width_mm",
        "bore_diameter_mm",
        "end_bore_diameter_mm",
        "tip_diameter_mm",
        "root_radius_coefficient",
        "sector_teeth",
    ),
    *("thickness_allowance_um", "tip_rounding_mm", "tip_chamfer_mm", "pitches", "tolerance", "time_budget_s"),
    *(figure.field for figure in (*figures(FlankModification, Kind.LENGTH), *figures(DrawingStarts))),
    *("position_mm", "diameter_mm"),
    *("rim_thickness_mm", "web_thickness_mm", "hub_diameter_mm", "web_offset_mm", "width_mm", "offset_mm"),
    *("rim_diameter_mm", "cutter_teeth", "cutter_profile_shift_coefficient", "center_distance_change_mm"),
    *("teeth", "duration_s", "torsional_stiffness_n_m_per_rad", "dedendum_coefficient", "polar_kg_m2"),
    *("tip_chamfer_angle_deg", "angles_deg", "pitch_diameter_mm", "clearance_um", "count", "axial_preload_n"),
    *("bore_mm", "outside_diameter_mm", "static_rating_n", "contact_angle_deg"),
)
"""Numbers whose bounds follow from others too: what the schema says of them alone is not all."""


def flexible_scene() -> Table:
    scene = copy.deepcopy(SCENE)
    inertia = {"mass_kg": 2.0, "polar_kg_m2": 1e-3, "transverse_kg_m2": 7e-3}
    sections = [
        {"length_mm": 80.0, "outer_diameter_mm": 40.0},
        {"length_mm": 120.0, "outer_diameter_mm": 50.0},
    ]
    scene["shafts"][0].pop("diameter_mm")
    scene["shafts"][0] |= {"sections": sections}
    scene["shafts"].append(
        {"name": "fan", "length_mm": 100.0, "origin_mm": [80.0, 0.0, 300.0], "inertia": inertia}
    )
    scene["gears"][0] |= {"inertia": dict(inertia)}
    tilts = {"direction": "tilt_x", "tilt_mrad": [-1.0, 0.0, 1.0], "moment_n_m": [-50.0, 0.0, 50.0]}
    ways = {"direction": "x", "displacement_um": [-40.0, 0.0, 40.0], "force_n": [-60.0, 0.0, 60.0]}
    scene["bushings"][0] |= {"rolling_contact": {"stiffness_n_per_m_n": 5e8}, "spring_curves": [ways, tilts]}
    scene["bushings"][1] |= {"preload_force_n": [0.0, 0.0, 5.0], "preload_moment_n_m": [0.0, 0.0]}
    row = {"count": 14, "diameter_mm": 9.0, "pitch_diameter_mm": 53.5, "clearance_um": 10.0}
    line = {"bore_mm": 25.0, "outside_diameter_mm": 62.0, "static_rating_n": 11600.0, "clearance_um": 5.0}
    rolling = {"shaft": "fan", "axial_preload_n": 0.0}
    rows = {
        "ball": {**row, "count": 8, "contact_angle_deg": 0.0},
        "roller": row | {"length_mm": 13.6, "contact_angle_deg": 0.0},
        "catalog": line,
    }
    scene["rolling_bearings"] = [
        rolling | {"name": kind, "position_mm": 20.0 * (1 + index), kind: own}
        for index, (kind, own) in enumerate(rows.items())
    ]
    bearing = {"shaft": "fan", "radial_stiffness_n_per_m": 1e8, "axial_stiffness_n_per_m": 1e8}
    scene["bushings"] += [bearing | {"name": f"fan {z:g}", "position_mm": z} for z in (0.0, 100.0)]
    scene["couplings"] = [
        {"name": "joint", "first": "output", "second": "fan", "torsional_stiffness_n_m_per_rad": 5e4}
    ]
    curve = {
        "name": "air",
        "shaft": "fan",
        "kind": "table",
        "speed_rpm": [0.0, 1500.0],
        "torque_n_m": [0.0, 9.0],
    }
    scene["meshes"][0] |= {"coast_flank": {"backlash_um": 80.0}}
    on_the_fan = {"shaft": "fan", "position_mm": 50.0}
    pull = on_the_fan | {"force_n": [0.0, 5.0, 0.0], "moment_n_m": [0.0, 0.0, 1.0]}
    courses = [
        {"name": "time", "time_s": [0.0, 1.0], "factor": [0.0, 1.0]},
        {"name": "speed", "speed_rpm": [0.0, 1500.0], "factor": [0.0, 1.0], "turns_with": "fan"},
        {"name": "orders", "orders": [2.0], "amplitude": [0.1], "phase_deg": [0.0], "mean": 1.0},
        {"name": "turn", "turn_factor": [1.0, 0.5, 0.0]},
    ]
    scene["forces"] = [copy.deepcopy(pull) | course for course in courses]
    scene["unbalances"] = [on_the_fan | {"name": "fan", "amount_g_mm": 10.0, "angle_deg": 0.0}]
    return scene | {"speed_torques": [curve], "integration": {}, "accuracy": {}}


def planetary_scene() -> Table:
    scene = good_scene()
    number = scene["planets"][0]["number"]
    scene["planets"][0]["angles_deg"] = [360.0 / number * index for index in range(number)]
    scene["planets"][0] |= {"radial_errors_um": [0.0] * number, "tangential_errors_um": [0.0] * number}
    return scene


TABLES: dict[str, Table] = {
    "external": EXTERNAL,
    "internal": INTERNAL,
    "flexible": flexible_scene(),
    "planetary": planetary_scene(),
}


@cache
def pair_facts(case: str) -> PairGeometry:
    return PairGeometry.of(check_case(Case.model_validate_json(case)))


def check(given: Case | SceneInput) -> None:
    if isinstance(given, Case):
        check_case(given)
        return
    cases = {mesh.name: mesh.case for mesh in given.meshes if mesh.case is not None}
    check_scene(given, {name: pair_facts(case.model_dump_json()) for name, case in cases.items()})


def kind_of(table: Table) -> type[Case] | type[SceneInput]:
    return SceneInput if "run" in table else Case


def refusal(table: Table) -> Fault | None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what is implausible is accepted
            check(validated(kind_of(table), table))
    except BadInput as error:
        return error.faults[0]
    return None


@cache
def walked(name: str) -> list[list[Trial]]:
    """Return the chains of a table; the cases of a scene's meshes are walked on their own."""
    table = TABLES[name]
    assert refusal(table) is None
    return list(chains(kind_of(table), table, refusal, leave_out="case"))


EVERY = pytest.mark.parametrize("name", TABLES)


def own(trial: Trial) -> bool:
    return trial.fault is not None and trial.fault.field == dotted(trial.place)


@pytest.mark.law
@EVERY
def test_a_value_far_off_is_refused_by_the_callers_field_as_the_caller_wrote_it(name):
    for chain in walked(name):
        assert own(chain[0]), f"{chain[0].value} for {dotted(chain[0].place)}: {chain[0].fault}"
        for trial in (trial for trial in chain if own(trial)):
            assert trial.fault is not None and isinstance(trial.fault.value, int | float)
            assert math.isclose(trial.fault.value, trial.value, rel_tol=1e-11, abs_tol=0.0), trial
            assert trial.fault.bound and trial.fault.suggestion, trial


@EVERY
def test_every_error_names_a_field_that_a_caller_can_write(name):
    for trial in (trial for chain in walked(name) for trial in chain if trial.fault is not None):
        assert trial.fault is not None and is_field(kind_of(trial.table), trial.fault.field), trial.fault


@EVERY
def test_the_number_of_a_bound_is_accepted_as_it_is_printed(name):
    for chain in walked(name):
        assert len(chain) < LONGEST_CHAIN, chain
        told = [trial.fault.bound for trial in chain[:-1] if own(trial) and trial.fault is not None]
        assert len(told) == len(set(told)), f"{dotted(chain[0].place)} is told the same again: {chain}"


@EVERY
def test_a_bound_that_depends_on_nothing_else_is_told_at_once(name):
    for chain in walked(name):
        refused = [trial for trial in chain[:-1] if own(trial)]
        field = str(next(part for part in reversed(chain[0].place) if isinstance(part, str)))
        assert len(refused) <= 1 or field in DEPEND_ON_OTHERS, [trial.fault for trial in refused]


@EVERY
def test_just_beyond_a_bound_a_value_is_refused(name):
    for chain in walked(name):
        for inside, beyond in pairwise(chain):
            if inside.fault is None:
                assert beyond.fault is not None, f"{dotted(beyond.place)} = {beyond.value}"


@pytest.mark.law
@EVERY
def test_the_file_says_the_same(name, tmp_path):
    file = tmp_path / "input.toml"
    for trial in (trial for chain in walked(name) for trial in chain[:2]):
        file.write_text(toml_text(trial.table))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                check(read_model(kind_of(trial.table), file))
                assert trial.fault is None, trial
            except BadInput as error:
                assert error.faults[0] == trial.fault


@pytest.mark.law
@EVERY
def test_http_says_the_same(name, client):
    process, key = ("simulate", "scene") if "run" in TABLES[name] else ("analyze", "case")
    for trial in (trial for chain in walked(name) for trial in chain):
        if trial.fault is None:
            continue
        body = json.dumps({"inputs": {key: trial.table}})
        headers = {"Content-Type": "application/json"}
        answer = client.post(f"/v1/processes/{process}/execution", content=body, headers=headers)
        assert answer.status_code == 422, answer.text
        assert answer.json()["errors"][0] == trial.fault.as_json()


def test_a_table_in_a_list_is_told_both_ends_and_what_the_field_is():
    fault = refusal(changed(TABLES["flexible"], {"shafts[0].sections[1].length_mm": -1.0}))
    assert (fault.bound, fault.suggestion) == (
        "above 0 and at most 1e+06",
        "Length, in mm. For example 80.0.",
    )


def test_a_thin_web_is_told_its_bound_in_mm():
    fault = refusal(changed(EXTERNAL, {"pair.pinion.blank.web_thickness_mm": 0.3}))
    assert fault is not None
    assert str(fault).startswith(
        "pair.pinion.blank.web_thickness_mm = 0.3: must be from 0.5 mm to the face width 25 mm"
    )


def test_advice_on_a_foundation_is_in_its_unit():
    fault = refusal(changed(EXTERNAL, {"pair.pinion.seat.tangential_foundation_n_per_mm3": DROP}))
    assert fault is not None and fault.field == "pair.pinion.seat.tangential_foundation_n_per_mm3"
    assert fault.suggestion == "About G / h for a key of height h: 10000 N/mm^3 for 8 mm of steel."


FAR = 10.0**6
"""Far off in SI: lengths of a thousand kilometers."""
PINION = Gear(
    20,
    4e-3,
    25e-3,
    40e-3,
    tip_diameter=88e-3,
    modification=FlankModification(tip_relief=2e-5, tip_relief_length=1e-3),
    blank=GearBlank(8e-3, 1e-2, 45e-3),
    seat=BoreSeat(tangential_foundation=1e13, width=2e-2, key=Key(12e-3)),
)
WHEEL = Gear(20, 4e-3, 25e-3, 40e-3)
OBJECTS: dict[str, Any] = {
    "gear": PINION,
    "ring gear": RingGear(60, 4e-3, 25e-3, 0.28, addendum_coefficient=0.75),
    "pair": GearPair(PINION, WHEEL, 80.2e-3, shafts=(Shaft(0.2, 0.04, 0.06, 4e8), None)),
    "beam": BeamSection(0.2, 0.04, 0.01),
    "turning shaft": TurningShaft("input", 0.2, sections=(BeamSection(0.2, 0.04),)),
    "gear body": GearBody("pinion", "input", 0.1, 20, 0.0376, 0.025, 0.0, hollow_cylinder(0.08, 0.025, 0.04)),
    "inertia": Inertia(2.0, 1e-3, 7e-3),
    "bushing": Bushing("left", "input", 0.0, 1e8, 1e8, 1e3, 1e3),
    "rolling contact": RollingContact("left", 5e8, 1.5, 2e-5, 500.0),
    "coast flank": CoastFlank(8e-5, 0.49),
    "mesh": GearMesh("mesh", "a", "b", straight_table(1e8), damping=1e3, nominal_force=2e3, friction=0.05),
    "load": LoadTorque("brake", "output", TimeLaw.constant(100.0)),
    "coupling": Coupling("joint", "a", "b", 5e4, 5.0),
    "outputs": Outputs(2e4),
    "integration": Integration(fixed_step=1e-5),
}


def numbers(thing: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], type]]:
    for field in fields(thing):
        value = getattr(thing, field.name)
        if is_dataclass(value):
            yield from numbers(value, (*path, field.name))
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield (*path, field.name), type(value)


def refusal_in_python(thing: Any, path: tuple[str, ...], value: float) -> Fault | None:
    """Return why an object is refused that has another value at a path; the error as Python shows it."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with_number(thing, path, value)
    except RefusedValue as error:
        assert f"{error.field} = " in str(error) and f": must be {error.bound}" in str(error)
        return Fault(error.field, error.value, str(error.bound), str(error.suggestion))
    return None


def same(told: str, path: str) -> bool:
    """Whether an error's field is a path: either may leave out what it is inside of."""
    names, wanted = told.split("."), path.split(".")
    shared = min(len(names), len(wanted))
    return names[-shared:] == wanted[-shared:]


def with_number(thing: Any, path: tuple[str, ...], value: float) -> Any:
    name, *rest = path
    return replace(thing, **{name: with_number(getattr(thing, name), tuple(rest), value) if rest else value})


@pytest.mark.parametrize("name", OBJECTS)
def test_the_number_of_a_bound_in_python_is_accepted_as_it_is_printed(name):
    told = 0
    for path, kind in numbers(OBJECTS[name]):
        for end, far in ((LOW, -FAR), (HIGH, FAR)):
            value: float | None = kind(far)
            seen: list[str] = []
            while value is not None and len(seen) < LONGEST_CHAIN:
                fault = refusal_in_python(OBJECTS[name], path, value)
                if fault is None or not same(fault.field, ".".join(path)):
                    break
                assert fault.value == pytest.approx(value, rel=1e-12), fault
                assert fault.bound not in seen, f"{path} is told the same again: {fault}"
                seen.append(fault.bound)
                value = next_typed(fault, end, kind)
            assert len(seen) < LONGEST_CHAIN, seen
            told += len(seen)
    assert told >= 1
