"""The study of influence estimates of dynamic effects counts what it states."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from geared_scenes import gear_pair_scene

from benchmarks import dynamic_influence_cases
from benchmarks.dynamic_influence_estimates import STUDY, AssessedLevel, assess, markdown
from dynamics.ablation import ablate
from dynamics.assembly.assemble import assemble
from dynamics.effects import EFFECTS
from dynamics.influence.level_change import LevelChange
from dynamics.meshes.standard_sliding import StandardTeeth
from dynamics.meshes.stiffness_table import straight_table


def test_counts_and_tables_are_those_of_the_ablations():
    right = AssessedLevel("one", "tilt", (0.1, 0.2, 0.3), (0.11, 0.19, 0.5), (), "sound power", (3.0, 2.0))
    wrong = AssessedLevel(
        "two", "tilt", (0.1, 0.2, 0.3), (0.11, -0.19, 0.3), (), "bearing forces", (3.0, 1.0)
    )
    off = AssessedLevel(
        "two", "axial", (0.001, 0.0, 0.0), (0.002, 0.003, 0.03), (0.05,), "bearing forces", (0.0, 0.05)
    )
    rows = {figure.what: figure for figure in STUDY.counts([right, right, wrong, off])}
    assert rows["any quantity beyond a factor 2"].value == pytest.approx(50.0)
    assert rows["bearing forces: beyond a factor 2, of the 4 changes above 1 %"].value == pytest.approx(25.0)
    left = [
        rows[f"largest change by what auto neglects at {text}"]
        for text in ("1 % (0 ablations)", "5 % (1 ablations)")
    ]
    assert [figure.value for figure in left] == pytest.approx([0.0, 3.0])
    text = markdown([right, wrong, off])
    assert "| two | tilt | +10 / +11 | **+20 / -19** | +30 / +30 | **+3 / +1** |" in text
    assert "| tilt | 2 | 100 % | 50 % | 100 % | 50 % |" in text
    assert "50 % of the 2 that change it by 0.1 dB" in text
    assert "sound power in 1 scenes, all bearing forces in 1." in text


def test_an_ablation_is_assessed_beside_its_estimate():
    made = ablate(gear_pair_scene(duration=0.06), only=["lateral"])
    one = assess("pair", made.effects[0])
    whole = made.nominal
    assert one.measured[1] == made.effects[0].peak_to_peak_change[0] / whole.peak_to_peak[0]
    assert all(one.right) and one.level_right
    assert one.decibels == (made.effects[0].level.decibels, made.effects[0].level_change.decibels)
    assert one.measured[2] == pytest.approx(-1.0)


def test_levels_are_compared_at_the_order_of_the_estimate():
    """Amplitudes of orders 1 and 2 change by 9 and 8: the run names order 1, the estimate the other."""
    (entry,) = ablate(gear_pair_scene(duration=0.06), only=["lateral"]).effects
    order, estimate = np.array([1.0, 2.0]), entry.estimate
    assert estimate is not None
    told = replace(
        entry,
        with_effect=replace(entry.with_effect, line_order=order, line_square=np.array([100.0, 1.0])),
        without_effect=replace(entry.without_effect, line_order=order, line_square=np.array([1.0, 81.0])),
        estimate=replace(estimate, level=LevelChange("bearing forces", "dB", 2.0, 19.0, 0.8)),
    )
    assert assess("pair", told).decibels == (19.0, pytest.approx(20.0 * math.log10(9.0)))


def test_every_effect_can_be_on_in_some_scene(monkeypatch):
    """On tables in closed form: what needs a table's axes or its ripple is left to the study itself.

    The study has no planetary set, its bearings have no elements that pass, and temperatures are sized on
    scenes of their own, `warm_scenes`.
    """
    teeth = StandardTeeth((20, 20), 0.0188, 0.35, 0.0, 0.04)
    monkeypatch.setattr(dynamic_influence_cases, "table", lambda *_: straight_table(3e8, teeth))
    on = {
        entry.effect
        for scene in dynamic_influence_cases.influence_scenes(Path()).values()
        for entry in assemble(scene).ledger.entries
        if entry.on
    }
    names = {effect.name for effect in EFFECTS}
    by_tables = {"dynamic_misalignment", "dynamic_center_distance", "moving_application_point", "friction"}
    by_tables |= {"tooth_deviations"}  # on with tables of many base pitches, in its own tests
    beside = {"backlash", "centrifugal_load", "element_passing", "bearing_temperature", "mesh_temperature"}
    assert on >= names - by_tables - beside
