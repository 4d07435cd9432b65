"""Frames of REXS components in that of the gear unit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rexs_stage import PINION, stage_unit

from lineofaction.gearbox.from_rexs.placement import frame_of
from lineofaction.gearbox.problems import BadInput


def frame_with(**values: Any) -> Any:
    unit = stage_unit({PINION: values})
    return frame_of(unit.part(PINION)), unit


def test_a_frame_within_a_turned_frame_is_turned_with_it() -> None:
    # Shaft 1 points along w of the unit; 30 mm along its u axis is 30 mm along w.
    turned = {
        "support_vector": (1.0, 2.0, 3.0),
        "u_axis_vector": (0.0, 0.0, 1.0),
        "w_axis_vector": (1.0, 0.0, 0.0),
    }
    unit = stage_unit({1: turned, PINION: {"reference_component_for_position": 1}})
    frame = frame_of(unit.part(PINION))
    assert frame.origin == pytest.approx([1e-3, 2e-3, 33e-3], rel=1e-12)
    assert frame.u == pytest.approx([0.0, 0.0, 1.0], abs=1e-15)
    assert np.linalg.det(frame.axes) == pytest.approx(1.0, rel=1e-12)


def test_a_gear_without_a_place_stands_at_its_coordinate_on_the_shaft() -> None:
    frame, _ = frame_with(support_vector=None, u_coordinate_on_shaft=12.0)
    assert frame.origin == pytest.approx([12e-3, 0.0, 0.0], rel=1e-12)


def test_a_vector_that_is_none_is_left_out_and_said() -> None:
    frame, unit = frame_with(u_axis_vector=False)
    assert frame.u == pytest.approx([1.0, 0.0, 0.0])
    fates = {(line.component, line.item): line.fate for line in unit.account.lines()}
    assert fates[PINION, "u_axis_vector"] == "refused"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"u_axis_vector": (0.0, 0.0, 0.0)}, "a direction"),
        ({"u_axis_vector": (0.0, 0.0, 2.0), "w_axis_vector": (0.0, 0.0, 1.0)}, "not along u_axis_vector"),
    ],
)
def test_a_frame_that_is_none_is_refused(values: dict[str, Any], words: str) -> None:
    with pytest.raises(BadInput, match=words):
        frame_with(**values)


def test_frames_in_a_circle_are_refused() -> None:
    unit = stage_unit(
        {
            PINION: {"reference_component_for_position": 1},
            1: {"reference_component_for_position": PINION},
        }
    )
    with pytest.raises(BadInput, match="not placed by this one itself"):
        frame_of(unit.part(PINION))


def test_a_part_of_a_shaft_that_another_refers_to_carries_it() -> None:
    """The pinion has no place but its coordinate; what refers to it stands there too."""
    changes = {
        PINION: {"support_vector": None, "u_coordinate_on_shaft": 12.0},
        2: {"support_vector": (0.0, 0.0, 80.0), "reference_component_for_position": PINION},
    }
    unit = stage_unit(changes)
    assert frame_of(unit.part(2)).origin == pytest.approx([12e-3, 0.0, 80e-3], rel=1e-12)
