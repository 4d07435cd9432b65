"""The 20/20 spur pair that all subjects measure, as code for a process of its own."""

from __future__ import annotations

TORQUES = (10, 20, 35, 50, 75, 100, 130, 165, 200, 260, 330, 400)

PAIR = """
from fe_contact import Gear, GearPair, analyze
gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
pair = GearPair(gear, gear, center_distance=80e-3)
"""
