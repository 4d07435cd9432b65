"""Gears that nothing loads: they rattle between their flanks as the drive's speed swings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import modal_analysis
from dynamics.loads import TimeLaw
from dynamics.meshes import CoastFlank
from dynamics.results.mesh_figures import dynamic_factor
from dynamics.scene import Scene
from dynamics.simulation import simulate

BACKLASH = 20e-6
SWING = TimeLaw((0.0, 0.005, 0.01, 0.015, 0.02), (80.0, 81.0, 79.0, 81.0, 80.0), "smooth")


def idle(speed: TimeLaw = SWING, **changes: object) -> Scene:
    """A pair on a table that a line contact makes: no stiffness at lift-off."""
    scene = gear_pair_scene(square_wave_table(16), torque=0.0, duration=0.02, speed=speed)
    return with_mesh(scene, coast=CoastFlank(BACKLASH, thickness=0.48), **changes)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("loads", ["zero", "none"])
def test_idle_gears_rattle_between_both_flanks(loads):
    scene = idle()
    run = simulate(replace(scene, loads=()) if loads == "none" else scene)
    assert run.nominal_force[0] == 0.0
    assert run.mesh_force.max() > 1.0
    assert run.coast_force.max() > 1.0
    assert not np.any(run.contact == 3.0)
    assert 0.1 < np.mean(run.contact == 0.0) < 0.99
    assert run.energy.meshes > 0.0
    assert run.energy.relative < 1e-2
    deflection = run.dynamic_transmission_error
    assert deflection.min() > -BACKLASH - 1e-6


@pytest.mark.filterwarnings("error")
def test_an_idle_mesh_has_stiffness_and_damping_of_the_lowest_load_of_its_table():
    table = square_wave_table(16)
    flanks = assemble(idle()).flanks
    expected = float(np.mean(table.stiffness[0, 0, :, 1]))
    assert flanks.mean_stiffness[0] == pytest.approx(expected, rel=1e-9)
    assert np.all(flanks.law.damping > 0.0)
    assert modal_analysis(assemble(idle())).natural_frequency.size > 0


def test_a_constant_torque_of_none_is_refused_and_says_what_to_do():
    with pytest.raises(InputError, match=r"nominal_force, or use .variable_torque.") as caught:
        simulate(idle(technique="constant_torque"))
    assert caught.value.field == "meshes[0].technique"
    assert simulate(idle(technique="constant_torque", nominal_force=1000.0)).coast_force.max() > 1.0
    with pytest.raises(InputError, match="An idle mesh has no dynamic factor"):
        dynamic_factor(simulate(idle()), pitches=1)
