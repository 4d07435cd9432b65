"""Transfer functions of the rows on which flanks act: solved once for a scene, a product for other flanks.

With the dynamic stiffness D of the scene, the gradients G of the rows of its flanks and of the bearings that
are not linear, their tangents T and viscous damping V, other flanks exert e' instead of e, and move the
equilibrium and with it the tangents: an update of the rank of the rows,

    (D + G^T X G) u = G^T e' + loads,  X = T' - T + i w (V' - V),
    u = u_0 + D^-1 G^T v,  (1 + X A) v = e' - e - X G u_0,  A = G D^-1 G^T.

Every linear quantity is a product of its transfer functions and the inputs (1, v), and every power or mean
square their Hermitian form. As in every linear response, how the stiffness varies along the pitch and flanks
that part are left out; couplings across frames keep the tangents of the first equilibrium.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.checks import integer
from dynamics.errors import InputError, ResultError, SolveError
from dynamics.forces.laws import Law
from dynamics.linearize.flank_cycles import SAMPLES
from dynamics.linearize.harmonic_response import bearing_forces, extremes
from dynamics.linearize.load_harmonics import load_harmonics, load_multiples
from dynamics.linearize.modal_elimination import solved
from dynamics.linearize.operating_speeds import checked_speeds
from dynamics.linearize.steady_vibration import (
    ROUNDED,
    Excited,
    excited,
    flank_forces,
    gyroscopic_terms,
    with_receptances,
)
from dynamics.linearize.strongest_lines import require_memory, strongest_lines
from dynamics.linearize.varying_stiffness import VaryingStiffness, still_motion
from dynamics.motion.force_balance import block_diagonal
from dynamics.results.array_file import ArrayFile, stored
from dynamics.types import BoolArray, ComplexArray, FloatArray, IntArray
from model_studies.cached_file import keep_cached, read_cached

BLOCK = 4_000_000  # complex displacements held at once
SAME = 1e-9  # difference of gradients over the largest, below which rows are the same
VERSION = 1
"""Version of cached files, raised with every change of the fields of a transfer function or of their numbers.
"""

_SOLVED = 6e-8
"""CPU seconds of a line at a speed by freedoms squared: 3.5 to 9e-8 for 47 to 170 of them."""


class FlankExcitation(NamedTuple):
    """Excitation by flanks at their equilibrium, and the tangents there; m meshes, R rows, H harmonics."""

    static: ComplexArray
    """Static transmission errors, m. Shape (m, H)."""
    force: ComplexArray
    """Exciting force on the rows, N. On the row of the deflection it raises the deflection with the
    transmission error. On the further rows of a mesh it is the moment of the load as it travels along the
    face, over a length, and the friction. Shape (R, H).
    """
    tangent: FloatArray
    viscous: FloatArray
    """`tangent`, `viscous`: Stiffness and damping of the rows, N/m and N s/m; those of flanks are means over
    the positions. Shape (R, R) each.
    """
    mean_force: FloatArray
    """Static mesh forces, N. Shape (m,)."""


@dataclass(frozen=True)
class TransferredResponse:
    """Linear response of other flanks: `dynamics.vibration.BearingHarmonics`; b bearings, m meshes."""

    bearing: tuple[str, ...]
    speed: FloatArray
    order: FloatArray
    frequency: FloatArray
    bearing_force: ComplexArray
    """Bearing force as in `HarmonicResponse`. Shape (b, 3 or 6, S, H)."""
    mesh_force: ComplexArray
    """Transverse mesh force, N. Shape (m, S, H)."""
    least_mesh_force: FloatArray
    """Least mesh force, N. Where it is negative flanks part, and no linear answer holds. Shape (m, S)."""

    @property
    def in_contact(self) -> BoolArray:
        """Whether all driving flanks stay in contact at each speed, (S,) bool."""
        return np.asarray(np.all(self.least_mesh_force > 0.0, axis=0))

    @property
    def floor(self) -> None:
        """None: other flanks respond in the lines of the transfer functions alone."""


@dataclass(frozen=True)
class FlankTransfer(ArrayFile):
    """Transfer functions at S speeds in H harmonics from the inputs (1, v) of R rows.

    The first of the 1 + R columns is the vibration under the flanks of the scene and its loads, each further
    one that per N on a row. Complex peak amplitudes as those of `HarmonicResponse`.
    """

    SCHEMA = "lineofaction flank transfer"

    bearing: tuple[str, ...]
    freedom: tuple[str, ...]
    orders: int
    time: float
    """`orders`, `time`: Requested harmonics of the first mesh, and time at which loads are taken, s."""
    harmonics: IntArray = field(metadata=stored("1", "multiple of the common period's frequency", "order"))
    speed: FloatArray = field(metadata=stored("rad s-1", "speed of the leading shaft", "speed"))
    order: FloatArray = field(
        metadata=stored("1", "multiple of the frequency of the first mesh that turns", "order")
    )
    frequency: FloatArray = field(metadata=stored("Hz", "frequency of the harmonic", "speed", "order"))
    first: IntArray = field(metadata=stored("1", "first row of each part, and their number", "bound"))
    """First row of each mesh, then of each bearing that is not linear, and the number of rows. The rows of a
    mesh are its deflection, then misalignment, center distance, sliding and rolling as far as it has them.
    Shape (k + 1,).
    """
    gradient: FloatArray = field(metadata=stored("1", "gradient of the rows", "row", "freedom"))
    """Gradients of the rows in the freedoms. Shape (R, n)."""
    force: ComplexArray = field(metadata=stored("N", "what excites the rows", "row", "order"))
    tangent: FloatArray = field(metadata=stored("N m-1", "tangents of the rows", "row", "row"))
    viscous: FloatArray = field(metadata=stored("N s m-1", "damping of the rows", "row", "row"))
    """`force`, `tangent`, `viscous`: Excitation, stiffness and damping of the rows with the scene's flanks,
    as in `FlankExcitation`.
    """
    motion: ComplexArray = field(
        metadata=stored("m or m N-1", "motion of the rows", "row", "speed", "order", "input")
    )
    """Motion of the rows, m under the flanks of the scene, then m/N per force on each row. Shape
    (R, S, H, 1 + R).
    """
    bearing_force: ComplexArray = field(
        metadata=stored("N or 1", "forces of bearings", "bearing", "direction", "speed", "order", "input")
    )
    """Bearing forces, N or N m under the flanks of the scene, then per N on each row. Shape
    (b, 3 or 6, S, H, 1 + R).
    """
    residual: float = 0.0

    def excitation(self, system: System) -> FlankExcitation:
        """Return the excitation by the flanks of a design: the scene with other tables of its meshes.

        Raises
        ------
        InputError
            More than tables differ, or the tables have no common period.
        SolveError
            There is no static equilibrium.
        """
        at = excited(system, self.time, self.orders)
        rows = at.system.arrays.direction[_rows(at)]
        same = rows.shape == self.gradient.shape and at.linear.freedom == self.freedom
        if not same or np.max(np.abs(rows - self.gradient), initial=0.0) > SAME * np.max(np.abs(rows)):
            raise InputError("system", "another scene", "the scene of the transfer with other tables")
        return excitation_of(at, self.harmonics)

    def inputs(self, flanks: FlankExcitation) -> ComplexArray:
        """Return the inputs (1, v) that stand for other flanks, (S, H, 1 + R); (1, 0) for the scene's own.

        Raises `SolveError`: nothing bounds the vibration at one of the frequencies.
        """
        opposing = self._opposing(flanks.tangent - self.tangent, flanks.viscous - self.viscous, self.motion)
        right = (flanks.force - self.force).T[None] - opposing[..., 0]
        v = solved(np.eye(len(self.force)) + opposing[..., 1:], right[..., None])[..., 0]
        if not np.all(np.isfinite(v)):
            raise SolveError("the vibration is unbounded with these flanks at one of the frequencies")
        return np.concatenate([np.ones((*v.shape[:2], 1)), v], axis=2)

    def excitation_errors(
        self, system: System, flanks: FlankExcitation, mesh: int, errors: tuple[FloatArray, ...]
    ) -> list[FlankExcitation]:
        """Return the change of the excitation by three errors of the excitation of one mesh.

        `errors` (H,) of amplitudes are those of the transmission error, m, of the arm of the load, m, and of
        the friction along the sliding over the largest. Flanks without such a row err by nothing there.
        """
        static, arm, friction = errors
        mesh_rows, elements = slice(*self.first[mesh : mesh + 2]), system.arrays.elements
        forces, load = np.zeros((3, *self.force.shape), dtype=complex), abs(flanks.mean_force[mesh])
        forces[0, mesh_rows] = flanks.tangent[mesh_rows, mesh_rows.start, None] * static
        if elements.law[mesh] == Law.SPATIAL_FLANK:
            laws, entry = elements.laws.spatial_flank, elements.entry[mesh]
            tilting, _, sliding = (mesh_rows.start + int(row) for row in laws.row[entry])
            if laws.per_face[entry] > 0.0:
                forces[1, tilting] = laws.per_face[entry] * load * arm
            if sliding > mesh_rows.start:
                forces[2, sliding] = laws.friction[entry] * load * friction
        none = np.zeros_like(self.tangent)
        return [flanks._replace(force=force, tangent=none, viscous=none) for force in forces]

    def input_changes(
        self, flanks: FlankExcitation, inputs: ComplexArray, changes: Sequence[FlankExcitation]
    ) -> ComplexArray:
        """Return the changes (S, H, 1 + R, d) of `inputs` of flanks, to first order in d small `changes`.

        They follow from the derivative (1 + X A) dv = de' - dX (A v + G u_0).
        """
        opposing = self._opposing(flanks.tangent - self.tangent, flanks.viscous - self.viscous, self.motion)
        motion = np.einsum("rshc,shc->rsh", self.motion, inputs)[..., None]
        right = [
            change.force.T[None] - self._opposing(change.tangent, change.viscous, motion)[..., 0]
            for change in changes
        ]
        v = solved(np.eye(len(self.force)) + opposing[..., 1:], np.stack(right, axis=-1))
        return np.concatenate([np.zeros((*v.shape[:2], 1, v.shape[3])), v], axis=2)

    def varied_inputs(self, at: Excited, flanks: FlankExcitation) -> tuple[ComplexArray, float]:
        """Return `inputs` of flanks with tangents that vary with position, and the residual left, relative.

        `at` is the scene about its equilibrium with these flanks. With B = (1 + X A)^-1 the varying part of
        the tangents acts as in a scene of the receptances A B, and its forces are subtracted from v. Raises
        `SolveError` where nothing bounds the vibration.
        """
        inputs, count = self.inputs(flanks), at.cycles[-1].rows.stop
        opposing = self._opposing(flanks.tangent - self.tangent, flanks.viscous - self.viscous, self.motion)
        reach = np.linalg.inv(np.eye(len(self.force)) + opposing[..., 1:])[..., :count]
        displacement = np.einsum("rshc,shcf->shrf", self.motion[:count, :, :, 1:], reach)
        made = np.einsum("rshc,shc->shr", self.motion[:count], inputs)
        made[..., self.first[: len(flanks.static)]] -= flanks.static.T
        rows = self.gradient[:count]
        varying = VaryingStiffness.of(at, self.harmonics, rows @ still_motion(at, rows))
        if not varying.parts:
            return inputs, 0.0
        push, left = varying.push(displacement, made)
        inputs[..., 1:] -= np.matmul(reach, push[:, 1:, :, None])[..., 0]
        residual = float(np.max(left, initial=0.0))
        if not residual <= ROUNDED:
            raise SolveError("the vibration is unbounded with these flanks at one of the speeds")
        return inputs, residual

    def _opposing(self, stiffer: FloatArray, damped: FloatArray, motion: ComplexArray) -> ComplexArray:
        """Return the forces (S, H, R, c) of added tangents (R, R) against motions (R, S, H, c)."""
        omega, opposing = 2j * math.pi * self.frequency[..., None], np.zeros_like(motion)
        for start, end in pairwise(self.first.tolist()):
            flank_rows = slice(start, end)
            tangent, viscous = stiffer[flank_rows, flank_rows], damped[flank_rows, flank_rows]
            if np.any(tangent) or np.any(viscous):
                part = motion[flank_rows]
                opposing[flank_rows] = np.tensordot(tangent, part, 1) + omega * np.tensordot(viscous, part, 1)
        return np.moveaxis(opposing, 0, 2)

    def response(self, flanks: FlankExcitation) -> TransferredResponse:
        """Return the linear response with other flanks; raises `SolveError` as `inputs` does."""
        inputs = self.inputs(flanks)
        local = np.einsum("rshc,shc->shr", self.motion, inputs)
        rate = 2j * math.pi * self.frequency[..., None] * local
        rows = self.first[: len(flanks.mean_force)]
        force = local @ flanks.tangent[rows].T + rate @ flanks.viscous[rows].T - flanks.force[rows].T
        mesh_force = np.ascontiguousarray(np.moveaxis(force, 2, 0))
        return TransferredResponse(
            self.bearing,
            self.speed,
            self.order,
            self.frequency,
            np.einsum("bdshc,shc->bdsh", self.bearing_force, inputs),
            mesh_force,
            flanks.mean_force[:, None] + extremes(mesh_force, self.order)[0],
        )


def parting_share(least_force: FloatArray, mean_force: FloatArray) -> float:
    """Return the largest share of the static mesh forces (m,), N, by which flanks pull; 0: none does.

    `least_force` (m,) are the least forces of the linear response, N, negative where flanks would have to
    pull. Where no static force presses them the share is 1.
    """
    pull, static = np.maximum(-least_force, 0.0), np.abs(mean_force)
    share = np.divide(pull, static, out=np.where(pull > 0.0, 1.0, 0.0), where=static > 0.0)
    return float(np.max(share, initial=0.0))


def flank_transfer(
    system: System,
    speed: FloatArray,
    orders: int = 10,
    cache: Path | None = None,
) -> FlankTransfer:
    """Return the transfer functions of a scene about its equilibrium under the loads at t = 0.

    With tables of long periods the lines are the `strongest_lines` of the scene's flanks, the mesh orders
    always among them.

    Parameters
    ----------
    speed : (S,) array
        Speeds of the first drive that turns, rad/s, increasing, > 0.
    orders : int
        Harmonics of the mesh frequency of the first mesh that turns.
    cache : Path, optional
        Directory in which they are stored by their content; None: neither read nor written.

    Raises
    ------
    InputError
        If a value is out of range, the meshes have no common period, or the functions would take more than
        8 GB.
    SolveError
        If there is no static equilibrium, or a vibration is unbounded.
    """
    speed = checked_speeds(np.asarray(speed, dtype=float), above_zero=True)
    if not speed.size:
        raise InputError("speed", [], "at least one speed")
    integer("orders", orders, 1, SAMPLES // 4)
    at = excited(system, 0.0, orders)
    harmonics = possible_lines(at, orders, speed)
    _require_memory(at, speed.size, harmonics.size)
    file = None if cache is None else cache / f"transfer-{_content_key(at, speed, harmonics, orders)}.nc"
    cached = read_cached(file, FlankTransfer.from_netcdf, ResultError)
    if cached is not None:
        return cached
    transfer = _computed_transfer(at, speed, harmonics, orders)
    keep_cached(transfer, file, FlankTransfer.to_netcdf)
    return transfer


def transfer_seconds(system: System, speed: FloatArray, orders: int) -> float:
    """Return the cost of `flank_transfer` with these arguments, CPU s: within a factor of 2 from 0.05 s on.

    Raises `InputError` and `SolveError` as `flank_transfer` does.
    """
    lines = possible_lines(excited(system, 0.0, orders), orders, speed)
    return _SOLVED * speed.size * lines.size * system.freedoms.column.size**2


def possible_lines(at: Excited, orders: int, speed: FloatArray) -> IntArray:
    """Return the `strongest_lines` that tables or loads may excite, as multiples of the period's."""
    return strongest_lines(at, _harmonics(at, orders, float(speed[-1])), speed).harmonics


def _harmonics(at: Excited, orders: int, speed: float) -> IntArray:
    """Return the multiples of the common period's frequency that any tables or the loads may excite."""
    highest = orders * at.period.counted
    pitches = zip(at.period.pitches, at.system.scene.meshes, strict=True)
    steps = {abs(passed) // mesh.table.period for passed, mesh in pitches} - {0}
    loads = load_multiples(at.system, at.period, speed, at.time).tolist()
    multiples = {k for step in steps for k in range(step, highest + 1, step)}
    return np.array(sorted(multiples | {k for k in loads if k <= highest}), dtype=np.int64)


def _require_memory(at: Excited, speeds: int, lines: int) -> None:
    """Refuse a transfer too large for memory: motions of rows and forces of bearings per input."""
    rows, bearings = _rows(at).size, len(at.system.supports.name)
    freedoms = at.system.arrays.mass.shape[0]
    require_memory(speeds, lines, 2 * (1 + rows) * (rows + 6 * bearings), freedoms)


def _parts(at: Excited) -> list[slice]:
    """Return the local coordinates of each driving flank and of each bearing that is not linear."""
    first = at.system.arrays.elements.first.tolist()
    bearings = list(pairwise(first))[len(first) - 1 - len(at.system.bearings) :]
    return [*(cycle.rows for cycle in at.cycles), *(slice(*ends) for ends in bearings)]


def _rows(at: Excited) -> IntArray:
    return np.concatenate([np.arange(part.start, part.stop) for part in _parts(at)]).astype(np.int64)


def excitation_of(at: Excited, harmonics: IntArray) -> FlankExcitation:
    """Return the excitation by the flanks of a system about its equilibrium in `harmonics` (H,)."""
    arrays, start = at.system.arrays, at.linear.equilibrium
    static, excited_rows = flank_forces(at, harmonics)
    rows = _rows(at)
    tangent, viscous = (
        block_diagonal(arrays.elements, part)[np.ix_(rows, rows)]
        for part in (at.at_rest.tangent, at.at_rest.viscous)
    )
    for cycle in at.cycles:  # driving flanks come first
        tangent[cycle.rows, cycle.rows] = cycle.tangent
    force = np.zeros((rows.size, harmonics.size), dtype=complex)
    force[: len(excited_rows)] = excited_rows
    return FlankExcitation(static, force, tangent, viscous, start.mesh_force)


def _computed_transfer(at: Excited, speed: FloatArray, harmonics: IntArray, orders: int) -> FlankTransfer:
    """Solve a block of speeds at a time."""
    flanks, rows, parts = excitation_of(at, harmonics), _rows(at), _parts(at)
    gradient, inputs = at.system.arrays.direction[rows], 1 + rows.size
    block = max(BLOCK // max(harmonics.size * gradient.shape[1] * inputs, 1), 1)
    motion, force, omega, residual = [], [], [], 0.0
    for start in range(0, speed.size, block):
        steady = with_receptances(at, speed[start : start + block], harmonics, gradient)
        u = np.concatenate([steady.displacement[..., None], steady.receptance], axis=-1)
        motion.append(np.moveaxis(gradient @ u, 2, 0))
        force.append(_bearing_columns(at, steady.omega, u, rows))
        omega.append(steady.omega)
        residual = max(residual, steady.residual)
    return FlankTransfer(
        bearing=at.system.supports.name,
        freedom=at.linear.freedom,
        orders=orders,
        time=at.time,
        harmonics=harmonics,
        speed=speed,
        order=harmonics / at.period.counted,
        frequency=np.concatenate(omega) / (2.0 * math.pi),
        first=np.cumsum([0, *(part.stop - part.start for part in parts)]),
        gradient=gradient,
        force=flanks.force,
        tangent=flanks.tangent,
        viscous=flanks.viscous,
        motion=np.concatenate(motion, axis=1),
        bearing_force=np.concatenate(force, axis=2),
        residual=residual,
    )


def _bearing_columns(at: Excited, omega: FloatArray, u: ComplexArray, rows: IntArray) -> ComplexArray:
    """Return the forces of bearings per input (b, 3 or 6, S, H, 1 + R) by motions u (S, H, n, 1 + R).

    An input on a row of a bearing is what its changed tangents exert on the body, so the ground feels it too.
    """
    speeds, harmonics, freedoms, inputs = u.shape
    by_input = np.moveaxis(u, 3, 2).reshape(speeds, harmonics * inputs, freedoms)
    force = bearing_forces(at, np.repeat(omega, inputs, axis=1), by_input)
    force = force.reshape(*force.shape[:2], speeds, harmonics, inputs)
    unit = np.zeros((at.system.arrays.elements.offset.size, rows.size))
    unit[rows, np.arange(rows.size)] = 1.0
    rest = np.zeros((rows.size, freedoms))
    static = at.system.bearing_force(np.zeros((len(unit), 1)), rest[:1], rest[:1])
    direct = at.system.bearing_force(unit, rest, rest) - static  # (b, 3 or 6, R)
    force[..., 1:] -= direct[:, :, None, None]
    return np.asarray(force)


def _content_key(at: Excited, speed: FloatArray, harmonics: IntArray, orders: int) -> str:
    """Return the hash of everything that decides the transfer functions."""
    system, linear, flanks = at.system, at.linear, excitation_of(at, harmonics)
    terms = gyroscopic_terms(system, speed) if at.turning else []
    loads = load_harmonics(system, at.period, speed, harmonics, at.time)
    matrices = linear.mass, linear.damping, linear.stiffness, linear.scale, system.arrays.direction
    bearings = at.at_rest.tangent, at.at_rest.viscous, *system.bearing_map[:4]
    key = speed, harmonics, loads, flanks.force, flanks.tangent, flanks.viscous
    names = VERSION, orders, at.time, at.period, linear.freedom, system.supports.name
    digest = hashlib.sha256(repr(names).encode())
    for array in (*matrices, *bearings, *key, *(part for term in terms for part in term)):
        values = np.ascontiguousarray(array)
        digest.update(f"{values.dtype.str} {values.shape}".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()
