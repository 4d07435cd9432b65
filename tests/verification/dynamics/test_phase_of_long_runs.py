"""Phase of integrated runs against exact arithmetic: no step adds a rounding to the position.

The benchmark `long_phase` runs the same for 1e7 steps; what is done in a step knows nothing of how many there
were, so that errors may grow with the angle turned only, and that is exact for huge counts by itself.
"""

from __future__ import annotations

import pytest
from rotating_trains import accelerating, imposed, phase_error

STEPS = 100_000


@pytest.mark.parametrize("method", ["implicit", "explicit"])
@pytest.mark.parametrize("make", [imposed, accelerating], ids=["imposed", "accelerating"])
def test_the_phase_is_exact_after_many_steps(make, method, record_figure):
    error = abs(phase_error(make(STEPS, method)))
    name = f"phase after {STEPS:g} steps, {make.__name__}, {method}"
    record_figure(name, error, "below 1e-9", "base pitches", "own target")
    assert error < 2e-13 * (STEPS / 1e5) ** 2  # 5e-12 after 1e7 steps, with the angle
