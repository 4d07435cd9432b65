"""Dynamic factor: what vibration makes of the static mesh force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import at_most
from dynamics.checks import integer, positive
from dynamics.errors import InputError
from dynamics.results.run_result import RunResult
from dynamics.types import FloatArray


@dataclass(frozen=True)
class DynamicFactor:
    """Mesh force over the nominal one, in B blocks along a run.

    Attributes
    ----------
    time, mesh_frequency : (B,) arrays
        Means of each block, s and Hz.
    largest, mean, least : (B,) arrays
        Of the driving flank's force in the block, over the nominal force. `largest` is K_v as ISO 6336-1
        defines it; `mean` differs from 1 by what accelerates the train.
    """

    time: FloatArray
    mesh_frequency: FloatArray
    largest: FloatArray
    mean: FloatArray
    least: FloatArray


def dynamic_factor(result: RunResult, pitches: int = 16, mesh: int = 0) -> DynamicFactor:
    """Return the dynamic factor of a mesh in blocks of `pitches` base pitches.

    Raises
    ------
    InputError
        If the run is shorter than one block, or nothing loads the mesh.
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
    force, least, largest = (
        series[mesh, : first[-1]] / nominal
        for series in (result.mesh_force, result.least_mesh_force, result.largest_mesh_force)
    )
    first = np.unique(first[:-1])
    samples = np.diff(np.append(first, force.size))

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(values[: force.size], first) / samples)

    return DynamicFactor(
        mean(result.time),
        mean(result.mesh_frequency[mesh]),
        np.maximum.reduceat(largest, first),
        mean(force),
        np.minimum.reduceat(least, first),
    )
