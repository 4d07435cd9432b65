"""Speed ratios of all shafts to the drive's, from tooth numbers, and the sense in which each turns."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from dynamics.errors import InputError
from dynamics.system.scene import Scene


@dataclass(frozen=True)
class Kinematics:
    """Motion of the shafts if all gears were conjugate.

    Attributes
    ----------
    drive : int
        The shaft whose rotation is imposed.
    ratio : tuple of Fraction
        Speed of each shaft over that of the drive's, both about +z; exact.
    sense : tuple of int
        +1 or -1: in which sense about +z each shaft is driven.
    """

    drive: int
    ratio: tuple[Fraction, ...]
    sense: tuple[int, ...]


def solve_kinematics(scene: Scene) -> Kinematics:
    """Walk through the meshes from the drive.

    Raises
    ------
    InputError
        If a shaft is not geared to the drive, or a loop of meshes asks for two speeds of one shaft.
    """
    drive = scene.shaft_index(scene.drives[0].shaft)
    found: dict[int, Fraction] = {drive: Fraction(1)}
    links = [_link(scene, index) for index in range(len(scene.meshes))]
    while True:
        fresh = [(a, b, ratio) for a, b, ratio in links if (a in found) != (b in found)]
        if not fresh:
            break
        for a, b, ratio in fresh:
            if a in found:
                found.setdefault(b, found[a] * ratio)
            else:
                found.setdefault(a, found[b] / ratio)
    for index, (a, b, ratio) in enumerate(links):
        if a in found and found[b] != found[a] * ratio:
            raise InputError(
                f"meshes[{index}]", str(ratio), f"of ratio {found[b] / found[a]}, as other meshes ask"
            )
    for index, shaft in enumerate(scene.shafts):
        if index not in found:
            raise InputError(
                f"shafts[{index}]", shaft.name, "geared to the drive", "Add a mesh or leave it out."
            )
    forward = 1 if scene.drives[0].speed.extreme > 0.0 else -1
    ratios = tuple(found[index] for index in range(len(scene.shafts)))
    return Kinematics(drive, ratios, tuple(forward if value > 0 else -forward for value in ratios))


def _link(scene: Scene, index: int) -> tuple[int, int, Fraction]:
    """Shafts of a mesh and the speed of the second over that of the first."""
    mesh = scene.meshes[index]
    driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
    a, b = scene.shaft_index(driver.shaft), scene.shaft_index(driven.shaft)
    if a == b:
        raise InputError(f"meshes[{index}].driven", mesh.driven, "on another shaft than the driver")
    return a, b, Fraction(-driver.teeth, driven.teeth)
