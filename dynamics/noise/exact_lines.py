"""Boundary elements at the loudest lines of a housing, which take the place of the estimate there alone.

The resistance of a line holds for any motion of the housing at its frequency, and with the square of the
frequency `FLAT` to both sides; from there to `BLEND` it becomes the estimate again. The error of the estimate
at a line says nothing about lines farther away.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bounds import engineering
from dynamics.acoustics import Air, BoundaryElements, outer_hull, resistance, sound_power_level
from dynamics.acoustics.boundary_elements import EDGES
from dynamics.acoustics.model_comparison import WORK
from dynamics.errors import ResultError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.noise.coarse_hull import Coarseness, RadiatingHull, radiating_hull
from dynamics.noise.estimated_radiation import EstimatedRadiation
from dynamics.noise.housing_radiation import HousingRadiation, RadiationMetadata, content_key
from dynamics.noise.radiated_sound import LoudPoint, RadiatedSound, loudest, radiated_sound
from dynamics.types import BoolArray, ComplexArray, FloatArray
from dynamics.vibration import BearingHarmonics
from dynamics.work_cost import Cost, WorkMeter
from host import MissingExtra
from model_studies.cached_file import keep_cached, read_cached

LINES, BUDGET = 4, 60.0
"""Most lines of a housing, and CPU seconds on the reference host that they may take together."""
COARSE = Coarseness(EDGES, 450)
"""Hull of a line. At 15 lines of five gear cases its level is within `EXACT` of that with six edges in a
wavelength.
"""
EXACT = 0.5
"""Error of the level of a line by its hull, dB."""
FLAT, BLEND = 1.03, 1.06
"""Ratios of frequencies up to which the resistance of a line holds, and at which it is the estimate again;
natural frequencies are guessed within the first.
"""
QUIETER = 6.0
"""Distance below the loudest point that the mesh resolves, dB, beyond which no line is corrected: a line that
cannot be louder adds 1 dB at most.
"""
CANDIDATES = 200
"""Number of loudest points among which the lines are."""
AIR, NAME = Air(), BoundaryElements().model_name


@dataclass(frozen=True)
class ExactLine:
    """A line that boundary elements correct."""

    frequency: float
    """Frequency of the line, Hz."""
    estimate: float
    level: float
    """`estimate`, `level`: Sound power level by the estimate and by boundary elements at its loudest point,
    dB.
    """
    panels: int
    seconds: float
    """CPU time when it was computed; a later result takes it from the cache."""


@dataclass(frozen=True)
class CorrectedRadiation:
    """The estimate with boundary elements at its loudest lines."""

    radiation: EstimatedRadiation
    lines: tuple[ExactLine, ...]
    """Lines in the order in which they were corrected."""
    omitted: tuple[str, ...]
    """Reasons why further lines are not corrected; empty: no other line may be as loud."""


def corrected_radiation(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    estimate: EstimatedRadiation,
    model: BoundaryElements = BoundaryElements(),  # noqa: B008 (frozen)
    cache: Path | None = None,
    budget: float = BUDGET,
) -> CorrectedRadiation:
    """Return the estimate, in usual air, corrected line by line; the next line is that which may be loudest.

    Raises `InputError`, `SolveError` as `radiated_sound` and `surface_pressure` do.

    Parameters
    ----------
    response, housing, bearings
        Arguments of `radiated_sound`.
    model : BoundaryElements
        Boundary elements with their progress and workers.
    cache : Path, optional
        Cache as in `cached_radiation`.
    budget : float
        Predicted CPU seconds on the reference host: the lines are the same on every host.
    """
    exact: list[HousingRadiation] = []
    lines: list[ExactLine] = []
    omitted: dict[float, str] = {}
    radiation = estimate
    sound = radiated_sound(response, housing, bearings, radiation)
    while point := _next_point(sound, radiation, (*omitted, *(line.frequency for line in lines))):
        hertz, at = point.frequency, (point.speed_index, point.order_index)
        if len(lines) == LINES or len(omitted) == LINES:
            omitted[hertz] = f"further lines, at {engineering(hertz, 4)} Hz first: {LINES} at most"
            break
        seconds = line_cost(housing, hertz).seconds
        if seconds > budget:
            omitted[hertz] = f"{engineering(hertz, 4)} Hz: {seconds:.0f} of {budget:.0f} CPU s that are left"
            continue
        try:
            exact.append(_exact_line(housing, hertz, model, cache))
        except MissingExtra as error:
            omitted[hertz] = str(error)
            break
        budget -= seconds
        before, radiation = float(sound.power[at]), with_exact_lines(estimate, exact)
        sound = radiated_sound(response, housing, bearings, radiation)
        estimated_level, level = sound_power_level([before, sound.power[at]]).tolist()
        metadata = exact[-1].metadata
        lines.append(ExactLine(hertz, estimated_level, level, metadata.panels, metadata.cost.seconds))
    return CorrectedRadiation(radiation, tuple(lines), tuple(omitted.values()))


def _next_point(
    sound: RadiatedSound, radiation: EstimatedRadiation, known: Sequence[float]
) -> LoudPoint | None:
    """Return the point that may be the loudest away from frequencies in Hz; None where none counts."""
    resolved = radiation.metadata.resolved_frequency
    points = [point for point in loudest(sound, CANDIDATES) if point.frequency <= resolved]
    highest = {
        point: _highest_level(sound, radiation, point)
        for point in points
        if all(max(point.frequency / hertz, hertz / point.frequency) > FLAT for hertz in known)
    }
    first = max(highest, key=highest.__getitem__, default=None)
    if first is None or highest[first] < points[0].weighted_level - QUIETER:
        return None
    return first


def _highest_level(sound: RadiatedSound, radiation: EstimatedRadiation, point: LoudPoint) -> float:
    """Return the highest level that a point may have, dB(A)."""
    alone = sound.mode_alone[:, point.speed_index, point.order_index]
    return point.weighted_level - radiation.error_band(point.frequency, alone)[0]


def _line_hull(housing: ReducedHousing, hertz: float) -> RadiatingHull:
    return radiating_hull(outer_hull(housing), hertz, AIR.sound_speed, COARSE)


def line_cost(housing: ReducedHousing, hertz: float) -> Cost:
    """Predict the cost of a line of a housing on the reference host."""
    return BoundaryElements().cost(len(_line_hull(housing, hertz).shapes), 0.0, 0)


def _exact_line(
    housing: ReducedHousing, hertz: float, model: BoundaryElements, cache: Path | None
) -> HousingRadiation:
    """Return the resistance at one frequency, from the cache if the cache has it."""
    file = None if cache is None else cache / f"line-{content_key(housing, model, hertz, COARSE, AIR)}.nc"
    cached = read_cached(file, HousingRadiation.from_netcdf, ResultError)
    if cached is not None:
        return cached
    outer, hull = outer_hull(housing), _line_hull(housing, hertz)
    panels, shapes = len(hull.shapes), hull.shapes.astype(complex)
    meter = WorkMeter.at_start(WORK.format(NAME), line_cost(housing, hertz), cache, model.workers)
    matrix = resistance(model, hull.hull, hertz, shapes, AIR)
    metadata = RadiationMetadata(panels, meter.finish(), hertz, 0.0, outer.inner_area, outer.cap_area)
    hermitian = 0.5 * (matrix + matrix.conj().T)
    line = HousingRadiation(
        frequency=np.array([hertz]),
        matrix=hermitian[None],
        surface=outer.surface,
        area=outer.hull.area,
        impedance=AIR.impedance,
        model_name=NAME,
        metadata=metadata,
    )
    keep_cached(line, file, HousingRadiation.to_netcdf)
    return line


class _Knot(NamedTuple):
    """Arrays of an estimate at a frequency, Hz."""

    frequency: float
    matrix: ComplexArray
    correction: FloatArray
    mode_error: FloatArray
    by_velocity: BoolArray


def with_exact_lines(estimate: EstimatedRadiation, lines: Sequence[HousingRadiation]) -> EstimatedRadiation:
    """Return the estimate with resistances of single frequencies near these frequencies.

    Between two lines closer than `BLEND` squared it goes from one to the other.
    """
    rising = sorted(lines, key=lambda line: float(line.frequency[0]))
    hertz = np.array([line.frequency[0] for line in rising])
    ratios = estimate.frequency[:, None] / hertz
    away = np.all((ratios < 1.0 / BLEND) | (ratios > BLEND), axis=1)
    knots = [_knot(estimate, at) for at in estimate.frequency[away].tolist()]
    closer = np.diff(np.log(hertz)) < 2.0 * np.log(BLEND)
    for line, below, above in zip(rising, [False, *closer], [*closer, False], strict=True):
        sides = ([] if below else [-1]) + ([] if above else [1])
        knots += _knots_of_line(estimate, line, sides)
    knots.sort(key=lambda knot: knot.frequency)
    frequency, matrix, correction, mode_error, by_velocity = zip(*knots, strict=True)
    return replace(
        estimate,
        frequency=np.array(frequency),
        matrix=np.stack(matrix),
        correction=np.stack(correction),
        mode_error=np.stack(mode_error, axis=1),
        by_velocity=np.stack(by_velocity),
    )


def _knots_of_line(
    estimate: EstimatedRadiation, line: HousingRadiation, sides: Sequence[int]
) -> Iterator[_Knot]:
    """Yield the knots of a line, and the knots at which it ends at its `sides`, -1 below and 1 above it."""
    hertz = float(line.frequency[0])
    lowest, highest = float(estimate.frequency[0]), float(estimate.frequency[-1])
    for at in (hertz, *(hertz * FLAT**side for side in sides)):
        knot = _knot(estimate, at)
        error = np.broadcast_to([[-EXACT], [EXACT]], knot.mode_error.shape)
        matrix = line.matrix[0] * (at / hertz) ** 2
        yield knot._replace(matrix=matrix, mode_error=error, by_velocity=np.zeros_like(knot.by_velocity))
    for side in sides:
        yield _knot(estimate, float(np.clip(hertz * BLEND**side, lowest, highest)))


def _knot(estimate: EstimatedRadiation, hertz: float) -> _Knot:
    """Return the resistance of an estimate at a frequency, and the rest at its next computed frequency."""
    row = int(np.abs(estimate.frequency - hertz).argmin())
    knots = np.searchsorted(estimate.frequency, [knot for knot, _ in estimate.weights(hertz)])
    shares = [share for _, share in estimate.weights(hertz)]
    return _Knot(
        frequency=hertz,
        matrix=np.tensordot(shares, estimate.matrix[knots], 1),
        correction=estimate.correction[row],
        mode_error=estimate.mode_error[:, row],
        by_velocity=estimate.by_velocity[row],
    )
