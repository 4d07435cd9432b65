"""Mesh orders of the forces on bearings along a run, with their phases.

A mesh order is a multiple of the frequency of the first mesh that turns. A window is a stretch of the run
over which amplitudes are fitted; the sweep is the change of the mesh frequency in it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from bounds import at_least
from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.orders.resampling import checked_order, leading_shaft
from dynamics.results import RunResult
from dynamics.results.order_fit import order_phasors, unwrapped
from dynamics.types import BoolArray, ComplexArray, FloatArray, IntArray, Json

SAME = 1e-6
"""Orders closer than this are one: frequencies of meshes in a train are ratios of teeth."""
SECOND_MOMENT = 1.0 / 12.0 - 0.5 / np.pi**2
"""Second moment of Hann weights about their middle, over the square of the window's length."""
PITCHES = 16
"""Base pitches of a window, if orders lie no closer than an eighth."""
MIN_DISTANCE = 2.0
"""Cycles by which two orders differ within a window, or its Hann weights do not tell them apart."""
ROWS = 400
"""Most windows; they overlap by half where that makes fewer."""
MAX_SWEEP = 0.2
"""Change of the mesh frequency within a window, of its mean: beyond it the window has no speed."""


def bearing_signals(result: RunResult) -> FloatArray:
    """Return forces on bearings over time, (b, 3, T) in N, with moments (b, 6, T) in N m where there are any.

    Raises `InputError`: the run holds no bearing forces.
    """
    if not len(result.bearing_force):
        remedy = "Run the scene with bearing forces among its outputs."
        raise InputError("bearing_force", "none", "a run with bearing forces", remedy)
    if not result.bearing_moment.size:
        return result.bearing_force
    return np.concatenate([result.bearing_force, result.bearing_moment], axis=1)


@dataclass(frozen=True)
class _MeshHarmonics:
    """Harmonics of meshes, in rising order; one that several meshes share is that of the first of them."""

    order: FloatArray
    """Multiples of the frequency of the mesh that counts. Shape (H,)."""
    mesh: IntArray
    """Mesh of which each is a harmonic. Shape (H,)."""
    multiple: IntArray
    """Multiple of the frequency of that mesh. Shape (H,)."""

    @property
    def closest(self) -> float:
        """Smallest distance of two orders, or of the first from the mean."""
        return float(np.min(np.diff(self.order, prepend=0.0)))

    def cycles(self, result: RunResult) -> FloatArray:
        """Return the number of cycles of each harmonic since the start of the run, (H, T).

        They rise, whichever way a mesh turns; where it reverses for a while they fall.
        """
        turned = unwrapped(result.position)
        turned = (turned - turned[:, :1]) * np.where(turned[:, -1:] < turned[:, :1], -1.0, 1.0)
        return np.asarray(self.multiple[:, None] * turned[self.mesh])


def _counting_mesh(result: RunResult) -> int:
    """Return the first mesh that turns; a run without one is refused."""
    turning: BoolArray = np.any(result.mesh_frequency > 0.0, axis=-1)
    if not np.any(turning):
        raise InputError("mesh_frequency", 0.0, "a run with a mesh that turns")
    return int(np.argmax(turning))


def _mesh_harmonics(result: RunResult, highest: int) -> _MeshHarmonics:
    """Return the harmonics of all meshes that turn up to order `highest` of the `_counting_mesh`."""
    mean = result.mesh_frequency.mean(axis=-1)
    ratio = mean / mean[_counting_mesh(result)]
    rows = [
        (multiple * ratio[mesh], mesh, multiple)
        for mesh in np.flatnonzero(ratio > 0.0)
        for multiple in range(1, int(highest / ratio[mesh] * (1.0 + SAME)) + 1)
    ]
    rows.sort(key=lambda row: row[0])
    first_row = rows[:1]
    for row in rows[1:]:
        if row[0] - first_row[-1][0] > SAME * row[0]:
            first_row.append(row)
    order, mesh, multiple = (np.array(column) for column in zip(*first_row, strict=True))
    return _MeshHarmonics(order, mesh, multiple)


def _smearing(modes: Json, frequency: FloatArray, sweep: FloatArray) -> FloatArray:
    """Return the leading error of amplitudes under Hann windows, of the amplitude near each mode, (S, H).

    An amplitude that passes a mode of frequency f_n and damping ratio z goes with 1/(1 + i x), where
    x = (f - f_n)/(z f_n). Weights of the second moment m over a window in which f changes by d average it to
    (1 - m (d/(z f_n))^2/(1 + i x)^2) of itself; stated is the largest of all modes. Where it is above 0.1
    the amplitude is not resolved: take shorter windows, or run up more slowly. `modes` are as `RunResult` has
    them, `frequency` (S, H) in Hz, `sweep` (S,) the change of the frequency in the window, of its mean.
    """
    natural = np.asarray(modes.get("frequency", ()), dtype=float)
    ratio = np.asarray(modes.get("damping_ratio", ()), dtype=float)
    swept = sweep[:, None] * frequency
    largest = np.full(frequency.shape, 0.0 if natural.size else np.nan)
    for width, center in zip(natural * ratio, natural, strict=True):
        if width > 0.0:
            off = (frequency - center) / width
            largest = np.maximum(largest, SECOND_MOMENT * (swept / width) ** 2 / (1.0 + off**2))
    return largest


@dataclass(frozen=True)
class BearingOrders:
    """Mesh orders of the forces on b bearings in S windows of a run; H orders.

    Complex peak amplitudes A, of one moment for all bearings: at constant speed the force is its mean and the
    sum over h of Re(A exp(2 pi i frequency t)), t from the start of the run. At changing speed the angle is
    that of the mesh in place of 2 pi frequency t.

    Windows are in order of speed where it rises or falls all along, or else of time.
    """

    bearing: tuple[str, ...]
    time: FloatArray
    """Middle of each window, s. Shape (S,)."""
    speed: FloatArray
    """Speed of the leading shaft at that time, rad/s, without sign. Shape (S,)."""
    order: FloatArray
    """Multiples of the frequency of the first mesh that turns; harmonics of the other meshes are among them.
    Shape (H,).
    """
    frequency: FloatArray
    """Frequencies of the orders, Hz. Shape (S, H)."""
    bearing_force: ComplexArray
    """Force on the ground or the pin, in the bearing's own frame, N; with seats (b, 6, S, H), moments in N m
    too. Shape (b, 3, S, H).
    """
    in_contact: BoolArray
    """Whether all driving flanks stay in contact throughout the window. Shape (S,)."""
    sweep: FloatArray
    """Change of the mesh frequency within the window, of its mean. Shape (S,)."""
    smearing: FloatArray
    """Relative error of an amplitude by the window, which rounds off a resonance of the scene (`_smearing`);
    NaN if the run states no modes. Shape (S, H).
    """
    remainder: FloatArray
    """Share of the variance of each bearing's force, from half the first order to half an order above the
    last, that belongs to none of the orders: impacts, sidebands, orders of bearings, free vibration. Shape
    (b, S).
    """
    metadata: Json = field(default_factory=dict)
    """Plain JSON: `leading_shaft`, `pitches` of a window, `windows_left_out` (standstill, reversal, too fast
    a sweep), `effect_ledger` of the run.
    """

    @property
    def floor(self) -> None:
        """None: the part outside the orders is the `remainder`."""


@dataclass(frozen=True)
class _Row:
    """One window: scalars, (H,) frequencies, (b, 3 or 6, H) phasors, (b,) remainders."""

    time: float
    speed: float
    frequency: FloatArray
    force: ComplexArray
    in_contact: bool
    sweep: float
    remainder: FloatArray


def bearing_orders(result: RunResult, orders: int | None = None, pitches: int | None = None) -> BearingOrders:
    """Return the mesh orders of the forces on the bearings of a run, window by window.

    Least squares under Hann weights: an order of constant amplitude is found exactly at any sweep. Changes
    within the window are averaged, see `_smearing`. Raises `InputError`: the run holds no bearing forces or
    not those orders, no mesh turns, windows are too short to tell orders apart, or the run is too short or
    too fast for any window.

    Parameters
    ----------
    result : RunResult
        Run with bearing forces.
    orders : int, optional
        Highest multiple of the mesh frequency of the first mesh that turns; default: 10, or what the run's
        output holds.
    pitches : int, optional
        Base pitches of a window; default: 16, or as many as tell the orders of several meshes apart.
    """
    mesh, signals = _counting_mesh(result), bearing_signals(result)
    harmonics = _mesh_harmonics(result, checked_order(result, "orders", orders, mesh))
    pitches = _checked_pitches(harmonics, pitches)
    cycles = harmonics.cycles(result)
    mesh_cycles = cycles[np.argmax((harmonics.mesh == mesh) & (harmonics.multiple == 1))]
    windows = list(_windows(mesh_cycles, pitches))
    rows = [_row(result, harmonics, cycles, signals, window) for window in windows]
    steady = [row for row in rows if row.sweep <= MAX_SWEEP]  # a mesh that rests or reverses sweeps from 0
    if not steady:
        raise _no_window(mesh_cycles, pitches, rows)
    metadata: Json = {
        "leading_shaft": leading_shaft(result),
        "pitches": pitches,
        "windows_left_out": len(windows) - len(steady),
        "effect_ledger": result.effect_ledger,
    }
    falls = all(later.speed < earlier.speed for earlier, later in pairwise(steady))
    return _put_together(result, harmonics, steady[::-1] if falls else steady, metadata)


def _checked_pitches(harmonics: _MeshHarmonics, pitches: int | None) -> int:
    """Return the base pitches of a window that tells the orders apart."""
    minimum = int(np.ceil(MIN_DISTANCE / harmonics.closest * (1.0 - 1e-6)))
    if pitches is None:
        return max(PITCHES, minimum)
    integer("pitches", pitches, 1, 1_000_000)
    if pitches < minimum:
        remedy = "Longer windows, or fewer orders."
        raise InputError("pitches", pitches, at_least(minimum, note=", which tell the orders apart"), remedy)
    return pitches


def _windows(position: FloatArray, pitches: int) -> Iterator[slice]:
    """Yield the samples of windows of `pitches` over the cycles (T,) of the mesh that counts."""
    travel = np.maximum.accumulate(position)
    spare = float(travel[-1]) - pitches
    if spare < 0.0:
        return
    count = min(int(2.0 * spare / pitches), ROWS - 1) + 1
    starts = np.linspace(0.0, spare, count) if count > 1 else np.array([0.5 * spare])
    firsts, ends = np.searchsorted(travel, starts), np.searchsorted(travel, starts + pitches, "right")
    yield from map(slice, firsts.tolist(), ends.tolist())


def _row(
    result: RunResult, harmonics: _MeshHarmonics, cycles: FloatArray, signals: FloatArray, window: slice
) -> _Row:
    hertz = result.mesh_frequency[:, window]
    mesh_hertz = hertz[_counting_mesh(result)]
    progress = cycles[0, window]
    # Hann by position: the window has its length in pitches
    weight = np.sin(np.pi * (progress - progress[0]) / (progress[-1] - progress[0])) ** 2
    part = weight / weight.sum()
    phasors, left = order_phasors(cycles[:, window].T, signals[..., window], weight)
    shaft = result.shaft.index(leading_shaft(result))
    mean = hertz @ part
    frequency = harmonics.multiple * mean[harmonics.mesh]
    return _Row(
        float(part @ result.time[window]),
        float(part @ np.abs(result.speed[shaft, window])),
        frequency,
        phasors,
        bool(np.all(result.least_mesh_force[:, window] > 0.0)),
        float(np.ptp(mesh_hertz) / (part @ mesh_hertz)),
        _remainder(left[:, :3], phasors[:, :3], cycles[:, window], weight, frequency, result.sample_rate),
    )


def _remainder(
    left: FloatArray,
    phasors: ComplexArray,
    cycles: FloatArray,
    weight: FloatArray,
    frequency: FloatArray,
    rate: float,
) -> FloatArray:
    """Return the share of the variance in the band that the orders leave, by bearing, (b,)."""
    orders = np.einsum("...h,ht->...t", phasors, np.exp(2j * np.pi * cycles)).real
    line = np.fft.rfftfreq(weight.size, 1.0 / rate)
    half = 0.5 * float(frequency[0])
    band = (line >= half) & (line <= float(frequency[-1]) + half)
    energy, total = (
        np.sum(np.abs(np.fft.rfft(series * weight, axis=-1)[..., band]) ** 2, axis=(-2, -1))
        for series in (left, left + orders)
    )
    return np.asarray(np.divide(energy, total, out=np.zeros(energy.shape), where=total > 0.0))


def _no_window(position: FloatArray, pitches: int, rows: list[_Row]) -> InputError:
    if not rows:
        value = f"{float(np.max(position)):.4g} base pitches of one sense"
        return InputError("result", value, f"at least {pitches}, the length of a window", "Run for longer.")
    minimum = min(row.sweep for row in rows)
    value = f"speeds that change by {100.0 * minimum:.3g} % or more within {pitches} base pitches"
    remedy = "Run up more slowly, or take fewer orders of several meshes."
    return InputError("result", value, f"at most {100.0 * MAX_SWEEP:g} %", remedy)


def _put_together(
    result: RunResult, harmonics: _MeshHarmonics, rows: list[_Row], metadata: Json
) -> BearingOrders:
    frequency = np.stack([row.frequency for row in rows])
    sweep = np.array([row.sweep for row in rows])
    return BearingOrders(
        bearing=tuple(result.bearing),
        time=np.array([row.time for row in rows]),
        speed=np.array([row.speed for row in rows]),
        order=harmonics.order,
        frequency=frequency,
        bearing_force=np.stack([row.force for row in rows], axis=-2),
        in_contact=np.array([row.in_contact for row in rows]),
        sweep=sweep,
        smearing=_smearing(result.modes, frequency, sweep),
        remainder=np.stack([row.remainder for row in rows], axis=-1),
        metadata=metadata,
    )
