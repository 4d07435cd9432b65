"""loa deflect: load cases, what it prints and writes, its record, the inputs of an optimization, a rotor."""

import json
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import loa, printed
from declared_figures import check_declared
from scene_files import scene_file
from two_stage_scenes import two_stages

from dynamics.deflection import BearingLoad, ForceUnderCase, deflect
from dynamics.settings.load_case import LoadCase
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.deflect import Inputs
from lineofaction.gearbox.studies.deflect.cases import load_cases
from lineofaction.gearbox.studies.deflect.figures import optimization_inputs, write_spectrum
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, MeshFlanks, Outline
from lineofaction.gearbox.studies.deflect.run import RUN
from lineofaction.gearbox.studies.optimize import Inputs as OptimizeInputs
from lineofaction.report.deflection.deflect import PAGE, _force_table, _meshes_worst_first
from lineofaction.report.deflection.gearbox_drawing import _exaggeration
from lineofaction.report.document import write_report
from lineofaction.report.drawing.figure import Table, number


def tables(result: GearboxDeflection) -> list[Table]:
    """Return what the verb prints of meshes, bearings and their life."""
    return [part for part in PAGE.text(result) if isinstance(part, Table)]


def test_load_cases_come_from_their_file_in_its_units(tmp_path):
    file = tmp_path / "cases.toml"
    file.write_text('[[load_cases]]\nname = "a"\nspeed_rpm = 600.0\ntorque_n_m = 20.0\ndirection = "coast"\n')
    (case,) = load_cases(read_model(Inputs, file).load_cases)
    assert case.speed == pytest.approx(20.0 * np.pi) and (case.torque, case.direction) == (20.0, "coast")
    answer = printed("deflect", scene_file(tmp_path), file)["load_cases"][0]
    assert (answer["torque_n_m"], answer["speed_rpm"]) == (pytest.approx(20.0), pytest.approx(600.0))


@pytest.mark.parametrize(
    ("line", "field"),
    [
        ("torque_n_m = -1.0", "load_cases[0].torque_n_m"),
        ('direction = "up"', "load_cases[0].direction"),
        ("torque_n_m = 1.0\nfactor = 2.0", "load_cases[0].factor"),
        ('forces = [{name = "belt", factor = 2.0}]', "load_cases[0].forces[0].name"),
        (
            'forces = [{name = "a", factor = 2.0, moment_n_m = [0.0, 0.0, 1.0]}]',
            "load_cases[0].forces[0].factor",
        ),
        ('forces = [{name = "a"}]', "load_cases[0].forces[0].force_n"),
        ('forces = [{name = "a", force_n = [1.0, 2.0]}]', "load_cases[0].forces[0].force_n"),
    ],
)
def test_a_case_that_cannot_be_is_refused_by_its_field(tmp_path, line, field):
    file = tmp_path / "cases.toml"
    file.write_text(f'[[load_cases]]\nname = "a"\n{line}\n')
    done = loa("deflect", scene_file(tmp_path), file)
    assert done.exit_code == 2 and field in done.stderr


BELT = '[[forces]]\nname = "belt"\nshaft = "input"\nposition_mm = 50.0\nforce_n = [0.0, 100.0, 0.0]\n'
PULLED = """
[[load_cases]]
name = "as in the scene"
[[load_cases]]
name = "its own"
forces = [{name = "belt", force_n = [0.0, -300.0, 50.0]}]
[[load_cases]]
name = "doubled"
forces = [{name = "belt", factor = 2.0}]
[[load_cases]]
name = "coast"
direction = "coast"
forces = [{name = "belt", factor = 2.0}]
[[load_cases]]
name = "coast as in the scene"
direction = "coast"
"""


def test_a_case_states_forces_of_the_scene(tmp_path):
    scene, file = scene_file(tmp_path), tmp_path / "cases.toml"
    axial = "axial_stiffness_n_per_m = 1e8\nradial_stiffness"
    held = scene.read_text("utf-8").replace("radial_stiffness", axial, 1)
    scene.write_text(held + BELT, encoding="utf-8")
    file.write_text(PULLED)
    cases = printed("deflect", scene, file)["load_cases"]
    across = [np.array(case["bearings"][0]["force_n"][:2]) for case in cases]
    assert cases[1]["forces"] == [
        {"name": "belt", "shaft": "input", "force_n": [0.0, -300.0, 50.0], "moment_n_m": [0.0, 0.0, 0.0]}
    ]
    assert [case["forces"][0]["force_n"][1] for case in cases] == [100.0, -300.0, 200.0, 200.0, 100.0]
    assert across[1] - across[0] == pytest.approx([0.0, -400.0], rel=1e-9, abs=1e-6)
    assert across[2] - across[0] == pytest.approx([0.0, 100.0], rel=1e-9, abs=1e-6)
    assert across[3] - across[4] == pytest.approx([0.0, 100.0], rel=1e-9, abs=1e-6)


def test_forces_that_the_scene_has_not_are_refused_before_its_tables_are_computed(tmp_path):
    scene = read_model(SceneInput, scene_file(tmp_path))
    cases = [{"name": "a", "forces": [{"name": "belt", "factor": 2.0}]}]
    with pytest.raises(BadInput, match=r"load_cases\[0\]\.forces\[0\]\.name"):
        RUN.check(scene, validated(Inputs, {"load_cases": cases}))


def test_a_case_without_forces_keeps_the_address_of_its_result():
    """Results are stored by what is written of their inputs."""
    (case,) = validated(Inputs, {"load_cases": [{"name": "a"}]}).model_dump(mode="json")["load_cases"]
    assert set(case) == {"name", "share", "factor", "torque_n_m", "speed_rpm", "direction"}


def test_a_force_of_a_scene_says_what_acts(tmp_path):
    scene = scene_file(tmp_path)
    scene.write_text(scene.read_text("utf-8") + BELT.rpartition("force_n")[0], encoding="utf-8")
    done = loa("deflect", scene)
    assert done.exit_code == 2 and "forces[0].force_n" in done.stderr


CASES = (
    LoadCase("climb", share=1.0, factor=1.0),
    LoadCase("cruise", share=3.0, factor=0.5),
    LoadCase("again", share=2.0, factor=0.5),
    LoadCase("back", share=4.0, factor=0.3, direction="coast"),
)


def flanks_of(case: Any, mesh: Any) -> MeshFlanks:
    along, across = np.linspace(-0.015, 0.015, 41), np.linspace(0.005, 0.02, 40)
    load = np.maximum(0.0, 1e5 * (1.0 - along / 0.02))
    numbers = {"torque": 0.02 * mesh.force, "mean": 1e-5, "peak_to_peak": 1e-6}
    return MeshFlanks(
        mesh.name,
        case.name,
        numbers["torque"],
        numbers["mean"],
        float("nan"),
        numbers["peak_to_peak"],
        float("nan"),
        np.full(5, 1e-7),
        np.full(5, 1e-9),
        1.5,
        1e-9,
        9e8,
        along,
        load,
        across,
        np.full((40, 41), 5e8),
    )


@pytest.fixture(scope="module")
def result():
    """The two stages under four cases, with flanks as `flanks_of` makes them."""
    scene = two_stages()
    found = deflect(scene, CASES, 3)
    flanks = tuple(flanks_of(case, mesh) for case in found.cases for mesh in case.meshes)
    return GearboxDeflection(found, flanks, 3, 1e-8, True, Outline.of(scene), {"first": {"pair": {}}}, 1.0)


def test_a_scene_is_deflected_under_its_own_load(tmp_path):
    (case,) = printed("deflect", scene_file(tmp_path))["load_cases"]
    assert (case["name"], case["status"], case["torque_n_m"]) == ("load", "converged", pytest.approx(100.0))
    (mesh,) = case["meshes"]
    assert mesh["force_n"] == pytest.approx(100.0 / 0.0375877, rel=1e-5)
    left = case["bearings"][0]
    assert left["elastic_um"][0] == pytest.approx(left["force_n"][0] / 2e8 * 1e6, rel=1e-6)


def test_the_file_gives_back_the_result_bit_by_bit(result, tmp_path):
    file = tmp_path / "deflection.nc"
    RUN.file.write(result, file)
    back = RUN.file.read(file)
    assert RUN.figures(back) == RUN.figures(result)
    assert np.array_equal(back.flanks[3].pattern, result.flanks[3].pattern)
    assert np.array_equal(back.deflection.cases[1].shafts.motion, result.deflection.cases[1].shafts.motion)
    write_report([file], tmp_path / "page.html")
    assert "Misalignment of each mesh by cause" in (tmp_path / "page.html").read_text("utf-8")


def test_forces_of_all_cases_are_kept_and_shown(result, tmp_path):
    pull = ForceUnderCase("belt", "in", np.array([0.0, 800.0, -1.5]), np.array([0.0, 0.0, 20.0]))
    cases = tuple(replace(case, forces=(pull,)) for case in result.deflection.cases)
    pulled = replace(result, deflection=replace(result.deflection, cases=cases))
    table = _force_table(pulled)
    assert table is not None and _force_table(result) is None
    assert table.rows[3] == ("belt", "in", "back (coast)", "0", "800.0", "-1.500", "0", "0", "20.00")
    assert [section.title for section in PAGE.page(pulled).sections][-1] == "Forces"
    RUN.file.write(pulled, tmp_path / "d.nc")
    back = RUN.file.read(tmp_path / "d.nc").deflection.cases[1].forces[0]
    assert np.array_equal(back.force, pull.force) and np.array_equal(back.moment, pull.moment)


def test_the_worst_mesh_comes_first(result):
    largest = {
        name: max(abs(m.misalignment) for c in result.deflection.cases for m in c.meshes if m.name == name)
        for name in ("first", "second")
    }
    first, second = _meshes_worst_first(result)
    assert largest[first] > largest[second]
    assert [row[0] for row in tables(result)[0].rows] == [first] * 4 + [second] * 4
    assert PAGE.page(result).headlines[0].remark.startswith(f"mesh {first}")


def test_parts_of_the_table_sum_to_the_misalignment(result):
    table = tables(result)[0]
    assert table.head[4:7] == ("of shafts", "bearings", "K_Hbeta")  # what acts
    for row in table.rows:
        total, parts = float(row[3]), [float(part) for part in row[4:6]]
        assert total == pytest.approx(sum(parts), abs=0.02 * max(map(abs, parts)))


def test_a_mesh_that_nothing_loads_has_no_figures_of_its_flanks(result):
    name, case = result.flanks[0].mesh, result.deflection.cases[0]
    bare = tables(replace(result, flanks=result.flanks[1:]))[0].rows
    full = tables(result)[0].rows
    changed = [(new, old) for new, old in zip(bare, full, strict=True) if new != old]
    ((new, old),) = changed
    assert new[0] == name and case.name in new[1]
    assert new[-3:] == ("none", "none", "none") and new[:-3] == old[:-3]


def test_the_spectrum_of_the_driving_side_is_what_is_optimized(result):
    inputs = optimization_inputs(result, "first")
    study = OptimizeInputs.model_validate_json(json.dumps(inputs))
    first = [case.meshes[0] for case in result.deflection.cases]
    assert study.torque_n_m == pytest.approx((0.02 * first[1].force, 0.02 * first[0].force), rel=1e-6)
    assert study.objective.weights == (5.0, 1.0)  # equal torques are one load
    own = tuple(1e6 * mesh.misalignment for mesh in (first[1], first[0]))
    assert study.misalignment_um == pytest.approx(own, abs=5e-4) and own[1] / own[0] > 1.5
    assert study.scatter.misalignment_um == 0.0


def tilted(result: GearboxDeflection, case: int, further_um: float) -> GearboxDeflection:
    """The same with the first mesh misaligned further under a load case."""
    loaded = result.deflection.cases[case]
    mesh = loaded.meshes[0]
    skewed = replace(mesh, misalignment=mesh.misalignment + 1e-6 * further_um)
    cases = list(result.deflection.cases)
    cases[case] = replace(loaded, meshes=(skewed, *loaded.meshes[1:]))
    return replace(result, deflection=replace(result.deflection, cases=tuple(cases)))


def test_equal_torques_at_different_misalignments_stay_two_loads(result):
    before, after = (optimization_inputs(each, "first") for each in (result, tilted(result, 2, -2.0)))
    (torque, other), (skew, larger) = before["torque_n_m"], before["misalignment_um"]
    assert after["torque_n_m"] == [torque, torque, other]
    assert after["misalignment_um"] == pytest.approx([skew - 2.0, skew, larger], abs=1e-9)
    assert after["objective"]["weights"] == [2.0, 3.0, 1.0]
    OptimizeInputs.model_validate_json(json.dumps(after))
    assert optimization_inputs(tilted(result, 2, 1e-5), "first") == before  # less than a file shows


def test_a_plane_model_gets_no_misalignment_to_optimize_for(result):
    plane = replace(result, flanks=tuple(replace(f, face_load_factor=np.nan) for f in result.flanks))
    inputs, across_face = optimization_inputs(plane, "first"), optimization_inputs(result, "first")
    assert across_face.keys() - inputs.keys() == {"misalignment_um"}
    assert optimization_inputs(tilted(plane, 2, 2.0), "first") == inputs


def test_files_of_an_optimization_stand_beside_the_list_of_calls(result, tmp_path):
    write_spectrum(result, None, tmp_path / "gearbox.toml")
    (entry,) = tomllib.loads((tmp_path / "gearbox.toml").read_text("utf-8"))["meshes"]
    study = tomllib.loads((tmp_path / entry["study_file"]).read_text("utf-8"))
    assert study == optimization_inputs(result, "first")
    assert "pair" in tomllib.loads((tmp_path / entry["case_file"]).read_text("utf-8"))


def test_what_was_not_found_is_said(result):
    assert RUN.failure(result) == ""
    assert "after 3 passes" in RUN.failure(replace(result, agreed=False, change=0.1))
    lost = replace(result.deflection.cases[0], status="unbalanced")
    broken = replace(result, deflection=replace(result.deflection, cases=(lost,)))
    assert '"climb" (unbalanced)' in RUN.failure(broken) and "climb" in PAGE.page(broken).alarms[0]


def test_deflections_are_drawn_a_round_number_of_times_enlarged(result):
    case = result.deflection.cases[0]
    factor = _exaggeration(result.outline, case)
    largest = float(np.max(np.abs(case.shafts.motion[:, :2])))
    extent = float(np.ptp(result.outline.origin[:, 0]))
    assert extent > 0.2  # the length of the shafts
    assert f"{factor:e}"[0] in "125" and 0.04 * extent <= factor * largest <= 0.1 * extent * (1.0 + 1e-9)


def with_bearings(result: GearboxDeflection, change: Callable[[BearingLoad], BearingLoad]) -> Any:
    cases = tuple(
        replace(case, bearings=tuple(change(load) for load in case.bearings))
        for case in result.deflection.cases
    )
    return replace(result, deflection=replace(result.deflection, cases=cases))


def test_lives_are_in_hours_and_damage_adds_over_the_cases(result):
    known = with_bearings(result, lambda load: replace(load, rating_life=1e12 / load.radial**3))
    figures = RUN.figures(known)
    check_declared("deflection", figures)
    damage = np.zeros(len(result.outline.bearings))
    for case in figures["load_cases"]:
        for k, bearing in enumerate(case["bearings"]):
            hours = 1e12 / bearing["radial_force_n"] ** 3 / (60.0 * bearing["speed_rpm"])
            assert (
                bearing["rating_life_hours"] == pytest.approx(hours) and bearing["rating_life"] == "limited"
            )
            damage[k] += case["share"] / 10.0 / hours
    assert [part["rating_life_hours"] for part in figures["bearings"]] == pytest.approx(1.0 / damage)
    assert tables(known)[-1].rows[0][2] == number(float(f"{1.0 / damage[0]:.3g}"), 3)


def test_no_life_is_said_with_its_reason(result):
    assert {row[2] for row in tables(result)[-1].rows} == {"none: no capacity"}
    idle = with_bearings(result, lambda load: replace(load, rating_life=float("inf")))
    assert {row[-1] for row in tables(idle)[-2].rows} == {"unlimited"}
    part = RUN.figures(idle)["bearings"][0]
    assert (part["rating_life_hours"], part["rating_life"]) == (None, "unlimited")


def test_forces_within_rounding_are_zero(result):
    def axial(force):
        def changed(load):
            return replace(load, force=np.array([*load.force[:2], force, 0.0, 0.0]))

        return changed

    noisy, small = (with_bearings(result, axial(force)) for force in (6e-19, -1e-3))
    assert {row[4] for row in tables(noisy)[-2].rows} == {"0"}
    assert {row[5] for row in tables(noisy)[-1].rows} == {"0"}
    assert {float(row[4]) for row in tables(small)[-2].rows} == {-1e-3}


def test_displacements_within_rounding_are_zero(result):
    def clear(play):
        return lambda load: replace(load, clearance=np.full(5, play))

    noisy, small = (with_bearings(result, clear(play)) for play in (1e-19, 1e-12))
    assert {row[6] for row in tables(noisy)[-2].rows} == {"0"}
    assert {float(row[6]) for row in tables(small)[-2].rows} == {1.41e-6}


ROTOR = Path(__file__).parents[3] / "examples" / "jeffcott_scene.toml"
WEIGHT = 10.0 * 9.81


def test_a_rotor_under_its_weight_hangs_in_its_bearings(tmp_path):
    files = [tmp_path / f"rotor.{ending}" for ending in ("json", "png", "html")]
    for file in files:
        options = ["--set", "gravity_m_per_s2=[0.0, -9.81, 0.0]", "-o", str(file)]
        result = loa("deflect", ROTOR, *options)
        assert (result.exit_code, result.stderr) == (0, "")
    (case,) = json.loads(files[0].read_text("utf-8"))["load_cases"]
    assert [bearing["force_n"][1] for bearing in case["bearings"]] == pytest.approx([-0.5 * WEIGHT] * 2)
    html = files[2].read_text("utf-8")
    assert "The axes move by up to 49.1 µm." in html  # half of the weight on 1e6 N/m
    assert '"y, mm"' in html and '"x, mm"' not in html  # seen as it bends


def test_the_cost_of_a_verb_is_that_of_its_process_and_children(monkeypatch):
    monkeypatch.setattr("lineofaction.cli.run_study.cpu_seconds", lambda: 117.0)
    result = loa("deflect", ROTOR)
    assert [line for line in result.stdout.splitlines() if "CPU" in line] == ["cost 117 CPU s"]


def test_what_was_made_for_a_deflection_is_in_its_cost(tmp_path):
    scene = read_model(SceneInput, ROTOR)
    tabled = TabledScene(scene, {}, dynamic_scene(scene, {}), {}, seconds=57.5)
    inputs = Inputs.model_validate({"load_cases": [{"name": "own"}]})
    assert RUN.compute(tabled, inputs, Means(tmp_path, lambda *_: None)).seconds >= 57.5


def test_a_torque_in_a_scene_without_loads_is_refused_by_its_field():
    scene = read_model(SceneInput, ROTOR)
    inputs = Inputs.model_validate({"load_cases": [{"name": "own"}, {"name": "high", "torque_n_m": 5.0}]})
    with pytest.raises(BadInput) as refused:
        RUN.check(scene, inputs)
    (fault,) = refused.value.faults
    assert (fault.field, fault.value) == ("load_cases[1].torque_n_m", 5.0)
