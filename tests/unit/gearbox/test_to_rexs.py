"""Results in REXS documents: they read back in the axes of the file, and leave the unit as it was."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from command_line import loa, printed
from opened_unit import deflection_of_unit, scene_in_si
from rexs_stage import STAGE, stage_unit
from rexs_unit import (
    CASING,
    GEARS,
    INPUT,
    MIDDLE,
    MOTOR,
    NORMAL_LOAD,
    OUTPUT,
    ROOT,
    STAGES,
    antiparallel,
    mirrored,
    planetary,
    two_stages,
)
from small_table import small_table

from dynamics.assembly.assemble import assemble
from dynamics.deflection import LoadCase, loaded_scene
from dynamics.mechanism.flank_gradients import table_sense
from fe_contact.ste import Metadata, SteDatabase
from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import parsed, serialized
from lineofaction.gearbox.rexs.model import Attribute, Component, Document
from lineofaction.gearbox.rexs.vocabulary import si_value
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection
from lineofaction.gearbox.studies.deflect.run import RUN
from lineofaction.gearbox.to_rexs.deflection import deflected, omissions
from lineofaction.gearbox.to_rexs.stage import exported


def one_stage() -> GearUnit:
    return stage_unit()


def stages() -> tuple[StageCase, ...]:
    return StageCase.all_of(one_stage(), {})


def table() -> SteDatabase:
    (stage,) = stages()
    return replace(small_table(), metadata=Metadata(case=case_json(stage.case)))


def of_stage(document: Document) -> dict[str, Attribute]:
    stage = document.model.component(STAGE)
    return {entry.id: entry for entry in stage.attributes if entry.origin == "calculated"}


def test_the_unit_stays_as_it_was_and_reads_back_to_the_same_case():
    document = Document(one_stage().model)
    written = exported(document, stages(), [table()])
    for name in ("a.rexs", "a.rexsj", "a.rexsz"):
        read = parsed(serialized(written, name))
        assert read == written
        assert StageCase.all_of(GearUnit(read.model), {}) == stages()
    for before, after in zip(document.model.components, written.model.components, strict=True):
        assert [entry for entry in after.attributes if entry.origin is None] == list(before.attributes)


def test_contact_ratios_are_those_of_the_pair():
    found = of_stage(exported(Document(one_stage().model), stages(), [table()]))
    pair = gear_pair(stages()[0].case)
    assert found["radial_contact_ratio"].value == pair.transverse_contact_ratio
    assert found["total_contact_ratio"].value == pair.total_contact_ratio


def test_the_stiffness_is_the_slope_of_force_over_transmission_error():
    database, step = table(), 1e-4
    torque = float(0.7 * database.torque[-1])
    found = of_stage(exported(Document(one_stage().model), stages(), [database], torque))
    at = np.array(found["custom_mesh_positions"].value)
    low, high = (database.curve(torque=torque * (1.0 + sign * step), at=at).ste for sign in (-1, 1))
    force = 2.0 * step * torque / database.geometry.base_radius[0]
    stiffness = found["meshing_stiffness_characteristic"]
    assert stiffness.value == pytest.approx(1e-3 * force / (high - low), rel=1e-4)
    assert stiffness.unit == "N / mm"


def test_the_transmission_error_is_the_curves():
    database = table()
    torque = float(database.torque[0])
    found = of_stage(exported(Document(one_stage().model), stages(), [database], torque))
    curve = database.curve(torque=torque, at=found["custom_mesh_positions"].value)
    assert found["custom_transmission_error"].value == pytest.approx(1e6 * curve.ste)
    whole = 1e6 * curve.peak_to_peak.value
    assert found["custom_transmission_error_peak_to_peak"].value == pytest.approx(whole)
    assert found["custom_transmission_error_harmonics"].unit == "mum"
    assert found["custom_torque_on_driving_gear"].value == pytest.approx(torque)


def test_a_result_takes_the_place_of_an_earlier_one():
    once = exported(Document(one_stage().model), stages(), [table()], float(table().torque[0]))
    twice = exported(once, stages(), [table()])
    (stage,) = [part for part in twice.model.components if part.id == STAGE]
    names = [entry.id for entry in stage.attributes]
    assert len(names) == len(set(names))
    assert twice == exported(Document(one_stage().model), stages(), [table()])


def test_a_table_of_another_pair_is_refused():
    (stage,) = stages()
    other = case_json(stage.case)
    other["pair"]["pinion"]["tip_relief_um"] = 20.0
    other["pair"]["pinion"]["tip_relief_length_mm"] = 1.0
    with pytest.raises(BadInput, match=stage.name):
        exported(Document(one_stage().model), stages(), [replace(table(), metadata=Metadata(case=other))])


def test_equal_stages_have_equal_results():
    model = replace(
        one_stage().model, components=(*one_stage().model.components, Component(21, "cylindrical_stage"))
    )
    (stage,) = stages()
    written = exported(Document(model), [replace(stage, equal=(21,))], [table()])
    first, second = (written.model.component(number) for number in (STAGE, 21))
    assert first is not None
    assert set(second.attributes) == set(of_stage(written).values()) != set()


def test_the_verb_writes_what_it_names_of_a_table(tmp_path):
    unit_file, database, output = (tmp_path / name for name in ("one_stage.rexs", "ste.nc", "out.rexsj"))
    unit_file.write_bytes(serialized(Document(one_stage().model), unit_file.name))
    table().to_netcdf(database)
    arguments = ("export", database, "--rexs", unit_file, "-o", output)
    names = printed(*arguments)["calculated"][str(STAGE)]
    assert set(names) == set(of_stage(parsed(output.read_bytes())))
    refused = loa(*arguments, "--misalignment-um", "10")
    assert refused.exit_code == 2
    assert "--misalignment-um" in refused.stderr


BEARINGS = range(31, 37)
RADIAL, AXIAL = 2e8, 1e8
"""N/m, of the bearings of the unit."""
SHARES, TORQUES = (20.0, 70.0, 10.0), (50.0, 80.0, -30.0)
FORCES = (0.0, 300.0, -200.0)
"""Of the motor along v, N."""
SIDES = (1, 1, -1)
"""The face counts the other way on the coast side, where the train turns the other way."""
Values = Mapping[str, Any]


def spectrum() -> Document:
    """Return the unit with three load cases, the last on the coast side."""
    return two_stages(
        cases=[
            {
                ROOT: ("gear_unit", {"operating_time_fraction": share}),
                MOTOR: ("external_load", {"torque_around_u_axis": torque, "force_v_direction": force}),
            }
            for share, torque, force in zip(SHARES, TORQUES, FORCES, strict=True)
        ]
    )


def with_sides_exchanged(document: Document, bearing: int) -> Document:
    other = {"inner_part": "outer_part", "outer_part": "inner_part"}
    relations = tuple(
        replace(entry, refs=tuple(replace(ref, role=other.get(ref.role, ref.role)) for ref in entry.refs))
        if entry.type == "side" and entry.of_role("assembly") == bearing
        else entry
        for entry in document.model.relations
    )
    return replace(document, model=replace(document.model, relations=relations))


def written(document: Document) -> tuple[Document, GearboxDeflection]:
    unit = OpenedUnit.of(document)
    result = deflection_of_unit(unit)
    return deflected(document, unit, result), result


def results(document: Document, case: int | None = None) -> dict[int, Values]:
    """Return the calculated values in SI by component, of a load case or of the components themselves."""
    model = document.model
    components = model.components if case is None else model.spectra[0].cases[case].components
    return {
        part.id: {
            entry.id: np.array([si_value(float(v), entry.unit, str(entry.unit), "") for v in values])
            if isinstance(values := entry.value, tuple)
            else si_value(float(values), entry.unit, str(entry.unit), "")
            for entry in part.attributes
            if entry.origin == "calculated"
        }
        for part in components
    }


def vector(values: Values, name: str) -> np.ndarray[Any, Any]:
    return np.array([values[name.format(axis)] for axis in "uvw"])


@pytest.fixture(scope="module")
def deflected_unit():
    return written(spectrum())


def test_the_unit_reads_back_to_the_same_scene_and_cases(deflected_unit):
    document, before = deflected_unit[0], OpenedUnit.of(spectrum())
    for name in ("a.rexs", "a.rexsj", "a.rexsz"):
        read = parsed(serialized(document, name))
        assert read == document
        after = OpenedUnit.of(read)
        assert (after.scene, after.cases, after.load_cases) == (before.scene, before.cases, before.load_cases)
    assert document.model.components == spectrum().model.components
    for own, case in zip(document.model.spectra[0].cases, spectrum().model.spectra[0].cases, strict=True):
        assert own.components[: len(case.components)] == case.components


def test_every_load_case_has_its_own_results(deflected_unit):
    document, result = deflected_unit
    for number, case in enumerate(result.deflection.cases):
        found = results(document, number)
        for load in case.bearings:
            own = found[int(load.name.split()[-1])]
            x, y, z = load.force[:3]
            assert vector(own, "force_acting_on_outer_component_{}") == pytest.approx([z, x, y], rel=1e-12)
        for mesh in case.meshes:
            own = found[int(mesh.name.split()[-1])]
            size = own["effective_equivalent_misalignment_iso_6336_2019"]
            assert size == pytest.approx(abs(mesh.misalignment), rel=1e-12)
            along_u = OpenedUnit.of(spectrum()).parts.meshes[mesh.name].sense * SIDES[number]
            assert own["custom_misalignment"] == pytest.approx(along_u * mesh.misalignment, rel=1e-12)
            load = own["load_distribution_along_face_width"]
            assert np.all(along_u * np.diff(load) < 0.0)
        for number_of_shaft, shaft in enumerate((INPUT, MIDDLE, OUTPUT)):
            at = case.shafts.shaft == number_of_shaft
            own = found[shaft]
            u, v, w = (own[f"displacement_{axis}_of_nodes"] for axis in "uvw")
            assert np.allclose(np.array([v, w, u]).T, case.shafts.motion[at, :3], rtol=1e-12, atol=0.0)
            assert np.allclose(own["u_coordinates_of_beam_nodes"], case.shafts.position[at], rtol=1e-12)
            assert np.allclose(own["torsion_u"], case.shafts.motion[at, 5], rtol=1e-12)


@pytest.mark.parametrize("exchanged", [None, 31, 34])
def test_a_bearing_pulls_its_outer_side_after_the_inner(exchanged):
    plain = spectrum()
    document, _ = written(plain if exchanged is None else with_sides_exchanged(plain, exchanged))
    on_casing = np.zeros(3)
    for number in BEARINGS:
        own = results(document, 1)[number]
        inner, outer = (vector(own, f"force_acting_on_{side}_component_{{}}") for side in ("inner", "outer"))
        assert np.array_equal(inner, -outer)
        names = ("axial_deflection", "radial_deflection_in_v", "radial_deflection_in_w")
        deflection = np.array([own[name] for name in names])
        stiffness = np.array([AXIAL if number % 2 else 0.0, RADIAL, RADIAL])
        assert outer == pytest.approx(stiffness * deflection, rel=1e-6, abs=1e-6)
        moved = vector(own, "displacement_inner_side_{}") - vector(own, "displacement_outer_side_{}")
        assert moved == pytest.approx(deflection, rel=1e-12, abs=1e-20)
        on_casing += inner if number == exchanged else outer
    pulled = np.array([0.0, FORCES[1], 0.0])
    assert on_casing == pytest.approx(pulled, abs=1e-6 * NORMAL_LOAD)


@pytest.mark.parametrize("shaft", [INPUT, MIDDLE])
def test_a_shaft_described_from_its_other_end_has_the_same_results_in_its_own_axes(shaft):
    plain, turned = (results(written(document)[0]) for document in (two_stages(), antiparallel(shaft, 150.0)))
    flipped = np.array([-1.0, -1.0, 1.0])  # u and v of an axis turned about w
    before, after = plain[shaft], turned[shaft]
    assert after["u_coordinates_of_beam_nodes"] == pytest.approx(
        0.15 - before["u_coordinates_of_beam_nodes"][::-1], abs=1e-12
    )
    for sign, axis in zip(flipped, "uvw", strict=True):
        name = f"displacement_{axis}_of_nodes"
        assert after[name] == pytest.approx(sign * before[name][::-1], rel=1e-6, abs=1e-12)
    assert after["torsion_u"] == pytest.approx(-before["torsion_u"][::-1], rel=1e-6, abs=1e-12)
    for bearing in {INPUT: (31, 32), MIDDLE: (33, 34)}[shaft]:
        for name in ("force_acting_on_outer_component_{}", "displacement_inner_side_{}"):
            expected = flipped * vector(plain[bearing], name)
            assert vector(turned[bearing], name) == pytest.approx(expected, rel=1e-6, abs=1e-12)
        assert turned[bearing]["angular_deflection_in_v"] == pytest.approx(
            -plain[bearing]["angular_deflection_in_v"], rel=1e-6
        )
    for stage, first in zip(STAGES, (INPUT, MIDDLE), strict=True):
        own, other = plain[stage], turned[stage]
        step = -1 if first == shaft else 1
        load = "load_distribution_along_face_width"
        assert other[load] == pytest.approx(own[load][::step], rel=1e-6)
        assert other["load_distribution_node_positions"] == pytest.approx(
            own["load_distribution_node_positions"], abs=1e-12
        )
        assert other["custom_misalignment"] == pytest.approx(step * own["custom_misalignment"], rel=1e-6)


def test_the_mirrored_unit_has_the_mirrored_results():
    plain, image = (results(written(document)[0]) for document in (two_stages(), mirrored()))
    across_v = np.array([1.0, -1.0, 1.0])
    for bearing in BEARINGS:
        for name in ("force_acting_on_outer_component_{}", "displacement_inner_side_{}"):
            expected = across_v * vector(plain[bearing], name)
            assert vector(image[bearing], name) == pytest.approx(expected, rel=1e-6, abs=1e-9)
        tilt_v, tilt_w = ("angular_deflection_in_v", "angular_deflection_in_w")  # axial vectors
        assert image[bearing][tilt_v] == pytest.approx(plain[bearing][tilt_v], rel=1e-6)
        assert image[bearing][tilt_w] == pytest.approx(-plain[bearing][tilt_w], rel=1e-6)
    for stage in STAGES:
        name = "custom_misalignment"
        assert image[stage][name] == pytest.approx(plain[stage][name], rel=1e-6)


UNITS = {
    "plain": two_stages(),
    "mirrored": mirrored(),
    "input from its other end": antiparallel(INPUT, 150.0),
    "driven from the output": two_stages({MOTOR: {"torque_around_u_axis": -NORMAL_LOAD}}),
    "planetary": planetary(),
}


@pytest.mark.parametrize("name", UNITS)
@pytest.mark.parametrize("direction", ["drive", "coast"])
def test_the_face_counts_as_dynamics_counts_it(name, direction):
    unit = OpenedUnit.of(UNITS[name])
    scene = loaded_scene(scene_in_si(unit), LoadCase("load", direction=direction))
    system, turned = assemble(scene), 1 if direction == "drive" else -1
    for index, mesh in enumerate(scene.meshes):
        if mesh.name not in unit.parts.meshes:
            continue
        against_z = table_sense(scene, index, system.kinematics.mesh_sense[index])
        part = unit.parts.meshes[mesh.name]
        reversed_shaft = name == "input from its other end" and part.component == STAGES[0]
        assert turned * part.sense == -against_z * (-1 if reversed_shaft else 1)


def test_the_load_along_the_face_carries_the_mesh_force(deflected_unit):
    document, result = deflected_unit
    for number, case in enumerate(result.deflection.cases):
        for mesh in case.meshes:
            own = results(document, number)[int(mesh.name.split()[-1])]
            nodes = own["load_distribution_node_positions"]
            load = own["load_distribution_along_face_width"]
            assert nodes[0] == 0.0
            assert np.trapezoid(load, nodes) == pytest.approx(mesh.force, rel=1e-12)
            pattern = own["custom_contact_pattern"].reshape(-1, nodes.size)
            assert len(pattern) == own["custom_contact_pattern_roll_lengths"].size
            assert pattern.max() == pytest.approx(own["custom_largest_contact_stress"], rel=1e-12)
            assert np.all(np.diff(load) * np.diff(pattern[0]) > 0.0)  # both fall to the same end


def test_without_a_spectrum_results_are_the_components_own():
    document, result = written(two_stages())
    assert {load.name for load in result.deflection.cases[0].bearings} == {
        f"concept_bearing {number}" for number in BEARINGS
    }
    assert not document.model.spectra
    own = {number for number, values in results(document).items() if values}
    assert own == {INPUT, MIDDLE, OUTPUT, *STAGES, *BEARINGS}
    assert not own & {*GEARS, CASING}


def test_planets_copies_are_named_as_left_out():
    unit = OpenedUnit.of(planetary())
    result = deflection_of_unit(unit)
    names = omissions(unit, result)
    assert "shaft 6 2" in names
    assert not {"shaft 3", "concept_bearing 51", "cylindrical_stage 21"} & set(names)
    assert results(deflected(planetary(), unit, result))[51]["axial_deflection"] == pytest.approx(
        0.0, abs=1e-9
    )


LONGER_SECTION = {131: {"length": 101.0}}
OTHER_TIP = {11: {"tip_diameter": 43.0}}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (LONGER_SECTION, r"shafts\[0\]\.length_mm = 151\.0: must be 150\.0,"),
        ({31: {"radial_stiffness": 3e8}}, r"bushings\[0\]"),
        (OTHER_TIP, r'case of mesh "cylindrical_stage 21", pair\.pinion\.tip_diameter_mm'),
        ({INPUT: {"rotational_speed": 1501.0}}, "speed_rpm"),
    ],
)
def test_a_unit_of_another_scene_is_refused_with_the_first_difference(changes, words):
    result = deflection_of_unit(OpenedUnit.of(two_stages()))
    other = two_stages(changes)
    with pytest.raises(BadInput, match=words):
        deflected(other, OpenedUnit.of(other), result)


def test_settings_of_the_computation_may_differ():
    document = two_stages()
    unit = OpenedUnit.of(document)
    result = deflection_of_unit(unit)
    scene = result.scene | {"run": {"duration_s": 9.0}, "effects": {"friction": "off"}}
    assert deflected(document, unit, replace(result, scene=scene)) == deflected(document, unit, result)


def test_other_load_cases_and_lost_ones_are_refused(deflected_unit):
    result, unit = deflected_unit[1], OpenedUnit.of(spectrum())

    def with_case(**changes):
        first, *others = result.deflection.cases
        cases = (replace(first, **changes), *others)
        return replace(result, deflection=replace(result.deflection, cases=cases))

    for changes, words in (
        ({"name": "cruise"}, "cruise.*load case 1, load case 2, load case 3"),
        ({"torque": 51.0}, "torque_n_m"),
        ({"direction": "coast"}, "direction"),
        ({"share": 0.5}, "share"),
        ({"status": "unbalanced"}, "converged"),
    ):
        with pytest.raises(BadInput, match=words):
            deflected(spectrum(), unit, with_case(**changes))
    (pull,) = result.deflection.cases[0].forces
    with pytest.raises(BadInput, match=rf'load case 1", forces.external_load {MOTOR}\.force_n\[0\]'):
        deflected(spectrum(), unit, with_case(forces=(replace(pull, force=np.array([1.0, 0.0, 0.0])),)))
    with pytest.raises(BadInput, match=f'load case 1", forces.external_load {MOTOR}'):
        deflected(spectrum(), unit, with_case(forces=()))
    with pytest.raises(BadInput, match="older version"):
        deflected(spectrum(), unit, replace(result, scene={}))


def test_the_verb_writes_what_it_names(deflected_unit, tmp_path):
    unit_file, deflection, output = (tmp_path / name for name in ("unit.rexs", "d.nc", "out.rexsj"))
    unit_file.write_bytes(serialized(spectrum(), unit_file.name))
    RUN.file.write(deflected_unit[1], deflection)
    arguments = ("export", deflection, "--rexs", unit_file, "-o", output)
    facts = printed(*arguments)
    assert facts["left_out"] == []
    assert set(facts["calculated"]) == {str(n) for n in (INPUT, MIDDLE, OUTPUT, *STAGES, *BEARINGS)}
    found = results(parsed(output.read_bytes()), 2)
    assert set(facts["calculated"]["31"]) == set(found[31])
    lines = loa(*arguments).stdout.splitlines()
    alike = [line.partition(":")[0] for line in lines[:-1]]  # as many lines as lists of results
    assert alike == ["components 3, 4, 5", "components 21, 22", "components 31, 32, 33, 34, 35, 36"]
    refused = loa(*arguments, "--torque", "10")
    assert refused.exit_code == 2 and "--torque" in refused.stderr
