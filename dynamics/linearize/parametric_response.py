"""Forced response with a mesh stiffness that varies along the pitch: harmonic balance of Hill's equation."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.errors import SolveError
from dynamics.linearize.harmonic_response import HarmonicResponse, extremes, response_of
from dynamics.linearize.load_harmonics import load_multiples
from dynamics.linearize.steady_vibration import ComplexArray, Excited, Steady, swept_vibration
from dynamics.types import FloatArray, IntArray

MOST_UNKNOWNS = 150
LEAST_ORDERS = 8


@dataclass(frozen=True)
class ParametricResponse:
    """Steady vibration in which flanks have the stiffness of the position they are at; m meshes, S speeds.

    Attributes
    ----------
    harmonics : HarmonicResponse
    mean_shift : (m, S) array
        By how much the mean transmission error differs from the mean static one, m.
    """

    harmonics: HarmonicResponse
    mean_shift: FloatArray


@dataclass(frozen=True)
class Family:
    """Meshes that pass equally many base pitches in the common period, on tables of one pitch.

    Attributes
    ----------
    meshes : (f,) int array
    harmonic : (H,) int array
        Of the harmonics 1 to H of the mesh frequency among those of the vibration.
    stiffness : (f, 4 H + 1) complex array
        Fourier coefficients -2 H to 2 H of the tangent stiffness less its mean, N/m.
    """

    meshes: IntArray
    harmonic: IntArray
    stiffness: ComplexArray


def parametric_response(
    at: Excited, speed: FloatArray, rate: FloatArray, orders: int = 10, gyroscopic: bool = False
) -> ParametricResponse:
    """Return the response of a system to its errors and loads, the stiffness varying with position.

    M u'' + C u' + (K + sum k(t) g^T g) u = sum k(t) g STE(t). With k = k_0 + dk(t) and the receptances A of
    the system of mean stiffness, what makes force, w = g u - STE, is sought in the harmonics -H to H of the
    mesh frequency:

        w_i + A_i sum_j dk_(i-j) w_j = (response of the mean stiffness)_i - STE_i.

    Left out: what the varying stiffness of one mesh makes of vibration at another one's frequency, flanks
    that part, how stiffness varies with load. Tables of several pitches keep their mean stiffness.

    Parameters
    ----------
    at : Excited
    speed, rate : (S,) arrays
        Of the leading law, rad/s, and how fast it changes, rad/s^2.
    orders : int
        H; fewer where many meshes share a frequency.
    gyroscopic : bool
        With gyroscopic and frame terms.
    """
    harmonics, meshes = _all_harmonics(at, orders, float(np.max(np.abs(speed)))), len(at.cycles)
    steady = swept_vibration(at, speed, rate, harmonics, gyroscopic)
    u, extra = steady.displacement.copy(), np.zeros((meshes, *steady.omega.shape), dtype=complex)
    shift = np.zeros((meshes, speed.size))
    row = at.system.arrays.direction[at.system.driving_rows]
    still = _at_rest(at, row)
    for family in _families(at, harmonics, orders):
        first = np.broadcast_to(still, (speed.size, 1, *still.shape))
        moved = np.concatenate([first, steady.receptance[:, family.harmonic]], axis=1)[..., family.meshes]
        push = _push(family, row[family.meshes] @ moved, _made(family, row, steady))
        u[:, family.harmonic] -= 2.0 * np.einsum("shnf,shf->shn", moved[:, 1:], push[:, 1:])
        own = np.ix_(family.meshes, np.arange(speed.size), family.harmonic)
        extra[own] += 2.0 * np.moveaxis(push[:, 1:], 2, 0)
        shift -= row @ np.real(np.einsum("snf,sf->ns", moved[:, 0], push[:, 0]))
    response = response_of(at, speed, replace(steady, displacement=u))
    force = response.mesh_force + extra
    least = response.mean_force[:, None] + extremes(force, response.order)[0]
    return ParametricResponse(replace(response, mesh_force=force, least_mesh_force=least), shift)


def _all_harmonics(at: Excited, orders: int, speed: float) -> IntArray:
    """Return the multiples of the common period's frequency at which meshes (to `orders`) or loads excite."""
    multiples = set(load_multiples(at.system, at.period, speed, at.time).tolist())
    for pitches, mesh in zip(at.period.pitches, at.system.scene.meshes, strict=True):
        period = mesh.table.period
        step = abs(pitches) // period
        multiples |= {step * k for k in range(1, orders * period + 1)} if step else set()
    return np.array(sorted(multiples), dtype=np.int64)


def _families(at: Excited, harmonics: IntArray, orders: int) -> list[Family]:
    """Gather the meshes whose stiffness varies, by their frequency."""
    by_pitches: dict[int, list[int]] = {}
    for index, (pitches, mesh) in enumerate(zip(at.period.pitches, at.system.scene.meshes, strict=True)):
        if pitches and mesh.table.period == 1:
            by_pitches.setdefault(abs(pitches), []).append(index)
    families = []
    for pitches, meshes in by_pitches.items():
        count = min(orders, max(LEAST_ORDERS, MOST_UNKNOWNS // (2 * len(meshes))))
        harmonic = np.searchsorted(harmonics, pitches * np.arange(1, count + 1))
        stiffness = np.array([_coefficients(at, mesh, 2 * count) for mesh in meshes])
        families.append(Family(np.array(meshes), harmonic, stiffness))
    return families


def _coefficients(at: Excited, mesh: int, highest: int) -> ComplexArray:
    """Fourier coefficients (2 highest + 1,) over time of a mesh's tangent stiffness, its mean left out."""
    values = at.cycles[mesh].stiffness
    lines = np.fft.rfft(values) / values.size
    count = min(highest, lines.size - 2)
    coefficients = np.zeros(2 * highest + 1, dtype=complex)
    order = np.arange(1, count + 1)
    turned = lines[order] * np.exp(2j * np.pi * order * at.system.scene.meshes[mesh].position_offset)
    turned = turned if at.period.pitches[mesh] > 0 else turned.conj()
    coefficients[highest + order], coefficients[highest - order] = turned, turned.conj()
    return coefficients


def _made(family: Family, row: FloatArray, steady: Steady) -> ComplexArray:
    """Fourier coefficients 1 to H (S, H, f) of what makes force with the mean stiffness, m."""
    response = steady.displacement[:, family.harmonic] @ row[family.meshes].T
    return np.asarray(0.5 * (response - steady.static[family.meshes][:, family.harmonic].T))


def _push(family: Family, receptance: ComplexArray, made: ComplexArray) -> ComplexArray:
    """Solve the balance at S speeds.

    Parameters
    ----------
    family : Family
    receptance : (S, H + 1, f, f) complex array
        Of the meshes, harmonics 0 to H, m/N.
    made : (S, H, f) complex array

    Returns
    -------
    (S, H + 1, f) complex array
        Fourier coefficients 0 to H of the force by which the varying part of the stiffness presses, N.
    """
    speeds, count, meshes = made.shape
    whole = np.concatenate([receptance[:, :0:-1].conj(), receptance], axis=1)
    forcing = np.concatenate([made[:, ::-1].conj(), np.zeros((speeds, 1, meshes)), made], axis=1)
    step = np.arange(2 * count + 1)
    varying = family.stiffness[:, step[:, None] - step[None, :] + 2 * count]  # (f, 2 H + 1, 2 H + 1)
    size = step.size * meshes
    matrix = np.einsum("siab,bij->siajb", whole, varying).reshape(speeds, size, size)
    matrix += np.eye(size)
    w = np.linalg.solve(matrix, forcing.reshape(speeds, size, 1)).reshape(forcing.shape)
    return np.asarray(np.einsum("bij,sjb->sib", varying[:, count:], w))


def _at_rest(at: Excited, row: FloatArray) -> ComplexArray:
    """Displacements (n, f) per static force along rows (f, n); `SolveError` where a motion is free."""
    per_meter = 1.0 / at.linear.scale
    held = per_meter[:, None] * at.linear.stiffness * per_meter
    try:
        moved = np.linalg.solve(held, (row * per_meter).T)
    except np.linalg.LinAlgError as error:
        raise SolveError("nothing holds the system at its static equilibrium") from error
    return np.asarray(moved * per_meter[:, None], dtype=complex)
