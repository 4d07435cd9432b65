"""The fraction reported of a table over the face follows the CPU time spent on it."""

from __future__ import annotations

import itertools
import math
import resource
from pathlib import Path
from typing import Any

import pytest

from lineofaction.gearbox.convert.case import CheckedCase
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.stages import TableFraction
from service.worker.order import WorkOrder
from service.worker.simulation_work import database_of

LARGEST_ERROR = 0.15
LARGEST_STEP = 0.2

Report = tuple[float, str, float]
"""CPU seconds since the start, stage, fraction of the whole."""


def helical(face_width_mm: float = 12.0, **accuracy: Any) -> Case:
    width = {"face_width_mm": face_width_mm, "bore_diameter_mm": 12.0}
    pair = {
        "normal_module_mm": 1.8,
        "helix_angle_deg": 22.0,
        "center_distance_mm": 0.9 * 54 / math.cos(math.radians(22.0)),
        "pinion": {"teeth": 23} | width,
        "wheel": {"teeth": 31} | width,
    }
    return validated(Case, {"pair": pair, "load": {"torque_n_m": [50.0, 100.0]}, "accuracy": accuracy})


def cpu_seconds() -> float:
    usages = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def reports_of(case: Case, folder: Path) -> list[Report]:
    """Analyze without a cache; the last report is the end."""
    reports: list[Report] = []
    begun = cpu_seconds()
    order = WorkOrder("", {}, "", folder, folder)
    database_of(
        CheckedCase(case),
        order,
        lambda stage, _, whole=0.0, /: reports.append((cpu_seconds() - begun, stage, whole)),
    )
    return [*reports, (cpu_seconds() - begun, "end", 1.0)]


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> list[Report]:
    reports_of(helical(10.0, model="3d", level="draft", positions=8), tmp_path_factory.mktemp("compiles"))
    return reports_of(helical(model="3d", level="draft"), tmp_path_factory.mktemp("measured"))


@pytest.mark.nightly
def test_the_fraction_is_near_the_share_of_the_time_spent(reports: list[Report]) -> None:
    whole = reports[-1][0]
    error, stage = max((abs(fraction - spent / whole), stage) for spent, stage, fraction in reports)
    assert error < LARGEST_ERROR, stage


@pytest.mark.nightly
def test_the_fraction_never_falls_and_moves_in_small_steps(reports: list[Report]) -> None:
    whole = reports[-1][0]
    assert len({fraction for *_, fraction in reports}) > 50
    for (earlier, _, before), (later, stage, after) in itertools.pairwise(reports):
        assert after >= before, stage
        assert later - earlier < LARGEST_STEP * whole, stage


def test_a_pass_that_follows_takes_its_part_of_what_is_left() -> None:
    table = TableFraction(refines=True)
    table.plan({"compliance": 3.0, "contact": 1.0})
    first = [table.at(*step) for step in (("compliance", 0.5), ("compliance", 1.0), ("contact", 1.0))]
    table.plan({"compliance": 0.0, "contact": 9.0})
    second = [table.at(*step) for step in (("compliance", 1.0), ("contact", 0.5), ("contact", 1.0))]
    assert first == pytest.approx([0.3, 0.6, 0.8])
    assert second == pytest.approx([0.8, 0.88, 0.96])
    assert table.at("unknown", 0.1) == second[-1]
