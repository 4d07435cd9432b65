"""What the effect ledger says of angles that nobody states, against the response at every angle."""

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_trains import Train
from geared_scenes import square_wave_table

from dynamics import Bushing, LoadTorque, TimeLaw
from dynamics.assembly.assemble import assemble
from dynamics.influence import with_assumed_phases
from dynamics.linearize import harmonic_response

SPEED = 60.0


def two_stages(first: int, second: int):
    """Two stages on an intermediate shaft with gears of so many teeth."""
    train = Train(speed=SPEED)
    train.add("pinion", 21, share=0.6)
    train.add("wheel", first, share=0.6, shaft="middle")
    train.add("small", second, share=0.6, shaft="middle", position=0.15)
    train.add("large", 57, share=0.6, position=0.15)
    train.mesh("pinion", "wheel", 0.36, 0.3)
    train.mesh("small", "large", 0.36, 1.4)
    scene = train.scene()
    table = square_wave_table()
    return replace(
        scene,
        meshes=tuple(replace(mesh, table=table) for mesh in scene.meshes),
        bushings=tuple(
            Bushing(f"{shaft.name} {z}", shaft.name, z, 2e8) for shaft in scene.shafts for z in (0.0, 0.2)
        ),
        loads=(LoadTorque("brake", "large", TimeLaw.constant(100.0)),),
    )


def test_the_ledger_states_the_change_over_all_angles():
    scene = two_stages(42, 21)
    (row,) = with_assumed_phases({}, assemble(scene))["assumed"]
    assert row["part"] == "middle" and "wheel" in row["words"] and "small" in row["words"]
    level = []
    for turn in np.arange(61) / 61:
        middle = replace(scene.shafts[1], tooth_angles=(0.0, turn * 2.0 * math.pi / 21))
        stated = assemble(replace(scene, shafts=(scene.shafts[0], middle, scene.shafts[2])))
        assert with_assumed_phases({}, stated) == {}
        response = harmonic_response(stated, np.array([SPEED]), 10)
        level.append(np.sqrt(np.sum(np.abs(response.bearing_force[:, :3]) ** 2, axis=(0, 1, 2))))
    change = 20.0 * np.log10(np.max(level, axis=0) / np.min(level, axis=0))
    index = int(np.argmin(np.abs(response.order - row["order"])))
    assert row["decibels"] > 1.0
    assert row["decibels"] == pytest.approx(change[index], rel=0.02)
    above = 20.0 * np.log10(np.max(level, axis=0)[index] / level[0][index])
    assert row["above_assumed"] == pytest.approx(above, abs=0.1)


def test_gears_without_a_common_order_do_not_change_a_level():
    (row,) = with_assumed_phases({}, assemble(two_stages(43, 22)))["assumed"]
    assert abs(row["decibels"]) < 1e-9
