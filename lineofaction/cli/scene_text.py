"""The text of a scene file: a pair between two shafts."""

from __future__ import annotations

from lineofaction.cli.case_text import case_tables
from lineofaction.cli.pair_sketch import PairSketch

HEAD = """# {head}
# Made by loa new; every figure may be changed. All fields: docs/case-file.md#scene.
# Next: loa simulate FILE -o run.nc, then loa report run.nc; loa modes FILE for natural frequencies.
"""

ACCURACY = """
[meshes.case.accuracy]
level = "draft" # a table for a first run; "standard" or a tolerance once the scene is right
"""


def pair_scene_text(pair: PairSketch, head: str) -> str:
    """Return a motor, a pair between two shafts on two bearings each, and a brake; the motor runs up."""
    length = 4.0 * pair.width
    sides = (("input", "pinion", pair.pinion, 0.0), ("output", "wheel", pair.wheel, pair.center_distance))
    shafts = "".join(
        _shaft(name, length, gear.bore, origin)
        + _gear(tooth, name, 0.5 * length, gear.bore)
        + _bearings(name, length)
        for name, tooth, gear, origin in sides
    )
    load = pair.torque[-2] * pair.wheel.teeth / pair.pinion.teeth
    return f"""{HEAD.format(head=head)}
[run]
duration_s = 1.0
{shafts}
[[meshes]]
name = "mesh"
driver = "pinion"
driven = "wheel"
damping_ratio = 0.07 # measured ones lie between 0.03 and 0.17

{case_tables(pair, "meshes.case.")}{ACCURACY}
[[drives]] # the angle is imposed: a run-up
name = "motor"
shaft = "input"
time_s = [0.0, 1.0]
speed_rpm = [300.0, 3000.0]

[[loads]]
name = "brake"
shaft = "output"
torque_n_m = [{load:.4g}] # three quarters of the table's highest load

[outputs]
bearing_forces = true
"""


def _shaft(name: str, length: float, diameter: float, origin: float) -> str:
    return f"""
[[shafts]]
name = "{name}"
length_mm = {length:g}
diameter_mm = {diameter:g}
origin_mm = [{origin:.10g}, 0.0, 0.0]
"""


def _gear(name: str, shaft: str, position: float, bore: float) -> str:
    """Return a gear whose body follows from its case."""
    return f"""
[[gears]]
name = "{name}"
shaft = "{shaft}"
position_mm = {position:g} # along the shaft
bore_diameter_mm = {bore:g}
"""


def _bearings(shaft: str, length: float) -> str:
    """Return the two bearings of a shaft; the left one carries the axial force."""
    return "".join(
        f"""
[[bushings]]
name = "{shaft} {side}"
shaft = "{shaft}"
position_mm = {position:g}
radial_stiffness_n_per_m = 3e8
{"axial_stiffness_n_per_m = 1e8" + chr(10) if side == "left" else ""}damping_ratio = 0.02
"""
        for side, position in (("left", 0.0), ("right", length))
    )
