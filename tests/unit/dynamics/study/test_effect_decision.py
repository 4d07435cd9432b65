"""Effects of a study: decided once, on in all runs where they are on at an end of a factor."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from geared_scenes import RPM, gear_pair_scene, with_gear

from dynamics import Outputs, RunResult, Scene, TimeLaw, simulate
from dynamics.influence import decide_effects, neglected_check
from dynamics.study import (
    Design,
    Factor,
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
from dynamics.study.effect_decision import decision_points

RESPONSES = Response("bearing_force", order=1), Response("dte_peak_to_peak")
ANGLE, SPEED = "angle", "speed"
TOLERANCE = 0.02  # dB: axial motion is below half of it up to an angle of 0.015, and above it at 0.3
SMALL = (0.01, 0.012, 0.015)
LEAN = Outputs(energy_audit=False, receipt="minimal")


@dataclass(frozen=True)
class Helical:
    """Pairs with a base helix angle (rad) and a speed (rpm), whose axial motion is called for.

    From an angle of `braced` on a further bushing is on the first shaft.
    """

    braced: float = np.inf
    outputs: Outputs = LEAN

    def scene(self, values: Mapping[str, float]) -> Scene:
        angle, speed = values[ANGLE], TimeLaw.constant(values.get(SPEED, 2000.0) * RPM)
        scene = gear_pair_scene(duration=0.01, outputs=self.outputs, on_violation="report", speed=speed)
        scene = with_gear(with_gear(scene, 0, base_helix_angle=angle), 1, base_helix_angle=-angle)
        bushings = tuple(replace(part, axial_stiffness=1e8) for part in scene.bushings)
        if angle >= self.braced:
            bushings = (*bushings, replace(bushings[0], name="brace"))
        return replace(scene, bushings=bushings, level_tolerance=TOLERANCE)

    def expensive(self, values: Mapping[str, float]) -> Mapping[str, float]:
        return {}


def of_angles(*angles: float, scenes: Helical = Helical()) -> tuple[StudyTask, Design]:
    design = Design({ANGLE: Levels(angles)})
    return with_effects(StudyTask(scenes, design.names, RESPONSES), design), design


def figures(scene: Scene) -> list[float]:
    return responses_of(simulate(scene), RESPONSES)[0]


def test_runs_whose_own_decision_is_that_of_the_study_are_as_alone_to_the_last_bit():
    task, design = of_angles(*SMALL)
    made = study(task, design)
    for angle, row in zip(made.value[:, 0], made.figure, strict=True):
        scene = Helical().scene({ANGLE: float(angle)})
        assert decide_effects(scene).scene.effects["axial"] == "off"
        np.testing.assert_array_equal(row, figures(scene))
    effects = made.metadata["effects"]
    assert "axial" in effects["neglected"] and "axial" not in effects["on"]
    own = [decide_effects(Helical().scene({ANGLE: angle})).influences["axial"].decibels for angle in SMALL]
    assert effects["neglected"]["axial"]["decibels"] == max(own)
    assert effects["largest"]["decibels"] == max(row["decibels"] for row in effects["neglected"].values())


def test_an_effect_that_one_end_of_a_factor_needs_is_on_in_all_runs(tmp_path):
    task, design = of_angles(*SMALL, 0.3)
    made = study(task, design, keep_worst=4)
    assert "axial" in made.metadata["effects"]["on"] and made.metadata["effects"]["points"] == 3
    for angle, row in zip(made.value[:, 0], made.figure, strict=True):
        scene = Helical().scene({ANGLE: float(angle)})
        choices = {**decide_effects(scene).scene.effects, "axial": "on"}
        np.testing.assert_array_equal(row, figures(replace(scene, effects=choices, level_tolerance=None)))
    alone = figures(Helical().scene({ANGLE: SMALL[0]}))
    assert made.figure[0].tolist() != alone  # which leaves the effect out
    kept = [RunResult.from_netcdf(file) for file in keep_runs(task, made, tmp_path)]
    for point, run in zip(made.worst, kept, strict=True):
        assert responses_of(run, RESPONSES)[0] == made.figure[point].tolist()
        entry = next(row for row in run.effect_ledger["entries"] if row["effect"] == "axial")
        assert entry["on"] and entry["choice"] == "auto" and "study" in entry["reason"]


def test_without_a_decision_for_all_every_run_decides_by_itself():
    task, design = of_angles(SMALL[0], 0.3)
    made = study(replace(task, effects=None), design)
    assert made.metadata["effects"] is None
    for angle, row in zip(made.value[:, 0], made.figure, strict=True):
        np.testing.assert_array_equal(row, figures(Helical().scene({ANGLE: float(angle)})))
    assert made.figure[0].tolist() != study(task, design).figure[0].tolist()


def test_sizes_are_estimated_at_the_points_of_the_decision_alone(monkeypatch):
    estimated: list[Scene] = []
    estimate = neglected_check._estimated

    def counted(scene, *others):
        estimated.append(scene)
        return estimate(scene, *others)

    monkeypatch.setattr(neglected_check, "_KNOWN", {})
    monkeypatch.setattr(neglected_check, "_estimated", counted)
    design = Design({ANGLE: Uniform(0.01, 0.015), SPEED: Levels((1900.0, 2000.0))}, samples=6)
    task = with_effects(StudyTask(Helical(), design.names, RESPONSES), design)
    made = study(task, design)
    assert made.usable == 12 and len(estimated) == made.metadata["effects"]["points"] == 4


def test_a_run_with_a_part_that_the_decision_never_had_decides_by_itself():
    task, design = of_angles(*SMALL)
    braced = replace(task, scenes=Helical(braced=0.012))
    for angle in SMALL:
        scene = braced.scene((angle,))
        decision = task.decide(scene)
        assert decision.scene.effects["axial"] == "off"
        alone = decide_effects(scene)
        assert (decision.automatic == alone.automatic) == (angle >= 0.012)
    made = study(braced, design)  # a task keeps its decision
    assert made.metadata["effects"] == task.effects.to_json()


def test_points_of_a_decision_are_the_middle_and_the_ends_of_every_factor():
    factors: dict[str, Factor] = {
        "a": Levels((1.0, 2.0, 3.0, 4.0)),
        "b": Listed((5.0, 7.0, 6.0)),
        "c": Listed((30.0, 10.0, 20.0)),
        "d": Normal(0.0, 1.0, -2.0, 2.0),
    }
    design = Design(factors, samples=9)
    points = decision_points(design.points, design.kinds)
    sample = design.points[:9, 3]
    middle = (3.0, 6.0, 20.0, np.median(sample))
    expected = {
        middle,
        (1.0, *middle[1:]),
        (4.0, *middle[1:]),
        (3.0, 5.0, 30.0, middle[3]),
        (3.0, 7.0, 10.0, middle[3]),
        (*middle[:3], sample.min()),
        (*middle[:3], sample.max()),
    }
    assert set(map(tuple, points)) == expected and len(points) == len(expected)


def test_a_small_design_is_decided_at_all_its_points():
    design = Design({"a": Levels((1.0, 2.0)), "b": Levels((3.0, 4.0))})
    np.testing.assert_array_equal(decision_points(design.points, design.kinds), design.points)


def test_points_without_a_scene_decide_nothing():
    wrong, _ = of_angles(2.0)
    assert wrong.effects is not None and wrong.effects.points == 0 and not wrong.effects.choices


def test_the_file_of_a_study_gives_its_decision_back(tmp_path):
    task, design = of_angles(*SMALL)
    made = study(task, design)
    made.to_netcdf(tmp_path / "study.nc")
    assert Study.from_netcdf(tmp_path / "study.nc").metadata["effects"] == made.metadata["effects"]
