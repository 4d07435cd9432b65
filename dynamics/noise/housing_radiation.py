"""Radiation resistances kept on disk, by the hash of everything that decides them.

The radiation resistance R gives the sound power v^H R v / 2 of the velocities v of r reduced coordinates. It
is computed at frequencies close enough for interpolation; each octave has a hull that resolves its waves.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from dynamics.acoustics import Air, ModalResistance, OuterHull, RadiationModel, outer_hull, resistance
from dynamics.acoustics.hull import ROUNDED_DOWN
from dynamics.acoustics.radiation import EquivalentRadiatedPower
from dynamics.checks import positive
from dynamics.errors import InputError, ResultError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.noise.coarse_hull import RadiatingHull, radiating_hull
from dynamics.results.array_file import ArrayFile, stored
from dynamics.types import ComplexArray, FloatArray
from dynamics.work_cost import Cost, WorkCost, WorkMeter, announce, on_this_host
from model_studies.cached_file import keep_cached, read_cached
from model_studies.progress import Progress, silent, unreported
from model_studies.record import under_key
from model_studies.workers import InProcess, Workers, divided

TOLERANCE = 0.5
"""Tolerance of the power of each mode in the middle of two frequencies, dB. The middle is computed, too, and
between it and the ends a quarter of the error is left.
"""
NOTHING = 1e-6
"""Resistance over the largest of all modes, below which a mode radiates nothing."""
CONSTANT, CONSTANT_ERROR = 1.05, 0.008
"""Ratio of frequencies for R that does not change: R/f^2 is convex, 3/4 (step/f)^2 off in the middle, dB."""
FEWEST, KNOTS = 8.0, (0.9, 0.025)
"""Number of frequencies of an octave for a body much smaller than the wavelength, and further ones per ka and
its square.
"""
WIDEST, CLOSEST = 1.5, 1.03
"""Largest ratio of two frequencies side by side, and smallest ratio between which another one is added."""

USUAL = 0.85
"""Frequency of an octave, over its highest, whose cost is the mean: frequencies lie closer towards the end of
the octave.
"""
Points = Sequence[tuple[int, float]]
"""Numbers of octaves, and frequencies in Hz."""
BAND = 10.0**0.05
"""Half a third octave: the range grows to edges of bands."""
WORK = "radiation resistance by {}"
"""Name of a model over a range of frequencies in the log of runs."""
RADIATION_VERSION = 3
"""Version of cached files, raised with every change of the fields of a resistance or of their numbers."""
STAGE = "radiation"
MIN_COST = 1.0
"""CPU seconds."""


@dataclass(frozen=True)
class _Knots:
    """Frequencies (F,) in Hz, matrices (F, r, r), and the largest error in dB between them."""

    frequency: FloatArray
    matrix: ComplexArray
    error: float


def octave_ranges(low: float, high: float) -> list[tuple[float, float]]:
    """Return ranges of at most an octave from `low` to `high`, each a bit above the one before.

    Each has its own panels: the highest are too many for the lowest.
    """
    if low >= high:
        return []
    ends = np.geomspace(low, high, max(int(np.ceil(np.log2(high / low))), 1) + 1).tolist()
    starts = [low, *(float(np.nextafter(end, np.inf)) for end in ends[1:-1])]
    return list(zip(starts, ends[1:], strict=True))


def expected_knots(ka: float) -> float:
    """Return the expected number of frequencies of `_knots_of` in an octave up to a wavenumber times radius.

    Counted on cast boxes with 40 and 100 coordinates, ka of 0.6 to 28: within a quarter. Few simple modes
    need half as many.
    """
    return FEWEST + KNOTS[0] * ka + KNOTS[1] * ka**2


def _constant_knots(low: float, high: float, matrix: ComplexArray) -> _Knots:
    """Return frequencies between which a matrix that does not change is interpolated within 0.01 dB."""
    frequency = np.geomspace(low, high, max(int(np.ceil(np.log(high / low) / np.log(CONSTANT))), 1) + 1)
    return _Knots(frequency, np.broadcast_to(matrix, (frequency.size, *matrix.shape)), 4.0 * CONSTANT_ERROR)


class _Interval(NamedTuple):
    """The interval between two computed frequencies of an octave, Hz."""

    octave: int
    left: float
    right: float

    @property
    def middle(self) -> float:
        """Geometric mean of the ends, Hz."""
        return float(np.sqrt(self.left * self.right))


def _interpolation_error(
    interval: _Interval, matrices: dict[float, ComplexArray], modes: FloatArray
) -> float:
    """Return the error of the power of a mode in the middle by interpolation between the ends, dB."""
    left, middle, right = interval.left, interval.middle, interval.right
    ends = ModalResistance(np.array([left, right]), np.stack([matrices[left], matrices[right]]))
    expected = ends.alone(np.array([middle]), modes)[0]
    power = np.einsum("mk,mn,nk->k", modes, matrices[middle], modes, optimize=True).real
    floor = NOTHING * float(power.max(initial=0.0)) or 1.0
    return float(np.max(np.abs(10.0 * np.log10((expected + floor) / (power + floor))), initial=0.0))


class Octave(NamedTuple):
    """A range of frequencies, Hz, and the panels that resolve it."""

    first: float
    last: float
    hull: RadiatingHull


def _knots_of(
    ranges: Sequence[tuple[float, float]],
    resistances: Callable[[Points], Iterator[ComplexArray]],
    modes: FloatArray,
) -> list[_Knots]:
    """Return frequencies of each range, in Hz, between which R/f^2 is linear within `TOLERANCE`.

    The middle of each interval is computed and added. Where interpolation misses it by more, both halves
    become intervals; all intervals of a width are computed together. With the middles added the error is
    about a quarter of that stated. `resistances` yields matrices (r, r); `modes` (r, m) are vectors whose
    power is compared.
    """
    computed: list[dict[float, ComplexArray]] = [{} for _ in ranges]
    error = [0.0] * len(ranges)
    pending: list[_Interval] = []

    def compute(points: Points) -> None:
        for (index, frequency), matrix in zip(points, resistances(points), strict=True):
            computed[index][frequency] = matrix

    for index, (low, high) in enumerate(ranges):
        count = max(int(np.ceil(np.log(high / low) / np.log(WIDEST))), 1)
        ends = np.geomspace(low, high, count + 1).tolist()
        pending += [_Interval(index, left, right) for left, right in pairwise(ends)]
    ends_of_all = [(part.octave, end) for part in pending for end in (part.left, part.right)]
    compute(list(dict.fromkeys(ends_of_all)))  # neighbors share an end
    while pending:
        compute([(part.octave, part.middle) for part in pending])
        halves = []
        for part in pending:
            deviation = _interpolation_error(part, computed[part.octave], modes)
            if deviation > TOLERANCE and part.right / part.left > CLOSEST:
                halves += [part._replace(right=part.middle), part._replace(left=part.middle)]
            else:
                error[part.octave] = max(error[part.octave], deviation)
        pending = halves
    knots = [(np.array(sorted(matrices)), matrices) for matrices in computed]
    return [
        _Knots(frequency, np.stack([matrices[float(at)] for at in frequency]), deviation)
        for (frequency, matrices), deviation in zip(knots, error, strict=True)
    ]


@dataclass(frozen=True)
class _Radiators:
    """A model, and the hulls of octaves: what the tasks of a radiation share."""

    model: RadiationModel
    hulls: tuple[RadiatingHull, ...]
    air: Air


def _resistance_at(radiators: _Radiators, point: tuple[int, float]) -> ComplexArray:
    """Return the resistance of an octave's hull at a frequency: one task."""
    panels = radiators.hulls[point[0]]
    shapes = cast(ComplexArray, panels.shapes)
    return resistance(radiators.model, panels.hull, point[1], shapes, radiators.air)


def radiation_cost(octaves: Iterable[Octave], model: RadiationModel, air: Air) -> Cost:
    """Predict the cost of `housing_radiation` once its hulls are there, on the reference host."""
    total = Cost(0.0, 0.0)
    for octave in octaves:
        cost, count = _knot_cost(octave, model, air)
        total = total.then(cost.times(count))
    return total


def _knot_cost(octave: Octave, model: RadiationModel, air: Air) -> tuple[Cost, float]:
    """Predict the cost of a frequency of an octave, and the number of its frequencies."""
    panels, coordinates = octave.hull.shapes.shape
    per_hertz = 2.0 * math.pi / air.sound_speed * octave.hull.hull.outer_radius
    cost = model.cost(panels, per_hertz * (USUAL * octave.last), coordinates)
    return cost, expected_knots(per_hertz * octave.last)


@dataclass(frozen=True)
class RadiationMetadata:
    """Panels, cost and errors of a radiation resistance."""

    panels: int
    """Number of panels of the finest hull."""
    cost: WorkCost
    """Cost of the resistance, without the cost of the hulls."""
    resolved_frequency: float
    """Frequency up to which the hulls resolve the waves, Hz; above it panels radiate as parts of a plane
    (ERP).
    """
    interpolation_error: float
    """Error of the level by interpolation over the frequency, dB."""
    inner_area: float
    cap_area: float
    """`inner_area`, `cap_area`: Areas of the inner faces and the caps of `OuterHull`, m^2."""


@dataclass(frozen=True)
class HousingRadiation(ModalResistance, ArrayFile):
    """Radiation resistance over the coordinates of a reduced housing."""

    SCHEMA = "lineofaction housing radiation"
    RECORDS = MappingProxyType(
        {"metadata": lambda data: RadiationMetadata(**{**data, "cost": WorkCost(**data["cost"])})}
    )

    surface: FloatArray = field(
        metadata=stored("m2", "integral of products of normal motions", "coordinate", "coordinate")
    )
    """Integral over the hull of the products of normal displacements, m^2: half its quadratic form of
    velocities is the integral of the mean square in time. Shape (r, r).
    """
    area: float
    """Area of the outer hull with its caps, m^2."""
    impedance: float
    """rho c of the air, Pa s/m."""
    model_name: str
    """Name of the radiation model."""
    metadata: RadiationMetadata = field(metadata=under_key("facts"))

    def hull_at(self, outer: OuterHull, frequency: float, sound_speed: float) -> RadiatingHull | None:
        """Return the panels at a computed frequency, Hz; None above those that the mesh resolves."""
        low, high = float(self.frequency[0]), float(self.frequency[-1])
        for first, last in octave_ranges(low, min(high, self.metadata.resolved_frequency)):
            if first <= frequency <= last:
                return radiating_hull(outer, last, sound_speed)
        return None

    def radiating(self, velocity: ComplexArray, knot: float) -> ComplexArray:
        """Return the velocity (r,) that the model radiates at a computed frequency, Hz: as it is."""
        del knot
        return velocity

    def efficiency(self, power: FloatArray, velocity: ComplexArray) -> FloatArray:
        """Return the radiation efficiency of powers (B,) in W of velocities (B, r), 0 where nothing moves."""
        flow = np.sum(velocity.conj() * (velocity @ self.surface), axis=1).real
        return np.asarray(power / np.maximum(0.5 * self.impedance * flow, 1e-300))


def housing_radiation(
    housing: ReducedHousing,
    model: RadiationModel,
    frequencies: ArrayLike,
    air: Air | None = None,
    progress: Callable[[float], None] = unreported,
    expected: Callable[[Cost], object] = lambda _cost: None,
    cache: Path | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> HousingRadiation:
    """Return the radiation resistance of a housing from the lowest to the highest of some frequencies.

    Frequencies at which it is computed lie closer until the power of every mode is interpolated within about
    0.1 dB. Panels are as coarse as each octave allows. Above the frequency that the mesh resolves
    (six edges of a panel in a wavelength) equivalent radiated power takes the model's place. Raises
    `InputError`: the housing has no surface, a frequency is not above zero, or what the model refuses.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with a surface.
    frequencies : array
        Frequencies, Hz, above zero; the range grows outwards to the edges of third octaves.
    progress : callable
        Called with the fraction done.
    expected : callable, optional
        Called with the predicted cost before it is computed.
    cache : Path, optional
        Directory of what is known of the host, see `work_cost.on_this_host`.
    workers : Workers
        Workers, which compute a frequency each.
    """
    air, requested = air or Air(), np.asarray(frequencies, dtype=float)
    if not requested.size:
        raise InputError("frequencies", [], "at least one frequency")
    low, high = positive("frequencies", float(requested.min())) / BAND, float(requested.max()) * BAND
    outer = outer_hull(housing)
    resolved = 0.0 if isinstance(model, EquivalentRadiatedPower) else resolved_frequency(outer, air)
    ends = octave_ranges(low, min(high, resolved))
    parted = [Octave(*span, radiating_hull(outer, span[1], air.sound_speed)) for span in ends]
    parts, cost = _resolved_parts(parted, model, air, housing.modes[1], progress, expected, cache, workers)
    panels = max((len(octave.hull.shapes) for octave in parted), default=len(outer.hull.triangles))
    if high > resolved:
        first = max(low, float(np.nextafter(resolved, np.inf)))
        parts.append(_constant_knots(first, high, cast(ComplexArray, air.impedance * outer.surface)))
    error = 0.25 * max(part.error for part in parts)
    return HousingRadiation(
        frequency=np.concatenate([part.frequency for part in parts]),
        matrix=np.concatenate([part.matrix for part in parts]),
        surface=outer.surface,
        area=outer.hull.area,
        impedance=air.impedance,
        model_name=model.model_name,
        metadata=RadiationMetadata(panels, cost, resolved, error, outer.inner_area, outer.cap_area),
    )


def _resolved_parts(
    octaves: Sequence[Octave],
    model: RadiationModel,
    air: Air,
    modes: FloatArray,
    done: Callable[[float], None],
    expected: Callable[[Cost], object],
    cache: Path | None,
    workers: Workers,
) -> tuple[list[_Knots], WorkCost]:
    """Return the knots of each octave, and their cost."""
    kind, reference = WORK.format(model.model_name), radiation_cost(octaves, model, air)
    expected(on_this_host(kind, reference, cache))
    radiators = _Radiators(model, tuple(octave.hull for octave in octaves), air)
    ranges = [(octave.first, octave.last) for octave in octaves]
    knot_seconds = [_knot_cost(octave, model, air)[0].seconds for octave in octaves]
    computed: list[float] = []

    def resistances(points: Points) -> Iterator[ComplexArray]:
        # the first points are followed by all others
        seconds = sum(knot_seconds[index] for index, _ in points) if computed else reference.seconds
        matrices = divided(workers, _resistance_at, radiators, points, seconds)
        for (index, _), matrix in zip(points, matrices, strict=True):
            yield matrix
            computed.append(knot_seconds[index])
            done(min(sum(computed) / reference.seconds, 1.0))

    meter = WorkMeter.at_start(kind, reference, cache, workers)
    knots = _knots_of(ranges, resistances, modes)
    return knots, meter.finish()


def resolved_frequency(outer: OuterHull, air: Air) -> float:
    """Return the frequency up to which the panels resolve the wavelength, Hz."""
    return outer.hull.highest_wavenumber * air.sound_speed / (2.0 * np.pi) * ROUNDED_DOWN


def cached_radiation(
    housing: ReducedHousing,
    model: RadiationModel,
    frequencies: ArrayLike,
    air: Air | None = None,
    cache: Path | None = None,
    progress: Progress = silent,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> HousingRadiation:
    """Return `housing_radiation`, from the cache if the cache has it.

    Raises `InputError` as `housing_radiation` does.

    Parameters
    ----------
    cache : Path, optional
        Directory of cached results and of what is known of the host; None: neither read nor written.
        Results that take less than a second are not stored.
    progress : callable, optional
        Called as progress("radiation", fraction), before costly work with its predicted cost behind it.
    workers : Workers
        Workers as in `housing_radiation`.
    """
    ends = float(np.min(frequencies)), float(np.max(frequencies))
    file = None
    if cache is not None:
        file = cache / f"radiation-{content_key(housing, model, ends, air or Air())}.nc"
    cached = read_cached(file, HousingRadiation.from_netcdf, ResultError)
    if cached is not None:
        return cached
    radiation = housing_radiation(
        housing,
        model,
        ends,
        air,
        lambda fraction: progress(STAGE, fraction),
        lambda cost: announce(progress, STAGE, model.model_name.replace("_", " "), cost),
        cache,
        workers,
    )
    if radiation.metadata.cost.seconds > MIN_COST:
        keep_cached(radiation, file, HousingRadiation.to_netcdf)
    return radiation


def content_key(housing: ReducedHousing, *settings: object) -> str:
    """Return the hash of a housing and of settings whose `repr` says all of them."""
    digest = hashlib.sha256(repr((RADIATION_VERSION, *settings)).encode())
    surface = housing.surface
    arrays = () if surface is None else (surface.points, surface.triangles, surface.motion)
    for array in (*arrays, housing.mass, housing.stiffness):
        values = np.ascontiguousarray(array)
        digest.update(f"{values.dtype.str} {values.shape}".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()
