"""The text of a scene file of a planetary stage.

The sun is driven, the carrier is braked, and the ring stands still. The templates are TOML with its comments.
"""

from __future__ import annotations

import math

from lineofaction.cli.case_text import case_tables
from lineofaction.cli.scene_text import ACCURACY, HEAD
from lineofaction.cli.stage_sketch import PLANETS, StageSketch

_LOAD_SHARE = 0.6
"""Torque of the sun under the brake, as part of the highest torque of its STE table."""
_CARRIER_THICKNESS = 0.8
"""Axial length of steel in the carrier, over the length of its shaft."""
_STEEL = 7850.0
"""Density of steel, kg/m^3."""


def planetary_text(stage: StageSketch, head: str) -> str:
    """Return the text of the scene file of a stage; `head` is the first comment of the file."""
    length = 2.0 * stage.sun.width  # of all shafts, mm
    middle = 0.5 * length
    # torques rise: the last is the highest; the ratio is that of sun to carrier
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
    """Return the tables of the carrier, the sun, the ring and the first planet; `length` is in mm.

    The inertia of the carrier is that of a steel disc whose radius is the center distance. The ring has none
    on its shaft: it stands still.
    """
    radius = 1e-3 * stage.sun.center_distance  # m
    thickness = 1e-3 * _CARRIER_THICKNESS * length  # m
    mass = _STEEL * math.pi * radius**2 * thickness
    polar = 0.5 * mass * radius**2
    transverse = 0.6 * polar  # a thin disc has 0.5; the rest is a round figure for its thickness
    carrier = f"{{ mass_kg = {mass:.3g}, polar_kg_m2 = {polar:.3g}, transverse_kg_m2 = {transverse:.3g} }}"
    zero = "{ mass_kg = 0.0, polar_kg_m2 = 0.0, transverse_kg_m2 = 0.0 }"
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
inertia = {zero}

[[shafts]] # the first planet
name = "planet"
frame = "carrier"
length_mm = {length:g}
diameter_mm = {stage.sun.wheel.bore:g}
origin_mm = [{stage.sun.center_distance:.10g}, 0.0, 0.0]
"""


def _gears(stage: StageSketch, middle: float) -> str:
    """Return the tables of the gears at mid-length.

    A gear without a bore needs an inertia; that of the ring has no effect, as its speed is imposed as zero.
    """
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
    """Return the tables of the bearings of the sun, the ring and the carrier, and of the planet's pin."""
    sun = _bushing("sun bearing", "sun", middle, "1e6 # soft: the sun floats between the planets")
    ring = _bushing("ring mount", "ring", middle, "1e9")
    carrier = _bushing("carrier bearing", "carrier", middle, "2e8")
    return f"""{sun}{ring}{carrier}
[[planet_bearings]]
name = "pin"
shaft = "planet"
carrier = "carrier"
position_mm = {middle:g}
radial_stiffness_n_per_m = 2e8
axial_stiffness_n_per_m = 1e8
"""


def _bushing(name: str, shaft: str, position: float, radial_stiffness: str) -> str:
    """Return the table of a bushing; the stiffness is a text in TOML, which may end in a comment."""
    return f"""
[[bushings]]
name = "{name}"
shaft = "{shaft}"
position_mm = {position:g}
radial_stiffness_n_per_m = {radial_stiffness}
axial_stiffness_n_per_m = 1e8
"""
