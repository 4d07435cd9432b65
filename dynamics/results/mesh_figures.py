"""Figures of meshes from a run: contact state, dynamic factor, load sharing of planets."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from bounds import at_most
from dynamics.checks import integer, positive
from dynamics.errors import InputError
from dynamics.results.run_result import RunResult
from dynamics.types import FloatArray

AXIS_AGREEMENT = 1e-9  # m


class ContactState(IntEnum):
    """The flanks of a mesh that carry."""

    OFF = 0
    DRIVING = 1
    COAST = 2
    BOTH = 3


def contact_shares(result: RunResult) -> list[dict[str, float]]:
    """Return per mesh the share of the samples in each state, by its name in lower case."""
    return [
        {state.name.lower(): float(np.mean(row == state)) for state in ContactState} for row in result.contact
    ]


@dataclass(frozen=True)
class _DynamicFactor:
    """Mesh force over the nominal one, in B blocks along a run."""

    time: FloatArray
    mesh_frequency: FloatArray
    """`time`, `mesh_frequency`: Means of each block, s and Hz. Shape (B,) each."""
    largest: FloatArray
    mean: FloatArray
    minimum: FloatArray
    """`largest`, `mean`, `minimum`: Largest, mean and least force of the driving flank in the block, over the
    nominal force. `largest` is K_v as ISO 6336-1 defines it; `mean` differs from 1 by the acceleration of the
    train. Shape (B,) each.
    """


def dynamic_factor(result: RunResult, pitches: int = 16, mesh: int = 0) -> _DynamicFactor:
    """Return the dynamic factor of a mesh in blocks of `pitches` base pitches.

    Raises `InputError`: the run is shorter than one block, or nothing loads the mesh.
    """
    integer("pitches", pitches, 1, 1_000_000)
    integer("mesh", mesh, 0, len(result.mesh) - 1)
    positive("nominal_force", float(result.nominal_force[mesh]), "An idle mesh has no dynamic factor.")
    travel = np.abs(np.unwrap(result.position[mesh], period=1.0) - result.position[mesh][0])
    block = np.floor(travel * (1.0 + 1e-12) / pitches).astype(int)
    first = np.searchsorted(block, np.arange(block[-1] + 1))
    if first.size < 2:
        raise InputError("pitches", pitches, at_most(int(travel[-1]), note=", the run's length"))
    nominal = result.nominal_force[mesh]
    force, minimum, largest = (
        series[mesh, : first[-1]] / nominal
        for series in (result.mesh_force, result.least_mesh_force, result.largest_mesh_force)
    )
    first = np.unique(first[:-1])  # a block without samples has the first sample of the next one
    samples = np.diff(np.append(first, force.size))

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(values[: force.size], first) / samples)

    return _DynamicFactor(
        mean(result.time),
        mean(result.mesh_frequency[mesh]),
        np.maximum.reduceat(largest, first),
        mean(force),
        np.minimum.reduceat(minimum, first),
    )


@dataclass(frozen=True)
class PlanetLoadSharing:
    """Shares of the N planets that mesh with one central gear."""

    central: str
    """Name of the sun's or the ring's gear."""
    mesh: tuple[str, ...]
    """Names of the N meshes of the central gear."""
    ratio: FloatArray
    """Load share N F_p / sum of all F_p: 1 where all meshes carry the same, the sum is N; NaN where none
    carries. Shape (N, T).
    """
    mean: FloatArray
    """Load share by the forces' means over the run. Shape (N,)."""

    @property
    def mesh_load_factor(self) -> float:
        """The largest of the means: K_gamma of ISO 6336-1."""
        return float(self.mean.max())


def planet_load_sharing(result: RunResult) -> tuple[PlanetLoadSharing, ...]:
    """Return the load sharing at every central gear with two or more planets; empty if there is none."""
    planets = _planet_shafts(result)
    shaft = {gear["name"]: gear["shaft"] for gear in result.case["gears"]}
    groups: dict[str, list[int]] = {}
    for index, mesh in enumerate(result.case["meshes"]):
        central = [name for name in (mesh["driver"], mesh["driven"]) if shaft[name] not in planets]
        if len(central) == 1:
            groups.setdefault(central[0], []).append(index)
    return tuple(_sharing(result, name, rows) for name, rows in groups.items() if len(rows) > 1)


def _sharing(result: RunResult, central: str, rows: list[int]) -> PlanetLoadSharing:
    force = result.mesh_force[rows] - (result.coast_force[rows] if result.coast_force.size else 0.0)
    total, mean = force.sum(axis=0), force.mean(axis=1)
    ratio = np.full(force.shape, np.nan)
    np.divide(len(rows) * force, total, out=ratio, where=total != 0.0)
    names = tuple(result.mesh[row] for row in rows)
    return PlanetLoadSharing(central, names, ratio, len(rows) * mean / mean.sum())


def _planet_shafts(result: RunResult) -> set[str]:
    """Names of the shafts that lie off the axis of the carrier they turn with."""
    shafts = {shaft["name"]: shaft for shaft in result.case["shafts"]}
    return {
        name
        for name, shaft in shafts.items()
        if (frame := shaft.get("frame")) is not None
        and math.dist(shaft["origin"][:2], shafts[frame]["origin"][:2]) > AXIS_AGREEMENT
    }
