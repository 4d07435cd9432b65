"""One base pitch for gears that mesh: the rounding of printed radii is corrected, more is refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bounds import Quantity, Text, exactly
from dynamics.errors import InputError
from dynamics.identity_cache import cached_by
from dynamics.scene.scene import Scene
from dynamics.shafts import GearBody

EQUAL = 1e-9
"""Relative difference of base pitches that rounding in arithmetic alone may leave: nothing is corrected."""
PRINTED = 1e-3
"""Relative difference that radii printed with few digits may leave, and largest correction of a radius."""

Corrections = dict[str, tuple[float, float]]
"""Base radius as given and as used, m, of every gear that was corrected, by name."""


def with_common_base_pitches(scene: Scene) -> tuple[Scene, Corrections]:
    """Return `scene` with one base pitch per train of meshing gears, and the corrections.

    Printed radii are all rounded to the same length. So the pitch of a train is the least-squares fit of
    radius = pitch x teeth / (2 pi) to all its base radii. Raises `InputError`: the base pitches of two gears
    that mesh differ by more than `PRINTED`.
    """
    corrected = _corrections(scene)
    if not corrected:
        return scene, {}
    gears = tuple(
        replace(gear, base_radius=corrected[gear.name][1]) if gear.name in corrected else gear
        for gear in scene.gears
    )
    return replace(scene, gears=gears), dict(corrected)


@cached_by(lambda scene: (scene.gears, *((mesh.driver, mesh.driven) for mesh in scene.meshes)))
def _corrections(scene: Scene) -> Corrections:
    """Return the necessary corrections; raises `InputError`."""
    _check(scene)
    corrected: Corrections = {}
    for train in _trains(scene):
        radius = np.array([gear.base_radius for gear in train])
        teeth = np.array([gear.teeth for gear in train])
        per_tooth = radius / teeth
        if np.ptp(per_tooth) <= EQUAL * per_tooth.max():
            continue
        used = float(radius @ teeth / (teeth @ teeth)) * teeth
        for gear, value in zip(train, used, strict=True):
            if abs(value / gear.base_radius - 1.0) > PRINTED:
                field = f"gears[{scene.gears.index(gear)}].base_radius"
                remedy = f"Base pitches of a train agree to {PRINTED:g}."
                raise InputError(field, gear.base_radius, exactly(value, ", as its train has it"), remedy)
            corrected[gear.name] = (gear.base_radius, float(value))
    return corrected


def _check(scene: Scene) -> None:
    """Refuse meshes whose base pitches differ by more than printing rounds."""
    for index, mesh in enumerate(scene.meshes):
        driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
        if abs(driver.base_pitch / driven.base_pitch - 1.0) > PRINTED:
            pitch = Quantity(driver.base_pitch, "m", digits=6)
            bound = Text.of("a gear of base pitch ", pitch, " like the driver's")
            remedy = f"base_radius / teeth must agree to {PRINTED:g}; smaller differences are corrected."
            raise InputError(f"meshes[{index}].driven", Quantity(driven.base_pitch, "m"), bound, remedy)


def _trains(scene: Scene) -> Sequence[list[GearBody]]:
    """Return the gears of each train: a mesh joins the trains that its two gears are in."""
    trains: list[set[str]] = []
    for mesh in scene.meshes:
        pair = {mesh.driver, mesh.driven}
        separate = [train for train in trains if not train & pair]
        trains = [*separate, pair.union(*(train for train in trains if train & pair))]
    return [[gear for gear in scene.gears if gear.name in train] for train in trains]
