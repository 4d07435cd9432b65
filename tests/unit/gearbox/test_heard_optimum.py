"""Flanks that are heard least in a scene: laws of levels, their derivatives and the search."""

import copy
from collections import Counter
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from small_inputs import small_inputs

from fe_contact import Limits
from fe_contact.microgeometry.design_problem import PENALTY
from fe_contact.microgeometry.linearized_table import tabled_loads
from fe_contact.microgeometry.scatter import ScatterNodes
from fe_contact.types import FloatArray
from host.directories import cache_home
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import change, optimize
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.change.question import flank_mesh
from lineofaction.gearbox.studies.change.sound_flanks import system_with
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.cost import Work
from lineofaction.gearbox.studies.optimize import Inputs
from lineofaction.gearbox.studies.optimize import sound_problem as sound_problem_module
from lineofaction.gearbox.studies.optimize.result import HeardOptimization
from lineofaction.gearbox.studies.optimize.run import RUN, request_of
from lineofaction.gearbox.studies.optimize.sound_problem import HeardMerit, HeardProblem, Powers
from lineofaction.gearbox.studies.optimize.sound_search import LINEARIZED, misalignments, sound_problem
from lineofaction.gearbox.units import RPM
from lineofaction.gearbox.workbench import tabled
from lineofaction.report.design.optimize import PAGE
from model_studies.spread import quantiles
from model_studies.workers import InProcess

Json = dict[str, Any]
HALF: Json = {"name": "half", "factor": 0.5}
HEARD: Json = {"speed_rpm": [300.0, 3000.0, 9000.0], "orders": 3, "load_cases": [HALF, {"name": "whole"}]}
FREE: Json = {
    "pinion": {"tip_relief_um": [0.0, 8.0], "profile_crowning_um": [0.0, 4.0]},
    "wheel": {"tip_relief_um": [0.0, 8.0]},
}
FEW: Json = {"evaluations": 60, "sample": 4, "trials": 1, "positions": 32}


def scene() -> Json:
    """A spur pair in the plane whose flanks are relieved a little."""
    own: Json = small_inputs("modes")["scene"]
    pair = own["meshes"][0]["case"]["pair"]
    for gear in ("pinion", "wheel"):
        pair[gear] = pair[gear] | {"tip_relief_um": 3.0, "tip_relief_length_mm": 0.4}
    return own


def inputs(**heard: Any) -> Json:
    return {"variables": FREE, "search": FEW, "heard": HEARD | heard}


def problem(**heard: Any) -> HeardProblem:
    study = Inputs.model_validate(inputs(**heard))
    subject = tabled(scene())
    mesh = flank_mesh(subject.inputs, None)
    assert mesh.case is not None and study.heard is not None
    request = request_of(mesh.case, study)
    loads = len(study.heard.load_cases)
    means = Means(cache_home(), lambda _stage, _part: None)
    return sound_problem(subject, mesh, study.heard, request, np.zeros(loads), means).problem


DESIGN = {"pinion.tip_relief": 5e-6, "pinion.profile_crowning": 1.5e-6, "wheel.tip_relief": 3.5e-6}


@cache
def problems() -> tuple[HeardProblem, HeardProblem]:
    return problem(over_speeds="energy_mean", over_loads="energy_mean"), problem()


@pytest.mark.law
def test_a_design_is_as_loud_as_its_table_in_a_scene_assembled_anew():
    own = problems()[0]
    tabled_at = own.tables_of(list(tabled_loads(own.evaluator, DESIGN, (0,))))
    subject = tabled(scene())
    for at, each in zip(own.sound.at, tabled_at, strict=True):
        whole = at.case.transfer.excitation(system_with(subject, "mesh", each.table, at.case.load))
        power = at.case.form.weighted(at.case.transfer.inputs(whole)) @ at.counted
        np.testing.assert_allclose(at.power(each.table), power, rtol=1e-7)


def place(own: HeardProblem) -> FloatArray:
    return own.unit_point(tuple(DESIGN[name] for name in own.names))


def level(own: HeardProblem, values: dict[str, float]) -> float:
    return own.evaluated(values)[0]


@pytest.mark.law
def test_the_derivative_of_a_level_is_that_of_solved_contacts():
    """Of the power over speeds and loads, central differences of 20 nm: no contact changes on the way."""
    own = replace(problems()[0], scale=level(problems()[0], DESIGN))
    assessed, merit = own.linearize(place(own), InProcess())
    assert assessed.objective == pytest.approx(own.scale, abs=1e-9)
    (slope,) = merit.powers.slope / own.ranges * 10.0 / np.log(10.0)  # dB/m about the start
    step, differences = 2e-8, []
    for name in own.names:
        value = DESIGN[name]
        above, below = (level(own, DESIGN | {name: value + side * step}) for side in (1.0, -1.0))
        differences.append((above - below) / (2.0 * step))
    np.testing.assert_allclose(slope, differences, atol=1e-4 * np.abs(differences).max())


def test_moved_tables_made_at_once_are_those_made_one_by_one():
    own = problems()[0]
    tabled_at = list(tabled_loads(own.evaluator, DESIGN, (0,), own.names))[-1]
    steps = 1e-9 * np.eye(len(own.names))
    for step, moved in zip(steps, tabled_at.force_tables(steps), strict=True):
        changes = {
            name: getattr(tabled_at.table, name) + np.tensordot(step, by, 1)[..., None, None]
            for name, by in tabled_at.by.items()
        }
        alone = replace(tabled_at.table, **changes).force_table()
        for name in ("level", "misalignment", "deflection", "stiffness", "stiffness_slope", "load_arm"):
            np.testing.assert_allclose(getattr(moved, name), getattr(alone, name), rtol=1e-12, err_msg=name)


def test_a_mean_over_loads_or_speeds_is_no_louder_than_the_worst():
    means, worst = level(problems()[0], DESIGN), level(problems()[1], DESIGN)
    assert means < worst


def searched(question: Json, subject: Json | None = None) -> HeardOptimization:
    result = optimize(subject or scene(), question)
    assert isinstance(result, HeardOptimization)
    return result


@cache
def found() -> HeardOptimization:
    return searched(inputs())


def test_the_optimum_is_no_louder_than_the_start_and_stays_in_its_bounds():
    own = found()
    assert own.outcome == "improved" and own.gain.value > own.gain.error
    assert own.optimum.objective.value < own.start.objective.value
    for variable in own.variables:
        assert variable.low <= own.optimum.values[variable.name] <= variable.high


def test_start_and_optimum_are_as_loud_as_a_comparison_of_their_flanks_says():
    """The study of a change takes tables of all loads of the case, not of those that are heard."""
    own = found()
    case = copy.deepcopy(scene()["meshes"][0]["case"])
    for name, value in own.optimum.values.items():
        gear, quantity = name.split(".")
        case["pair"][gear][f"{quantity}_um"] = 1e6 * value
    compared = change(scene(), {"after": case, "tolerances": {"samples": 2}, **HEARD})
    for design, side in ((own.start, compared.before), (own.optimum, compared.after)):
        loud = side.nominal > side.nominal.max() - 25.0
        np.testing.assert_allclose(design.level[loud], side.nominal[loud], atol=0.2)


def predicted(**heard: Any) -> dict[str, list[Work]]:
    question = inputs(**heard)
    subject = SceneInput.model_validate(scene())
    cost = RUN.predicted(subject, Inputs.model_validate(question), None)
    return {part.name: [own for own in cost.parts if own.name == part.name] for part in cost.parts}


@pytest.mark.law
def test_a_usual_search_takes_the_contacts_that_are_predicted(monkeypatch):
    """Counted at few positions and at all, a design with its slopes as often as it costs; within 2."""
    solved: Counter[int] = Counter()

    def counted(evaluator, values, nodes, *slopes):
        solved[evaluator.position.size] += LINEARIZED if slopes else 1.0
        return tabled_loads(evaluator, values, nodes, *slopes)

    monkeypatch.setattr(sound_problem_module, "tabled_loads", counted)
    searched(inputs())
    few, full = predicted()["designs"]
    (pairs,) = predicted()["pairs"]
    assert solved[16] / 2.0 < few.pieces + pairs.pieces < 2.0 * solved[16]
    assert solved[FEW["positions"]] / 2.0 < full.pieces < 2.0 * solved[FEW["positions"]]


def test_a_prediction_grows_with_speeds_orders_loads_and_pairs():
    own = predicted()
    speeds = list(np.linspace(300.0, 9000.0, 30))
    (few,), (many,), (high,) = (
        predicted(**heard)["transfer functions"] for heard in ({}, {"speed_rpm": speeds}, {"orders": 9})
    )
    assert many.seconds == pytest.approx(10.0 * few.seconds)
    assert high.seconds == pytest.approx(3.0 * few.seconds)
    one_load = predicted(load_cases=[HALF])
    assert one_load["designs"][1].seconds == pytest.approx(0.5 * own["designs"][1].seconds)
    spread = predicted(quantile=0.75, tolerances={"samples": 8})
    assert spread["designs"][1].pieces == 8 * own["designs"][1].pieces
    assert spread["pairs"][0].pieces == 16


def test_limits_are_held_or_said_to_be_exceeded():
    before = found().start.pressure.max() / 1e6
    asked = inputs() | {"limits": {"max_pressure_mpa": 1.002 * before, "edge_load_share": 0.05}}
    own = searched(asked)
    assert own.outcome != "limits_exceeded"
    assert own.optimum.pressure.max() / 1e6 <= 1.002 * before * (1.0 + 1e-3)
    free = found().optimum.objective
    assert free.value <= own.optimum.objective.value + 0.1  # a limit makes nothing quieter


@pytest.mark.law
def test_a_pair_within_tolerances_is_as_loud_as_its_flanks():
    """At the same position in the sample as a design whose amounts are those of the pair."""
    own = replace(problems()[1], quantile=0.75)
    deviation = 1e-6 * np.array([[0.0], [0.4], [-0.3], [1.0]])
    nodes = ScatterNodes(("pinion.tip_relief",), deviation, np.full(4, 0.25))
    pairs = replace(own, evaluator=replace(own.evaluator, nodes=nodes))
    made = [DESIGN | {"pinion.tip_relief": DESIGN["pinion.tip_relief"] + each} for each in deviation[:, 0]]
    levels = [level(own, each) for each in made]
    np.testing.assert_allclose(pairs.levels(DESIGN, InProcess()), levels, atol=1e-6)
    assert pairs.evaluated(DESIGN)[0] == pytest.approx(float(quantiles(np.array(levels), 0.75)))
    scaled = replace(pairs, scale=pairs.evaluated(DESIGN)[0])
    assessed, merit = scaled.linearize(place(pairs), InProcess())
    assert assessed.objective == pytest.approx(scaled.scale)
    assert merit.amplitudes(np.zeros(3)).max() == pytest.approx(1.0)  # of the start, as of every objective


def test_the_flanks_are_told_within_the_tolerance_class():
    own = found()
    assert own.pairs.shape == (2, 32) and "Within class 6: " in own.within_tolerances()
    low, median, high = own.bands[2]
    assert low <= median <= high and own.bands[0, 1] == np.median(own.pairs[0])
    same = replace(own, pairs=np.stack([own.pairs[0], own.pairs[0]]))
    assert not same.bands[2].any() and same.louder_share == 0.0
    assert not replace(own, pairs=np.zeros((2, 0))).within_tolerances()


def test_a_quantile_of_the_pairs_is_minimized():
    """Of those that are told: the same sample at as many positions, so no pair of it is left out."""
    few: Json = {"search": FEW | {"positions": 16}, "heard": HEARD | {"load_cases": [{"name": "whole"}]}}
    few["heard"] |= {"tolerances": {"samples": 8, "tolerance_class": 4}, "orders": 1}
    own = searched({"variables": FREE, **few, "heard": few["heard"] | {"quantile": 0.75}})
    levels = quantiles(own.pairs.T, 0.75)
    ends = own.start.objective.value, own.optimum.objective.value
    np.testing.assert_allclose(levels, ends, atol=1e-6)
    assert levels[1] < levels[0]


@pytest.mark.law
def test_scatter_of_hardly_anything_is_as_loud_as_the_table():
    """Solved at few positions the quiet optimum was louder or quieter by some dB."""
    few: Json = {"search": FEW | {"positions": 8}, "heard": HEARD | {"load_cases": [{"name": "whole"}]}}
    own = searched({"variables": FREE, **few, "scatter": {"pinion": {"tip_relief_um": 1e-4}}})
    for design in (own.start, own.optimum):
        assert design.objective.value == pytest.approx(design.level[0, 0], abs=0.01)
        assert design.objective.error < 0.5


def test_the_level_that_is_stated_is_that_of_all_orders_in_the_table():
    """Whatever the positions of the search: 8 of them alone are off by more than a decibel."""
    few: Json = {"search": FEW | {"positions": 8}, "heard": HEARD | {"load_cases": [{"name": "whole"}]}}
    own = searched({"variables": FREE, **few})
    for design in (own.start, own.optimum):
        assert design.objective.value == pytest.approx(design.level[0, 0], abs=1e-9)


def test_levels_before_and_after_name_their_speeds_and_loads():
    own = found()
    before, after, _ = PAGE.page(own).headlines
    assert before.remark == after.remark
    speeds, loads = own.speed / RPM, own.torque
    assert f"from {speeds.min():.4g} to {speeds.max():.4g} rpm" in before.remark
    ends = {f"{torque:.4g}" for torque in (loads.min(), loads.max())}
    assert ends <= set(before.remark.split()) and before.remark.endswith("N m")


def test_a_mesh_that_states_its_misalignment_is_heard_at_it():
    """It would be deflected twice: the misalignment stated is part of what a deflection finds."""
    study, subject = Inputs.model_validate(inputs()), tabled(scene())
    mesh = flank_mesh(subject.inputs, None)
    assert study.heard is not None
    table = subject.databases["mesh"]
    receipt = table.metadata.receipt
    facts = replace(table.metadata, receipt=receipt | {"plan": receipt["plan"] | {"model": "3d"}})
    across = {"mesh": replace(table, metadata=facts)}
    stated = replace(subject.scene, meshes=(replace(subject.scene.meshes[0], misalignment=4e-6),))
    means = Means(cache_home(), lambda _stage, _part: None)
    own = misalignments(replace(subject, scene=stated, databases=across), mesh, study.heard, means)
    np.testing.assert_array_equal(own, [4e-6, 4e-6])


@pytest.mark.parametrize(
    "heard",
    [{"quantity": "surface_velocity"}, {"microphone_mm": [10.0, 10.0, 400.0]}],
    ids=["velocity", "pressure"],
)
def test_velocity_and_pressure_are_heard_as_the_comparison_has_them(heard):
    """And all orders together follow from the orders, so that the right lines are counted."""
    sounding: Json = small_inputs("noise")["scene"]
    sounding["meshes"][0]["case"] = scene()["meshes"][0]["case"]
    few: Json = {"evaluations": 8, "sample": 4, "trials": 1, "positions": 32}
    asked: Json = {"speed_rpm": [300.0, 3000.0], "orders": 2}
    own = searched({"variables": FREE, "search": few, "heard": asked | heard}, sounding)
    after = copy.deepcopy(sounding["meshes"][0]["case"])
    for name, value in own.optimum.values.items():
        gear, quantity = name.split(".")
        after["pair"][gear][f"{quantity}_um"] = 1e6 * value
    compared = change(sounding, {"after": after, "tolerances": {"samples": 2}, "heard": heard, **asked})
    assert own.quantity == compared.quantity and own.unit == compared.unit
    for design, side in ((own.start, compared.before), (own.optimum, compared.after)):
        loud = side.nominal > side.nominal.max() - 25.0
        np.testing.assert_allclose(design.level[loud], side.nominal[loud], atol=0.3)


def test_levels_are_drawn_as_bars_with_their_errors_from_a_floor_below_all():
    result = found()
    for load, panel in enumerate(PAGE.figure(result).content):
        before, first, after, second = panel.bars
        assert [own.name for own in panel.bars] == ["before", "error", "after", "error"]
        drawn = (before, first, result.start), (after, second, result.optimum)
        for bar, error, design in drawn:
            level, band = design.level[load], design.level_error[load]
            assert np.array_equal(bar.top, level) and bar.base < (level - band).min()
            np.testing.assert_allclose([error.base, error.top], [level - band, level + band])
        assert panel.x.names[0] == (0.0, "all") and len(panel.x.names) == len(result.lines)
        assert before.x[0] + 0.5 * before.width == pytest.approx(after.x[0] - 0.5 * after.width)


def test_the_design_is_told_in_the_unit_of_its_names():
    (table,) = (part for part in PAGE.text(found()) if getattr(part, "caption", "") == "Design")
    for name, start, optimum, least, most in table.rows:
        assert name.endswith("_um") and 0.0 == float(least) <= float(optimum) <= float(most) in (4.0, 8.0)
        assert float(start) == pytest.approx(0.0 if "crowning" in name else 3.0)


def test_what_gets_worse_is_said_first():
    own = found()
    louder = replace(own, start=own.optimum, optimum=own.start)
    assert "Gets worse: all orders" in louder.costs() and louder.outcome == "not_improved"
    assert replace(own, optimum=own.start).costs() == "Nothing gets worse beyond its error."


@pytest.mark.parametrize(
    ("question", "field"),
    [
        ({}, "heard"),
        ({"heard": HEARD, "torque_n_m": [1.0]}, "torque_n_m"),
        ({"heard": HEARD | {"quantile": 0.9}, "scatter": {"misalignment_um": 1.0}}, "scatter"),
        ({"heard": HEARD | {"mesh": "second"}}, "heard.mesh"),
        ({"heard": HEARD | {"quantity": "sound_power"}}, "housings"),
        ({"heard": HEARD | {"microphone_mm": [0.0, 0.0, 1000.0]}}, "housings"),
        ({"heard": HEARD | {"bearing": "output in"}}, "heard.bearing"),
        ({"heard": HEARD | {"load_cases": [{"name": "back", "direction": "coast"}]}}, "direction"),
        ({"heard": HEARD, "variables": {"pinion": {"helix_crowning_um": [0.0, 9.0]}}}, "helix_crowning_um"),
    ],
)
def test_a_scene_without_what_is_heard_is_refused_by_its_field(question, field):
    def predicted():
        return RUN.predicted(SceneInput.model_validate(scene()), validated(Inputs, question), None)

    for refused in (lambda: optimize(scene(), question), predicted):
        with pytest.raises(BadInput) as caught:
            refused()
        assert any(field in fault.field for fault in caught.value.faults)


def bowl(sizes: tuple[int, int], seed: int) -> HeardMerit:
    """Rows of powers |a + B x|^2 with random a and B."""
    rows, count = sizes
    random = np.random.default_rng(seed)
    a, b = random.normal(size=(rows, 3)), random.normal(size=(rows, 3, count))
    slope, bend = 2.0 * np.einsum("rk,rkd->rd", a, b), np.einsum("rkd,rke->rde", b, b)
    limit = random.normal(size=(4,)) - 1.0, random.normal(size=(4, count))
    return HeardMerit(Powers((a * a).sum(axis=1), slope, bend), (limit,), PENALTY)


def merit_at(merit: HeardMerit, step: FloatArray) -> float:
    ((value, by),) = merit.limits
    return float(merit.amplitudes(step).max()) + merit.penalty * max(0.0, float((value + by @ step).max()))


@pytest.mark.parametrize("sizes", [(1, 2), (5, 3), (40, 4)])
@pytest.mark.parametrize("seed", [0, 1])
def test_no_step_of_many_has_less_merit_than_the_least(sizes, seed):
    merit, reach = bowl(sizes, seed), np.full(sizes[1], 0.4)
    step, promised = merit.minimum(-reach, reach)
    assert promised == pytest.approx(merit_at(merit, step))
    trials = np.random.default_rng(9).uniform(-0.4, 0.4, (20_000, sizes[1]))
    assert promised <= min(merit_at(merit, trial) for trial in trials) * (1.0 + 2e-3)


def test_a_limit_of_pressure_is_a_row_of_the_merit():
    own = replace(problems()[0], limits=Limits(max_pressure=1e9), scale=level(problems()[0], DESIGN))
    _, merit = own.linearize(place(own), InProcess())
    ((value, by),) = merit.limits
    assert by.shape == (value.size, len(DESIGN))


@pytest.mark.law
def test_a_limit_of_ripple_is_rows_of_the_merit_with_their_slopes():
    """The largest row is the peak-to-peak of the worst load, and moves as that of solved contacts does."""
    own = replace(problems()[0], limits=Limits(peak_to_peak=2e-7), scale=level(problems()[0], DESIGN))

    def ripple(values):
        return float(own.evaluator.evaluate(values).peak_to_peak.max())

    assessed, merit = own.linearize(place(own), InProcess())
    ((value, by),) = merit.limits
    assert value.max() == pytest.approx(ripple(DESIGN) / 2e-7 - 1.0)
    assert assessed.violation == pytest.approx(max(0.0, value.max()))
    step, row = 1e-8, by[value.argmax()] / own.ranges * 2e-7
    for name, slope in zip(own.names, row, strict=True):
        above, below = (ripple(DESIGN | {name: DESIGN[name] + side * step}) for side in (1.0, -1.0))
        assert slope == pytest.approx((above - below) / (2.0 * step), abs=2e-3)


def test_a_search_that_is_cancelled_tells_its_best_without_the_pairs():
    own = RUN.compute(
        tabled(scene()),
        Inputs.model_validate(inputs()),
        Means(cache_home(), lambda _stage, _part: None, cancel=lambda: True),
    )
    assert isinstance(own, HeardOptimization)
    assert own.pairs.shape == (2, 0) and not own.within_tolerances()
    assert own.optimum.objective.value == own.start.objective.value and "interrupted" in own.ended()
