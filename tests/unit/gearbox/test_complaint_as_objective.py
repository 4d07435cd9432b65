"""Better flanks lower what is complained of, on the grid of the drawing, in the form typed."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_inputs import small_inputs

from fe_contact.microgeometry.variables import DesignVariable
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.optimize import Inputs
from lineofaction.gearbox.studies.optimize.complained import of_case, of_scene
from lineofaction.gearbox.studies.optimize.drawing import as_typed, drawing_grid
from lineofaction.gearbox.studies.optimize.run import RUN

Json = dict[str, Any]
EXAMPLE = tomllib.loads((Path(__file__).parents[3] / "examples" / "helical_ev_23_67.toml").read_text("utf-8"))
SECOND: Json = {"frequency_hz": 2300.0, "speed_rpm": 3000.0, "torque_n_m": 80.0}
"""Complaint of harmonic 2: 23 teeth at 50 revolutions a second are 1150 Hz."""


def case(**pinion: Any) -> Case:
    pair = EXAMPLE["pair"]
    own = {name: value for name, value in pair["pinion"].items() if pinion.get(name, value) is not None}
    changed = {**own, **{name: value for name, value in pinion.items() if value is not None}}
    return validated(Case, {**EXAMPLE, "pair": {**pair, "pinion": changed}, "complaint": SECOND})


@pytest.mark.law
def test_the_complaint_of_a_case_is_the_objective_unless_one_is_given():
    study = of_case(case(), Inputs())
    assert study.objective.harmonic == 2 and study.torque_n_m == (80.0,)
    given = Inputs.model_validate({"objective": {"kind": "worst"}, "torque_n_m": [50.0]})
    assert of_case(case(), given) == given
    assert of_case(validated(Case, EXAMPLE), Inputs()) == Inputs()


@pytest.mark.law
def test_a_service_that_reads_the_stored_inputs_has_the_same_objective():
    checked = CheckedCase(case())
    stored = RUN.normalized(checked, Inputs())
    again = Inputs.model_validate(stored)
    assert again.objective.harmonic == 2
    assert RUN.normalized(checked, again) == stored


@pytest.mark.law
def test_the_complaint_of_a_scene_is_its_mesh_its_order_and_its_speed():
    scene = small_inputs("modes")["scene"]
    teeth = scene["meshes"][0]["case"]["pair"]["pinion"]["teeth"]
    mesh = scene["meshes"][0]["name"]
    complaint = {"frequency_hz": teeth * 1000.0 / 60.0 * 2.0, "speed_rpm": 1000.0}
    study = of_scene(validated(SceneInput, {**scene, "complaint": complaint}), Inputs())
    assert (study.heard.mesh, study.heard.counted_orders, study.heard.orders) == (mesh, (2,), 2)
    assert study.heard.speed_rpm == pytest.approx((1000.0,))


@pytest.mark.law
def test_amounts_and_lengths_lie_on_the_grid_in_the_form_in_which_they_are_typed():
    typed = case(tip_relief_length_mm=None, tip_relief_start_diameter_mm=47.37)
    pair = CheckedCase(typed).pair
    free = (
        DesignVariable("pinion.tip_relief", 0.2e-6, 9.9e-6),
        DesignVariable("pinion.tip_relief_length", 0.3e-3, 1.4e-3),
        DesignVariable("wheel.tip_relief_length", 0.3e-3, 1.4e-3),
    )
    grid = drawing_grid(typed, pair, free)
    amounts, starts, lengths = (grid[variable.name] for variable in free)
    assert amounts == pytest.approx(np.arange(0.5e-6, 9.6e-6, 0.5e-6))
    assert lengths == pytest.approx(np.arange(0.3e-3, 1.41e-3, 0.1e-3))
    assert len(starts) > 5
    for length in starts:
        design = as_typed(typed, pair, {"pinion.tip_relief_length": float(length)})
        (field, value) = next(iter(design["pinion"].items()))
        assert field == "tip_relief_start_diameter_mm"
        assert value == pytest.approx(round(10.0 * value) / 10.0, abs=1e-6)
        reread = case(tip_relief_length_mm=None, tip_relief_start_diameter_mm=value)
        assert CheckedCase(reread).pair.pinion.modification.tip_relief_length == pytest.approx(length)
