"""Variants and fidelities run one by one: reasons, memory, progress, errors against the finest."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import pytest

from model_studies import LeftOut, Outcome, against_finest, run_fidelities, run_variants


class Unsolved(Exception):
    """What a library raises."""


@dataclass(frozen=True)
class Step:
    """A fidelity that approximates 1 by 1 + its step."""

    name: str
    step: float
    family: str = "steps"
    fails: type[Exception] | None = None

    @property
    def title(self) -> str:
        return f"step {self.step:g}"

    def refusal(self, request: float) -> str | None:
        return "too coarse" if self.step > request else None

    def run(self) -> float:
        if self.fails is not None:
            raise self.fails("no solution")
        return 1.0 + self.step


STEPS = (Step("a", 0.4), Step("b", 0.2), Step("c", 0.1))


def run(fidelities: Sequence[Step], request: float = 1.0, warmed: list[str] | None = None):
    seen: list[tuple[str, float]] = []
    outcomes, left_out = run_fidelities(
        fidelities,
        request,
        lambda valid: (warmed if warmed is not None else []).extend(each.name for each in valid),
        Step.run,
        (LookupError, Unsolved),
        lambda *step: seen.append(step),
    )
    return outcomes, left_out, seen


def test_what_fails_is_left_out_with_its_reason_and_the_others_go_on():
    fails = (
        Step("d", 0.1, fails=Unsolved),
        Step("e", 0.1, fails=KeyError),
        Step("f", 0.1, fails=MemoryError),
    )
    outcomes, left_out, _ = run((Step("coarse", 3.0), STEPS[0], *fails, STEPS[1]))
    assert [outcome.fidelity.name for outcome in outcomes] == ["a", "b"]
    assert left_out == {
        "coarse": "too coarse", "d": "no solution", "e": "'no solution'", "f": "out of memory",
    }  # fmt: skip


def test_a_defect_ends_the_study():
    with pytest.raises(ZeroDivisionError):
        run((*STEPS, Step("d", 0.05, fails=ZeroDivisionError)))


def test_one_result_compares_to_nothing():
    with pytest.raises(Unsolved, match="too coarse"):
        run((Step("coarse", 3.0), STEPS[0]))


def test_only_what_runs_is_warmed_up_and_progress_rises_to_the_end():
    warmed: list[str] = []
    _, _, seen = run((Step("coarse", 3.0), *STEPS), warmed=warmed)
    assert warmed == ["a", "b", "c"]
    assert seen == [("ladder", pytest.approx(k / 3)) for k in range(4)]


def test_cpu_time_is_that_of_the_fidelity_alone():
    def burn(fidelity):
        end = time.process_time() + fidelity.step / 4.0
        while time.process_time() < end:
            pass
        return 0.0

    outcomes, _ = run_fidelities(STEPS, 1.0, lambda _: None, burn, (Unsolved,), lambda *_: None)
    for outcome, step in zip(outcomes, STEPS, strict=True):
        assert outcome.cpu_seconds == pytest.approx(step.step / 4.0, abs=0.02)


def test_errors_are_those_against_the_last_and_its_own_come_from_its_family():
    outcomes = [Outcome(step, step.run(), 1.0) for step in (Step("x", 0.9, family="model"), *STEPS)]

    def remaining(coarser, finest):
        assert [step.name for step, _ in coarser] == ["a", "b"]
        return {"off": coarser[-1][1]["off"] / (coarser[-1][0].step / finest.step - 1.0)}

    errors = against_finest(outcomes, lambda result, reference: {"off": abs(result - reference)}, remaining)
    assert [error["off"] for error in errors] == [pytest.approx(off) for off in (0.8, 0.3, 0.1, 0.1)]


def test_a_variant_may_say_itself_that_it_says_nothing():
    def compute(value):
        if value == 2:
            raise LeftOut("it is even")
        return value

    seen: list[tuple[str, float]] = []
    variants = {"one": 1, "two": 2, "three": 3}
    results, left_out = run_variants("count", variants, compute, (), lambda *step: seen.append(step))
    assert (results, left_out) == ({"one": 1, "three": 3}, {"two": "it is even"})
    assert [stage for stage, _ in seen] == ["count"] * 4 and seen[-1][1] == 1.0
    assert run_variants("none", {}, compute, (), lambda *_: None) == ({}, {})


def test_the_fraction_done_of_variants_follows_their_predicted_costs():
    seen: list[float] = []
    costs = {"dear": 6.0, "cheap": 1.0, "last": 3.0}
    variants = {"dear": 1, "free": 2, "cheap": 3, "last": 4}
    run_variants("stage", variants, str, (), lambda _, fraction: seen.append(fraction), costs=costs)
    assert seen == pytest.approx([0.0, 0.6, 0.6, 0.7, 1.0])
