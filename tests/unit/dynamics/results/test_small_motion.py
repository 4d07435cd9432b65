"""Runs beyond small motion end with the part, its value and the bound; others say what comes nearest."""

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_trains import PITCH, Train
from geared_scenes import square_wave_table

from dynamics import Bushing, LoadTorque, Outputs, Scene, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.bearings import BallBearing, RollingBearing
from dynamics.errors import SolveError
from dynamics.motion.sampled_states import States
from dynamics.results.small_motion import SmallMotionCheck


def pair_on(stiffness: float, **changes) -> Scene:
    """A spur pair of 20 and 30 teeth on bearings of a stiffness, loaded by 40 N m."""
    train = Train(speed=100.0)
    train.add("pinion", 20, share=0.6, position=0.1)
    train.add("wheel", 30, share=0.6, position=0.1)
    train.mesh("pinion", "wheel", 0.36, 0.3)
    scene = train.scene()
    return replace(
        scene,
        duration=0.01,
        meshes=(replace(scene.meshes[0], table=square_wave_table()),),
        bushings=tuple(
            Bushing(f"{shaft.name} {z}", shaft.name, z, stiffness)
            for shaft in scene.shafts
            for z in (0.0, 0.2)
        ),
        loads=(LoadTorque("brake", "wheel", TimeLaw.constant(40.0)),),
        outputs=Outputs(displacements=True),
        **changes,
    )


def small_motion(ledger):
    return [check for check in ledger["checks"] if check["assumption"] == "small motion"]


def test_a_run_within_names_what_comes_nearest():
    result = simulate(pair_on(1e8))
    (check,) = small_motion(result.effect_ledger)
    assert check["holds"] and check["valid"] and 0.0 < check["largest"] < check["bound"]
    assert "invalid" not in result.receipt


def test_axes_that_move_by_the_working_depth_end_the_run_with_part_value_and_bound():
    """Against the distance of the displaced axes themselves."""
    scene = pair_on(9e4)
    with pytest.raises(SolveError, match=r"small motion \(pinion-wheel\)") as error:
        simulate(scene)
    result = error.value.partial
    (entry,) = result.receipt["invalid"]
    assert entry["part"] == "pinion-wheel" and entry["valid"] is False
    distance = 50e-3 / math.cos(0.36)
    assert entry["bound"] == pytest.approx(2.0 * 2.0 * distance / 50, rel=1e-12)
    names = list(result.case["freedoms"])
    x, y = (
        result.displacement[names.index(f"wheel.{axis}")] - result.displacement[names.index(f"pinion.{axis}")]
        for axis in "xy"
    )
    apart = np.hypot(distance * math.cos(0.3) + x, distance * math.sin(0.3) + y) - distance
    assert entry["largest"] == pytest.approx(np.max(np.abs(apart)), rel=1e-6)
    assert entry["largest"] > entry["bound"]
    assert f"{1e3 * entry['bound']:.4g} mm" in entry["reason"]


def test_a_report_completes_and_says_that_it_is_invalid():
    result = simulate(pair_on(9e4, on_violation="report"))
    assert result.status.usable
    assert [entry["part"] for entry in result.receipt["invalid"]] == ["pinion-wheel"]


def test_flanks_that_part_by_a_base_pitch_end_the_run():
    """A load that turns around, and no coast flank behind the driving one."""
    scene = pair_on(1e8)
    load = LoadTorque("brake", "wheel", TimeLaw((0.0, 0.002, 0.003, 0.05), (40.0, 40.0, -400.0, -400.0)))
    with pytest.raises(SolveError, match="transmission error up to") as error:
        simulate(replace(scene, duration=0.03, loads=(load,)))
    largest = np.max(np.abs(error.value.partial.dynamic_transmission_error))
    entry = error.value.partial.receipt["invalid"][0]
    assert entry["largest"] == pytest.approx(largest, rel=1e-9)
    assert entry["bound"] == pytest.approx(PITCH, rel=1e-12)


def checked(system, **moved):
    q = np.zeros((3, len(system.freedoms.name)))
    for name, value in moved.items():
        q[1, system.freedoms.name.index(name.replace("__", "."))] = value
    check = SmallMotionCheck(system)
    none = np.zeros((3, 0))
    series = {"dynamic_transmission_error": np.zeros((1, 3))}
    check.see(series, States(q, q, none, none.astype(int), none, none, none))
    return check.checks()


def test_tilts_count_by_their_size_whatever_their_direction():
    system = assemble(pair_on(1e8, effects={"tilt": "on"}))
    for size, holds in ((0.0099, True), (0.0101, False)):
        (check,) = checked(system, pinion__tilt_x=0.6 * size, pinion__tilt_y=-0.8 * size)
        assert (check.part, check.holds, check.valid) == ("pinion", holds, holds)
        assert check.figures["largest"] == pytest.approx(size, rel=1e-12)


def test_rings_of_a_rolling_bearing_move_by_less_than_a_ball():
    scene = pair_on(1e8)
    ball = BallBearing(count=9, diameter=3e-3, pitch_diameter=30e-3)
    bearing = RollingBearing("ball bearing", "pinion", ball, 0.1)
    system = assemble(replace(scene, bushings=scene.bushings[2:], rolling_bearings=(bearing,)))
    assert checked(system, pinion__x=2.9e-3)[0].holds
    (check,) = [check for check in checked(system, pinion__x=3.1e-3) if check.part == "ball bearing"]
    assert not check.holds and check.figures["bound"] == 3e-3
