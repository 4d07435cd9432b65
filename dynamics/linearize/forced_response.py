"""Forced response over speed as a study: harmonic response with its peaks, error estimate, cost and file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from bounds.brief import brief
from dynamics.assembly.assemble import System
from dynamics.assembly.motion_and_loads import drive_springs
from dynamics.bearings.seat import SEAT
from dynamics.errors import InputError
from dynamics.forces.laws import Law
from dynamics.linearize.flank_cycles import FlankCycle
from dynamics.linearize.harmonic_response import (
    HarmonicResponse,
    excited_lines,
    response_of,
    varied_floor,
)
from dynamics.linearize.linear_system import HELD_BY, LinearSystem, natural_modes
from dynamics.linearize.load_harmonics import load_cycles, load_harmonics
from dynamics.linearize.operating_speeds import checked_speeds, leading_law
from dynamics.linearize.steady_vibration import (
    Excited,
    Steady,
    gyroscopic_terms,
    heard_harmonics,
    speed_blocks,
)
from dynamics.linearize.strongest_lines import require_memory
from dynamics.linearize.varying_stiffness import varied_vibration
from dynamics.mechanism.columns import elastic_columns, elastic_terms, housing_columns
from dynamics.mechanism.connections import frame_couplings
from dynamics.motion.force_balance import swept_by_frames
from dynamics.motion.observation import local_state
from dynamics.results.array_file import ArrayFile, stored
from dynamics.results.run_checks import checked_ledger
from dynamics.types import ComplexArray, FloatArray, Json
from host import cpu_seconds

# The parts of a linearized system that take power from its vibration, each assembled by itself.


KINDS = (*HELD_BY, "load", "frame")
FLANKS = (Law.FLANK, Law.SPATIAL_FLANK)
LOADS = "loads"
FRAMES = "rotating frames"
NOTHING_EXCITES = "such that one excites: transmission errors and loads are constant"


@dataclass(frozen=True)
class _Absorber:
    """A part with k coordinates y = rows q, whose force against its motion is stiffness y + damping y'."""

    name: str
    kind: str
    """`name`, `kind`: Of the part; one of `KINDS`."""
    rows: FloatArray
    """Shape (k, n)."""
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: N/m, N s/m. A symmetric stiffness takes no power over a cycle, and is 0 where
    it is known to be. Shape (k, k) each.
    """


def _elements(
    system: System, linear: LinearSystem, cycles: tuple[FlankCycle, ...], time: float
) -> Iterator[_Absorber]:
    """Yield the force elements but those of rotating frames."""
    arrays, elements = system.arrays, system.arrays.elements
    rest = np.zeros(arrays.mass.shape[0])
    local = local_state(arrays, time, linear.equilibrium.displacement, rest)
    tangents = local.tangent - swept_by_frames(elements, local, local.pace)
    for e, (first, end) in enumerate(zip(elements.first[:-1], elements.first[1:], strict=True)):
        if elements.law[e] == Law.ROTATING_FRAME:
            continue
        own = slice(first, end)
        tangent = cycles[e].tangent if e < len(cycles) else tangents[own, : end - first]
        damping = local.viscous[own, : end - first]
        yield _Absorber(*_element_part(system, e), arrays.direction[own], tangent, damping)


def _element_part(system: System, element: int) -> tuple[str, str]:
    """Return the name of the part that a force element belongs to, and its kind."""
    scene, elements = system.scene, system.arrays.elements
    law, entry, count = elements.law[element], int(elements.entry[element]), elements.law.size
    on_bearings = (*system.housed, *system.bearings)
    if element >= count - len(on_bearings):
        return on_bearings[element - count].name, "bearing"
    if law in FLANKS:
        return scene.meshes[int(elements.mesh[element])].name, "mesh"
    if law == Law.FRAME_COUPLING:
        return system.couplings.name[frame_couplings(scene)[entry].coupling], "coupling"
    if law == Law.SPEED_TORQUE:
        return scene.speed_torques[entry].name, "load"
    loads = scene.forces if law == Law.APPLIED_FORCE else scene.unbalances
    return loads[entry].name, "load"


def _bearings(system: System) -> Iterator[_Absorber]:
    """Yield linear bearings: those that are springs, and groups with matrices, on a massless housing one."""
    supports, seats, keep = system.supports, system.seats, system.freedoms.keep
    held = ~supports.carried
    for index in np.flatnonzero(held):
        damping = np.diag(supports.damping[index])
        yield _damper(supports.name[index], "bearing", keep(supports.motion[index]), damping)
    on = np.repeat(held[seats.support], SEAT)
    for name, at in seats.group:
        yield _damper(name, "bearing", keep(seats.motion[at]), seats.damping[at, at] * on[at])


def _couplings(system: System) -> Iterator[_Absorber]:
    """Yield couplings, as far as no frame turns them, and elastic drives."""
    couplings, keep = system.couplings, system.freedoms.keep
    for name, motion, damping in zip(couplings.name, couplings.motion, couplings.damping, strict=True):
        yield _damper(name, "coupling", keep(motion), damping)
    for _, drive, row in drive_springs(system.scene, system.kinematics, system.rotors, system.freedoms):
        yield _damper(drive.name, "drive", row[None, :], np.array([[drive.damping]]))


def _bodies(system: System) -> Iterator[_Absorber]:
    """Yield the shafts that bend and the housings that move."""
    rotors, dampers = system.rotors, elastic_terms(system.rotors)[1]
    columns = [(rotor.shaft.name, "shaft", elastic_columns(rotors, i)) for i, rotor in enumerate(rotors)]
    columns += [(part.name, "housing", housing_columns(rotors, i)) for i, part in enumerate(rotors.housings)]
    for name, kind, own in columns:
        yield _damper(name, kind, system.freedoms.motion[own], dampers[own, own])


def _damper(name: str, kind: str, rows: FloatArray, damping: FloatArray) -> _Absorber:
    return _Absorber(name, kind, rows, np.zeros_like(damping), damping)


# Power balance of a harmonic vibration: what excitation puts in, and what parts lose, by harmonic.


@dataclass(frozen=True)
class _PowerBalance:
    """Mean powers of H harmonics at S speeds, W; p sources, a sinks."""

    source: tuple[str, ...]
    """Meshes, by their transmission errors; `LOADS`: forces and unbalances, where they excite."""
    input: FloatArray
    """By each, negative where it brakes the vibration. Shape (p, S, H)."""
    sink: tuple[str, ...]
    kind: tuple[str, ...]
    """`sink`, `kind`: Parts and what they are, one of `KINDS`."""
    loss: FloatArray
    """In each. A mesh whose friction feeds the vibration has a negative one. Shape (a, S, H)."""

    @property
    def fields(self) -> dict[str, Any]:
        """The fields of `ForcedResponse` that hold it."""
        own = {"source": self.source, "input": self.input, "sink": self.sink}
        own |= {"sink_kind": self.kind, "loss": self.loss}
        return {f"power_{name}": value for name, value in own.items()}

    @property
    def residual(self) -> float:
        """Power that is put in and lost nowhere over that put in, all harmonics, at the worst speed."""
        missing = np.abs(np.sum(self.input, axis=0) - np.sum(self.loss, axis=0)).sum(axis=-1)
        turned = np.abs(self.input).sum(axis=(0, 2))
        return float(np.max(missing / np.maximum(turned, 1e-300), initial=0.0))

    def by_kind(self) -> dict[str, FloatArray]:
        """Return what parts of a kind lose together, all harmonics, (S,)."""
        total = np.sum(self.loss, axis=2)
        return {
            kind: np.sum(total[[own == kind for own in self.kind]], axis=0)
            for kind in dict.fromkeys(self.kind)
        }


def _power_balance(at: Excited, speed: FloatArray, steady: Steady) -> _PowerBalance:
    """Return where the power of a vibration at `speed` (S,) comes from and goes to.

    Forces of complex amplitude F on coordinates of amplitude y put in Re(F conj(i w y))/2. Each part is
    assembled by itself, so the residual tells what the linear solves and the sum of the parts leave.
    """
    gained: dict[str, list[FloatArray]] = {mesh.name: [] for mesh in at.system.scene.meshes}
    lost: dict[tuple[str, str], list[FloatArray]] = {}
    loaded = False
    for part in speed_blocks(steady.omega.shape, steady.displacement.shape[2]):
        u, own = steady.displacement[part], dict[tuple[str, str], FloatArray]()
        rate = 1j * steady.omega[part, :, None] * u
        for name, cycle in zip(gained, at.cycles, strict=False):
            along = rate @ at.system.arrays.direction[cycle.rows].T
            force = steady.force if len(steady.force) == 1 else steady.force[part]
            gained[name].append(_power(np.swapaxes(force[:, cycle.rows], 1, 2), along))
        loads = load_harmonics(at.system, at.period, speed[part], steady.harmonics, at.time)
        loaded = loaded or bool(np.any(loads))
        gained.setdefault(LOADS, []).append(_power(loads, rate))
        for name, kind, power in _losses(at, speed[part], u, rate):
            own[name, kind] = own.get((name, kind), 0.0) + power
        for key, power in own.items():
            lost.setdefault(key, []).append(power)
    if not loaded:
        gained.pop(LOADS, None)
    return _PowerBalance(
        tuple(gained),
        np.array([np.concatenate(each) for each in gained.values()]).reshape(-1, *steady.omega.shape),
        tuple(name for name, _ in lost),
        tuple(kind for _, kind in lost),
        np.array([np.concatenate(each) for each in lost.values()]).reshape(-1, *steady.omega.shape),
    )


def _losses(
    at: Excited, speed: FloatArray, u: ComplexArray, rate: ComplexArray
) -> Iterable[tuple[str, str, FloatArray]]:
    """Yield name, kind and power (S, H) of parts; one part may come several times.

    The sum of all parts with damping about the equilibrium, driving flanks by their mean tangents, is the
    damping of `LinearSystem`; what gyroscopic and frame terms do comes last.
    """
    elements = _elements(at.system, at.linear, at.cycles, at.time)
    for part in (*elements, *_bearings(at.system), *_couplings(at.system), *_bodies(at.system)):
        if not (np.any(part.damping) or np.any(part.stiffness)):
            continue
        along = rate @ part.rows.T
        force = (u @ part.rows.T) @ part.stiffness.T + along @ part.damping.T
        yield part.name, part.kind, _power(force, along)
    if at.turning:
        terms = gyroscopic_terms(at.system, speed)
        damping, stiffness = (np.stack([term[k] for term in terms]) for k in (0, 1))
        force = np.einsum("sij,shj->shi", damping, rate) + np.einsum("sij,shj->shi", stiffness, u)
        yield FRAMES, "frame", _power(force, rate)


def _power(force: ComplexArray, rate: ComplexArray) -> FloatArray:
    """Return the mean power of forces (..., k) on rates (..., k), peak amplitudes, W."""
    return np.asarray(0.5 * np.real(np.sum(force * rate.conj(), axis=-1)))


@brief
@dataclass(frozen=True)
class ForcedResponse(HarmonicResponse, ArrayFile):
    """Harmonic response over S speeds with a measure of its validity."""

    SCHEMA = "lineofaction forced response"

    excitation_difference: FloatArray = field(
        default_factory=lambda: np.empty((0, 0)),
        metadata=stored(
            "1", "change of the largest amplitude with the other excitation, relative", "mesh", "order"
        ),
    )
    """By how much the largest dynamic transmission error over the speeds changes if the blocked force excites
    instead of the static error, relative to the largest of all harmonics: what a theory of first order in the
    ripple cannot tell. Shape (m, H).
    """
    natural_frequency: FloatArray = field(
        default_factory=lambda: np.empty(0), metadata=stored("Hz", "undamped natural frequency", "mode")
    )
    """With the mean mesh stiffness. Shape (n,)."""
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
    """`bearing_floor`, `bearing_floor_error`: Empty where no orders are left out. Shape (b, S) each."""
    facts: Json = field(default_factory=dict)
    """Plain JSON: `leading_shaft`, `time`, `equilibrium`, `seconds` (CPU by stage), `effect_ledger`."""

    @property
    def bearing_mean_square(self) -> FloatArray:
        """Mean square of the force on each bearing, all orders together, those left out too, (b, S), N^2."""
        listed = 0.5 * np.sum(np.abs(self.bearing_force[:, :3]) ** 2, axis=(1, 3))
        return np.asarray(listed + self.bearing_floor if self.bearing_floor.size else listed)

    def to_netcdf(self, path: str | Path) -> None:
        """Write a netCDF-4 file, without `floor`; it appears whole or not at all."""
        ArrayFile.to_netcdf(replace(self, floor=None), path)

    @property
    def power(self) -> _PowerBalance:
        """Where the power of the vibration comes from and goes to, with the residual of the balance."""
        return _PowerBalance(
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
    system : System
    speed : (S,) sequence
        Of the first drive that turns, rad/s, increasing, > 0; its sense is the scene's.
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
    harmonics = heard_harmonics(at, speeds, lines.harmonics)
    if not harmonics.size:
        raise InputError("orders", orders, NOTHING_EXCITES, "Give a mesh a table, or let a load vary.")
    steady, *largest = varied_vibration(at, speeds, harmonics, progress)
    response, power = response_of(at, speeds, steady), _power_balance(at, speeds, steady)
    response = replace(response, floor=varied_floor(at, speeds, lines, response))
    floor, floor_error = (np.empty((0, 0)),) * 2 if response.floor is None else response.floor.of_bearings()
    seconds["response"] = cpu_seconds() - began
    return ForcedResponse(
        **vars(response),
        excitation_difference=_difference(*largest),
        natural_frequency=frequency,
        **power.fields,
        bearing_floor=floor,
        bearing_floor_error=floor_error,
        facts=_facts(at, time, seconds)
        | lines.facts(response.floor is not None)
        | {"effect_ledger": ledger}
        | system.corrections,
    )


def _require_memory(at: Excited, speeds: int, harmonics: int) -> None:
    """Refuse what cannot be held: by speed and harmonic motions, forces, and the power of each part."""
    system = at.system
    freedoms, bearings, meshes = system.arrays.mass.shape[0], len(system.supports.name), len(at.cycles)
    loaded = 3 * freedoms if load_cycles(system, at.period) else 0
    numbers = freedoms + loaded + 6 * bearings + 8 * meshes + system.arrays.elements.law.size
    require_memory(speeds, harmonics, numbers, freedoms)


def _facts(at: Excited, time: float, seconds: Json) -> Json:
    start = at.linear.equilibrium
    return {
        "leading_shaft": at.system.scene.references[leading_law(at.system)].shaft,
        "time": time,
        "equilibrium": {"status": start.status.name, "residual": start.residual},
        "seconds": seconds,
    }


def _difference(static: FloatArray, blocked: FloatArray) -> FloatArray:
    """Return how unlike the largest transmission errors (m, H) by static errors and blocked forces are."""
    return np.asarray(np.abs(blocked - static) / np.max(static, initial=1e-300))


@dataclass(frozen=True)
class _Peak:
    """A local maximum over the speeds."""

    quantity: str
    """"mesh_force" or "bearing_force"."""
    name: str
    """Of the mesh or bearing."""
    order: float
    speed: float
    frequency: float
    """`order`, `speed`, `frequency`: Multiple of the mesh frequency; rad/s; Hz."""
    amplitude: float
    """N; of a bearing the root of the sum of squares of x, y and z."""
    amplification: float
    """Dynamic over static transmission error there; of a bearing that of the mesh where it is largest."""
    natural_frequency: float
    """The nearest, Hz."""


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
        own = [
            _peak(response, quantity, names[k], (s + 1, h), float(amplitude[k, s + 1, h]), gains[k])
            for k, s, h in zip(*(index.tolist() for index in maxima), strict=True)
        ]
        rows += sorted(own, key=lambda peak: -peak.amplitude)
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
