"""The operating point of a result in words: loads, speeds, misalignment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bounds import engineering, shaft_words
from lineofaction.gearbox.units import MM, RPM, UM

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.scene import SceneInput

OPERATING_POINT = "operating_point"
"""Name among the facts of the result of a scene, under which its operating point stands."""
_TYPED, _COMPUTED = 5, 4
"""Significant digits of a number that somebody typed, at most, and of one that was computed."""


def pair_point(
    torque: float, force: float | None, misalignment: float, center_distance_change: float = 0.0
) -> str:
    """Return the operating point of a pair: "at 120 N m (6169 N), misalignment 0 µm".

    Torque on the driving gear in N m, normal force in N, None: not named; both lengths in m.
    """
    newtons = "" if force is None else f" ({engineering(force, 4)} N)"
    parts = [f"at {typed(torque)} N m{newtons}", f"misalignment {engineering(misalignment / UM, 4)} µm"]
    if center_distance_change:
        parts.append(f"center distance {engineering(center_distance_change / MM, 4, '+')} mm")
    return ", ".join(parts)


def typed(value: float) -> str:
    """Return a number as it was typed; a number of more digits than anybody types is rounded to four."""
    text = engineering(value, _TYPED)
    return text if float(text) == float(f"{value:.12g}") else engineering(value, _COMPUTED)


def scene_point(scene: SceneInput, speed: tuple[str, float] | None = None) -> str:
    """Return the operating point of a scene: its loads at the start, constant speeds, misaligned meshes.

    `speed`: a shaft and its speed, rad/s, at which a result is computed in place of the speeds of drives.
    """
    parts = []
    for load in scene.loads:
        later = " at the start" if len(set(load.torque_n_m)) > 1 else ""
        parts.append(f"{typed(load.torque_n_m[0])} N m on {shaft_words(load.shaft)}{later}")
    parts += [f"the torques over speed of {part.name}" for part in scene.speed_torques]
    if speed is not None:
        parts.append(f"{engineering(speed[1] / RPM, _COMPUTED)} rpm of {shaft_words(speed[0])}")
    for drive in scene.drives if speed is None else ():
        if drive.speed_rpm is not None and drive.speed_rpm[0] and len(set(drive.speed_rpm)) == 1:
            parts.append(f"{typed(drive.speed_rpm[0])} rpm of {shaft_words(drive.shaft)}")
    for mesh in scene.meshes:
        misalignment = getattr(mesh, "misalignment_um", 0.0)
        if misalignment:
            parts.append(f"{engineering(misalignment, 4)} µm misalignment of {mesh.name}")
    return f"at {', '.join(parts)}" if parts else ""
