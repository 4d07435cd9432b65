"""Sound and vibration of a scene as Hermitian forms of the inputs of its flanks (`flank_transfer`).

By the forces of a response or of a run alone, such a quantity is one number, see `QuantityLevel`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np

from dynamics.acoustics import Air, outer_hull
from dynamics.acoustics.levels import FLOOR, REFERENCE_POWER, a_weighting
from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.noise.housing_recordings import pressure_transfer
from dynamics.noise.sound_band import SoundModel
from dynamics.settings.level_quantity import ForceLines
from dynamics.types import ComplexArray, FloatArray
from dynamics.vibration import seat_forces, surface_weight
from dynamics.vibration.housing_motion import modal_amplitudes
from dynamics.vibration.housing_vibration import REFERENCE, MotionQuantity, named_points

VELOCITY = REFERENCE[MotionQuantity.VELOCITY] ** 2
PRESSURE = 4e-10
"""Mean square of 0 dB, Pa^2: 20 uPa."""
AXES = ("x", "y", "z")


@dataclass(frozen=True)
class QuantityForm:
    """A power or mean square at S speeds in H orders by the inputs y of flanks: y^H `matrix` y."""

    unit: str
    """Unit of the matrix."""
    reference: float
    """Value at 0 dB, in `unit`."""
    frequency: FloatArray
    """Frequencies, Hz. Shape (S, H)."""
    weighting: FloatArray
    """A-weighting of sound as a factor, else 1. Shape (S, H)."""
    matrix: ComplexArray
    """Hermitian, positive semidefinite. Shape (S, H, 1 + R, 1 + R)."""

    def of(self, inputs: ComplexArray) -> FloatArray:
        """Return the power or mean square of inputs (S, H, 1 + R), (S, H), not weighted."""
        product = (self.matrix @ inputs[..., None])[..., 0]
        return np.asarray(np.maximum(np.sum(inputs.conj() * product, axis=-1).real, 0.0))

    def weighted(self, inputs: ComplexArray) -> FloatArray:
        """Return `of` with the weighting, (S, H)."""
        return self.weighting * self.of(inputs)

    def decibels(self, weighted: FloatArray) -> FloatArray:
        """Return the level of weighted powers or mean squares, or of sums of them, dB, at least `FLOOR`."""
        minimum = self.reference * 10.0 ** (FLOOR / 10.0)
        return np.asarray(10.0 * np.log10(np.maximum(weighted, minimum) / self.reference))


class Quantity(Protocol):
    """A quantity of a scene by name, of forces (b, 3 or 6, S, H, 1 + R) per input, as `FlankTransfer` has."""

    def form(self, transfer: ForceLines, model: SoundModel) -> QuantityForm:
        """Return the quantity by the inputs of the transfer functions of the model's scene.

        Raises `InputError`: the scene has no such part, or its housing cannot tell it.
        """


@dataclass(frozen=True)
class BearingForce:
    """Force on the ground of a bearing along "x", "y" or "z" of its own frame; None: its size. dB re 1 N."""

    bearing: str
    direction: str | None = None

    def form(self, transfer: ForceLines, model: SoundModel) -> QuantityForm:
        """Return the mean square of the force, N^2."""
        index = transfer.bearing.index(one_of("bearing", self.bearing, transfer.bearing))
        force = transfer.bearing_force[index][_axes(self.direction)]
        return _mean_square(transfer, "N2", 1.0, np.moveaxis(force, 0, 2))


@dataclass(frozen=True)
class PointVelocity:
    """Velocity of a named point of a housing along "x", "y" or "z"; None: its size. dB re 1 nm/s."""

    housing: str
    point: str
    direction: str | None = None

    def form(self, transfer: ForceLines, model: SoundModel) -> QuantityForm:
        """Return the mean square of the velocity, m^2/s^2."""
        housing = _housing(model, self.housing)
        (point,) = named_points(housing, (self.point,))
        velocity = _velocities(transfer, model, self.housing)
        point_velocity = np.moveaxis(velocity @ point.motion[_axes(self.direction)].T, 2, 3)
        return _mean_square(transfer, "m2 s-2", VELOCITY, point_velocity)


@dataclass(frozen=True)
class SurfaceVelocity:
    """Normal velocity of the outer hull of a housing, root of its mean square. dB re 1 nm/s."""

    housing: str

    def form(self, transfer: ForceLines, model: SoundModel) -> QuantityForm:
        """Return the mean square of the velocity over surface and time, m^2/s^2."""
        weight = surface_weight(_housing(model, self.housing))
        velocity = _velocities(transfer, model, self.housing)
        matrix = 0.5 * velocity.conj() @ weight @ np.swapaxes(velocity, 2, 3)
        return _form(transfer, "m2 s-2", VELOCITY, matrix)


@dataclass(frozen=True)
class SoundPower:
    """Sound power of all housings that radiate, dB(A) re 1e-12 W."""

    def form(self, transfer: ForceLines, model: SoundModel) -> QuantityForm:
        """Return the sound power, W."""
        inputs = transfer.bearing_force.shape[-1]
        matrix = np.zeros((*transfer.frequency.shape, inputs, inputs), dtype=complex)
        for name in _sounding(model):
            velocity = _velocities(transfer, model, name)
            flat = velocity.reshape(-1, velocity.shape[-1])
            hertz = np.repeat(transfer.frequency.ravel(), inputs)
            force = model.resistance[name].reaction(hertz, flat).reshape(velocity.shape)
            matrix += 0.5 * velocity.conj() @ np.swapaxes(force, 2, 3)
        return _form(transfer, "W", REFERENCE_POWER, matrix, sounds=True)


@dataclass(frozen=True)
class SoundPressure:
    """Sound pressure at a place in the frame of a housing's mesh, m, in free space. dB(A) re 20 uPa."""

    housing: str
    microphone: tuple[float, float, float]

    def form(self, transfer: ForceLines, model: SoundModel) -> QuantityForm:
        """Return the mean square of the sound pressure, Pa^2."""
        hertz = transfer.frequency
        housing, microphone = _housing(model, self.housing), np.array(self.microphone)
        path = pressure_transfer(housing, microphone, hertz.ravel()).reshape(*hertz.shape, -1, 1)
        force = _seats(transfer, model, self.housing)
        return _mean_square(transfer, "Pa2", PRESSURE, np.swapaxes(force @ path, 2, 3), sounds=True)


@dataclass(frozen=True)
class EquivalentSoundPower:
    """Sound power of all housings with a surface, as if parts of planes radiated it, dB(A) re 1e-12 W.

    The power is too high at low frequency, by the same factor in all scenes that are compared.
    """

    def form(self, transfer: ForceLines, model: SoundModel) -> QuantityForm:
        """Return the equivalent sound power, W."""
        inputs = transfer.bearing_force.shape[-1]
        matrix = np.zeros((*transfer.frequency.shape, inputs, inputs), dtype=complex)
        for name, housing in model.housings.items():
            velocity = _velocities(transfer, model, name)
            weight = Air().impedance * outer_hull(housing).surface
            matrix += 0.5 * velocity.conj() @ weight @ np.swapaxes(velocity, 2, 3)
        return _form(transfer, "W", REFERENCE_POWER, matrix, sounds=True)


@dataclass(frozen=True)
class Together:
    """Several quantities of one unit, their powers or mean squares added."""

    parts: tuple[Quantity, ...]

    def form(self, transfer: ForceLines, model: SoundModel) -> QuantityForm:
        """Return the sum."""
        first, *others = (part.form(transfer, model) for part in self.parts)
        return replace(first, matrix=sum((form.matrix for form in others), first.matrix))


class _OneInput(NamedTuple):
    """Forces (b, 3 or 6, S, H, 1) of a response or a run as those of one input."""

    bearing: tuple[str, ...]
    frequency: FloatArray
    bearing_force: ComplexArray


@dataclass(frozen=True)
class QuantityLevel:
    """A quantity by whose level the effects of a scene are sized: a `LevelQuantity`."""

    quantity: Quantity
    model: SoundModel
    name: str
    unit: str = "dB"

    def squares(self, forces: ForceLines) -> FloatArray:
        """Return powers or mean squares of a response or a run, weighted, (S, H)."""
        bearing_input = _OneInput(forces.bearing, forces.frequency, forces.bearing_force[..., None])
        form = self.quantity.form(bearing_input, self.model)
        return form.weighted(np.ones((*forces.frequency.shape, 1), dtype=complex))


def _axes(direction: str | None) -> slice:
    if direction is None:
        return slice(0, 3)
    axis = AXES.index(one_of("direction", direction, AXES))
    return slice(axis, axis + 1)


def _housing(model: SoundModel, name: str) -> ReducedHousing:
    return model.housings[one_of("housing", name, tuple(model.housings))]


def _sounding(model: SoundModel) -> Iterator[str]:
    """Yield the housings that radiate; raises `InputError` where none does."""
    names = [part.name for part in model.scene.housings if part.name in model.resistance]
    if not names:
        raise InputError("housings", [], "at least one that radiates")
    yield from names


def _seats(transfer: ForceLines, model: SoundModel, name: str) -> ComplexArray:
    """Return the forces on the seats of a housing per input, (S, H, 1 + R, s)."""
    part = next(part for part in model.scene.housings if part.name == name)
    return seat_forces(transfer, _housing(model, name), part.bushings)


def _velocities(transfer: ForceLines, model: SoundModel, name: str) -> ComplexArray:
    """Return the velocities of the r coordinates of a housing per input, (S, H, 1 + R, r)."""
    housing, force = _housing(model, name), _seats(transfer, model, name)
    hertz = transfer.frequency.ravel()
    amplitude = modal_amplitudes(housing, hertz, force.reshape(hertz.size, *force.shape[2:]))
    velocity = 2j * math.pi * hertz[:, None, None] * (amplitude @ housing.modes[1].T)
    return np.asarray(velocity.reshape(*force.shape[:3], -1))


def _mean_square(
    transfer: ForceLines, unit: str, reference: float, amplitude: ComplexArray, sounds: bool = False
) -> QuantityForm:
    """Return the mean square of d components together, of peak amplitudes (S, H, d, 1 + R)."""
    matrix = 0.5 * np.swapaxes(amplitude, 2, 3).conj() @ amplitude
    return _form(transfer, unit, reference, matrix, sounds)


def _form(
    transfer: ForceLines, unit: str, reference: float, matrix: ComplexArray, sounds: bool = False
) -> QuantityForm:
    hertz = transfer.frequency
    weighting = 10.0 ** (a_weighting(hertz) / 10.0) if sounds else np.ones(hertz.shape)
    hermitian = 0.5 * (matrix + np.swapaxes(matrix, 2, 3).conj())
    return QuantityForm(unit, reference, hertz, weighting, hermitian)
