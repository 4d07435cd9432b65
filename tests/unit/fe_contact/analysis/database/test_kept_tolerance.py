"""A tolerance is kept: plan, run, measure, refine what dominates, and say why it ends."""

import dataclasses
import math

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import AllowedError, Gear, GearPair, SteDatabase, analyze
from fe_contact.analysis.database import refined_table
from fe_contact.analysis.database.compute_database import compute_database, compute_pass
from fe_contact.analysis.estimates import validation_loads
from fe_contact.analysis.pairs import solved_contact
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact.sweep import solve_sets
from fe_contact.errors import MeshError, SolveError
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.planning import model_error
from fe_contact.ste.fields import DIMENSIONS

SPUR = GearPair(*[Gear(20, 2e-3, 12e-3, 20e-3)] * 2, 40e-3)
PLANE = {"torques": [2.0, 5.0], "model": "plane_strain"}
"""At low loads, where the mesh is most of the error."""


@pytest.fixture(autouse=True)
def nothing_but_discretization(monkeypatch):
    """No refinement mends what the method and plane strain leave out: it would end every run here."""
    none = (0.0, 0.0, 0.0)
    monkeypatch.setattr(model_error, "FLOOR", none)
    for name in ("LARGE_DISPLACEMENT", "TILT"):
        monkeypatch.setattr(model_error, name, {False: none, True: none})


@pytest.fixture
def from_draft(monkeypatch):
    """Begin with the draft, whatever is expected of it: what follows is about what is measured."""

    def drafted(checked, cache=None, **_):
        first = decide(checked, cache)
        return first.refined("draft", first.mesh.slices, first.plan.nodes, "the coarsest")

    monkeypatch.setattr(refined_table, "decide", drafted)


def receipt(table: SteDatabase) -> dict:
    return table.metadata.receipt


def same(one: SteDatabase, other: SteDatabase) -> bool:
    """Whether all arrays agree to the last bit."""
    names = [*DIMENSIONS, "error_estimate", "curve_error"]
    return all(
        np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True)
        for name in dict.fromkeys(names)
    )


def test_a_loose_tolerance_runs_one_pass_and_gives_the_table_of_its_level():
    asked = PLANE | {"effects": {"corner_contact": "on"}}  # else the tolerance neglects it
    table = analyze(SPUR, tolerance=AllowedError(0.5, 0.0), **asked)
    (only,) = receipt(table)["passes"]
    assert (only["refined"], only["kept"]) == ([], True)
    assert receipt(table)["tolerance"]["reason"] == "met"
    assert same(table, analyze(SPUR, level=only["level"], **asked))


def test_a_tight_one_refines_until_it_is_met(from_draft, tmp_path):
    drafts: list[tuple[SteDatabase, str]] = []
    tight = AllowedError(0.001, 0.0)
    table = analyze(
        SPUR, tolerance=tight, **PLANE, cache=tmp_path, on_draft=lambda t, words: drafts.append((t, words))
    )
    passes = receipt(table)["passes"]
    assert receipt(table)["tolerance"]["met"] is True
    assert [one["level"] for one in passes] == ["draft", "standard"]
    assert passes[1]["refined"] == ["mesh draft -> standard"]
    assert "discretization takes" in passes[1]["because"]
    assert [one["kept"] for one in passes] == [False, True]
    ((draft, words),) = drafts
    assert words == "mesh draft -> standard"
    assert receipt(draft)["tolerance"]["used"] == passes[0]["used"] > 1.0
    exact = decide(check_request(SPUR, *table_request(tolerance=tight, **PLANE))).refined(
        "standard", 1, table_nodes(tight), "as refined"
    )
    assert same(table, compute_database(exact.checked, {}, Run(cache=tmp_path), exact))


def test_what_a_pass_uses_at_nodes_compares_with_what_was_expected(tmp_path):
    """Loads are inserted until errors between them fill what is left: those are in `used` alone."""
    torques = [20.0, 60.0, 200.0]
    table = analyze(SPUR, **PLANE | {"torques": torques}, tolerance=0.01, cache=tmp_path)
    (only,) = receipt(table)["passes"]
    tolerance = receipt(table)["tolerance"]
    assert (only["used"], only["used_at_nodes"]) == (tolerance["used"], tolerance["used_at_nodes"])
    assert only["used_at_nodes"] < 0.6 * only["used"] < 0.6
    assert 1.0 / 3.0 < only["expected_used"] / only["used_at_nodes"] < 3.0


def table_nodes(allowed: AllowedError):
    return decide(check_request(SPUR, *table_request(tolerance=allowed, **PLANE))).plan.nodes


@pytest.mark.law
@pytest.mark.parametrize("tolerance", [0.002, 0.001, pytest.param(0.0005, marks=pytest.mark.nightly), 0.0001])
def test_what_is_used_falls_from_pass_to_pass_and_met_is_what_the_table_states(
    from_draft, tolerance, tmp_path
):
    allowed = AllowedError(tolerance, 0.0)
    table = analyze(SPUR, tolerance=allowed, **PLANE, cache=tmp_path)
    used = [one["used"] for one in receipt(table)["passes"]]
    assert used == sorted(used, reverse=True)
    assert len(set(used)) == len(used) <= refined_table.MAX_PASSES
    stated = [
        getattr(table, name)(torque=torque)
        for torque in PLANE["torques"]
        for name in ("mean", "peak_to_peak")
    ]
    worst = max(one.error / float(allowed.of(np.array(one.value))) for one in stated)
    assert receipt(table)["tolerance"]["used_at_nodes"] == pytest.approx(worst, rel=1e-3)
    assert receipt(table)["tolerance"]["met"] is (worst <= 1.0)
    assert (receipt(table)["tolerance"]["reason"] == "met") is (worst <= 1.0)


def test_a_small_helical_draft_is_refined(from_draft):
    gear = Gear(18, 2e-3, 12e-3, 20e-3, helix_angle=0.3)
    pair = GearPair(gear, dataclasses.replace(gear, helix_angle=-0.3), 36e-3 / math.cos(0.3))
    table = analyze(pair, torques=[50.0], tolerance=AllowedError(0.015, 0.0), positions=32)
    first, second = receipt(table)["passes"]
    assert first["level"] == "draft"
    assert second["level"] == "standard"
    assert second["refined"] == ["mesh draft -> standard", "slices 12 -> 15"]
    assert second["used"] < 1.0 < first["used"]
    assert receipt(table)["tolerance"]["met"] is True


@pytest.mark.law
def test_a_time_budget_ends_refinement_and_keeps_what_is_there(from_draft):
    """The draft is kept, its tolerance is not met, and the reason names the refinement and its time."""
    asked = PLANE | {"tolerance": AllowedError(0.001, 0.0)}
    table = analyze(SPUR, time_budget=1e-3, **asked)
    assert receipt(table)["tolerance"]["met"] is False
    assert [one["level"] for one in receipt(table)["passes"]] == ["draft"]
    assert "mesh draft -> standard is predicted to take" in receipt(table)["tolerance"]["reason"]
    assert "of 0.001 are left" in receipt(table)["tolerance"]["reason"]


def test_the_first_pass_is_the_most_exact_that_fits_into_the_time():
    asked = {"torques": [50.0], "model": "3d", "tolerance": AllowedError(0.002, 0.0)}
    free = decide(check_request(SPUR, *table_request(**asked)))
    draft = decide(check_request(SPUR, TableAxes(torques=[50.0]), AnalysisOptions(model="3d", level="draft")))
    between = math.sqrt(free.predicted(None).cpu_seconds * draft.predicted(None).cpu_seconds)
    bound = decide(check_request(SPUR, *table_request(time_budget=between, **asked)))
    assert free.mesh.level != "draft"
    assert (bound.mesh.met, bound.predicted(None).cpu_seconds <= between) == (False, True)
    assert f"{free.mesh.option.name} is predicted to take" in bound.mesh.reason
    assert bound.checked.request.options.tolerance == asked["tolerance"]


def test_refining_is_deterministic_and_its_cost_that_of_all_passes(from_draft):
    """With and without a time budget that is not used up, and however long it takes."""
    asked = PLANE | {"tolerance": AllowedError(0.001, 0.0)}
    one, other = (analyze(SPUR, **asked, **bound) for bound in ({}, {"time_budget": 1e5}))
    assert same(one, other)
    passes, cost = receipt(one)["passes"], receipt(one)
    assert len(passes) == 2 and all(each["cpu_seconds"] > 0.0 for each in passes)
    stages = sum(stage["cpu_seconds"] for stage in cost["stages"].values())
    assert cost["cpu_seconds"] == pytest.approx(sum(each["cpu_seconds"] for each in passes))
    assert cost["cpu_seconds"] == pytest.approx(stages)
    told = [[dict(p, cpu_seconds=0.0) for p in receipt(table)["passes"]] for table in (one, other)]
    assert told[0] == told[1]


def test_passes_share_condensed_bodies(from_draft, monkeypatch):
    """Positions that are searched more closely need no new bodies, without a cache either.

    The prediction is that of all passes, each before it began, as the cost is that of all.
    """
    computed: list[list[str]] = []
    predicted: list[float] = []

    def counted(checked, case, run, decision, clock):
        done = compute_pass(checked, case, run, decision, clock)
        computed.append(sorted(file.name for file in run.cache.glob("compliance-*")))
        predicted.append(receipt(done.table)["prediction"]["cpu_seconds"])
        return done

    monkeypatch.setattr(refined_table, "compute_pass", counted)
    refine_positions(monkeypatch)
    table = analyze(SPUR, tolerance=AllowedError(0.001, 0.0), **PLANE)
    assert len(computed) > 1
    assert all(names == computed[0] != [] for names in computed)
    prediction = receipt(table)["prediction"]
    assert prediction["cpu_seconds"] == pytest.approx(sum(predicted)) == sum(prediction["stages"].values())


def refine_positions(monkeypatch) -> None:
    """Let the next pass search its positions more closely, whatever dominates."""

    def closer(decision, _shares):
        plan = decision.plan
        finer = decision.refined("draft", 1, dataclasses.replace(plan.nodes, tolerance=1e-4), "closer")
        return refined_table.Refinement(finer, "position", ("positions",), 0.5)

    monkeypatch.setattr(refined_table, "next_pass", closer)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (SolveError("no convergence"), "no convergence"),
        (MeshError("no acceptable mesh"), "no acceptable mesh"),
        (MemoryError(), "out of memory"),
        (KeyboardInterrupt(), "interrupted"),
    ],
)
def test_a_pass_that_fails_or_is_interrupted_keeps_the_table_before_it(from_draft, monkeypatch, error, said):
    fail_from(monkeypatch, 2, error)
    drafts: list[SteDatabase] = []
    allowed = AllowedError(0.001, 0.0)
    table = analyze(SPUR, tolerance=allowed, **PLANE, on_draft=lambda draft, _: drafts.append(draft))
    first, second = receipt(table)["passes"]
    assert (first["level"], first["kept"], second["kept"]) == ("draft", True, False)
    assert second["failure"] == said
    assert receipt(table)["tolerance"]["met"] is False
    assert receipt(table)["tolerance"]["reason"].endswith(f"failed: {said}")
    assert "pass 2" in receipt(table)["tolerance"]["reason"]
    assert same(table, drafts[0])


def fail_from(monkeypatch, number: int, error: BaseException) -> None:
    begun: list[int] = []

    def failing(*arguments, **more):
        begun.append(1)
        if len(begun) >= number:
            raise error
        return compute_pass(*arguments, **more)

    monkeypatch.setattr(refined_table, "compute_pass", failing)


def test_the_first_pass_may_fail_as_ever(monkeypatch):
    fail_from(monkeypatch, 1, SolveError("no convergence"))
    with pytest.raises(SolveError, match="no convergence"):
        analyze(SPUR, tolerance=0.01, **PLANE)


def test_a_pass_that_does_not_lower_the_errors_ends_the_search(from_draft, monkeypatch):
    refine_positions(monkeypatch)  # fixed ones, so that nothing changes
    table = analyze(SPUR, tolerance=AllowedError(0.001, 0.0), **PLANE, positions=64)
    first, second = receipt(table)["passes"]
    assert first["used"] == second["used"]
    assert (first["kept"], second["kept"]) == (True, False)
    assert "did not lower the measured errors" in receipt(table)["tolerance"]["reason"]


def test_a_level_or_a_minimal_receipt_refines_nothing():
    for asked in ({"level": "draft"}, {"tolerance": AllowedError(0.001, 0.0), "receipt": "minimal"}):
        assert "passes" not in receipt(analyze(SPUR, **asked, **PLANE))


@pytest.mark.law
def test_loads_are_inserted_until_every_interval_meets_the_tolerance(tmp_path):
    """Those that were requested stay the axis; the others are support loads between them."""
    wide = analyze(SPUR, tolerance=0.01, **(PLANE | {"torques": [16.0, 80.0]}), cache=tmp_path)
    kept = receipt(wide)["tolerance"]
    assert wide.torque == pytest.approx([16.0, 80.0])
    assert wide.inserted_force.size >= 1
    assert wide.inserted_force.tolist() == receipt(wide)["held_out"]["force"]["inserted"]
    assert f"{wide.inserted_force.size} loads inserted" in wide.summary()
    assert (kept["met"], kept["between_nodes"]) == (True, [])
    assert kept["used_at_nodes"] < kept["used"] <= 1.0
    # What is said of the interval holds where nothing was solved, by a table that is solved there.
    for torque in (20.0, 34.0, 47.0, 66.0):
        truth = analyze(SPUR, tolerance=0.01, **(PLANE | {"torques": [torque, 80.0]}), cache=tmp_path)
        for ours, true in zip(figures_at(wide, torque), figures_at(truth, torque), strict=True):
            assert abs(ours.value - true.value) <= min(ours.error, max(0.01 * true.value, 20e-9))


def figures_at(table, torque):
    return table.mean(torque=torque), table.peak_to_peak(torque=torque)


def test_an_interval_that_misses_the_tolerance_is_not_met(tmp_path, monkeypatch):
    """Without a limit on halvings it would be: met is said of the intervals, too."""
    monkeypatch.setattr(validation_loads, "MAX_HALVINGS", 0)
    wide = analyze(SPUR, tolerance=0.01, **(PLANE | {"torques": [1.0, 80.0]}), cache=tmp_path)
    kept = receipt(wide)["tolerance"]
    (beyond,) = kept["between_nodes"]
    assert beyond["axis"] == "force"
    assert beyond["between"] == wide.force.tolist()
    assert kept["used"] >= beyond["used"] > 1.0 >= kept["used_at_nodes"]
    assert kept["met"] is False
    assert kept["reason"].startswith("between force")
    dense = analyze(SPUR, tolerance=0.01, **(PLANE | {"torques": [40.0, 41.0]}), cache=tmp_path)
    assert receipt(dense)["tolerance"]["between_nodes"] == []


def test_a_level_inserts_nothing(tmp_path):
    table = analyze(SPUR, level="draft", **(PLANE | {"torques": [16.0, 80.0]}), cache=tmp_path)
    assert table.inserted_force.size == 0
    assert table.interval_error[0, 0, 0, 0] > 0.0


def test_what_the_method_leaves_out_stands_beside_a_tolerance_and_buys_no_mesh(monkeypatch):
    """Below what full contact has proved, meshes are taken for their own errors."""
    allowed = AllowedError(0.0005, 0.0)
    kept = {}
    for name in ("without", "with"):
        kept[name] = receipt(analyze(SPUR, tolerance=allowed, **PLANE))
        monkeypatch.undo()
    first, second = kept["without"]["tolerance"], kept["with"]["tolerance"]
    assert (first["used"], first["met"]) == (second["used"], second["met"])
    assert second["lasting"] > first["lasting"] and second["lasting"] > allowed.relative
    levels = [[one["level"] for one in each["passes"]] for each in kept.values()]
    assert levels[0] == levels[1]


@pytest.mark.usefixtures("from_draft")
def test_points_that_the_draft_does_not_solve_are_solved_on_the_next_mesh(monkeypatch):
    """A compliance that is not definite at one position of the bodies that come first."""
    drafts: set[float] = set()

    def damaging_the_draft(problem, sets):
        softest = float(problem.compliance.max())
        drafts.update([] if drafts else [softest])
        if softest not in drafts:
            return solve_sets(problem, sets)
        compliance = problem.compliance.copy()
        compliance[problem.candidates.position == 0.25] *= -1.0
        return solve_sets(dataclasses.replace(problem, compliance=compliance), sets)

    monkeypatch.setattr(solved_contact, "solve_sets", damaging_the_draft)
    asked = PLANE | {"positions": 32}
    assert analyze(SPUR, level="draft", **asked).n_failed > 0
    table = analyze(SPUR, tolerance=AllowedError(0.02, 0.0), **asked)
    first, *others = receipt(table)["passes"]
    assert table.n_failed == 0
    assert first["level"] == "draft" and first["used"] is None
    assert others[0]["because"].endswith("points had no solution")
    assert receipt(table)["tolerance"]["met"]
