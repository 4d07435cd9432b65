"""Blocks of a run: between them the interpreter looks at it."""

from __future__ import annotations

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, march, static_equilibrium
from dynamics.integrators.start_value import Trail


def test_blocks_leave_every_sample_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    system = assemble(gear_pair_scene(spring_table(4e8), duration=0.02))
    start, settings = static_equilibrium(system), system.scene.integration
    runs, early = [], []
    for work in (0, march.BLOCK_WORK):
        monkeypatch.setattr(march, "BLOCK_WORK", work)
        trail = Trail(system)
        runs.append(integrate(system, start, settings, trail=trail))
        early.append(trail.before(0.5 * system.scene.duration) is not None)
    for name in ("q", "v", "work", "stored"):
        np.testing.assert_array_equal(getattr(runs[0], name), getattr(runs[1], name))
    assert early == [True, False]


def test_whoever_waits_is_told_fifty_times() -> None:
    system = assemble(gear_pair_scene(spring_table(4e8), duration=0.02))
    seen: list[float] = []
    integrate(
        system,
        static_equilibrium(system),
        system.scene.integration,
        progress=lambda fraction, _: seen.append(fraction),
    )
    assert len(seen) >= 0.9 * march.CHUNKS
