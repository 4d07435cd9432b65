"""Sound power of housings by order and speed, its loudest points, and the bearings and modes behind them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from bounds import at_least
from bounds.brief import brief
from bounds.plottable import Plottable
from dynamics.acoustics import Hull, OrderPower, sound_power_level
from dynamics.acoustics.levels import a_weighting
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.linearize.line_floor import FloorPower
from dynamics.noise.floor_sound import radiated_floor
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.noise.panel_sound import PanelSound
from dynamics.results.array_file import ArrayFile, stored
from dynamics.types import BoolArray, ComplexArray, FloatArray, IntArray, Json
from dynamics.vibration import BearingHarmonics, seat_forces
from dynamics.vibration.housing_motion import modal_amplitudes
from model_studies.record import under_key

POWER = ("speed", "order")
BINS = ("speed", "bin")
QUIET = 30.0
"""Distance below the loudest maximum, dB, beyond which a maximum is not listed."""


def _powers(
    frequency: FloatArray, amplitudes: ComplexArray, housing: ReducedHousing, radiation: HousingRadiation
) -> dict[str, Any]:
    """Return the fields of `RadiatedSound` by the motion in the modes under all bearings, with shares.

    The share of a part u of the velocity v is Re(u^H R v) / 2: shares add up to the power v^H R v / 2.
    Frequencies (S, H) in Hz; `amplitudes` (S H, b, m) are complex peaks of `ReducedHousing.modes` by bearing.
    """
    grid, hertz = frequency.shape, frequency.ravel()
    natural, shape = housing.modes
    rates = 2j * np.pi * hertz[:, None, None] * amplitudes
    by_bearing = np.moveaxis(rates @ shape.T, 1, 0)
    velocity = by_bearing.sum(axis=0)
    force = radiation.reaction(hertz, velocity)
    power = np.maximum(_power(velocity, force), 0.0)
    natural_modes = slice(0, housing.frequency.size)
    rate = rates.sum(axis=1)[:, natural_modes]
    mode_share = 0.5 * (rate.conj() * (force @ shape[:, natural_modes])).real
    mode_alone = 0.5 * np.abs(rate) ** 2 * radiation.alone(hertz, shape[:, natural_modes])
    alone = [_power(part, radiation.reaction(hertz, part)) for part in by_bearing]
    return {
        "power": power.reshape(grid),
        "efficiency": radiation.efficiency(power, velocity).reshape(grid),
        "bearing_share": np.stack([_power(part, force) for part in by_bearing]).reshape(-1, *grid),
        "bearing_alone": np.stack(alone).reshape(-1, *grid),
        "mode_share": mode_share.T.reshape(-1, *grid),
        "mode_alone": mode_alone.T.reshape(-1, *grid),
        "natural_frequency": natural[natural_modes] / (2.0 * np.pi),
    }


def _power(velocity: ComplexArray, force: ComplexArray) -> FloatArray:
    """Return Re(v^H f) / 2 of every row, W."""
    return np.asarray(0.5 * np.sum(velocity.conj() * force, axis=1).real)


def _no_bins() -> FloatArray:
    return np.empty((0, 0))


@brief
@dataclass(frozen=True)
class RadiatedSound(ArrayFile, Plottable):
    """Sound power at S speeds in H orders, each as in a steady state; b bearings and m modes of housings.

    Orders add up in power, and so do several housings. Shares of bearings add up to the power, those of modes
    to the power without the static motion by the other modes. A share is negative where a part cancels
    others. Fields state unit, meaning and dimensions of arrays.
    """

    SCHEMA = "lineofaction radiated sound"

    housing: tuple[str, ...]
    bearing: tuple[str, ...]
    mode_housing: tuple[str, ...]
    """The housing of each mode."""
    speed: FloatArray = field(metadata=stored("rad s-1", "speed of the leading drive", "speed"))
    order: FloatArray = field(
        metadata=stored("1", "multiple of the frequency of the first mesh that turns", "order")
    )
    frequency: FloatArray = field(metadata=stored("Hz", "frequency of the harmonic", *POWER))
    power: FloatArray = field(metadata=stored("W", "radiated sound power", *POWER))
    efficiency: FloatArray = field(metadata=stored("1", "radiation efficiency", *POWER))
    """Power over that of a plane with the same mean square velocity. Shape (S, H)."""
    bearing_share: FloatArray = field(
        metadata=stored("W", "part of the power by the force of a bearing", "bearing", *POWER)
    )
    bearing_alone: FloatArray = field(
        metadata=stored("W", "power under the force of a bearing alone", "bearing", *POWER)
    )
    mode_share: FloatArray = field(
        metadata=stored("W", "part of the power by a mode of the housing", "mode", *POWER)
    )
    mode_alone: FloatArray = field(
        metadata=stored("W", "power of a mode of the housing alone", "mode", *POWER)
    )
    natural_frequency: FloatArray = field(
        metadata=stored("Hz", "natural frequency of the housing, seats free", "mode")
    )
    """Natural frequencies of the housing on its feet, Hz. Shape (m,)."""
    in_contact: BoolArray = field(metadata=stored("1", "whether all flanks stay in contact", "speed"))
    """Whether all flanks stay in contact at each speed. Where flanks part, no linear answer holds. Shape
    (S,).
    """
    metadata: Json = field(default_factory=dict, metadata=under_key("facts"))
    """Plain JSON: `radiation` by housing (`HousingRadiation.metadata`, `model_name`, `area`, and
    `valid_frequency` in Hz, up to which the modes of the reduction carry the motion).
    """
    panel_node: FloatArray = field(
        default_factory=lambda: np.empty((0, 3)),
        metadata=stored("m", "nodes of the panels", "panel_nodes", "xyz"),
    )
    panel_corner: IntArray = field(
        default_factory=lambda: np.empty((0, 3), dtype=int),
        metadata=stored("1", "nodes of each panel", "panel", "corner"),
    )
    panel_power: FloatArray = field(
        default_factory=lambda: np.empty(0),
        metadata=stored("W", "radiated sound power of each panel", "panel"),
    )
    """`panel_node`, `panel_corner`, `panel_power`: Panels of all housings and their power at the loudest
    order and speed (`PanelSound`); empty where they were not computed. (N, 3), (T, 3), (T,) arrays.
    """
    floor_frequency: FloatArray = field(
        default_factory=_no_bins, metadata=stored("Hz", "mean frequency of orders left out, in bins", *BINS)
    )
    floor_power: FloatArray = field(
        default_factory=_no_bins, metadata=stored("W", "sound power of orders left out", *BINS)
    )
    floor_missed: FloatArray = field(
        default_factory=_no_bins, metadata=stored("W", "by how much that may be off", *BINS)
    )
    """`floor_frequency`, `floor_power`, `floor_missed`: The fields of `floor`; empty where every order is
    listed. Shape (S, K) each.
    """

    @classmethod
    def of_all(cls, sounds: Sequence[RadiatedSound]) -> RadiatedSound:
        """Return the sound of housings under one response: powers add up, without interference between them.

        The efficiency is that of all surfaces together. Raises `InputError`: there is none, or their speeds
        and orders differ.
        """
        if not sounds:
            raise InputError("sounds", len(sounds), at_least(1))
        first = sounds[0]
        if len(sounds) == 1:
            return first
        for index, sound in enumerate(sounds):
            if not np.array_equal(sound.frequency, first.frequency):
                raise InputError(f"sounds[{index}].frequency", "others", "those of the first")
        plane = sum(sound.power / np.maximum(sound.efficiency, 1e-300) for sound in sounds)
        power = np.asarray(np.sum([sound.power for sound in sounds], axis=0))
        names = ("housing", "bearing", "mode_housing")
        by_part = ("bearing_share", "bearing_alone", "mode_share", "mode_alone", "natural_frequency")
        joined: dict[str, Any] = {
            **{name: tuple(value for sound in sounds for value in getattr(sound, name)) for name in names},
            **{name: np.concatenate([getattr(sound, name) for sound in sounds]) for name in by_part},
        }
        radiation = {name: about for sound in sounds for name, about in sound.metadata["radiation"].items()}
        floors = [sound.floor for sound in sounds]
        return cls(
            speed=first.speed,
            order=first.order,
            frequency=first.frequency,
            power=power,
            efficiency=np.asarray(power / np.maximum(plane, 1e-300)),
            in_contact=first.in_contact,
            metadata={"radiation": radiation},
            **joined,
            **_floor_fields([floor for floor in floors if floor is not None]),
        )

    @property
    def panels(self) -> PanelSound | None:
        """Return the panels at the loudest order and speed; None where they were not computed."""
        if not self.panel_power.size:
            return None
        return PanelSound(Hull(self.panel_node, self.panel_corner), self.panel_power)

    @property
    def floor(self) -> FloorPower | None:
        """Return the power of the orders that are not listed; None where every one is."""
        if not self.floor_power.size:
            return None
        return FloorPower(self.floor_frequency, self.floor_power, self.floor_missed)

    @property
    def orders(self) -> OrderPower:
        """Return levels, A-weighted levels and third octaves: orders first, then speeds."""
        return OrderPower(self.frequency.T, self.power.T, self.floor)

    @property
    def without_bearing(self) -> FloatArray:
        """Return the power that is left without the force of each bearing, (b, S, H), W."""
        return np.maximum(self.power - 2.0 * self.bearing_share + self.bearing_alone, 0.0)

    @property
    def bearing_alone_level(self) -> FloatArray:
        """Return the A-weighted level by the force of each bearing alone, (b, H, S), dB(A)."""
        power = np.maximum(self.bearing_alone, 0.0)
        return np.swapaxes(sound_power_level(power) + a_weighting(self.frequency), 1, 2)

    @property
    def level_without_bearing(self) -> FloatArray:
        """Return the A-weighted level that is left without each bearing, (b, H, S), dB(A)."""
        return np.swapaxes(sound_power_level(self.without_bearing) + a_weighting(self.frequency), 1, 2)


def _floor_fields(floors: Sequence[FloorPower]) -> dict[str, Any]:
    """Return the fields of `RadiatedSound` on orders left out, all housings together; empty without."""
    if not floors:
        return {}
    total = FloorPower.of_all(floors)
    return {f"floor_{name}": values for name, values in total._asdict().items()}


def radiated_sound(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    radiation: HousingRadiation,
    name: str = "housing",
) -> RadiatedSound:
    """Return the sound power of a housing under the bearing forces of a linear response or a run.

    Raises `InputError` as `seat_forces` and `modal_amplitudes` do, or the radiation is of another housing or
    range.

    Parameters
    ----------
    response : BearingHarmonics
        Linear, or the orders of a run (`bearing_orders`); in the frame of the housing's mesh.
    housing : ReducedHousing
        Housing with mass and a surface.
    bearings : sequence of str or None
        Bearings in the order of the seats; None: those with the names of the seats.
    radiation : HousingRadiation
        Radiation of this housing, over the frequencies of the response.
    name : str
        Name of the housing.
    """
    names = tuple(seat.name for seat in housing.seats) if bearings is None else tuple(bearings)
    coordinates = radiation.matrix.shape[1]
    if coordinates != len(housing.stiffness):
        bound = f"one of {len(housing.stiffness)} coordinates, the housing's"
        raise InputError("radiation", coordinates, bound)
    force = seat_forces(response, housing, names).reshape(response.frequency.size, 1, -1)
    owner = np.repeat(np.arange(len(names)), [len(seat.motions) for seat in housing.seats])
    alone = np.where(owner == np.arange(len(names))[:, None], force, 0.0)  # force of each bearing alone
    amplitudes = modal_amplitudes(housing, response.frequency.ravel(), alone)
    powers = _powers(response.frequency, amplitudes, housing, radiation)
    floor = response.floor
    about = {
        "model_name": radiation.model_name,
        "area": radiation.area,
        "valid_frequency": housing.valid_frequency,
        **asdict(radiation.metadata),
    }
    return RadiatedSound(
        housing=(name,),
        bearing=names,
        mode_housing=(name,) * powers["natural_frequency"].size,
        speed=response.speed,
        order=response.order,
        frequency=response.frequency,
        in_contact=response.in_contact,
        metadata={"radiation": {name: about}},
        **powers,
        **_floor_fields([] if floor is None else [radiated_floor(floor, housing, names, radiation)]),
    )


@dataclass(frozen=True)
class LoudPoint:
    """An order at a speed at which it is louder than at the speeds beside it."""

    speed_index: int
    order_index: int
    order: float
    speed: float
    frequency: float
    """`order`, `speed`, `frequency`: Multiple of the frequency of the first mesh; speed, rad/s; frequency,
    Hz.
    """
    level: float
    weighted_level: float
    """`level`, `weighted_level`: Sound power level, dB and dB(A) re 1e-12 W."""
    efficiency: float
    """Radiation efficiency."""
    mode: int
    natural_frequency: float
    """`mode`, `natural_frequency`: Number from 1 on, and frequency in Hz, of the mode of the housing with the
    largest share.
    """
    mode_share: float
    """Share of that mode in the power."""
    mode_housing: str
    bearing: str
    """Bearing with the largest share in the power."""
    bearing_level: float
    level_without_bearing: float
    """`bearing_level`, `level_without_bearing`: Level by the force of that bearing alone, and level without
    it, dB(A).
    """
    in_contact: bool
    """Whether all flanks stay in contact there; where not, no linear answer holds."""


def loudest(sound: RadiatedSound, count: int = 15) -> tuple[LoudPoint, ...]:
    """Return the maxima over speed of the A-weighted levels of all orders, the loudest first.

    The ends of the speeds count too. Maxima `QUIET` below the loudest are left out; silence has none.
    """
    level = sound.orders.weighted_level.T
    if not np.any(sound.power > 0.0):
        return ()
    padded = np.pad(level, ((1, 1), (0, 0)), constant_values=-np.inf)
    peak = (level > padded[:-2]) & (level >= padded[2:]) & (level >= level.max() - QUIET)
    rows, columns = np.nonzero(peak)
    order = np.argsort(-level[rows, columns], kind="stable")[:count]
    return tuple(_point(sound, int(rows[k]), int(columns[k])) for k in order)


def _point(sound: RadiatedSound, s: int, h: int) -> LoudPoint:
    power, hertz = float(sound.power[s, h]), float(sound.frequency[s, h])
    mode, bearing = int(np.argmax(sound.mode_share[:, s, h])), int(np.argmax(sound.bearing_share[:, s, h]))
    housing_mode = mode - sound.mode_housing.index(sound.mode_housing[mode])
    powers = np.array([power, sound.bearing_alone[bearing, s, h], sound.without_bearing[bearing, s, h]])
    weighted: FloatArray = sound_power_level(np.maximum(powers, 0.0)) + a_weighting(hertz)
    return LoudPoint(
        speed_index=s,
        order_index=h,
        order=float(sound.order[h]),
        speed=float(sound.speed[s]),
        frequency=hertz,
        level=float(sound_power_level(power)),
        weighted_level=float(weighted[0]),
        efficiency=float(sound.efficiency[s, h]),
        mode=housing_mode + 1,
        natural_frequency=float(sound.natural_frequency[mode]),
        mode_share=float(sound.mode_share[mode, s, h]) / power,
        mode_housing=sound.mode_housing[mode],
        bearing=sound.bearing[bearing],
        bearing_level=float(weighted[1]),
        level_without_bearing=float(weighted[2]),
        in_contact=bool(sound.in_contact[s]),
    )
