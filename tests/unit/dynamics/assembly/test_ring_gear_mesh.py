"""The line of action in a ring gear: action = reaction, torques, thrust, virtual work, coast flank."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_gear

from dynamics import TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.mechanism.line_of_action import line_of_action

ALPHA = math.radians(22.0)
PINION, RING = 20, 61
PER_TOOTH = 1.8e-3


def ring_scene(driver="pinion", helix=0.0, turn=0.0, sense=1, **changes):
    """A pinion in a ring gear at the angle `turn` from it; `driver` says which of them drives."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(sense * 90.0), **changes)
    teeth = (PINION, RING) if driver == "pinion" else (RING, PINION)
    for index, z in enumerate(teeth):
        ring = z == RING
        values = {"teeth": z, "base_radius": PER_TOOTH * z, "internal": ring, "base_helix_angle": helix}
        scene = with_gear(scene, index, **values)
    distance = PER_TOOTH * (RING - PINION) / math.cos(ALPHA)
    location = (distance * math.cos(turn), distance * math.sin(turn), 0.0)
    return replace(scene, shafts=(scene.shafts[0], replace(scene.shafts[1], origin=location)))


def wrenches(scene, sense):
    """Force and moment about each gear's center, on driver and driven gear, per unit force."""
    line = line_of_action(scene, 0, sense)
    centers = [np.add(shaft.origin, (0.0, 0.0, 0.1)) for shaft in scene.shafts]
    return line, centers, -line.gradient(centers[0]), line.gradient(centers[1])


@pytest.mark.parametrize("driver", ["pinion", "ring"])
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize(("helix", "turn"), [(0.0, 0.3), (0.25, 2.0), (-0.25, -1.0)])
def test_forces_torques_and_power(driver, sense, helix, turn):
    scene = ring_scene(driver, helix, turn)
    line, centers, on_driver, on_driven = wrenches(scene, sense)
    np.testing.assert_allclose(on_driver[:3] + on_driven[:3], 0.0, atol=1e-15)
    moment = (
        on_driver[3:]
        + on_driven[3:]
        + np.cross(centers[0], on_driver[:3])
        + np.cross(centers[1], on_driven[:3])
    )
    np.testing.assert_allclose(moment, 0.0, atol=1e-15)
    radius = [gear.base_radius for gear in scene.gears]
    assert on_driver[5] == pytest.approx(-sense * radius[0], rel=1e-12)
    assert on_driven[5] == pytest.approx(sense * radius[1], rel=1e-12)  # in a ring both turn the same way
    teeth = [gear.teeth for gear in scene.gears]
    assert abs(on_driven[5] / on_driver[5]) == pytest.approx(teeth[1] / teeth[0], rel=1e-12)
    assert on_driver[5] * 1.0 + on_driven[5] * teeth[0] / teeth[1] == pytest.approx(0.0, abs=1e-15)  # power
    assert line.working_pressure_angle == pytest.approx(ALPHA, rel=1e-12)
    assert line.force[2] == pytest.approx(-sense * math.tan(helix))


@pytest.mark.parametrize("driver", ["pinion", "ring"])
@pytest.mark.parametrize("sense", [1, -1])
def test_virtual_work_of_a_planet_rolling_in_a_ring(driver, sense):
    """The pinion carried around the ring's center as it rolls: the transmission error does not change."""
    scene = ring_scene(driver, 0.0, 0.7)
    _, centers, on_driver, on_driven = wrenches(scene, sense)
    ring, pinion = (1, 0) if driver == "pinion" else (0, 1)
    on = (on_driver, on_driven)
    arm = centers[pinion] - centers[ring]
    carried = np.array([-arm[1], arm[0], 0.0])
    rolling = 1.0 - RING / PINION  # w_pinion / w_carrier with the ring at rest
    work = on[pinion][:3] @ carried + on[pinion][5] * rolling
    assert work == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("driver", ["pinion", "ring"])
def test_flanks_push_apart_and_the_coast_flank_mirrors(driver):
    """The pinion is pushed off the ring's teeth, towards the ring's center, on both flanks."""
    scene = ring_scene(driver)
    _, centers, *driving = wrenches(scene, 1)
    _, _, *coasting = wrenches(scene, -1)
    pinion, ring = (0, 1) if driver == "pinion" else (1, 0)
    inwards = (centers[ring] - centers[pinion]) / np.linalg.norm(centers[ring] - centers[pinion])
    for on in (driving[pinion], coasting[pinion]):
        assert on[:3] @ inwards == pytest.approx(math.sin(ALPHA))
    assert driving[pinion][5] == pytest.approx(-coasting[pinion][5])


@pytest.mark.parametrize("driver", ["pinion", "ring"])
def test_power_balance_of_a_run(driver):
    result = simulate(ring_scene(driver, duration=0.02, torque=80.0))
    ratio = PINION / RING if driver == "pinion" else RING / PINION
    assert result.speed[1].mean() == pytest.approx(90.0 * ratio, rel=1e-6)
    assert result.drive_torque[0].mean() == pytest.approx(80.0 * ratio, rel=1e-6)
    assert result.energy.relative_to_throughput < 1e-6


def test_ring_gears_that_cannot_mesh_are_refused():
    scene = ring_scene()
    shafts = (scene.shafts[0], replace(scene.shafts[1], origin=(0.07, 0.0, 0.0)))
    cases = [
        with_gear(scene, 0, internal=True),
        with_gear(scene, 1, base_helix_angle=0.1),
        with_gear(with_gear(scene, 0, teeth=61, base_radius=61 * PER_TOOTH), 1, teeth=61),
        replace(scene, shafts=shafts),
    ]
    for case in cases:
        with pytest.raises(InputError, match=r"meshes\[0\]\.driven"):
            assemble(case)
