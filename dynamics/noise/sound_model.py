"""What the sound of a scene follows from, and its sound power in a linear response."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from dynamics.acoustics import ModalResistance, OrderPower, order_power
from dynamics.acoustics.hull import ComplexArray
from dynamics.assembly.assemble import assemble
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.housing_modes.scene_housing import scene_housing
from dynamics.linearize import harmonic_response
from dynamics.scene import Scene
from dynamics.types import FloatArray
from dynamics.vibration import BearingHarmonics, housing_motion, seat_forces


@dataclass(frozen=True)
class SoundModel:
    """A scene with what its housings are and radiate.

    Attributes
    ----------
    scene : Scene
        With the matrices of the housings.
    housings : mapping of str to ReducedHousing
        By name, those that radiate.
    resistance : mapping of str to ModalResistance
        Of the same, over their reduced coordinates.
    """

    scene: Scene
    housings: Mapping[str, ReducedHousing]
    resistance: Mapping[str, ModalResistance]

    def with_housing(self, name: str, housing: ReducedHousing) -> SoundModel:
        """Return the model with another reduction of a housing, over the same coordinates."""
        parts = tuple(
            replace(scene_housing(housing, name, part.bushings), seat_positions=part.seat_positions)
            if part.name == name
            else part
            for part in self.scene.housings
        )
        scene = replace(self.scene, housings=parts)
        return replace(self, scene=scene, housings={**self.housings, name: housing})


def radiated_power(model: SoundModel, response: BearingHarmonics) -> OrderPower:
    """Return the sound power of a response by order and speed, the sum over all housings.

    Raises
    ------
    InputError
        A bearing of a housing is not in the response, or a frequency is beyond the radiation resistance.
    """
    frequency = response.frequency.T
    power = np.zeros(frequency.shape)
    for part in model.scene.housings:
        if part.name in model.housings:
            velocity = _velocity(model.housings[part.name], response, part.bushings)
            power += order_power(model.resistance[part.name], frequency, velocity).power
    return OrderPower(frequency, power)


def forced_power(model: SoundModel, speed: FloatArray, orders: int) -> tuple[FloatArray, OrderPower]:
    """Return orders (H,) and the sound power of the linear response at `speed` (S,), rad/s.

    Raises
    ------
    InputError, SolveError
        As `harmonic_response` and `radiated_power` do.
    """
    response = harmonic_response(assemble(model.scene), speed, orders)
    return response.order, radiated_power(model, response)


def _velocity(housing: ReducedHousing, response: BearingHarmonics, bearings: tuple[str, ...]) -> ComplexArray:
    """Return the velocities of the reduced coordinates, (H, S, r)."""
    motion = housing_motion(housing, response.frequency, seat_forces(response, housing, bearings))
    velocity = 2j * np.pi * response.frequency[..., None] * motion
    return np.asarray(np.swapaxes(velocity, 0, 1))
