"""A motion that dies away comes to rest: numbers that underflow would cost a hundred times as much."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.loads import TimeLaw
from dynamics.scene import Integration


@pytest.mark.parametrize("method", ["explicit", "implicit"])
def test_what_dies_away_is_at_rest_before_it_underflows(method: str) -> None:
    """Along the axis nothing pushes a spur gear: what is there at the start falls by its damping alone."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(50.0), duration=2.0)
    scene = replace(scene, effects={**scene.effects, "axial": "on"})
    system = assemble(scene)
    along = system.freedoms.name.index("input.z")
    start = static_equilibrium(system)
    moved = start.displacement.copy()
    moved[along] = 1e-9
    run = integrate(system, replace(start, displacement=moved), Integration(method=method))
    sizes = np.abs(run.q[:, along])
    assert sizes[0] > 1e-10
    assert not np.any((sizes > 0.0) & (sizes < 1e-200))
    assert np.all(run.q[-10:, along] == 0.0) and np.all(run.v[-10:, along] == 0.0)
