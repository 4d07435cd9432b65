"""What a run costs, in steps and evaluations: in proportion to its duration, nothing for what is off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.meshes.gear_mesh import CoastFlank
from dynamics.meshes.technique import PlainTable
from dynamics.scene import Integration
from dynamics.simulation import simulate

SCENE = replace(gear_pair_scene(duration=0.1), effects={"lateral": "on", "tilt": "on"})


def cost(scene, method="implicit"):
    """Steps tried, and evaluations of the force laws' stages."""
    found = simulate(replace(scene, integration=Integration(method=method))).statistics
    tried = found.accepted + found.rejected
    return np.array([tried, tried * max(found.newton_mean, 1.0)])


def with_axes(table):
    knots = np.array([-1e-5, 0.0, 1e-5])
    names = ("deflection", "deflection_slope", "stiffness", "stiffness_slope")
    shape = (3, 3, *table.deflection.shape[2:])
    fields = {name: np.broadcast_to(getattr(table, name), shape).copy() for name in names}
    levers = dict.fromkeys(("face_centroid", "sliding_share", "sliding_lever"), np.full(shape, 1e-3))
    return PlainTable(table.position, table.level, knots, knots, **fields, **levers)


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_steps_and_evaluations_grow_in_proportion_to_the_duration(method):
    short, middle, long = (cost(replace(SCENE, duration=seconds), method) for seconds in (0.1, 0.2, 0.4))
    assert np.all(short > 500)
    np.testing.assert_allclose(long - middle, 2.0 * (middle - short), rtol=0.02)


AXES = ("dynamic_misalignment", "dynamic_center_distance", "moving_application_point")


@pytest.mark.parametrize(
    ("able", "effects"),
    [
        ({"coast": CoastFlank(50e-6)}, ("backlash",)),
        ({"friction": 0.05, "table": with_axes(square_wave_table())}, ("friction", *AXES)),
        ({"table": with_axes(square_wave_table())}, AXES),
    ],
    ids=["backlash", "friction", "axes"],
)
def test_an_effect_that_is_off_takes_no_step_and_no_evaluation(able, effects):
    off = replace(with_mesh(SCENE, **able), effects={**SCENE.effects, **dict.fromkeys(effects, "off")})
    with_it, without = simulate(off), simulate(SCENE)
    assert with_it.statistics == without.statistics
    np.testing.assert_array_equal(with_it.mesh_force, without.mesh_force)
    assert len(assemble(off).elements) == len(assemble(SCENE).elements) == 1
