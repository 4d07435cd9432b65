"""Levels in bands of one third of an octave."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bounds import Bound, at_least, at_most, from_to
from bounds.brief import brief
from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.orders.resampling import checked_order, resample_to_position, unit_of
from dynamics.orders.spectrum import Spectrum, spectrum
from dynamics.results import RunResult
from dynamics.types import FloatArray, IntArray

ON_LINE = 1e-6  # distance from a line over the distance of lines, up to which a value is on it
MIN_LINES = 3.0
"""Lines in the narrowest band: below, a band holds what leaks from its neighbors."""
REFERENCE = 1000.0  # Hz, the center of band 0
SHARE = 10.0**0.05 - 10.0**-0.05  # width of a band over its center
NOMINAL = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)
"""Nominal center frequencies of a decade, IEC 61260-1."""


@brief
@dataclass(frozen=True)
class Waterfall:
    """Spectra of B blocks along a run."""

    line: FloatArray
    """Frequencies in Hz, or orders in multiples of the mesh frequency, from 0, equally spaced. Shape (K,)."""
    time: FloatArray
    mesh_frequency: FloatArray
    """`time`, `mesh_frequency`: Means of each block, s and Hz. Shape (B,) each."""
    amplitude: FloatArray
    """Peak amplitude under the window, in `unit`; the mean at line 0. Shape (..., B, K)."""
    rms: FloatArray
    """Root mean square of each block about its mean, over the whole content of the signal, in `unit`. Shape
    (..., B).
    """
    unit: str
    noise_bandwidth: float
    """Noise bandwidth of the window, in lines."""

    def cut(self, line: float) -> FloatArray:
        """Return the amplitude over the run at one line, (..., B): an order cut where lines are orders.

        Raises `InputError`: there is no such line.
        """
        fraction = line / self.line[1]
        nearest = round(fraction)
        if abs(fraction - nearest) > ON_LINE or not 0 <= nearest < self.line.size:
            bound = f"a multiple of {self.line[1]:g} up to {self.line[-1]:g}"
            raise InputError("line", line, bound, "Longer blocks have more lines.")
        return np.asarray(self.amplitude[..., nearest])


def order_waterfall(
    result: RunResult,
    series: str,
    pitches: int = 16,
    highest: int | None = None,
    mesh: int = 0,
    window: str = "hann",
    overlap: float = 0.0,
) -> Waterfall:
    """Return the spectra over mesh orders, up to `highest`, of blocks of `pitches` base pitches.

    `overlap` is a share of their length. Orders are 1/`pitches` apart: if that is a multiple of a gear's
    teeth, the orders of its shaft are lines. Without `highest` they reach to the tenth mesh order, or as far
    as the output holds. Raises `InputError`: the run is shorter than one block, has no such series, or its
    output does not hold the order.
    """
    unit = unit_of(series)
    integer("pitches", pitches, 1, 1_000_000)
    if not result.mesh:
        raise InputError("mesh", mesh, "one of the run, which has none: orders are those of a mesh")
    highest = checked_order(result, "highest", highest, mesh)
    per_pitch = max(64, 8 * highest)
    _, time, values = resample_to_position(result, getattr(result, series), per_pitch, mesh)
    if time.size < pitches * per_pitch:
        bound = at_most(time.size // per_pitch, note=", the run's length")
        raise InputError("pitches", pitches, bound)
    blocks = _blocks(time.size, pitches * per_pitch, overlap)
    frequency = np.interp(time, result.time, result.mesh_frequency[mesh])
    spectra = [spectrum(values[..., block], float(per_pitch), unit, window) for block in blocks]
    return _waterfall(spectra, values, blocks, (time, frequency), highest * pitches + 1)


def order_track(
    result: RunResult, series: str, pitches: int = 16, highest: int | None = None, mesh: int = 0
) -> Waterfall:
    """Return the amplitudes of the mesh orders 0 to `highest` in blocks of `pitches` base pitches.

    They are lines of `order_waterfall`. Raises `InputError`: the run is shorter than one block, or its output
    does not hold the order.
    """
    waterfall = order_waterfall(result, series, pitches, highest, mesh)
    orders = np.arange((waterfall.line.size - 1) // pitches + 1)
    return replace(waterfall, line=orders.astype(float), amplitude=waterfall.amplitude[..., orders * pitches])


def frequency_waterfall(
    result: RunResult,
    series: str,
    block: float,
    overlap: float = 0.5,
    mesh: int = 0,
    window: str = "hann",
) -> Waterfall:
    """Return the spectra over frequency of blocks of `block` seconds; `overlap` is a share of it.

    Raises `InputError`: the run is shorter than one block, or has no such series.
    """
    unit = unit_of(series)
    length = round(block * result.sample_rate)
    if not 4 <= length <= result.time.size:
        bound = from_to(4.0 / result.sample_rate, float(result.time[-1]), "s", "the run's")
        raise InputError("block", block, bound)
    blocks = _blocks(result.time.size, length, overlap)
    values = getattr(result, series)
    spectra = [spectrum(values[..., block], result.sample_rate, unit, window) for block in blocks]
    return _waterfall(spectra, values, blocks, (result.time, result.mesh_frequency[mesh]))


def _blocks(samples: int, length: int, overlap: float) -> list[slice]:
    if not 0.0 <= overlap < 1.0:
        raise InputError("overlap", overlap, Bound(0.0, 1.0, high_open=True))
    step = max(round(length * (1.0 - overlap)), 1)
    return [slice(first, first + length) for first in range(0, samples - length + 1, step)]


def _waterfall(
    spectra: list[Spectrum],
    values: FloatArray,
    blocks: list[slice],
    series: tuple[FloatArray, FloatArray],
    lines: int | None = None,
) -> Waterfall:
    """Return the first `lines` of the spectra of blocks of `values` (..., T).

    `series` are time and mesh frequency (T,), whose means belong to the blocks.
    """
    time, frequency = (np.array([values_over[block].mean() for block in blocks]) for values_over in series)
    return Waterfall(
        line=spectra[0].frequency[:lines],
        time=time,
        mesh_frequency=frequency,
        amplitude=np.stack([spectrum.amplitude[..., :lines] for spectrum in spectra], axis=-2),
        rms=np.stack([values[..., block].std(axis=-1) for block in blocks], axis=-1),
        unit=spectra[0].unit,
        noise_bandwidth=spectra[0].noise_bandwidth,
    )


@dataclass(frozen=True)
class ThirdOctaves:
    """The rms of a signal in bands of one third of an octave (IEC 61260-1, base ten) along a run.

    The bands add up the lines of spectra, so that their mean squares add up to the signal's; they are not
    the filters of the standard, which overlap.
    """

    band: IntArray
    """Number of each band, 0 at 1 kHz. Shape (K,)."""
    edges: FloatArray
    """Edges of the bands, Hz. Shape (K + 1,)."""
    rms: FloatArray
    """Root mean square of each band in each block of the run, in `unit`. Shape (..., B, K)."""
    unit: str

    @property
    def nominal(self) -> FloatArray:
        """The nominal center frequencies in Hz, (K,)."""
        return nominal_center(self.band)


def band_number(frequency: FloatArray) -> IntArray:
    """Return the band that holds each frequency in Hz, above zero; 0 is the one about 1 kHz."""
    return np.asarray(np.floor(10.0 * np.log10(frequency / REFERENCE) + 0.5).astype(int))


def nominal_center(band: IntArray) -> FloatArray:
    """Return the nominal center frequencies of bands by their numbers, Hz."""
    decades, thirds = np.divmod(band, 10)
    return np.asarray(REFERENCE * 10.0 ** decades.astype(float) * np.array(NOMINAL)[thirds])


def third_octaves(blocks: Waterfall, top: float) -> ThirdOctaves:
    """Add up the lines of spectra over frequency in the bands that end at or below `top`, Hz.

    Raises `InputError`: no band below `top` holds three lines.
    """
    power = 0.5 * blocks.amplitude[..., 1:] ** 2 / blocks.noise_bandwidth
    band, edges, within = band_sums(float(blocks.line[1]), power, top)
    return ThirdOctaves(band, edges, np.sqrt(within), blocks.unit)


def band_sums(
    width: float, power: FloatArray, top: float, bottom: float = 0.0
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return bands (J,), their edges (J + 1,) in Hz and the sums (..., J) of lines of a spectrum in them.

    A line's power is spread evenly over its width, so that a band edge divides it. Raises `InputError`: no
    band between them holds three lines.

    Parameters
    ----------
    width : float
        Distance of the lines, Hz.
    power : (..., K) array
        Power of the lines at 1, 2, ... K times that distance.
    top, bottom : float
        Edges that no band crosses, Hz.
    """
    minimum = max(MIN_LINES * width / SHARE, bottom * 10.0**0.05)
    low = int(np.ceil(10.0 * np.log10(minimum / REFERENCE)))
    last = width * power.shape[-1]
    high = int(np.floor(10.0 * np.log10(min(top, last) / REFERENCE) - 0.5))
    band = np.arange(low, high + 1)
    if not band.size:
        bound = at_least(REFERENCE * 10.0 ** (0.1 * (low + 0.5)), "Hz")
        raise InputError("top", top, bound, "Longer blocks have narrower lines.")
    edges = REFERENCE * 10.0 ** ((np.append(band, band[-1] + 1) - 0.5) / 10.0)
    below = np.concatenate([np.zeros_like(power[..., :1]), np.cumsum(power, axis=-1)], axis=-1)
    at = np.clip(edges / width - 0.5, 0.0, power.shape[-1])
    floor = np.minimum(at.astype(int), power.shape[-1] - 1)
    under = below[..., floor] + (at - floor) * power[..., floor]
    return band, edges, np.maximum(np.diff(under, axis=-1), 0.0)
