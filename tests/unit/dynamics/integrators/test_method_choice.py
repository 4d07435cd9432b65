"""The choice of the method: explicit where accuracy sets the step, implicit where stability would."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.method_choice import EVALUATIONS, LIMIT, choose_method
from dynamics.integrators.workspace import Count
from dynamics.scene import Integration
from dynamics.simulation import simulate

SCENE = replace(gear_pair_scene(duration=0.05), effects={"lateral": "on", "tilt": "on"})


def on_stiff_bushings():
    """The pair on bushings whose motions are a hundred times faster than that of the mesh."""
    bushings = tuple(
        replace(bushing, radial_stiffness=1e4 * bushing.radial_stiffness) for bushing in SCENE.bushings
    )
    return replace(SCENE, bushings=bushings)


def choice(scene, **integration):
    system = assemble(scene)
    start = static_equilibrium(system)
    return choose_method(system, start.displacement, replace(scene.integration, **integration))


def evaluations(scene, method):
    """Evaluations of the laws over a run."""
    system = assemble(scene)
    run = integrate(system, static_equilibrium(system), replace(scene.integration, method=method))
    return EVALUATIONS[method] * int(run.count[Count.ACCEPTED] + run.count[Count.REJECTED])


@pytest.mark.parametrize("scene", [SCENE, on_stiff_bushings()], ids=["accuracy", "stability"])
def test_the_method_chosen_takes_fewer_evaluations(scene):
    chosen = choice(scene)
    costs = {method: evaluations(scene, method) for method in EVALUATIONS}
    assert costs[chosen.method] < costs[chosen.other]


def test_stiff_bushings_ask_for_the_implicit_method():
    assert choice(SCENE).method == "explicit"
    assert choice(on_stiff_bushings()).method == "implicit"


def test_a_fixed_step_is_what_stability_is_asked_for():
    rate = choice(SCENE).rate
    assert choice(SCENE, fixed_step=0.9 * LIMIT / rate).method == "explicit"
    assert choice(SCENE, fixed_step=1.1 * LIMIT / rate).method == "implicit"


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_a_method_that_is_stated_is_taken(method):
    for scene in (SCENE, on_stiff_bushings()):
        assert choice(scene, method=method).method == method


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_the_receipt_predicts_what_the_other_method_costs(method):
    run = simulate(replace(SCENE, integration=Integration(method)))
    said = run.receipt["method"]
    assert (said["used"], said["requested"]) == (method, method)
    predicted = said["other_seconds_predicted"] / run.receipt["seconds"]["integration"]
    actual = evaluations(SCENE, said["other"]) / evaluations(SCENE, method)
    assert predicted == pytest.approx(actual, rel=0.3)


def test_auto_runs_as_the_method_it_names():
    by_default = simulate(SCENE)
    said = by_default.receipt["method"]
    assert said["requested"] == "auto"
    assert said["rate_times_step"] <= said["explicit_up_to"]
    stated = simulate(replace(SCENE, integration=choice(SCENE).settings(SCENE.integration)))
    np.testing.assert_array_equal(by_default.mesh_force, stated.mesh_force)
