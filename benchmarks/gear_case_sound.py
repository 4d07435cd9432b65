"""Levels of five gear cases by radiation models, less those of boundary elements, at their loudest modes.

The reference has six edges in a wavelength; `lines` are what `loa noise` computes, on hulls of 900 panels.
"""

from __future__ import annotations

import numpy as np

from benchmarks.figures import Figure
from benchmarks.gear_case_solids import CASES
from dynamics.acoustics import (
    Air,
    BoundaryElements,
    ElementalRadiators,
    EquivalentRadiatedPower,
    a_weighting,
    outer_hull,
    resistance,
)
from dynamics.housings import ReducedHousing
from dynamics.noise import estimated_radiation, housing_radiation, radiating_hull
from dynamics.noise.exact_lines import BUDGET, COARSE, EXACT
from dynamics.types import ComplexArray, FloatArray
from dynamics.vibration.housing_motion import modal_amplitudes
from host import cpu_seconds

MODES, LINES = 40, 3
RANGE = 300.0, 1300.0
"""Range of frequencies, Hz. A hull of 1600 panels, 20 CPU s for boundary elements, resolves the highest."""
MODELS, FINEST = (EquivalentRadiatedPower(), ElementalRadiators()), BoundaryElements()
LIMIT = 1.5
"""dB, of the estimate."""
SHARE = 10.0
"""Per cent of the lines that the band may leave out."""
NOT_LEVELS = ("band", "outside", "CPU s")


def figures() -> list[Figure]:
    """Return the differences of the models on each case, at its loudest line and over all lines."""
    of_cases = {name: case_errors(CASES[name].reduced(MODES)) for name in CASES}
    outside = [missed for errors in of_cases.values() for missed in errors["outside"]]
    what, share = f"outside the band, of {len(outside)} lines", 100.0 * float(np.mean(outside))
    return [
        *(figure for name in CASES for figure in _figures_of(name, of_cases[name])),
        Figure("all cases", what, share, "%", SHARE),
    ]


def _figures_of(name: str, errors: dict[str, list[float]]) -> list[Figure]:
    made = [
        Figure(f"{name}, {LINES} lines", f"{model}, mean error", float(np.mean(values)), "dB")
        for model, values in errors.items()
        if model not in NOT_LEVELS
    ]
    made.append(Figure(name, "largest error of lines", float(np.abs(errors["lines"]).max()), "dB", EXACT))
    made.append(Figure(name, f"{LINES} lines by boundary elements", sum(errors["CPU s"]), "CPU s", BUDGET))
    loudest = Figure(f"{name}, loudest line", "estimate, error", abs(errors["estimate"][0]), "dB", LIMIT)
    return [*made, loudest, Figure(name, "band of the estimate", float(np.mean(errors["band"])), "dB", 8.0)]


def case_errors(housing: ReducedHousing) -> dict[str, list[float]]:
    """Return the errors of each model at the loudest lines, the widths of the band, dB; where it misses."""
    air, outer = Air(), outer_hull(housing)
    estimate = estimated_radiation(housing, housing_radiation(housing, MODELS[1], RANGE, air), air)
    names = [*(model.model_name for model in MODELS), "estimate", "lines", *NOT_LEVELS]
    errors: dict[str, list[float]] = {name: [] for name in names}
    for hertz in loudest_lines(housing):
        modal = _modal_velocity(housing, np.array([hertz]))[0]
        velocity = housing.modes[1] @ modal
        panels = radiating_hull(outer, hertz, air.sound_speed)
        finest, *others = (
            _power(resistance(model, panels.hull, hertz, panels.shapes.astype(complex), air), velocity)
            for model in (FINEST, *MODELS)
        )
        others.append(float(estimate.power(np.array([hertz]), velocity[None])[0]))
        began = cpu_seconds()
        coarse = radiating_hull(outer, hertz, air.sound_speed, COARSE)
        others.append(
            _power(resistance(FINEST, coarse.hull, hertz, coarse.shapes.astype(complex), air), velocity)
        )
        errors["CPU s"].append(cpu_seconds() - began)
        for name, power in zip(names, others, strict=False):
            errors[name].append(10.0 * float(np.log10(power / finest)))
        alone = estimate.alone(np.array([hertz]), housing.modes[1])[0] * np.abs(modal) ** 2
        low, high = estimate.error_band(hertz, alone)
        errors["band"].append(high - low)
        errors["outside"].append(not low <= errors["estimate"][-1] <= high)
    return errors


def loudest_lines(housing: ReducedHousing) -> list[float]:
    """Return the loudest resonances by A-weighted velocity under unit forces on the seats, Hz."""
    hertz = np.geomspace(*RANGE, 3000)
    surface = outer_hull(housing).surface
    velocity = _modal_velocity(housing, hertz) @ housing.modes[1].T
    moving = np.sum(velocity.conj() * (velocity @ surface), axis=1).real
    level = 10.0 * np.log10(moving) + a_weighting(hertz)
    peaks = np.flatnonzero((level[1:-1] > level[:-2]) & (level[1:-1] >= level[2:])) + 1
    return [float(hertz[at]) for at in peaks[np.argsort(-level[peaks])][:LINES]]


def _modal_velocity(housing: ReducedHousing, hertz: FloatArray) -> ComplexArray:
    """Return velocities of the modes under forces of random phase and direction on the seats, (F, m)."""
    motions = sum(len(seat.motions) for seat in housing.seats)
    real, imaginary = np.random.default_rng(3).normal(size=(2, motions))
    along = [number % len(seat.motions) < 3 for seat in housing.seats for number in range(len(seat.motions))]
    force = np.where(along, real + 1j * imaginary, 0.0)
    return np.asarray(2j * np.pi * hertz[:, None] * modal_amplitudes(housing, hertz, force[None, None])[:, 0])


def _power(matrix: ComplexArray, velocity: ComplexArray) -> float:
    return 0.5 * float(np.real(velocity.conj() @ matrix @ velocity))
