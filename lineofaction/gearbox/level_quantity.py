"""The quantity whose level a scene is computed for: force on a bearing, sound or velocity of a housing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from dynamics.housings import ReducedHousing
from dynamics.noise import (
    BearingForce,
    EquivalentSoundPower,
    PointVelocity,
    QuantityLevel,
    SoundModel,
    SurfaceVelocity,
    Together,
)
from dynamics.scene import Scene
from dynamics.settings.level_quantity import LevelQuantity
from lineofaction.gearbox.schemas.scene import SceneInput


def with_quantity(moving: Scene, scene: SceneInput, reduced: Mapping[str, ReducedHousing]) -> Scene:
    """Return a scene with the quantity whose level sizes its effects; without one: all bearing forces."""
    sounding = {name: body for name, body in reduced.items() if body.surface is not None}
    bearing = None if scene.complaint is None else scene.complaint.bearing
    if bearing is not None:
        model = SoundModel(moving, {}, {})
        return replace(moving, quantity=QuantityLevel(BearingForce(bearing), model, f"force on {bearing}"))
    if not sounding:
        return moving
    model = SoundModel(moving, sounding, {})
    sound = QuantityLevel(EquivalentSoundPower(), model, "sound power", "dB(A)")
    return replace(moving, quantity=sound)


def velocity_of(scene: Scene, name: str, housing: ReducedHousing) -> LevelQuantity | None:
    """Return the velocity of a housing: of its surface, without one of all its points; None: it has none."""
    if housing.surface is None and not housing.points:
        return None
    model = SoundModel(scene, {name: housing}, {})
    if housing.surface is not None:
        return QuantityLevel(SurfaceVelocity(name), model, f"surface velocity of {name}")
    points = tuple(PointVelocity(name, point.name) for point in housing.points)
    return QuantityLevel(Together(points), model, f"velocity of the points of {name}")
