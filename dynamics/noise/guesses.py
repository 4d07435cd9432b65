"""What of a scene is only guessed, as factors on what it states: damping, joints, mounts, mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

from dynamics.acoustics import Range
from dynamics.forces import GearMesh, RollingContact, SpringCurve
from dynamics.housing_modes.modification import with_damping, with_frequencies, with_mounts
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.joints import Bushing, PlanetBearing
from dynamics.noise.sound_model import SoundModel

Bearing = TypeVar("Bearing", Bushing, PlanetBearing)


@dataclass(frozen=True)
class Guess:
    """A figure of a scene that is known within a range only.

    Attributes
    ----------
    name : str
    title : str
        In words.
    usual : Range
        Of the factor on what the scene states.
    varied : callable
        ``varied(model, factor)``: the model with it; the same object where the scene has no such figure.
    """

    name: str
    title: str
    usual: Range
    varied: Callable[[SoundModel, float], SoundModel]


def _each_housing(
    model: SoundModel, change: Callable[[ReducedHousing, float], ReducedHousing], factor: float
) -> SoundModel:
    """Return the model with all its housings changed."""
    for name, housing in model.housings.items():
        model = model.with_housing(name, change(housing, factor))
    return model


def _housing_damping(model: SoundModel, factor: float) -> SoundModel:
    return _each_housing(model, with_damping, factor)


def _housing_frequency(model: SoundModel, factor: float) -> SoundModel:
    return _each_housing(model, with_frequencies, factor)


def _mount_stiffness(model: SoundModel, factor: float) -> SoundModel:
    mounted = {name: part for name, part in model.housings.items() if part.mount_stiffness is not None}
    for name, housing in mounted.items():
        model = model.with_housing(name, with_mounts(housing, factor))
    return model


def _mesh_damping(model: SoundModel, factor: float) -> SoundModel:
    """Scale ratio and damping; a mesh uses one of them."""

    def damped(mesh: GearMesh) -> GearMesh:
        own = None if mesh.damping is None else factor * mesh.damping
        return replace(mesh, damping=own, damping_ratio=factor * mesh.damping_ratio)

    meshes = tuple(damped(mesh) for mesh in model.scene.meshes)
    return replace(model, scene=replace(model.scene, meshes=meshes)) if meshes else model


def _bearing_stiffness(model: SoundModel, factor: float) -> SoundModel:
    """Scale linear bearings, curves and contacts; rows by their geometry follow from their load."""
    scene = model.scene
    if not (scene.bushings or scene.planet_bearings or scene.rolling_contacts or scene.spring_curves):
        return model
    stiffer = replace(
        scene,
        bushings=tuple(_stiffened(part, factor) for part in scene.bushings),
        planet_bearings=tuple(_stiffened(part, factor) for part in scene.planet_bearings),
        rolling_contacts=tuple(_pressed(part, factor) for part in scene.rolling_contacts),
        spring_curves=tuple(_steeper(part, factor) for part in scene.spring_curves),
    )
    return replace(model, scene=stiffer)


def _stiffened(bearing: Bearing, factor: float) -> Bearing:
    matrix = bearing.stiffness and tuple(tuple(factor * value for value in row) for row in bearing.stiffness)
    return replace(
        bearing,
        radial_stiffness=factor * bearing.radial_stiffness,
        axial_stiffness=factor * bearing.axial_stiffness,
        stiffness=matrix,
    )


def _pressed(contact: RollingContact, factor: float) -> RollingContact:
    return replace(contact, stiffness=factor * contact.stiffness)


def _steeper(curve: SpringCurve, factor: float) -> SpringCurve:
    return replace(curve, force=tuple(factor * value for value in curve.force))


GUESSES = {
    guess.name: guess
    for guess in (
        Guess("housing_damping", "damping of the housing", Range(0.4, 1.0, 2.0), _housing_damping),
        Guess(
            "housing_frequency",
            "natural frequencies of the housing",
            Range(0.97, 1.0, 1.01),
            _housing_frequency,
        ),
        Guess("mount_stiffness", "stiffness of the mounts", Range(0.5, 1.0, 2.0), _mount_stiffness),
        Guess("bearing_stiffness", "stiffness of the bearings", Range(0.7, 1.0, 1.4), _bearing_stiffness),
        Guess("mesh_damping", "damping of the meshes", Range(0.5, 1.0, 2.0), _mesh_damping),
    )
}
"""By name. Cast iron with bolted joints has ratios of 0.002 to 0.01 about 0.005; a mesh reads natural
frequencies too high, and walls of castings vary by some per cent."""
