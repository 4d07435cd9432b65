"""Harmonics of all meshes of a run, counted by the frequency of one of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError
from dynamics.results import RunResult
from dynamics.results.order_fit import unwrapped
from dynamics.types import BoolArray, FloatArray, IntArray

SAME = 1e-6
"""Orders closer than this are one: frequencies of meshes in a train are ratios of teeth."""


@dataclass(frozen=True)
class MeshHarmonics:
    """Harmonics of meshes, in rising order; one that several meshes share is that of the first of them.

    Attributes
    ----------
    order : (H,) array
        Multiples of the frequency of the mesh that counts.
    mesh : (H,) int array
        Whose harmonic each is.
    multiple : (H,) int array
        Of the frequency of that mesh.
    """

    order: FloatArray
    mesh: IntArray
    multiple: IntArray

    @property
    def closest(self) -> float:
        """Smallest distance of two orders, or of the first from the mean."""
        return float(np.min(np.diff(self.order, prepend=0.0)))

    def cycles(self, result: RunResult) -> FloatArray:
        """Return how often each has repeated since the start of the run, (H, T).

        They rise, whichever way a mesh turns; where it reverses for a while they fall.
        """
        turned = unwrapped(result.position)
        turned = (turned - turned[:, :1]) * np.where(turned[:, -1:] < turned[:, :1], -1.0, 1.0)
        return np.asarray(self.multiple[:, None] * turned[self.mesh])


def counting_mesh(result: RunResult) -> int:
    """Return the first mesh that turns.

    Raises
    ------
    InputError
        There is none.
    """
    turning: BoolArray = np.any(result.mesh_frequency > 0.0, axis=-1)
    if not np.any(turning):
        raise InputError("mesh_frequency", 0.0, "a run with a mesh that turns")
    return int(np.argmax(turning))


def mesh_harmonics(result: RunResult, highest: int) -> MeshHarmonics:
    """Return the harmonics of all meshes that turn up to order `highest` of the `counting_mesh`.

    Raises
    ------
    InputError
        No mesh turns.
    """
    mean = result.mesh_frequency.mean(axis=-1)
    ratio = mean / mean[counting_mesh(result)]
    rows = [
        (multiple * ratio[mesh], mesh, multiple)
        for mesh in np.flatnonzero(ratio > 0.0)
        for multiple in range(1, int(highest / ratio[mesh] * (1.0 + SAME)) + 1)
    ]
    rows.sort(key=lambda row: row[0])
    kept = rows[:1]
    for row in rows[1:]:
        if row[0] - kept[-1][0] > SAME * row[0]:
            kept.append(row)
    order, mesh, multiple = (np.array(column) for column in zip(*kept, strict=True))
    return MeshHarmonics(order, mesh, multiple)
