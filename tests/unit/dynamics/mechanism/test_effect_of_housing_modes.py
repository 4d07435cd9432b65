"""The effect of a housing's modes: off it changes no bit, and the ledger calls for it where they matter."""

import math
from dataclasses import replace

import numpy as np
from housed_scenes import BLOCK, GROUND, OFF, ON, block, housed, pair, rows

from dynamics import Outputs, RollingContact
from dynamics.assembly.assemble import assemble
from dynamics.bearings import RollerBearing, RollingBearing

ROLLERS = RollerBearing(17, 9e-3, 13.6e-3, 65e-3, clearance=-5e-6)


def test_without_the_effect_it_is_the_housing_without_mass_bit_by_bit():
    scene = housed(pair(OFF), 6)
    bare = replace(scene, housings=(replace(scene.housings[0], mass=None),))
    for a, b in zip(assemble(scene).arrays.sparse, assemble(bare).arrays.sparse, strict=True):
        for x, y in zip(a, b, strict=True):
            np.testing.assert_array_equal(x, y)


def test_the_ledger_calls_for_it_near_the_first_mode_and_where_bearings_are_not_linear():
    auto = {key: value for key, value in ON.items() if key != "housing_modes"}
    scene = block(effects=auto, ratio=0.01)
    first = math.sqrt(GROUND / BLOCK) / (2.0 * math.pi)
    mesh = 10.0 / (2.0 * math.pi) * 20.0
    for orders, on in ((1, (mesh / first) ** 2 > 0.01), (10, True)):
        ledger = assemble(replace(scene, outputs=Outputs(mesh_orders=orders))).ledger
        assert ledger.on("housing_modes", "disc") is on
        assert not ledger.on("housing_modes", "input")
    slow = replace(scene, housings=(replace(scene.housings[0], stiffness=rows(1e12 * np.eye(3))),))
    assert not assemble(slow).ledger.on("housing_modes", "disc")
    both = {"housing_modes": "off", "bearing_clearance": "off"}
    linear = replace(scene, rolling_contacts=(RollingContact("seat", 5e8),), effects=auto | both)
    assert not assemble(linear).ledger.on("housing_modes", "disc")
    assert not assemble(linear).rotors.housings
    curved = replace(
        slow, rolling_contacts=(RollingContact("seat", 5e8),), effects=auto | {"housing_modes": "off"}
    )
    entry = next(part for part in assemble(curved).ledger.of("housing_modes") if part.part == "disc")
    assert entry.on and not entry.possible and "not linear" in entry.reason


def test_the_ledger_calls_for_it_where_passing_elements_reach_the_first_mode():
    """17 rollers pass 7.3 times a turn, counted to the fourth multiple: above the 20 teeth."""
    first = 390.0
    ground = BLOCK * (2.0 * math.pi * first) ** 2
    scene = block(effects={"lateral": "on"}, speed=10.0, outputs=Outputs(mesh_orders=1))
    scene = replace(scene, housings=(replace(scene.housings[0], stiffness=rows(ground * np.eye(3))),))
    assert not assemble(scene).ledger.on("housing_modes", "disc")
    left, *others = scene.bushings
    roller = RollingBearing(left.name, left.shaft, ROLLERS, left.position)
    passed = replace(scene, bushings=tuple(others), rolling_bearings=(roller,))
    entry = next(part for part in assemble(passed).ledger.of("housing_modes") if part.part == "disc")
    assert entry.on
    passing = 4.0 * ROLLERS.count * ROLLERS.cage_ratio * 10.0 / (2.0 * math.pi)
    assert f"passing elements reach {passing:.4g} Hz" in entry.reason
