"""The spur pair of the verbs' tests as a case file writes it, without loads."""

from __future__ import annotations


def spur_case(pinion: str = "", wheel: str = "") -> str:
    return f"""
[pair]
normal_module_mm = 4.0
center_distance_mm = 80.0
[pair.pinion]
teeth = 20
face_width_mm = 25.0
bore_diameter_mm = 40.0
{pinion}
[pair.wheel]
teeth = 20
face_width_mm = 25.0
bore_diameter_mm = 40.0
{wheel}
"""


SPUR = spur_case()
