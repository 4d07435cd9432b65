"""The size of temperatures in the ledger against the scene solved with and without them."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import square_wave_table
from warm_scenes import ANGULAR, CYLINDRICAL, DEEP_GROOVE, TAPERED, distant, mirrored, warm_pair

from dynamics.assembly.assemble import assemble
from dynamics.integrators.static import static_equilibrium

FACTOR = 1.5
SCENES = {
    "deep groove": ({}, "bearing_temperature"),
    "gears off the middle": (
        {"positions": (0.02, 0.12), "housing": 90.0, "rings": (80.0, 60.0)},
        "bearing_temperature",
    ),
    "cylindrical": (
        {"rows": (DEEP_GROOVE, CYLINDRICAL), "rings": (90.0, 70.0), "housing": 70.0},
        "bearing_temperature",
    ),
    "tapered O": ({"rows": (TAPERED, mirrored(TAPERED)), "preload": 300.0}, "bearing_temperature"),
    "tapered X that opens": (
        {"rows": (mirrored(TAPERED), TAPERED), "preload": 800.0, "housing": 90.0, "rings": (75.0, 70.0)},
        "bearing_temperature",
    ),
    "angular O": (
        {"rows": (ANGULAR, mirrored(ANGULAR)), "preload": 300.0, "housing": 60.0},
        "bearing_temperature",
    ),
    "housing warmer than gears": ({"housing": 90.0, "gears": 60.0}, "mesh_temperature"),
    "gears warmer than housing": ({"housing": 30.0, "gears": 110.0}, "mesh_temperature"),
}


def gear_along_line(system, displacement):
    """How far the driver's gear moves along the line of action, m; by its rigid shaft."""
    scene, line = system.scene, system.lines[0]
    gear = scene.gear(scene.meshes[0].driver)
    index = scene.shaft_index(gear.shaft)
    move = (system.freedoms.motion @ displacement)[6 * index : 6 * index + 6]
    lever = scene.shafts[index].origin[2] + gear.position - system.rotors[index].center[2]
    return float((move[:3] + np.cross([*move[3:5], 0.0], [0.0, 0.0, lever]))[:2] @ line.force[:2])


def rest(scene, effect):
    """The displacement at a bearing's gear, or the mean of the transmission error, m."""
    system = assemble(scene)
    found = []
    for time in np.arange(16) / 16.0 * 0.2 / 90.0 if effect == "mesh_temperature" else (0.0,):
        solution = static_equilibrium(system, float(time))
        assert solution.status.usable
        rows = system.arrays.direction[system.driving_rows[0]]
        error = float(rows @ solution.displacement)
        found.append(
            error if effect == "mesh_temperature" else gear_along_line(system, solution.displacement)
        )
    return float(np.mean(found))


@pytest.mark.parametrize("name", SCENES)
def test_the_ledger_states_what_an_ablation_changes(name):
    changes, effect = SCENES[name]
    scene = warm_pair(**({"table": distant(square_wave_table())} | changes))
    on, off = (rest(replace(scene, effects={**scene.effects, effect: at}), effect) for at in ("on", "off"))
    entry = assemble(scene).ledger.of(effect)[0]
    assert entry.on
    assert 1.0 / FACTOR < entry.influence / abs(on - off) < FACTOR
