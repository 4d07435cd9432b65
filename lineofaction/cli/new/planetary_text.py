"""The text of a scene file of a planetary stage."""

from __future__ import annotations

import math
from dataclasses import dataclass

from lineofaction.cli.new.case_text import case_tables
from lineofaction.cli.new.scene_text import ACCURACY, HEAD
from lineofaction.cli.new.sketch import GearSketch, PairSketch, bore_of, face_width, ring_pair
from lineofaction.cli.new.wanted import Wanted
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import DEGREE

_PLANETS = 3
_LEAST_TEETH = 18
"""Of a planet: with fewer, teeth without profile shift are undercut."""
_LOAD_SHARE = 0.6
"""Of the sun's highest torque in the table."""


@dataclass(frozen=True)
class StageSketch:
    """Both meshes of a stage with a held ring, and its ratio of sun to carrier."""

    sun: PairSketch
    ring: PairSketch
    ratio: float


def planetary_stage(wanted: Wanted) -> StageSketch:
    """Return a stage of three planets; its ring has the teeth of the sun and twice those of a planet.

    Raises
    ------
    BadInput
        No planets fit a ratio that small.
    """
    module, teeth, helix = wanted.module or 2.0, wanted.teeth or 24, wanted.helix or 0.0
    wished = 0.5 * teeth * ((wanted.ratio or 5.0) - 2.0)
    fitting = [count for count in range(_LEAST_TEETH, int(wished) + 4) if (teeth + count) % _PLANETS == 0]
    if not fitting or wished < _LEAST_TEETH:
        least = 2.0 + 2.0 * _LEAST_TEETH / teeth
        bound = f"at least {least:.3g} with {teeth} teeth of the sun"
        raise BadInput.of("--ratio", wanted.ratio, bound, "Or leave it out.")
    planet = min(fitting, key=lambda count: abs(count - wished))
    width = wanted.width or face_width(module, helix)
    ring = ring_pair(module, helix, width, planet, teeth + 2 * planet)
    transverse = module / math.cos(helix * DEGREE)
    sun = GearSketch(teeth, 0.0, bore_of(teeth, module, helix, width), ring.wheel.allowance)
    torque = tuple(float(f"{value * teeth / planet:.2g}") for value in ring.torque)
    pair = PairSketch(module, helix, width, 0.5 * transverse * (teeth + planet), sun, ring.pinion, torque)
    return StageSketch(pair, ring, 2.0 + 2.0 * planet / teeth)


def planetary_text(stage: StageSketch, head: str) -> str:
    """Return a stage whose sun is driven, whose carrier is braked, and whose ring is held."""
    length = 2.0 * stage.sun.width
    middle = 0.5 * length
    brake = _PLANETS * _LOAD_SHARE * stage.sun.torque[-1] * stage.ratio
    offset = 0.5 if stage.sun.wheel.teeth % 2 == 0 else 0.0
    return f"""{HEAD.format(head=head)}
[run]
duration_s = 0.5
{_shafts(stage, length)}{_gears(stage, middle)}{_bearings(middle)}
[[planets]] # all are copies of the first
planet = "planet"
number = {_PLANETS}

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
position_offset = {offset} # planets with an even number of teeth meet sun and ring half a pitch apart

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
diameter_mm = {stage.sun.pinion.held:g}

[[shafts]]
name = "ring"
frame = "carrier"
length_mm = {length:g}
inertia = {none}

[[shafts]] # the first planet
name = "planet"
frame = "carrier"
length_mm = {length:g}
diameter_mm = {stage.sun.wheel.held:g}
origin_mm = [{stage.sun.center_distance:.10g}, 0.0, 0.0]
"""


def _gears(stage: StageSketch, middle: float) -> str:
    """Return the gears at mid-length; the ring's inertia counts for nothing while it is held."""
    return f"""
[[gears]]
name = "sun gear"
shaft = "sun"
position_mm = {middle:g}
bore_diameter_mm = {stage.sun.pinion.held:g}

[[gears]]
name = "planet gear"
shaft = "planet"
position_mm = {middle:g}
bore_diameter_mm = {stage.sun.wheel.held:g}

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
