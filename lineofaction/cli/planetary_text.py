"""The text of a scene file of a planetary stage."""

from __future__ import annotations

import math

from lineofaction.cli.case_text import case_tables
from lineofaction.cli.scene_text import ACCURACY, HEAD
from lineofaction.cli.stage_sketch import PLANETS, StageSketch

_LOAD_SHARE = 0.6
"""Of the sun's highest torque in the table."""


def planetary_text(stage: StageSketch, head: str) -> str:
    """Return a stage whose sun is driven, whose carrier is braked, and whose ring is held."""
    length = 2.0 * stage.sun.width
    middle = 0.5 * length
    brake = PLANETS * _LOAD_SHARE * stage.sun.torque[-1] * stage.ratio
    return f"""{HEAD.format(head=head)}
[run]
duration_s = 0.5
{_shafts(stage, length)}{_gears(stage, middle)}{_bearings(middle)}
[[planets]] # all are copies of the first
planet = "planet"
number = {PLANETS}

[[meshes]]
name = "sun mesh"
driver = "sun gear"
driven = "planet gear"
damping_ratio = 0.07 # measured ones lie between 0.03 and 0.17

{case_tables(stage.sun, "meshes.case.")}{ACCURACY}
[[meshes]]
name = "ring mesh"
driver = "planet gear"
driven = "ring gear"
damping_ratio = 0.07

{case_tables(stage.ring, "meshes.case.")}{ACCURACY}
[[drives]] # the angle is imposed: a run-up
name = "motor"
shaft = "sun"
time_s = [0.0, 0.5]
speed_rpm = [300.0, 1500.0]

[[drives]]
name = "ring held"
shaft = "ring"
speed_rpm = [0.0]

[[loads]]
name = "brake"
shaft = "carrier"
torque_n_m = [{brake:.3g}]
"""


def _shafts(stage: StageSketch, length: float) -> str:
    """Return carrier, sun, ring and the first planet; inertia of the carrier grows as its size."""
    radius = 1e-3 * stage.sun.center_distance
    mass = 800.0 * radius**2 * 1e-3 * length * math.pi * 7.85
    none = "{ mass_kg = 0.0, polar_kg_m2 = 0.0, transverse_kg_m2 = 0.0 }"
    polar = 0.5 * mass * radius**2
    carrier = f"{{ mass_kg = {mass:.3g}, polar_kg_m2 = {polar:.3g}, transverse_kg_m2 = {0.6 * polar:.3g} }}"
    return f"""
[[shafts]]
name = "carrier"
frame = "carrier" # a carrier names itself
length_mm = {length:g}
inertia = {carrier}

[[shafts]]
name = "sun"
frame = "carrier"
length_mm = {length:g}
diameter_mm = {stage.sun.pinion.bore:g}

[[shafts]]
name = "ring"
frame = "carrier"
length_mm = {length:g}
inertia = {none}

[[shafts]] # the first planet
name = "planet"
frame = "carrier"
length_mm = {length:g}
diameter_mm = {stage.sun.wheel.bore:g}
origin_mm = [{stage.sun.center_distance:.10g}, 0.0, 0.0]
"""


def _gears(stage: StageSketch, middle: float) -> str:
    """Return the gears at mid-length; the ring's inertia counts for nothing while it is held."""
    return f"""
[[gears]]
name = "sun gear"
shaft = "sun"
position_mm = {middle:g}
bore_diameter_mm = {stage.sun.pinion.bore:g}

[[gears]]
name = "planet gear"
shaft = "planet"
position_mm = {middle:g}
bore_diameter_mm = {stage.sun.wheel.bore:g}

[[gears]]
name = "ring gear"
shaft = "ring"
position_mm = {middle:g}
inertia = {{ mass_kg = 1.0, polar_kg_m2 = 1e-2, transverse_kg_m2 = 5e-3 }}
"""


def _bearings(middle: float) -> str:
    """Return the sun's soft bearing, the ring's mount, the carrier's bearing and the planet's pin."""
    return (
        "".join(
            f"""
[[bushings]]
name = "{name}"
shaft = "{shaft}"
position_mm = {middle:g}
radial_stiffness_n_per_m = {stiffness}
axial_stiffness_n_per_m = 1e8
"""
            for name, shaft, stiffness in (
                ("sun bearing", "sun", "1e6 # soft: the sun floats between the planets"),
                ("ring mount", "ring", "1e9"),
                ("carrier bearing", "carrier", "2e8"),
            )
        )
        + f"""
[[planet_bearings]]
name = "pin"
shaft = "planet"
carrier = "carrier"
position_mm = {middle:g}
radial_stiffness_n_per_m = 2e8
axial_stiffness_n_per_m = 1e8
"""
    )
