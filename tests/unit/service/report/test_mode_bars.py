"""Modes as bars: every bar is whole, parts keep their color, what is not named is drawn as others."""

from __future__ import annotations

import numpy as np
import pytest

from lineofaction.report.drawing import palette
from lineofaction.report.response.modes import OTHERS, _largest_parts, mode_bars

SHARES = [{"input lateral": 0.7, "output torsional": 0.3}, {"output torsional": 0.6}]


def test_the_parts_of_every_mode_add_up_to_the_whole() -> None:
    panel = mode_bars(["100 Hz", "200 Hz"], SHARES, "kinetic energy")
    heights = sum(bars.top - bars.base for bars in panel.bars)
    np.testing.assert_allclose(heights, 100.0, rtol=1e-12, atol=0.0)
    for below, above in zip(panel.bars, panel.bars[1:], strict=False):
        np.testing.assert_array_equal(below.top, above.base)
    sizes = {bars.name: (bars.top - bars.base).tolist() for bars in panel.bars}
    assert sizes["output torsional"] == pytest.approx([30.0, 60.0])
    assert sizes[OTHERS] == pytest.approx([0.0, 40.0])


def test_the_largest_parts_have_the_colors() -> None:
    many = [{f"part {k}": 0.5 / (k + 2) for k in range(9)}]
    parts = _largest_parts(many)
    assert parts == [f"part {k}" for k in range(len(palette.CATEGORIES))]
    assert [bars.name for bars in mode_bars(["1 Hz"], many, "strain energy").bars][-1] == OTHERS
