"""Sound power of a housing by order and speed, and through what it gets there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dynamics.acoustics import Hull, OrderPower
from dynamics.acoustics.hull import ComplexArray
from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.noise.panel_sound import PanelSound
from dynamics.results.array_file import ArrayFile, Stored
from dynamics.types import BoolArray, FloatArray, IntArray, Json
from dynamics.vibration import BearingHarmonics, seat_forces
from dynamics.vibration.modal_amplitudes import modal_amplitudes

# Sound power of a motion, and the shares of its parts: forces of bearings, modes of the housing.


@dataclass(frozen=True)
class Contributions:
    """Power and shares in it, W, as `RadiatedSound` has them."""

    power: FloatArray
    efficiency: FloatArray
    bearing_share: FloatArray
    bearing_alone: FloatArray
    mode_share: FloatArray
    mode_alone: FloatArray
    natural_frequency: FloatArray


def contributions(
    frequency: FloatArray, amplitudes: ComplexArray, housing: ReducedHousing, radiation: HousingRadiation
) -> Contributions:
    """Return the power of the motion in the modes under all bearings, and the shares of both.

    The share of a part u of the velocity v is Re(u^H R v) / 2: shares add up to the power v^H R v / 2.

    Parameters
    ----------
    frequency : (S, H) array
        Hz.
    amplitudes : (S H, b, m) array
        Complex peak amplitudes of `ReducedHousing.modes` by bearing.
    """
    grid, hertz = frequency.shape, frequency.ravel()
    natural, shape = housing.modes
    rates = 2j * np.pi * hertz[:, None, None] * amplitudes
    by_bearing = np.moveaxis(rates @ shape.T, 1, 0)
    velocity = by_bearing.sum(axis=0)
    force = radiation.reaction(hertz, velocity)
    power = np.maximum(_power(velocity, force), 0.0)
    kept = slice(0, housing.frequency.size)
    rate = rates.sum(axis=1)[:, kept]
    mode_share = 0.5 * (rate.conj() * (force @ shape[:, kept])).real
    mode_alone = 0.5 * np.abs(rate) ** 2 * radiation.alone(hertz, shape[:, kept])
    alone = [_power(part, radiation.reaction(hertz, part)) for part in by_bearing]
    return Contributions(
        power.reshape(grid),
        radiation.efficiency(power, velocity).reshape(grid),
        np.stack([_power(part, force) for part in by_bearing]).reshape(-1, *grid),
        np.stack(alone).reshape(-1, *grid),
        mode_share.T.reshape(-1, *grid),
        mode_alone.T.reshape(-1, *grid),
        natural[kept] / (2.0 * np.pi),
    )


def _power(velocity: ComplexArray, force: ComplexArray) -> FloatArray:
    """Return Re(v^H f) / 2 of every row, W."""
    return np.asarray(0.5 * np.sum(velocity.conj() * force, axis=1).real)


POWER = ("speed", "order")
STORED = {
    "speed": Stored(("speed",), "rad s-1", "speed of the leading drive"),
    "order": Stored(("order",), "1", "multiple of the frequency of the first mesh that turns"),
    "frequency": Stored(POWER, "Hz", "frequency of the harmonic"),
    "power": Stored(POWER, "W", "radiated sound power"),
    "efficiency": Stored(POWER, "1", "radiation efficiency"),
    "bearing_share": Stored(("bearing", *POWER), "W", "part of the power by the force of a bearing"),
    "bearing_alone": Stored(("bearing", *POWER), "W", "power under the force of a bearing alone"),
    "mode_share": Stored(("mode", *POWER), "W", "part of the power by a mode of the housing"),
    "mode_alone": Stored(("mode", *POWER), "W", "power of a mode of the housing alone"),
    "natural_frequency": Stored(("mode",), "Hz", "natural frequency of the housing, seats free"),
    "in_contact": Stored(("speed",), "1", "whether all flanks stay in contact"),
    "panel_node": Stored(("panel_nodes", "xyz"), "m", "nodes of the panels"),
    "panel_corner": Stored(("panel", "corner"), "1", "nodes of each panel"),
    "panel_power": Stored(("panel",), "W", "radiated sound power of each panel"),
}


@dataclass(frozen=True)
class RadiatedSound(ArrayFile):
    """Sound power at S speeds in H orders, each as in a steady state; b bearings and m modes of housings.

    Orders add up in power, and so do several housings. Shares of bearings add up to the power; to those of
    modes what the kept modes lack statically is missing. A share is negative where a part cancels others.

    Attributes
    ----------
    housing, bearing : tuples of str
    mode_housing : tuple of str
        The housing of each mode.
    speed, order : (S,), (H,) arrays
        rad/s of the leading drive; multiples of the frequency of the first mesh that turns.
    frequency : (S, H) array
        Hz.
    power : (S, H) array
        W.
    efficiency : (S, H) array
        Radiation efficiency: power over that of a plane with the same mean square velocity.
    bearing_share, bearing_alone : (b, S, H) arrays
        W: share in the power; power if this force acted alone.
    mode_share, mode_alone : (m, S, H) arrays
        W.
    natural_frequency : (m,) array
        Of the housing on its feet, its seats free, Hz.
    in_contact : (S,) bool array
        Whether the flanks stay in contact; where not, no linear answer holds.
    facts : dict
        Plain JSON: `radiation` by housing (`HousingRadiation.facts`, `model_name`, `area`, and
        `valid_frequency` in Hz, to which the modes kept carry the motion).
    panel_node, panel_corner, panel_power : (N, 3), (T, 3), (T,) arrays
        The panels of all housings at the loudest order and speed, m, and what each radiates there, W
        (`PanelSound`); empty where they were not looked at.
    """

    SCHEMA = "lineofaction radiated sound"
    ARRAYS = STORED

    housing: tuple[str, ...]
    bearing: tuple[str, ...]
    mode_housing: tuple[str, ...]
    speed: FloatArray
    order: FloatArray
    frequency: FloatArray
    power: FloatArray
    efficiency: FloatArray
    bearing_share: FloatArray
    bearing_alone: FloatArray
    mode_share: FloatArray
    mode_alone: FloatArray
    natural_frequency: FloatArray
    in_contact: BoolArray
    facts: Json = field(default_factory=dict)
    panel_node: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    panel_corner: IntArray = field(default_factory=lambda: np.empty((0, 3), dtype=int))
    panel_power: FloatArray = field(default_factory=lambda: np.empty(0))

    @property
    def panels(self) -> PanelSound | None:
        """Return the panels at the loudest order and speed; None where they were not looked at."""
        if not self.panel_power.size:
            return None
        return PanelSound(Hull(self.panel_node, self.panel_corner), self.panel_power)

    @property
    def orders(self) -> OrderPower:
        """Return levels, A-weighted levels and third octaves: orders first, then speeds."""
        return OrderPower(self.frequency.T, self.power.T)

    @property
    def without_bearing(self) -> FloatArray:
        """Return the power that is left without the force of each bearing, (b, S, H), W."""
        return np.maximum(self.power - 2.0 * self.bearing_share + self.bearing_alone, 0.0)

    @property
    def without_mode(self) -> FloatArray:
        """Return the power that is left without each mode, (m, S, H), W."""
        return np.maximum(self.power - 2.0 * self.mode_share + self.mode_alone, 0.0)


def radiated_sound(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    radiation: HousingRadiation,
    name: str = "housing",
) -> RadiatedSound:
    """Return the sound power of a housing under the bearing forces of a linear response or a run.

    Parameters
    ----------
    response : BearingHarmonics
        Linear, or the orders of a run (`bearing_orders`); in the frame of the housing's mesh.
    housing : ReducedHousing
        With mass and a surface.
    bearings : sequence of str or None
        Bearings in the order of the seats; None: those with the names of the seats.
    radiation : HousingRadiation
        Of this housing, over the frequencies of the response.
    name : str
        Of the housing.

    Raises
    ------
    InputError
        As `seat_forces` and `modal_amplitudes` do, or the radiation is of another housing or range.
    """
    names = tuple(seat.name for seat in housing.seats) if bearings is None else tuple(bearings)
    if radiation.matrix.shape[1] != len(housing.stiffness):
        raise InputError(
            "radiation",
            radiation.matrix.shape[1],
            f"one of {len(housing.stiffness)} coordinates, the housing's",
        )
    amplitudes = _amplitudes(response, housing, names)
    found = contributions(response.frequency, amplitudes, housing, radiation)
    return _result(response, housing, names, found, radiation, name)


def _amplitudes(response: BearingHarmonics, housing: ReducedHousing, names: tuple[str, ...]) -> ComplexArray:
    """Return the amplitudes of the housing's modes under the force of each bearing alone, (S H, b, m)."""
    force = seat_forces(response, housing, names).reshape(response.frequency.size, 1, -1)
    owner = np.repeat(np.arange(len(names)), [len(seat.motions) for seat in housing.seats])
    alone = np.where(owner == np.arange(len(names))[:, None], force, 0.0)
    return modal_amplitudes(housing, response.frequency.ravel(), alone)


def _result(
    response: BearingHarmonics,
    housing: ReducedHousing,
    names: tuple[str, ...],
    found: Contributions,
    radiation: HousingRadiation,
    name: str,
) -> RadiatedSound:
    about = {
        "model_name": radiation.model_name,
        "area": radiation.area,
        "valid_frequency": housing.valid_frequency,
    }
    return RadiatedSound(
        housing=(name,),
        bearing=names,
        mode_housing=(name,) * found.natural_frequency.size,
        speed=response.speed,
        order=response.order,
        frequency=response.frequency,
        in_contact=response.in_contact,
        facts={"radiation": {name: about | radiation.facts}},
        **vars(found),
    )
