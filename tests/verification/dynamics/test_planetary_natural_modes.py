"""Natural frequencies of the planetary set of Lin and Parker (1999), plane model, three freedoms per body."""

from __future__ import annotations

import numpy as np
import pytest
from planetary_scenes import planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.linearize import natural_modes

RING_TORSION = 1e9  # N/m on the ring's base circle

# Hz; recomputed independently for the data of the 1999 example
ROTATIONAL = {
    3: [0.0, 1475.75, 1930.35, 2658.32, 7462.80, 11775.27],
    5: [0.0, 1567.40, 2006.08, 2614.80, 8065.39, 14253.09],
}
TRANSLATIONAL = {
    3: [743.16, 1102.42, 1896.02, 2276.38, 6986.30, 9647.91],
    5: [710.05, 1072.01, 1888.08, 2425.30, 7382.38, 11172.31],
}
PLANET = {3: [], 5: [1808.18, 5963.76, 6981.71]}


def modes_of(planets):
    gears = published_set(planets)
    system = assemble(planetary_scene(gears, ring_support=RING_TORSION * gears.base_radius[2] ** 2))
    return natural_modes(system)


@pytest.mark.parametrize("planets", [3, 5])
def test_natural_frequencies_are_the_published_ones(planets, record_figure):
    modes = modes_of(planets)
    expected = sorted([*ROTATIONAL[planets], *2 * TRANSLATIONAL[planets], *(planets - 3) * PLANET[planets]])
    assert modes.frequency.size == 3 * (planets + 3) == len(expected)
    assert modes.frequency[0] == 0.0
    error = np.abs(modes.frequency[1:] / np.array(expected[1:]) - 1.0)
    record_figure(
        f"natural frequencies, {planets} planets",
        float(np.max(error)),
        "at most 1e-4",
        "1",
        "Lin and Parker 1999",
    )
    assert np.max(error) < 1e-4
