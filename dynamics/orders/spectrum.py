"""Spectra of a stretch of a run: amplitudes, their peaks and sidebands."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bounds.brief import brief
from dynamics.checks import integer, one_of, positive
from dynamics.errors import InputError
from dynamics.orders.resampling import checked_order, resample_to_position, unit_of
from dynamics.results import RunResult
from dynamics.types import FloatArray

WINDOWS = ("hann", "rectangular", "flat_top")
FLAT_TOP = (0.21557895, -0.41663158, 0.277263158, -0.083578947, 0.006947368)  # ISO 18431-2
ORDERS = 3
"""Mesh orders with sidebands where no number is given, as far as the output holds them."""
REVOLUTIONS = 4
"""Least length in periods of the modulation: under a Hann window a line reaches one line to either side."""


@brief
@dataclass(frozen=True)
class Spectrum:
    """One-sided amplitude spectrum."""

    frequency: FloatArray
    """Frequencies of the lines, Hz, from 0. Shape (K,)."""
    amplitude: FloatArray
    """Peak amplitude of a sinusoid at each frequency (corrected for the window), in `unit`; the mean at 0 Hz.
    Shape (..., K).
    """
    unit: str
    resolution: float
    """Distance of the lines, Hz."""
    window: str
    noise_bandwidth: float
    """Noise bandwidth of the window, in lines (1 rectangular, 1.5 Hann, 3.77 flat top). The mean square of a
    signal is the sum of half the squared amplitudes over it.
    """


@dataclass(frozen=True)
class _MeshOrder:
    """The band of a harmonic of the mesh frequency in a window of a run-up."""

    order: int
    """Multiple of the mesh frequency."""
    low: float
    high: float
    """`low`, `high`: Lowest and highest frequency of the order in the window, Hz."""


def spectrum(values: FloatArray, sample_rate: float, unit: str = "", window: str = "hann") -> Spectrum:
    """Return the amplitude spectrum of `values` (..., N), uniformly sampled.

    The lines of a sinusoid that falls between two of them read low by the window's scalloping: up to 1.4 dB
    (15 %) for Hann, 3.9 dB for rectangular, 0.01 dB for flat top. Raises `InputError`: there are fewer than 4
    samples or the window is unknown.
    """
    values = np.asarray(values, dtype=float)
    samples = values.shape[-1]
    if samples < 4:
        raise InputError("values", samples, "at least 4 samples")
    one_of("window", window, WINDOWS)
    phase = 2.0 * np.pi * np.arange(samples) / samples
    terms = {"hann": (0.5, -0.5), "rectangular": (1.0,), "flat_top": FLAT_TOP}[window]
    weight = np.asarray(sum(term * np.cos(k * phase) for k, term in enumerate(terms)), dtype=float)
    mean = values.mean(axis=-1, keepdims=True)
    lines = np.abs(np.fft.rfft((values - mean) * weight, axis=-1)) * 2.0 / weight.sum()
    if samples % 2 == 0:
        lines[..., -1] *= 0.5
    lines[..., 0] = np.abs(mean[..., 0])
    resolution = positive("sample_rate", sample_rate) / samples
    bandwidth = samples * float(np.sum(weight**2) / np.sum(weight) ** 2)
    return Spectrum(np.arange(lines.shape[-1]) * resolution, lines, unit, resolution, window, bandwidth)


def window_spectrum(
    result: RunResult, series: str, start: float, end: float, window: str = "hann"
) -> Spectrum:
    """Return the spectrum of one series of `result`, e.g. ``"bearing_force"``, between two times in s.

    Raises `InputError`: the run has no such series over time, or not those times.
    """
    unit = unit_of(series)
    values = getattr(result, series)[..., result.window(start, end)]
    return spectrum(values, result.sample_rate, unit, window)


def mesh_orders(
    result: RunResult, start: float, end: float, count: int = 5, mesh: int = 0
) -> tuple[_MeshOrder, ...]:
    """Return the first `count` multiples of a mesh's frequency over the window."""
    integer("count", count, 1, 1000)
    integer("mesh", mesh, 0, len(result.mesh) - 1)
    frequency = result.mesh_frequency[mesh, result.window(start, end)]
    low, high = float(frequency.min()), float(frequency.max())
    return tuple(_MeshOrder(order, order * low, order * high) for order in range(1, count + 1))


@dataclass(frozen=True)
class _Peak:
    """A local maximum of a spectrum."""

    frequency: float
    """Frequency between the lines, Hz: the vertex of the parabola through the logarithms of the three
    highest.
    """
    amplitude: float
    """Amplitude at that vertex, in the spectrum's unit: within 3 % for a sinusoid under a Hann window."""


def find_peaks(
    spectrum: Spectrum, count: int = 10, low: float = 0.0, high: float = np.inf
) -> tuple[_Peak, ...]:
    """Return the `count` highest peaks between `low` and `high` (Hz), highest first; the mean is none.

    Raises `InputError`: the spectrum holds more than one signal.
    """
    lines = spectrum.amplitude
    if lines.ndim != 1:
        raise InputError(
            "spectrum.amplitude", lines.shape, "of one signal, (K,)", "Pick one bearing and direction."
        )
    inner = np.arange(2, lines.size - 1)
    inside = (spectrum.frequency[inner] >= low) & (spectrum.frequency[inner] <= high)
    tops = inner[inside & (lines[inner] > lines[inner - 1]) & (lines[inner] >= lines[inner + 1])]
    tops = tops[np.argsort(lines[tops])[::-1][:count]]
    return tuple(_vertex(spectrum, int(top)) for top in tops)


def _vertex(spectrum: Spectrum, top: int) -> _Peak:
    """Parabola through the logarithms of three lines."""
    left, middle, right = np.log(np.maximum(spectrum.amplitude[top - 1 : top + 2], 1e-300))
    bend = left - 2.0 * middle + right
    shift = 0.5 * (left - right) / bend if bend < 0.0 else 0.0
    height = middle - 0.25 * (left - right) * shift
    return _Peak(float(spectrum.frequency[top] + shift * spectrum.resolution), float(np.exp(height)))


@dataclass(frozen=True)
class _Sideband:
    """One line beside a mesh order."""

    source: str
    """Source of the modulation: the name of a gear, or the name that the caller states."""
    mesh_order: int
    number: int
    """`mesh_order`, `number`: Multiple of the mesh frequency, and number of the sideband at it: < 0 below, 0
    the mesh order itself.
    """
    order: float
    """Order of the line, mesh_order + number * spacing, multiples of the mesh frequency."""
    amplitude: float
    """Peak amplitude, in the unit of the signal."""


def sidebands(
    result: RunResult,
    values: FloatArray,
    orders: int = 3,
    count: int = 3,
    mesh: int = 0,
    periods: Mapping[str, int] | None = None,
) -> tuple[_Sideband, ...]:
    """Return `count` sidebands on either side of the first `orders` mesh orders of the signal `values` (T,).

    `periods`: names and periods of what may modulate, in base pitches; left out: both gears with their teeth.
    What a planet carrier modulates has the ring's teeth as its period. Raises `InputError`: the run is
    shorter than four periods, or its output does not hold the orders.
    """
    orders = checked_order(result, "orders", orders, mesh, ORDERS)
    integer("count", count, 0, 1000)
    if np.ndim(values) != 1:
        raise InputError("values", np.shape(values), "one signal, (T,)", "Pick one bearing and direction.")
    per_pitch = max(64, 8 * (orders + 1))
    grid, _, signal = resample_to_position(result, values, per_pitch, mesh)
    bands: list[_Sideband] = []
    if not periods:
        pair = result.case["meshes"][mesh]
        teeth = {gear["name"]: int(gear["teeth"]) for gear in result.case["gears"]}
        periods = {name: teeth[name] for name in (pair["driver"], pair["driven"])}
    for source, period in periods.items():
        turns = grid.size // (period * per_pitch)
        if turns < REVOLUTIONS:
            bound = f"at least {REVOLUTIONS * period} base pitches for sidebands of {source}"
            raise InputError("result", f"{grid.size // per_pitch} base pitches", bound, "Run for longer.")
        lines = spectrum(signal[-turns * period * per_pitch :], float(per_pitch)).amplitude
        for order in range(1, orders + 1):
            for number in range(-count, count + 1):
                line = (order * period + number) * turns
                at = order + number / period
                if line > 0:
                    bands.append(_Sideband(source, order, number, at, float(lines[line])))
    return tuple(bands)
