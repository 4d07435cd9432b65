"""A study of scenes: its figures are those of single runs, whoever does them and whatever fails."""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from geared_scenes import (
    BASE_RADIUS,
    gear_pair_scene,
    spring_table,
    square_wave_table,
    with_bushings,
    with_mesh,
)

from dynamics import RunResult, Scene, TimeLaw, simulate
from dynamics.errors import InputError, SolveError
from dynamics.study import (
    Design,
    Levels,
    Listed,
    Normal,
    Response,
    Study,
    StudyTask,
    Uniform,
    keep_runs,
    responses_of,
    study,
    with_effects,
)
from model_studies import LeftOut
from model_studies.workers import ByExecutor, Remembering

RESPONSES = (
    Response("bearing_force", "input.left", order=1),
    Response("dte_rms"),
    Response("dte_peak_to_peak"),
    Response("dte_order", order=2),
    Response("peak_mesh_force", "mesh"),
    Response("dynamic_factor"),
    Response("contact_loss"),
)
TABLE = square_wave_table()
TORQUE, SPEED = "torque", "speed"


@dataclass(frozen=True)
class Pairs:
    """Pairs at a torque (N m) and a speed (rad/s); there is none at a torque below zero."""

    duration: float = 0.02

    def scene(self, values: Mapping[str, float]) -> Scene:
        if values[TORQUE] < 0.0:
            raise LeftOut(f"no pair at {values[TORQUE]:g} N m")
        speed = TimeLaw.constant(values.get(SPEED, 90.0))
        return gear_pair_scene(torque=values[TORQUE], speed=speed, duration=self.duration)

    def expensive(self, values: Mapping[str, float]) -> Mapping[str, float]:
        return {}


@dataclass(frozen=True)
class Springs:
    """Pairs whose teeth are one spring without error: the mesh force is the torque over the base radius."""

    def scene(self, values: Mapping[str, float]) -> Scene:
        return gear_pair_scene(spring_table(4e8), torque=values[TORQUE], duration=0.002)

    def expensive(self, values: Mapping[str, float]) -> Mapping[str, float]:
        return {}


def task(design: Design, scenes: Any = Pairs(), responses: Any = RESPONSES, **further: Any) -> StudyTask:
    return StudyTask(scenes, design.names, responses, **further)


GRID = Design({TORQUE: Levels((50.0, 100.0, 150.0)), SPEED: Levels((60.0, 90.0))})


@pytest.fixture(scope="module")
def found():
    return study(task(GRID), GRID, keep_worst=2)


def test_figures_are_those_of_single_runs_to_the_last_bit(found):
    for values, figures in zip(found.value, found.figure, strict=True):
        run = simulate(Pairs().scene({TORQUE: values[0], SPEED: values[1]}))  # with all its checks
        np.testing.assert_array_equal(figures, responses_of(run, RESPONSES)[0])


@dataclass(frozen=True)
class Supported:
    """Pairs on bearings of a stiffness (N/m), with a damping ratio and an offset of their mesh."""

    def scene(self, values: Mapping[str, float]) -> Scene:
        stiffness, ratio, offset = (values[name] for name in ("stiffness", "ratio", "offset"))
        pair = with_bushings(gear_pair_scene(TABLE, duration=0.01), radial_stiffness=stiffness)
        return with_mesh(pair, damping_ratio=ratio, position_offset=offset)

    def expensive(self, values: Mapping[str, float]) -> Mapping[str, float]:
        return {}


def test_every_run_of_a_batch_is_the_run_alone_bit_by_bit():
    levels = {"stiffness": (8e7, 2e8), "ratio": (0.05, 0.1), "offset": (0.0, 0.3)}
    design = Design({name: Levels(values) for name, values in levels.items()})
    batch = study(task(design, Supported()), design)
    assert np.ptp(batch.figure[:, 1]) > 0.0 and batch.usable == 8
    for values, figures in zip(batch.value, batch.figure, strict=True):
        alone = Supported().scene(dict(zip(levels, map(float, values), strict=True)))
        fresh = replace(alone, meshes=tuple(replace(m, table=replace(m.table)) for m in alone.meshes))
        np.testing.assert_array_equal(figures, responses_of(simulate(fresh), RESPONSES)[0])


def test_a_study_describes_no_run(monkeypatch):
    def described(*_):
        raise AssertionError("modes of a run whose responses alone are taken")

    monkeypatch.setattr("dynamics.simulation.documents.natural_modes", described)
    design = Design({TORQUE: Levels((100.0,))})
    assert study(task(design), design).usable == 1


def test_threads_give_the_same_bits(found):
    with ThreadPoolExecutor(2) as executor:
        threaded = study(task(GRID), GRID, ByExecutor(executor), keep_worst=2)
    np.testing.assert_array_equal(threaded.figure, found.figure)
    np.testing.assert_array_equal(threaded.worst, found.worst)


def test_the_last_factor_of_a_grid_changes_fastest(found):
    torque, speed = found.value.T
    assert torque.tolist() == [50.0, 50.0, 100.0, 100.0, 150.0, 150.0]
    assert speed.tolist() == [60.0, 90.0] * 3
    assert found.swing(0, 4) > found.swing(1, 4)  # the torque decides on the mesh force


def test_lists_change_together_and_meet_every_level():
    design = Design({"a": Listed((1.0, 2.0)), "b": Levels((5.0, 6.0)), "c": Listed((3.0, 4.0))})
    assert design.points.tolist() == [[1, 5, 3], [2, 5, 4], [1, 6, 3], [2, 6, 4]]


def test_every_combination_meets_the_same_samples_and_a_larger_sample_begins_with_a_smaller_one():
    factors = {"a": Normal(1.0, 0.1), "b": Levels((1.0, 2.0)), "c": Uniform(0.0, 1.0)}
    few, many = Design(factors, 5, seed=7), Design(factors, 8, seed=7)
    assert few.points.shape == (10, 3)
    np.testing.assert_array_equal(few.points[:5, ::2], few.points[5:, ::2])
    np.testing.assert_array_equal(few.points[:5, ::2], many.points[:5, ::2])
    np.testing.assert_array_equal(few.points, Design(factors, 5, seed=7).points)
    assert not np.array_equal(few.points, Design(factors, 5, seed=8).points)


def test_a_truncated_normal_distribution_keeps_its_ends_and_the_moments_of_its_closed_form():
    sample = Design({"a": Normal(2.0, 1.0, 1.0, 3.0)}, 20_000).points[:, 0]
    assert sample.min() >= 1.0 and sample.max() <= 3.0
    variance = 1.0 - 2.0 * np.exp(-0.5) / np.sqrt(2.0 * np.pi) / 0.6826894921370859
    assert sample.mean() == pytest.approx(2.0, abs=4.0 * np.sqrt(variance / sample.size))
    assert sample.var() == pytest.approx(variance, rel=0.03)


@pytest.mark.law
def test_the_mean_of_a_linear_response_is_within_its_stated_bounds():
    design = Design({TORQUE: Normal(100.0, 5.0)}, 64, seed=3)
    made = study(task(design, Springs(), (Response("peak_mesh_force"),)), design)
    spread = made.spread(0)
    assert abs(spread.mean[0] - 100.0 / BASE_RADIUS) < 3.0 * spread.standard_error[0]
    assert spread.standard_error[0] == pytest.approx(5.0 / BASE_RADIUS / 8.0, rel=0.25)
    assert spread.low[0, 1] < 100.0 / BASE_RADIUS < spread.high[0, 1]  # the median too
    np.testing.assert_allclose(made.figure[:, 0], made.value[:, 0] / BASE_RADIUS, rtol=1e-6)
    assert made.correlation(0)[0] == pytest.approx(1.0)


def test_a_failed_run_is_a_marked_point_with_its_reason(tmp_path):
    design = Design({TORQUE: Levels((100.0, -1.0, 50.0))})
    made = study(task(design), design, keep_worst=3)
    assert made.reason == ("", "no pair at -1 N m", "")
    assert np.isnan(made.figure[1]).all() and np.isfinite(made.figure[[0, 2]]).all()
    assert made.usable == 2 and 1 not in made.worst and made.worst.size == 2
    impossible = Response("dte_order", order=1000)  # above what the output holds
    made = study(task(design, responses=(impossible,)), design)
    assert made.usable == 0 and "order" in made.reason[0]
    made.to_netcdf(tmp_path / "study.nc")
    assert Study.from_netcdf(tmp_path / "study.nc").reason == made.reason


def test_an_interrupted_study_goes_on_where_it_was(tmp_path):
    design = Design({TORQUE: Levels(tuple(float(torque) for torque in range(50, 74)))})

    class EndsInMidRun(InterruptedError):
        pass

    @dataclass(frozen=True)
    class Counting:
        allowed: int
        done: list[int]

        def run(self, function, shared, items):
            for item in items:
                if len(self.done) == self.allowed:
                    raise EndsInMidRun
                self.done.append(len(item))
                yield function(shared, item)

    def study_by(workers):
        return study(with_effects(task(design), design, workers), design, workers)

    first, second = Counting(5, []), Counting(99, [])
    with pytest.raises(EndsInMidRun):
        study_by(Remembering(first, tmp_path, "1"))
    resumed = study_by(Remembering(second, tmp_path, "1"))
    assert first.done == [1, 1, 1, 8, 8] and second.done == [8]  # effects are decided at three points
    np.testing.assert_array_equal(resumed.figure, study(task(design), design).figure)


def test_errors_are_those_that_the_runs_state():
    design = Design({TORQUE: Levels((100.0,))})
    responses = (Response("bearing_force", order=1), Response("dte_rms"), Response("contact_loss"))
    full = study(task(design, Pairs(1.0), responses, receipt="full"), design)
    run = simulate(Pairs(1.0).scene({TORQUE: 100.0}))
    stated = [run.receipt["error"][source] for source in ("time_step", "table_interpolation")]
    assert full.error[0, 0] == sum(source["bearing_force_orders"][0] for source in stated) > 0.0
    assert full.error[0, 1] == sum(source["rms"] for source in stated)
    minimal = study(task(design, Pairs(1.0), responses), design)
    assert np.isnan(minimal.error[0, 0])  # not stated is not none
    assert minimal.error[0, 1] == 1e-9  # the tolerance
    assert np.isnan(full.error[0, 2])
    assert len(minimal.metadata["neglected"]) == 3 and len(full.metadata["neglected"]) == 1


def test_the_file_gives_the_study_back(found, tmp_path):
    found.to_netcdf(tmp_path / "study.nc")
    read = Study.from_netcdf(tmp_path / "study.nc")
    for name in ("value", "figure", "error", "worst", "factor", "response", "reason", "metadata"):
        np.testing.assert_equal(getattr(read, name), getattr(found, name))


def test_worst_cases_are_kept_as_full_runs(found, tmp_path):
    files = keep_runs(task(GRID), found, tmp_path)
    assert [file.name for file in files] == [f"point_{k}.nc" for k in found.worst]
    run = RunResult.from_netcdf(files[0])
    assert run.energy is not None  # which runs of a study do without
    assert responses_of(run, RESPONSES)[0] == found.figure[found.worst[0]].tolist()
    assert found.figure[found.worst[0], 0] == found.figure[:, 0].max()


def test_a_kept_run_that_its_checks_refuse_does_not_end_the_study(found, tmp_path, monkeypatch):
    def refuse(_scene, _file, **_):
        raise SolveError("more than 1 % of the work is unaccounted for")

    monkeypatch.setattr("dynamics.study.run_study.simulate_to_file", refuse)
    assert keep_runs(task(GRID), found, tmp_path) == []


def test_a_design_of_other_factors_is_refused():
    with pytest.raises(InputError, match="torque, speed"):
        study(task(GRID), Design({SPEED: Levels((60.0,))}))


@pytest.mark.parametrize(
    ("refused", "field"),
    [
        (lambda: Design({}), "factors"),
        (lambda: Design({"a": Levels(())}), "levels"),
        (lambda: Design({"a": Normal(1.0, 1.0)}), "samples"),
        (lambda: Design({"a": Levels((1.0,))}, samples=3), "samples"),
        (lambda: Design({"a": Listed((1.0,)), "b": Listed((1.0, 2.0))}), "values"),
        (lambda: Uniform(2.0, 1.0), "uniform.high"),
        (lambda: Normal(0.0, 1.0, 2.0, 1.0), "normal.high"),
        (lambda: Response("bearing_farce"), "quantity"),
        (lambda: Response("bearing_force"), "order"),
        (lambda: Response("dte_rms", order=1), "order"),
        (lambda: Response("mesh_load_factor", "mesh"), "part"),
    ],
)
def test_what_cannot_be_is_refused_by_its_field(refused, field):
    with pytest.raises(InputError) as error:
        refused()
    assert error.value.field == field
