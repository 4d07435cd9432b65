"""Forced response over speed as a study: harmonic response with its peaks, error estimate, cost and file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from bounds.brief import brief
from bounds.plottable import Plottable
from dynamics.assembly.assemble import System
from dynamics.errors import InputError
from dynamics.linearize.harmonic_response import HarmonicResponse, excited_lines, response_of, varied_floor
from dynamics.linearize.linear_system import SPRING_KINDS
from dynamics.linearize.load_harmonics import load_cycles
from dynamics.linearize.natural_modes import natural_modes
from dynamics.linearize.operating_speeds import checked_speeds, leading_law
from dynamics.linearize.power_balance import PowerBalance, power_balance
from dynamics.linearize.steady_vibration import Excited, excited_harmonics
from dynamics.linearize.strongest_lines import require_memory
from dynamics.linearize.varying_stiffness import varied_vibration
from dynamics.results.array_file import ArrayFile, stored
from dynamics.results.run_checks import checked_ledger
from dynamics.types import FloatArray, Json
from host import cpu_seconds
from model_studies.record import under_key

KINDS = (*SPRING_KINDS, "load", "frame")
NOTHING_EXCITES = "such that one excites: transmission errors and loads are constant"


@brief
@dataclass(frozen=True)
class ForcedResponse(HarmonicResponse, ArrayFile, Plottable):
    """Harmonic response over S speeds with a measure of its validity."""

    SCHEMA = "lineofaction forced response"

    excitation_difference: FloatArray = field(
        default_factory=lambda: np.empty((0, 0)),
        metadata=stored(
            "1", "change of the largest amplitude with the other excitation, relative", "mesh", "order"
        ),
    )
    """Change of the largest dynamic transmission error over the speeds, if the blocked force excites instead
    of the static error, relative to the largest of all harmonics. It is of second order in the ripple, which
    linear theory neglects. Shape (m, H).
    """
    natural_frequency: FloatArray = field(
        default_factory=lambda: np.empty(0), metadata=stored("Hz", "undamped natural frequency", "mode")
    )
    """Undamped natural frequencies with the mean mesh stiffness, Hz. Shape (n,)."""
    power_source: tuple[str, ...] = ()
    power_input: FloatArray = field(
        default_factory=lambda: np.empty((0, 0, 0)),
        metadata=stored("W", "mean power put in", "source", "speed", "order"),
    )
    power_sink: tuple[str, ...] = ()
    power_sink_kind: tuple[str, ...] = ()
    power_loss: FloatArray = field(
        default_factory=lambda: np.empty((0, 0, 0)),
        metadata=stored("W", "mean power lost", "sink", "speed", "order"),
    )
    """`power_source`, `power_input`, `power_sink`, `power_sink_kind`, `power_loss`: The fields of `power`;
    empty in files of versions without it.
    """
    bearing_floor: FloatArray = field(
        default_factory=lambda: np.empty((0, 0)),
        metadata=stored("N2", "mean square force of the orders left out", "bearing", "speed"),
    )
    bearing_floor_error: FloatArray = field(
        default_factory=lambda: np.empty((0, 0)),
        metadata=stored("N2", "by how much it may be off", "bearing", "speed"),
    )
    """`bearing_floor`, `bearing_floor_error`: Mean square bearing force of the orders left out, and its
    error, N^2. Empty where no orders are left out. Shape (b, S) each.
    """
    metadata: Json = field(default_factory=dict, metadata=under_key("facts"))
    """Plain JSON: `leading_shaft`, `time`, `equilibrium`, `seconds` (CPU by stage), `effect_ledger`."""

    @property
    def bearing_mean_square(self) -> FloatArray:
        """Mean square of the force on each bearing, all orders together, with those left out, (b, S), N^2."""
        listed = 0.5 * np.sum(np.abs(self.bearing_force[:, :3]) ** 2, axis=(1, 3))
        return np.asarray(listed + self.bearing_floor if self.bearing_floor.size else listed)

    def to_netcdf(self, path: str | Path) -> None:
        """Write a netCDF-4 file, without `floor`; it appears whole or not at all."""
        ArrayFile.to_netcdf(replace(self, floor=None), path)

    @property
    def power(self) -> PowerBalance:
        """Sources and sinks of the power of the vibration, with the residual of the balance."""
        return PowerBalance(
            self.power_source, self.power_input, self.power_sink, self.power_sink_kind, self.power_loss
        )


def forced_response(
    system: System,
    speed: Sequence[float] | FloatArray,
    orders: int = 10,
    time: float = 0.0,
    progress: Callable[[float], None] | None = None,
) -> ForcedResponse:
    """Return `harmonic_response` at the speeds given, by both excitations, with its receipt.

    Parameters
    ----------
    speed : (S,) sequence
        Speeds of the first drive that turns, rad/s, increasing, > 0; the scene decides the sense.
    orders : int
        Harmonics of the mesh frequency of the first mesh that turns.
    time : float
        Time at which loads are evaluated, s.
    progress : callable, optional
        Called with the fraction done; an exception in it ends the study.

    Raises
    ------
    InputError
        If a value is out of range, the meshes have no common period, nothing excites the scene, or the
        response would take more than 8 GB.
    SolveError
        If there is no static equilibrium, or one beyond the table (`STRAIGHT_ON`) that is not accepted.
    """
    speeds = checked_speeds(np.asarray(speed, dtype=float), above_zero=True)
    if not speeds.size:
        raise InputError("speed", [], "at least one speed")
    began = cpu_seconds()
    at, lines = excited_lines(system, orders, time, speeds)
    _require_memory(at, speeds.size, lines.harmonics.size)
    system, start = at.system, at.linear.equilibrium
    ledger = checked_ledger(system, start.mesh_force)
    frequency = natural_modes(at.linear).frequency
    seconds = {"equilibrium_and_modes": cpu_seconds() - began}
    began = cpu_seconds()
    harmonics = excited_harmonics(at, speeds, lines.harmonics)
    if not harmonics.size:
        raise InputError("orders", orders, NOTHING_EXCITES, "Give a mesh a table, or let a load vary.")
    steady, by_static_error, by_blocked_force = varied_vibration(at, speeds, harmonics, progress)
    response, power = response_of(at, speeds, steady), power_balance(at, speeds, steady)
    response = replace(response, floor=varied_floor(at, speeds, lines, response))
    floor, floor_error = np.empty((0, 0)), np.empty((0, 0))
    if response.floor is not None:
        floor, floor_error = response.floor.of_bearings()
    seconds["response"] = cpu_seconds() - began
    return ForcedResponse(
        **vars(response),
        excitation_difference=_difference(by_static_error, by_blocked_force),
        natural_frequency=frequency,
        **power.fields,
        bearing_floor=floor,
        bearing_floor_error=floor_error,
        metadata=_metadata(at, time, seconds)
        | lines.to_json(response.floor is not None)
        | {"effect_ledger": ledger}
        | system.corrections,
    )


def _require_memory(at: Excited, speeds: int, harmonics: int) -> None:
    """Refuse a response too large for memory: by speed and harmonic motions, forces, and powers of parts."""
    system = at.system
    freedoms, bearings, meshes = system.arrays.mass.shape[0], len(system.supports.name), len(at.cycles)
    loaded = 3 * freedoms if load_cycles(system, at.period) else 0
    numbers = freedoms + loaded + 6 * bearings + 8 * meshes + system.arrays.elements.law.size
    require_memory(speeds, harmonics, numbers, freedoms)


def _metadata(at: Excited, time: float, seconds: Json) -> Json:
    start = at.linear.equilibrium
    return {
        "leading_shaft": at.system.scene.references[leading_law(at.system)].shaft,
        "time": time,
        "equilibrium": {"status": start.status.name, "residual": start.residual},
        "seconds": seconds,
    }


def _difference(static: FloatArray, blocked: FloatArray) -> FloatArray:
    """Return the relative difference of largest transmission errors (m, H) by the two excitations."""
    return np.asarray(np.abs(blocked - static) / np.max(static, initial=1e-300))


@dataclass(frozen=True)
class _Peak:
    """A local maximum over the speeds."""

    quantity: str
    """"mesh_force" or "bearing_force"."""
    name: str
    """Name of the mesh or bearing."""
    order: float
    speed: float
    frequency: float
    """`order`, `speed`, `frequency`: Multiple of the mesh frequency; speed, rad/s; frequency, Hz."""
    amplitude: float
    """Amplitude of the force, N; of a bearing the root of the sum of squares of x, y and z."""
    amplification: float
    """Dynamic over static transmission error at the peak; of a bearing that of the mesh with the largest
    ratio.
    """
    natural_frequency: float
    """Natural frequency nearest to the peak, Hz."""


def peaks(response: ForcedResponse) -> tuple[_Peak, ...]:
    """Return the peaks of all mesh and bearing forces by order, those of meshes first, the largest first.

    A peak is a speed of the study at which an amplitude is above those at both neighbors.
    """
    gain = np.abs(response.dynamic_transmission_error)
    size = np.abs(response.static_transmission_error)[:, None]
    gain = gain / np.where(size > 0.0, size, np.inf)
    force = np.sqrt(np.sum(np.abs(response.bearing_force[:, :3]) ** 2, axis=1))
    rows = []
    for quantity, names, amplitude in (
        ("mesh_force", response.mesh, np.abs(response.mesh_force)),
        ("bearing_force", response.bearing, force),
    ):
        gains = gain if quantity == "mesh_force" else [np.max(gain, axis=0, initial=0.0)] * len(names)
        inner = amplitude[:, 1:-1]
        maxima = np.nonzero((inner > amplitude[:, :-2]) & (inner >= amplitude[:, 2:]))
        candidates = [
            _peak(response, quantity, names[k], (s + 1, h), float(amplitude[k, s + 1, h]), gains[k])
            for k, s, h in zip(*(index.tolist() for index in maxima), strict=True)
        ]
        rows += sorted(candidates, key=lambda peak: -peak.amplitude)
    return tuple(rows)


def _peak(
    sweep: ForcedResponse, quantity: str, name: str, at: tuple[int, int], amplitude: float, gain: FloatArray
) -> _Peak:
    frequency = float(sweep.frequency[at])
    near = sweep.natural_frequency[np.argmin(np.abs(sweep.natural_frequency - frequency))]
    return _Peak(
        quantity=quantity,
        name=name,
        order=float(sweep.order[at[1]]),
        speed=float(sweep.speed[at[0]]),
        frequency=frequency,
        amplitude=amplitude,
        amplification=float(gain[at]),
        natural_frequency=float(near),
    )
