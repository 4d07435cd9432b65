"""Errors of a run by source on its page."""

from __future__ import annotations

from dataclasses import replace

from geared_scenes import gear_pair_scene

from dynamics.scene import Outputs
from dynamics.simulation import simulate
from lineofaction.report.run.page import _accuracy


def test_every_source_has_its_row_and_unknown_ones_have_none() -> None:
    scene = gear_pair_scene(duration=0.2, effects={"lateral": "off"})
    full = dict(_accuracy(simulate(scene)).rows)
    lean = dict(_accuracy(simulate(replace(scene, outputs=Outputs(receipt="minimal")))).rows)
    for start in ("step error", "table error", "neglected effects"):
        assert sum(title.startswith(start) for title in full) >= 1
    assert not any(title.startswith("table error") for title in lean)
    assert [value for title, value in lean.items() if title.startswith("step error")] == ["1.00"]
