"""Vibration with a mesh stiffness that varies with position: harmonic balance of Hill's equation.

The tangent of a flank is the derivative of its forces in its coordinates. Its mean over the positions belongs
to the linear system; the rest multiplies the vibration and couples its harmonics.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dynamics.errors import SolveError
from dynamics.linearize.flank_cycles import FlankCycle
from dynamics.linearize.modal_elimination import ROUNDING, solved
from dynamics.linearize.natural_modes import unbounded
from dynamics.linearize.steady_vibration import (
    ROUNDED,
    Excited,
    Steady,
    harmonics_of,
    speed_blocks,
    with_blocked,
)
from dynamics.types import BoolArray, ComplexArray, FloatArray, IntArray
from host.optional_modules import fft, sparse_linalg

CONVERGED = 1e-9
"""Residual of the balance, over the displacements that make force with the mean stiffness."""
RESTART, CYCLES = 60, 10
"""Iterations of GMRES before a restart, and most restarts."""
DIRECT = 300
"""Unknowns up to which the balance is solved by a factorization a speed, all speeds together.

One flank in 24 orders has 49: 0.1 ms a speed in place of 2; six flanks of 294 take as long either way."""


def varied(at: Excited, steady: Steady) -> tuple[Steady, FloatArray]:
    """Return a vibration with the tangents of its flanks varying with position, and the mean's shift.

    M u'' + C u' + (K + sum G^T K(t) G) u = sum G^T (K(t) x_s(t) - f), K(t) = K_0 + K_1(t), f the other forces
    of a flank. With the receptances A of the system of mean tangents, what makes force, w = G u - x_s, is
    sought in the harmonics H of the vibration and their mean:

        w + A K_1 w = w_0,   w_0 that of the mean tangents.

    Left out: what the varying stiffness of one mesh makes of vibration between its own lines, flanks that
    part, how stiffness varies with load.

    Parameters
    ----------
    steady : Steady
        Vibration with mean tangents; its receptances belong to all rows of the driving flanks.

    Returns
    -------
    Steady
        Vibration whose `force` includes that of the varying tangents; bit-equal where none vary.
    (m, S) array
        Mean transmission errors less the mean static ones, m.

    Raises
    ------
    SolveError
        If nothing bounds the motion, or nothing holds the system at rest.
    """
    speeds, rows = len(steady.omega), steady.force.shape[1]
    shift = np.zeros((len(at.cycles), speeds))
    direction = at.system.arrays.direction[:rows]
    still = direction @ still_motion(at, direction)
    varying = VaryingStiffness.of(at, steady.harmonics, still)
    if not varying.parts:
        return steady, shift
    first = [cycle.rows.start for cycle in at.cycles]
    u, force = steady.displacement.copy(), np.repeat(steady.force, speeds // len(steady.force), axis=0)
    made = u @ direction.T
    made[..., first] -= steady.static.T
    push, left = varying.push(direction @ steady.receptance, made)
    if not np.all(left <= ROUNDED):
        raise unbounded(at.linear, steady.omega[~(left <= ROUNDED)][:1])
    u -= np.matmul(steady.receptance, push[:, 1:, :, None])[..., 0]
    force -= np.moveaxis(push[:, 1:], 1, 2)
    shift[:] = -(push[:, 0].real @ still.T)[:, first].T
    residual = max(steady.residual, float(np.max(left, initial=0.0)))
    return replace(steady, displacement=u, force=force, residual=residual), shift


def varied_vibration(
    at: Excited, speed: FloatArray, harmonics: IntArray, progress: Callable[[float], None] | None = None
) -> tuple[Steady, FloatArray, FloatArray]:
    """Return the vibration at `speed` (S,) in `harmonics` (H,) with tangents that vary.

    Two measures of the excitations follow it: the largest transmission errors over the speeds with mean
    tangents, excited by static errors and by blocked forces, (m, H) each, m.
    """
    rows = at.system.arrays.direction[: at.cycles[-1].rows.stop if at.cycles else 0]
    watched = at.system.arrays.direction[at.system.driving_rows]
    largest = np.zeros((2, len(watched), harmonics.size))
    blocks: list[Steady] = []
    for part in speed_blocks((speed.size, harmonics.size), (1 + len(rows)) * rows.shape[1]):
        mean, blocked = with_blocked(at, speed[part], harmonics, rows)
        static = np.max(np.abs(mean.displacement @ watched.T), axis=0, initial=0.0).T
        largest = np.maximum(largest, np.stack([static, blocked]))
        blocks.append(replace(varied(at, mean)[0], receptance=mean.receptance[:0]))
        if progress is not None:
            progress(min(part.stop, speed.size) / speed.size)
    forces = [block.force for block in blocks]
    steady = replace(
        blocks[0],
        omega=np.concatenate([block.omega for block in blocks]),
        force=np.concatenate(forces) if sum(map(len, forces)) == speed.size else forces[0],
        displacement=np.concatenate([block.displacement for block in blocks]),
        residual=max(block.residual for block in blocks),
    )
    return steady, largest[0], largest[1]


@dataclass(frozen=True)
class _Varying:
    """A flank of p rows whose tangents vary, in the Q lines of its table among those of the vibration."""

    rows: slice
    line_index: IntArray
    """Indices of the table's lines among the mean and the harmonics of the vibration. Shape (Q + 1,)."""
    line: IntArray
    """Multiples of the table's own frequency, 0 first. Shape (Q + 1,)."""
    tangent: FloatArray
    """Tangents less their mean, over the table's period in time, N/m. Shape (N, p, p)."""

    def pressed(self, coordinates: ComplexArray) -> ComplexArray:
        """Return the Fourier coefficients (Q + 1, p) of the forces by those of the coordinates."""
        samples = len(self.tangent)
        spectrum = np.zeros((samples // 2 + 1, coordinates.shape[1]), dtype=complex)
        spectrum[self.line] = coordinates
        wave = np.fft.irfft(spectrum, samples, axis=0)
        force = np.einsum("tij,tj->ti", self.tangent, wave)
        return np.asarray(np.fft.rfft(force, axis=0)[self.line])


@dataclass(frozen=True)
class VaryingStiffness:
    """The tangents of flanks about an equilibrium less their means, in H harmonics."""

    parts: tuple[_Varying, ...]
    """Flanks whose tangents vary."""
    still: FloatArray
    """Static receptance of the rows of all driving flanks, m/N. Shape (R', R')."""

    @classmethod
    def of(cls, at: Excited, harmonics: IntArray, still: FloatArray) -> VaryingStiffness:
        """Gather the flanks `at` their equilibrium whose tangents vary."""
        flanks = range(len(at.cycles))
        return cls(tuple(part for index in flanks for part in _varying(at, index, harmonics)), still)

    def push(self, receptance: ComplexArray, source: ComplexArray) -> tuple[ComplexArray, FloatArray]:
        """Return the forces by the varying tangents (S, H + 1, R'), N, and the relative residuals (S,) left.

        The first of the forces is the mean, the others are amplitudes. `receptance` (S, H, R', R') are those
        of the rows, m/N. `source` (S, H, R') are amplitudes of the coordinates that press with the mean
        tangents, m.
        """
        speeds, harmonics, rows = source.shape
        push, left = np.zeros((speeds, harmonics + 1, rows), dtype=complex), np.zeros(speeds)
        balance = DirectBalance.of(self.parts, harmonics + 1, rows)
        for part in speed_blocks((speeds, harmonics + 1), rows * max(rows, balance.size)):
            mean = np.broadcast_to(self.still, (len(receptance[part]), 1, rows, rows))
            receptances = np.concatenate([mean, receptance[part]], axis=1)
            sources = np.concatenate([np.zeros_like(source[part, :1]), 0.5 * source[part]], axis=1)
            if balance.size <= DIRECT:
                push[part], left[part] = balance.solve(receptances, sources)
                continue
            pairs = [_solved(self.parts, *speed) for speed in zip(receptances, sources, strict=True)]
            push[part] = [force for force, _ in pairs]
            left[part] = [residual for _, residual in pairs]
        push[:, 1:] *= 2.0
        return push, left


@dataclass(frozen=True)
class DirectBalance:
    """The balance as a real matrix of the N coordinates that move varying tangents, for all speeds together.

    The unknowns of a flank are the real parts 0 to Q, then the imaginary parts 1 to Q, of the coordinates
    that its tangents depend on.
    """

    pressing: ComplexArray
    """Fourier coefficients of the forces by the unknowns, N/m. Shape (H + 1, R', N)."""
    harmonic: IntArray
    row: IntArray
    imaginary: BoolArray
    """`harmonic`, `row`, `imaginary`: Coefficient of the motion that an unknown is: its harmonic
    (0 the mean), its row, and whether it is the imaginary part. Shape (N,) each.
    """

    @property
    def size(self) -> int:
        """Number N of unknowns."""
        return self.harmonic.size

    @classmethod
    def of(cls, parts: tuple[_Varying, ...], harmonics: int, rows: int) -> DirectBalance:
        """Lay out the unknowns of `parts` among `harmonics`, the mean included, and `rows`."""
        columns = [column for part in parts for column in _unknowns(part)]
        harmonic, row, imaginary = (np.array(side) for side in zip(*columns, strict=True))
        if harmonic.size > DIRECT:
            return cls(np.zeros((0, 0, 0), dtype=complex), harmonic, row, imaginary)
        pressing = np.zeros((harmonics, rows, harmonic.size), dtype=complex)
        first = 0
        for part in parts:
            part_pressing = _pressing(part)
            end = first + part_pressing.shape[2]
            pressing[part.line_index, part.rows, first:end] = part_pressing
            first = end
        return cls(pressing, harmonic, row, imaginary)

    def solve(self, receptance: ComplexArray, source: ComplexArray) -> tuple[ComplexArray, FloatArray]:
        """Return the Fourier coefficients of the forces (S, H + 1, R') and the relative residuals (S,).

        `receptance` (S, H + 1, R', R') are receptances of the rows, and `source` (S, H + 1, R') coefficients
        of the coordinates that press with the mean tangents.
        """
        row_receptance = receptance[:, self.harmonic, self.row, None]
        answer = np.matmul(row_receptance, self.pressing[self.harmonic])[..., 0, :]
        matrix = np.where(self.imaginary[:, None], answer.imag, answer.real) + np.eye(self.size)
        sources = source[:, self.harmonic, self.row]
        right = np.where(self.imaginary, sources.imag, sources.real)
        unknown = solved(matrix, right[..., None])
        residuals = np.linalg.norm((matrix @ unknown)[..., 0] - right, axis=1)
        size = np.sqrt(np.sum(np.abs(source) ** 2, axis=(1, 2)))
        return np.tensordot(unknown[..., 0], self.pressing, (1, 2)), residuals / np.maximum(size, 1e-300)


def _felt(part: _Varying) -> IntArray:
    """Return the coordinates of a flank on which its varying tangents depend."""
    return np.flatnonzero(np.any(part.tangent != 0.0, axis=(0, 1)))


def _unknowns(part: _Varying) -> list[tuple[int, int, bool]]:
    """Return the harmonic and the row of every unknown of a flank, and whether it is an imaginary part."""
    lines = part.line_index.tolist()
    rows = (part.rows.start + _felt(part)).tolist()
    return [
        (harmonic, row, imaginary)
        for row in rows
        for imaginary in (False, True)
        for harmonic in lines[int(imaginary) :]
    ]


def _pressing(part: _Varying) -> ComplexArray:
    """Return the Fourier coefficients (Q + 1, p, unknowns) of the forces of a flank by its unknowns.

    A product of waves: the line l of T w is the sum over l' of T_(l - l') w_l' + T_(l + l') conj(w_l').
    """
    lines = part.line
    spectrum = np.fft.rfft(part.tangent, axis=0) / len(part.tangent)
    differences = lines[:, None] - lines
    falling = np.where(differences[..., None, None] < 0, spectrum[-differences].conj(), spectrum[differences])
    rising = spectrum[lines[:, None] + lines]
    real, imaginary = falling + rising, 1j * (falling - rising)[:, 1:]
    real[:, 0] = falling[:, 0]  # the mean has no conjugate line
    by_column = [
        np.moveaxis(block[..., column], 1, 2) for column in _felt(part) for block in (real, imaginary)
    ]
    return np.concatenate(by_column, axis=2)


def _varying(at: Excited, index: int, harmonics: IntArray) -> list[_Varying]:
    """Return the flank of a mesh; nothing where its tangents do not vary or it does not turn."""
    cycle, period = at.cycles[index], at.system.scene.meshes[index].table.period
    turns = abs(at.period.pitches[index]) // period
    if not turns or _alike(cycle):
        return []
    coupled = np.flatnonzero(harmonics % turns == 0)
    if not coupled.size:
        return []
    line = harmonics[coupled] // turns
    highest = 2 * int(line[-1])
    samples = fft.next_fast_len(2 * highest + 2, real=True)
    p = cycle.tangent.shape[0]
    spectrum, multiples = np.zeros((samples // 2 + 1, p, p), dtype=complex), np.arange(1, highest + 1)
    for i, j in np.ndindex(p, p):
        values = cycle.tangents[:, i, j]
        spectrum[1 : highest + 1, i, j] = 0.5 * harmonics_of(at, index, values, turns * multiples)
    tangent = np.fft.irfft(spectrum, samples, axis=0) * samples
    return [_Varying(cycle.rows, np.append(0, coupled + 1), np.append(0, line), tangent)]


def _alike(cycle: FlankCycle) -> bool:
    """Return whether the tangents are the same at all positions."""
    maximum = np.max(np.abs(cycle.tangents - cycle.tangent))
    return bool(maximum <= ROUNDING * np.max(np.abs(cycle.tangent)))


def _solved(
    parts: tuple[_Varying, ...], receptance: ComplexArray, source: ComplexArray
) -> tuple[ComplexArray, float]:
    """Return the forces of the balance at one speed, and its relative residual.

    Parameters
    ----------
    receptance : (H + 1, R', R') complex array
        Receptances of the rows, of the mean and the harmonics, m/N.
    source : (H + 1, R') complex array
        Fourier coefficients of the coordinates that press with the mean tangents, m.

    Returns
    -------
    (H + 1, R') complex array
        Fourier coefficients of the forces by which the varying part of the tangents presses, N.
    """
    harmonics, rows = source.shape

    def pressed(w: ComplexArray) -> ComplexArray:
        force = np.zeros_like(w)
        for part in parts:
            force[part.line_index, part.rows] = part.pressed(w[part.line_index, part.rows])
        return force

    def balance(real: FloatArray) -> FloatArray:
        w = _complex(real, harmonics, rows)
        return real + _real(np.matmul(receptance, pressed(w)[..., None])[..., 0])

    right = _real(source)
    size = float(np.linalg.norm(right))
    operator = sparse_linalg.LinearOperator((right.size, right.size), matvec=balance, dtype=float)
    solution, _ = sparse_linalg.gmres(
        operator, right, x0=right, rtol=CONVERGED, restart=RESTART, maxiter=CYCLES
    )
    left = float(np.linalg.norm(right - balance(solution)))
    return pressed(_complex(solution, harmonics, rows)), left / max(size, 1e-300)


def _real(harmonics: ComplexArray) -> FloatArray:
    """Return the real parts 0 to H, then the imaginary parts 1 to H, of (H + 1, R'): w_-j is conjugate."""
    return np.concatenate([harmonics.real.ravel(), harmonics[1:].imag.ravel()])


def _complex(real: FloatArray, count: int, rows: int) -> ComplexArray:
    """Return the Fourier coefficients (count, R') of the real vector that `_real` returns."""
    harmonics = real[: count * rows].reshape(count, rows).astype(complex)
    harmonics[1:] += 1j * real[count * rows :].reshape(count - 1, rows)
    return harmonics


def still_motion(at: Excited, rows: FloatArray) -> FloatArray:
    """Displacements (n, f) per static force along rows (f, n); `SolveError` where a motion is free."""
    per_meter = 1.0 / at.linear.scale
    stiffness = per_meter[:, None] * at.linear.stiffness * per_meter
    try:
        displacement = np.linalg.solve(stiffness, (rows * per_meter).T)
    except np.linalg.LinAlgError as error:
        raise SolveError("nothing holds the system at its static equilibrium") from error
    return np.asarray(displacement * per_meter[:, None])
