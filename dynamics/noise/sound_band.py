"""Sound of a housing by its model, and bands of its levels from the ranges of guessed figures.

A guess is a figure of the scene that is known within a range only, such as the damping of joints. A band
holds a level in nine of ten cases with all guesses varied. Axes of arrays: S speeds, H orders.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from typing import TypeVar

import numpy as np

from dynamics.acoustics import (
    LevelBand,
    ModalResistance,
    OrderPower,
    Range,
    band_cases,
    level_bands,
    order_power,
    sound_power_level,
)
from dynamics.acoustics.levels import CASES
from dynamics.assembly.assemble import assemble
from dynamics.bearings import Bushing, PlanetBearing
from dynamics.checks import one_of
from dynamics.housings.modification import with_damping, with_frequencies, with_modes, with_mounts
from dynamics.housings.reduced_housing import ReducedHousing, scene_housing
from dynamics.linearize import harmonic_response
from dynamics.linearize.line_floor import FloorPower
from dynamics.meshes import GearMesh
from dynamics.noise.floor_sound import radiated_floor
from dynamics.scene import Scene
from dynamics.types import FloatArray, IntArray
from dynamics.vibration import BearingHarmonics, housing_motion, seat_forces
from model_studies.progress import Progress, silent

Bearing = TypeVar("Bearing", Bushing, PlanetBearing)
MAX_PEAK_ERROR = 10.0
"""Largest error by peaks between the speeds, dB: speeds with a larger one do not resolve a resonance."""
_SAME_ORDER = 9
"""Decimal places up to which orders of two responses are compared."""


@dataclass(frozen=True)
class SoundModel:
    """A scene with its radiating housings and their radiation resistances."""

    scene: Scene
    """Scene with the matrices of the housings."""
    housings: Mapping[str, ReducedHousing]
    """Radiating housings by name."""
    resistance: Mapping[str, ModalResistance]
    """Radiation resistances of these housings, over their reduced coordinates."""

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


def _radiated_power(model: SoundModel, response: BearingHarmonics) -> OrderPower:
    """Return the sound power of a response by order and speed, the sum over all housings."""
    frequency = response.frequency.T
    power, floors = np.zeros(frequency.shape), list[FloorPower]()
    for part in model.scene.housings:
        if part.name in model.housings:
            housing = model.housings[part.name]
            force = seat_forces(response, housing, part.bushings)
            motion = housing_motion(housing, response.frequency, force)
            velocity = np.swapaxes(2j * np.pi * response.frequency[..., None] * motion, 0, 1)
            power += order_power(model.resistance[part.name], frequency, velocity).power
            if response.floor is not None:
                floor = radiated_floor(response.floor, housing, part.bushings, model.resistance[part.name])
                floors.append(floor)
    return OrderPower(frequency, power, FloorPower.of_all(floors) if floors else None)


def forced_power(model: SoundModel, speed: FloatArray, orders: int) -> tuple[FloatArray, OrderPower]:
    """Return orders (H,) and the sound power of the linear response at `speed` (S,), rad/s.

    Raises `InputError` or `SolveError` as `harmonic_response` does; or a bearing of a housing is not in the
    response, or a frequency is beyond the radiation resistance.
    """
    response = harmonic_response(assemble(model.scene), speed, orders)
    return response.order, _radiated_power(model, response)


@dataclass(frozen=True)
class _Guess:
    """A figure of a scene that is known within a range only."""

    name: str
    title: str
    """Name of the figure in words."""
    usual: Range
    """Usual range of the factor on the value that the scene states."""
    varied: Callable[[SoundModel, float], SoundModel]
    """``varied(model, factor)`` returns the model with the figure times `factor`, or the same object where
    the scene has no such figure.
    """


def _with_housings(
    change: Callable[[ReducedHousing, float], ReducedHousing], model: SoundModel, factor: float
) -> SoundModel:
    for name, housing in model.housings.items():
        model = model.with_housing(name, change(housing, factor))
    return model


def _mount_stiffness(model: SoundModel, factor: float) -> SoundModel:
    mounted = {name: part for name, part in model.housings.items() if part.mount_stiffness is not None}
    for name, housing in mounted.items():
        model = model.with_housing(name, with_mounts(housing, factor))
    return model


def _mesh_damping(model: SoundModel, factor: float) -> SoundModel:
    """Scale ratio and damping; a mesh uses one of them."""

    def damped(mesh: GearMesh) -> GearMesh:
        damping = None if mesh.damping is None else factor * mesh.damping
        return replace(mesh, damping=damping, damping_ratio=factor * mesh.damping_ratio)

    meshes = tuple(damped(mesh) for mesh in model.scene.meshes)
    return replace(model, scene=replace(model.scene, meshes=meshes)) if meshes else model


def _bearing_stiffness(model: SoundModel, factor: float) -> SoundModel:
    """Scale linear bearings and the laws that the scene gives; rows by their geometry follow their load."""
    scene = model.scene
    if not (scene.bushings or scene.planet_bearings or scene.scene_bearing_laws):
        return model
    stiffer = replace(
        scene,
        bushings=tuple(_stiffened_bearing(part, factor) for part in scene.bushings),
        planet_bearings=tuple(_stiffened_bearing(part, factor) for part in scene.planet_bearings),
    ).with_bearing_laws(lambda law: law.scaled(factor))
    return replace(model, scene=stiffer)


def _stiffened_bearing(bearing: Bearing, factor: float) -> Bearing:
    rows = bearing.stiffness
    matrix = None if rows is None else tuple(tuple(factor * value for value in row) for row in rows)
    return replace(
        bearing,
        radial_stiffness=factor * bearing.radial_stiffness,
        axial_stiffness=factor * bearing.axial_stiffness,
        stiffness=matrix,
    )


GUESSES = {
    guess.name: guess
    for guess in (
        _Guess(
            "housing_damping",
            "damping of the housing",
            Range(0.4, 1.0, 2.0),
            partial(_with_housings, with_damping),
        ),
        _Guess(
            "housing_frequency",
            "natural frequencies of the housing",
            Range(0.97, 1.0, 1.01),
            partial(_with_housings, with_frequencies),
        ),
        _Guess("mount_stiffness", "stiffness of the mounts", Range(0.5, 1.0, 2.0), _mount_stiffness),
        _Guess("bearing_stiffness", "stiffness of the bearings", Range(0.7, 1.0, 1.4), _bearing_stiffness),
        _Guess("mesh_damping", "damping of the meshes", Range(0.5, 1.0, 2.0), _mesh_damping),
    )
}
"""Guessed figures by name. Cast iron with bolted joints has damping ratios of 0.002 to 0.01, most often
0.005. A finite-element mesh reads natural frequencies too high, and walls of castings vary by some per cent.
"""
USUAL_RANGES = {name: guess.usual for name, guess in GUESSES.items()}


def responses_of_band(scene: Scene, *, mounted: bool) -> int:
    """Return the number of linear responses of a band over all ranges, in a scene whose housings radiate.

    `mounted`: whether one of them stands on mounts.
    """
    bare = SoundModel(scene, {}, {})
    of_scene = sum(guess.varied(bare, 2.0) is not bare for guess in GUESSES.values())
    of_housings = 2 + mounted  # damping and frequencies, and stiffness of mounts
    return 2 + 2 * (of_housings + of_scene) + CASES


Powers = Callable[[SoundModel], tuple[FloatArray, OrderPower]]


@dataclass(frozen=True)
class SoundBand:
    """A-weighted sound power levels of a linear response with their bands, dB(A) re 1e-12 W."""

    speed: FloatArray
    """Speeds of the leading drive, rad/s. Shape (S,)."""
    order: FloatArray
    """Multiples of the frequency of the first mesh that turns. Shape (H,)."""
    largest_total: LevelBand
    """Largest level of all orders together over the speeds, at whichever speed it occurs. `speed_steps` above
    it is the error by a peak between the speeds.
    """
    mean_total: LevelBand
    """Level of the mean power of all orders together over the speeds, which a run-up of constant acceleration
    radiates. Its band is narrower than that of the largest level: a resonance that moves counts once at any
    speed, and twice the damping halves its power instead of quartering it. `speed_steps` is the error without
    every other speed.
    """
    largest: tuple[LevelBand, ...]
    """Largest level of each order over the speeds, as `largest_total`."""
    loudest_speed: FloatArray
    """Speed at which each order is largest with the nominal values, rad/s. Shape (H,)."""
    there: tuple[LevelBand, ...]
    """Level of each order at this speed. Its band is much wider than that of `largest`, as a resonance moves
    away from the speed.
    """
    total: tuple[LevelBand, ...]
    """Level of all orders together at each speed."""

    @property
    def _bands(self) -> list[LevelBand]:
        """All bands, in the order of the levels of `_levels`."""
        return [self.largest_total, self.mean_total, *self.largest, *self.there, *self.total]

    def _of_bands(self, bands: Sequence[LevelBand]) -> SoundBand:
        """Return the same with other bands in the order of `_bands`."""
        rows, orders = iter(bands), self.order.size
        return replace(
            self,
            largest_total=next(rows),
            mean_total=next(rows),
            largest=tuple(islice(rows, orders)),
            there=tuple(islice(rows, orders)),
            total=tuple(rows),
        )

    def about(self, order: FloatArray, power: OrderPower) -> SoundBand:
        """Return the bands, as wide as they are, about the levels of other powers (H, S) of orders (H,).

        The levels are those of a response with varying stiffness, while the ranges were run with the mean
        stiffness. An order that varying stiffness alone excites has the widest band of all orders.
        """
        known = self._of_orders(order, power)
        loudest = np.searchsorted(known.speed, known.loudest_speed)
        levels = _levels(order, loudest, order, power).tolist()
        return known._of_bands(
            [replace(band, nominal=at) for band, at in zip(known._bands, levels, strict=True)]
        )

    def _of_orders(self, order: FloatArray, power: OrderPower) -> SoundBand:
        """Return the bands of other orders (H,), the widest for those that have none."""
        if np.array_equal(order, self.order):
            return self
        row = {round(value, _SAME_ORDER): index for index, value in enumerate(self.order.tolist())}
        widest = max(range(self.order.size), key=lambda index: self.largest[index].width)
        rows = [row.get(round(value, _SAME_ORDER), -1) for value in order.tolist()]
        loudest_speed = self.speed[np.argmax(power.weighted_power, axis=1)]
        sources = [widest if index < 0 else index for index in rows]
        return replace(
            self,
            order=order,
            loudest_speed=np.where(np.array(rows) < 0, loudest_speed, self.loudest_speed[sources]),
            largest=tuple(self.largest[index] for index in sources),
            there=tuple(self.there[index] for index in sources),
        )

    def with_power_error(
        self, name: str, power: OrderPower, below: FloatArray, above: FloatArray
    ) -> SoundBand:
        """Return all bands with one more contribution: the error of every power, e.g. by its radiation model.

        All powers may be off at once, so that a quieter line may be the loudest.

        Parameters
        ----------
        power : OrderPower
            Power of the nominal response, (H, S).
        below, above : (H, S) arrays
            Distance of the ends of the band below and above a level, dB, at least 0.
        """
        loudest = np.searchsorted(self.speed, self.loudest_speed)

        def levels(off: FloatArray) -> FloatArray:
            shifted = replace(power, power=power.power * 10.0 ** (off / 10.0))
            if power.floor is not None:  # off as much as the orders together
                part = (shifted.power.sum(axis=0) / power.power.sum(axis=0))[:, None]
                shifted = replace(shifted, floor=power.floor._replace(power=part * power.floor.power))
            return _levels(self.order, loudest, self.order, shifted)

        nominal_levels = levels(np.zeros(power.power.shape))
        ends = zip(self._bands, nominal_levels - levels(-below), levels(above) - nominal_levels, strict=True)
        return self._of_bands([band.with_error(name, float(low), float(high)) for band, low, high in ends])


def sound_band(
    model: SoundModel,
    speed: FloatArray,
    orders: int,
    ranges: Mapping[str, Range] | None = None,
    *,
    cases: int = CASES,
    alternatives: Mapping[str, SoundModel] | None = None,
    progress: Progress = silent,
) -> SoundBand:
    """Return the bands of the levels that a scene radiates in its linear response.

    Guesses vary over the whole chain, as damping and stiffness change the bearing forces too. There is a
    linear response for each of `cases` joint cases, two of each guess alone, one of the nominal values, and
    one with half of the housings' modes. The change by the last one counts as the error of the number of
    modes, both ways.

    Parameters
    ----------
    speed : (S,) array
        Speeds of the first drive that turns, rad/s, increasing.
    orders : int
        Harmonics of the mesh frequency of the first mesh that turns.
    ranges : mapping of str to Range, optional
        Ranges of factors, by name in `GUESSES`; default: their usual ranges. Figures that a scene does not
        have, e.g. mounts, contribute nothing.
    cases : int
        Number of joint cases, see `band_cases`.
    alternatives : mapping of str to SoundModel, optional
        Further models that may be right, e.g. with the resistance of another radiation model, by the name of
        their contribution: their difference, both ways.
    progress : callable
        Called as progress("band", fraction).

    Raises
    ------
    InputError
        No such guess; or as `forced_power`.
    SolveError
        As `forced_power`.
    """
    ranges = USUAL_RANGES if ranges is None else ranges
    for name in ranges:
        one_of("ranges", name, GUESSES)
    ranges = {name: span for name, span in ranges.items() if GUESSES[name].varied(model, 2.0) is not model}
    fewer = _with_housings(
        lambda housing, part: with_modes(housing, max(int(part * len(housing.frequency)), 1)), model, 0.5
    )
    others = {"mode_number": fewer, **(alternatives or {})}
    count, done = 1 + len(others) + 2 * len(ranges) + cases, 0

    def powers(model: SoundModel) -> tuple[FloatArray, OrderPower]:
        nonlocal done
        result = forced_power(model, speed, orders)
        done += 1
        progress("band", min(done / count, 1.0))
        return result

    return _band(model, np.asarray(speed, dtype=float), ranges, cases, others, powers)


def band_about(
    model: SoundModel,
    speed: FloatArray,
    orders: int,
    ranges: Mapping[str, Range],
    order: FloatArray,
    power: OrderPower,
    error: FloatArray,
    progress: Progress = silent,
) -> SoundBand:
    """Return the bands about the levels of a sound, with the error of its radiation model.

    Parameters
    ----------
    model, speed, orders, ranges, progress
        Arguments of `sound_band`.
    order : (H,) array
        Orders of the sound; those of a response with varying stiffness may be more than the bands'.
    power : OrderPower
        Power of the sound at these speeds, (H, S).
    error : (2, S, H) array
        Bounds of the error of its levels, dB: lower and upper; a negative error is a level that is too low.
    """
    below, above = np.maximum(error[1].T, 0.0), np.maximum(-error[0].T, 0.0)
    band = sound_band(model, speed, orders, ranges, progress=progress).about(order, power)
    return band.with_power_error("radiation_model", power, below, above)


def _band(
    model: SoundModel,
    speed: FloatArray,
    ranges: Mapping[str, Range],
    cases: int,
    others: Mapping[str, SoundModel],
    powers: Powers,
) -> SoundBand:
    order, nominal = powers(model)
    loudest = np.argmax(nominal.weighted_power, axis=1)

    def levels(values: Mapping[str, float]) -> FloatArray:
        varied_model = model
        for name, value in values.items():
            varied_model = varied_model if value == 1.0 else GUESSES[name].varied(varied_model, value)
        varied_order, power = (order, nominal) if varied_model is model else powers(varied_model)
        return _levels(order, loudest, varied_order, power)

    level_cases = np.array([levels(values) for values in band_cases(ranges, cases)])
    bands = list(level_bands(ranges, level_cases))
    for name, other in others.items():
        difference = _levels(order, loudest, *powers(other)) - levels({})
        for index, error in enumerate(np.abs(difference).tolist()):
            bands[index] = bands[index].with_error(name, error, error)
    band = SoundBand(speed, order, bands[0], bands[1], (), speed[loudest], (), ())._of_bands(bands)
    total = nominal.total_weighted_power
    band = _with_floor_error(band, speed, nominal)
    error = _speed_step_error(speed, total)
    peaks = zip(band.largest, nominal.weighted_power, strict=True)
    return replace(
        band,
        largest_total=_with_peak(band.largest_total, speed, total),
        mean_total=band.mean_total.with_error("speed_steps", error, error),
        largest=tuple(_with_peak(level, speed, power) for level, power in peaks),
    )


def _with_floor_error(band: SoundBand, speed: FloatArray, power: OrderPower) -> SoundBand:
    """Return the bands of totals with the error of the orders that are not listed; without any the same."""
    if power.floor is None:
        return band
    total, name = power.total_weighted_power, "orders_left_out"
    off = np.array(power.total_error).tolist()
    mean, mean_error = mean_power(speed, total), mean_power(speed, power.weighted_error)
    minimum = float(sound_power_level(mean) - sound_power_level(max(mean - mean_error, 0.0)))
    largest = off[int(np.argmax(total))]
    return replace(
        band,
        largest_total=band.largest_total.with_error(name, largest, largest),
        mean_total=band.mean_total.with_error(name, minimum, minimum),
        total=tuple(
            level.with_error(name, error, error) for level, error in zip(band.total, off, strict=True)
        ),
    )


def _with_peak(band: LevelBand, speed: FloatArray, power: FloatArray) -> LevelBand:
    return band.with_error("speed_steps", 0.0, _peak_error(speed, power))


def mean_power(speed: FloatArray, power: FloatArray) -> float:
    """Return the mean of a power (S,) over the speeds, W, by trapezoids between them."""
    return float(np.trapezoid(power, speed) / (speed[-1] - speed[0]) if power.size > 1 else power[0])


def _speed_step_error(speed: FloatArray, power: FloatArray) -> float:
    """Return the difference of the mean over every other speed and the last from the mean over all, dB."""
    alternate = np.unique([*range(0, power.size, 2), power.size - 1])
    means = [mean_power(speed[alternate], power[alternate]), mean_power(speed, power)]
    coarse, fine = sound_power_level(means)
    return float(abs(coarse - fine))


def _peak_error(speed: FloatArray, power: FloatArray) -> float:
    """Return the height of a peak between the speeds above the largest, dB, at most `MAX_PEAK_ERROR`.

    The reciprocal of the power over speed is a parabola near a resonance: that through the largest value and
    its neighbors. At the ends of the speeds nothing is known.
    """
    at = int(np.argmax(power))
    if not (0 < at < power.size - 1 and power[at] > 0.0):
        return 0.0
    near = slice(at - 1, at + 2)
    reciprocal = power[at] / np.maximum(power[near], 1e-30 * power[at])
    bend, slope, height = np.polyfit(speed[near] - speed[at], reciprocal, 2)
    minimum = height - slope**2 / (4.0 * bend) if bend > 0.0 else 1.0
    return float(-10.0 * np.log10(np.clip(minimum, 10.0 ** (-MAX_PEAK_ERROR / 10.0), 1.0)))


def largest_level(speed: FloatArray, power: OrderPower) -> float:
    """Return the largest A-weighted level of all orders together, dB(A), a peak between the speeds counted.

    The level is a smooth function of everything that shifts a resonance, if the speeds resolve it.
    """
    total = power.total_weighted_power
    return float(sound_power_level(total.max())) + _peak_error(speed, total)


def _levels(order: FloatArray, loudest: IntArray, power_orders: FloatArray, power: OrderPower) -> FloatArray:
    """Return the levels that have bands, dB(A): largest and mean total, orders' largest and there, totals."""
    weighted = np.zeros((order.size, power.power.shape[1]))
    listed = np.isin(power_orders, order)
    weighted[np.searchsorted(order, power_orders[listed])] = power.weighted_power[listed]
    total = weighted.sum(axis=0) + power.weighted_floor
    at_loudest_speed = weighted[np.arange(order.size), loudest]
    totals = [total.max(), mean_power(power.frequency[0], total)]
    return sound_power_level(np.concatenate([totals, weighted.max(axis=1), at_loudest_speed, total]))
