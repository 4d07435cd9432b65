"""Scenes on bearings by geometry, taken linear where they rest."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table

from dynamics.assembly.assemble import assemble
from dynamics.bearings import BallBearing, RollerBearing
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.bearings.tangent_bushing import tangent_bushing
from dynamics.integrators import static_equilibrium
from dynamics.linearize import natural_modes
from dynamics.motion.observation import local_state

ON = {"lateral": "on", "axial": "on", "tilt": "on"}
DEEP_GROOVE = BallBearing(count=7, diameter=11.5e-3, pitch_diameter=43.5e-3, clearance=1e-5)
ANGULAR = BallBearing(8, 11.5e-3, 43.5e-3, contact_angle=0.6, clearance=-4e-5)
TAPERED = RollerBearing(17, 9e-3, 13.6e-3, 65e-3, contact_angle=-0.25, clearance=-5e-6)
LOAD = 1330.0  # N, on each bearing: half the mesh force


def on_bearings(scene, bearings, displacements):
    bushings = [
        tangent_bushing(part, (bushing.name, bushing.shaft, bushing.position), d)
        for part, bushing, d in zip(bearings, scene.bushings, displacements, strict=True)
    ]
    return replace(scene, bushings=tuple(bushings))


def rest(scene):
    """Forces on the ground (b, 5) and displacements of the shafts at the bushings, (b, 5)."""
    system = assemble(scene)
    solution = static_equilibrium(system)
    assert solution.status.usable
    q = solution.displacement[None]
    local = local_state(system.arrays, 0.0, q[0], 0.0 * q[0]).force
    force = system.bearing_force(local[:, None], q, 0.0 * q)[:, :, 0]
    if force.shape[1] == 3:  # springs alone: no moments
        return force, None
    force = force[:, :5]
    strained = [
        np.linalg.lstsq(np.array(bushing.stiffness), f + np.array(bushing.preload), rcond=1e-12)[0]
        for bushing, f in zip(scene.bushings, force, strict=True)
    ]
    return force, np.array(strained)


@pytest.mark.parametrize(
    "bearing", [DEEP_GROOVE, ANGULAR, TAPERED], ids=["deep groove", "angular", "tapered"]
)
def test_shafts_rest_where_the_bearings_carry_the_load(bearing):
    # the two bearings of a shaft push against each other
    turned = replace(bearing, contact_angle=-bearing.contact_angle)
    bearings = [LoadedBearing(part) for part in (bearing, turned, bearing, turned)]
    scene = gear_pair_scene(spring_table(4e8), effects=ON)
    pushed, _ = rest(scene)
    displacements = [
        part.displacement((*force[:2], 0.0, 0.0, 0.0)) if part.bearing.contact_angle == 0.0 else np.zeros(5)
        for part, force in zip(bearings, pushed, strict=True)
    ]
    for _ in range(20):
        force, moved = rest(on_bearings(scene, bearings, displacements))
        change = np.abs(moved - displacements).max()
        displacements = moved
        if change < 1e-13:
            break
    for part, d, f in zip(bearings, displacements, force, strict=True):
        assert part.evaluate(d).force == pytest.approx(f, rel=1e-6, abs=1e-6 * LOAD)
    assert np.hypot(force[:, 0], force[:, 1]) == pytest.approx(4 * [LOAD], rel=2e-2)
    assert force[0::2].sum(axis=0)[2] + force[1::2].sum(axis=0)[2] == pytest.approx(0.0, abs=1e-5 * LOAD)
    assert natural_modes(assemble(on_bearings(scene, bearings, displacements))).frequency.max() > 100.0
