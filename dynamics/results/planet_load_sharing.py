"""Load sharing of planets: how much each carries, against an equal share."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.results.run_result import RunResult
from dynamics.types import FloatArray

AXIS_AGREEMENT = 1e-9  # m


@dataclass(frozen=True)
class PlanetLoadSharing:
    """Shares of the N planets that mesh with one central gear.

    Attributes
    ----------
    central : str
        Name of the sun's or the ring's gear.
    mesh : tuple of str
        Names of its N meshes.
    ratio : (N, T) array
        N F_p / sum of all F_p: 1 where all carry the same, sums to N; NaN where none carries.
    mean : (N,) array
        The same of the forces' means over the run.
    """

    central: str
    mesh: tuple[str, ...]
    ratio: FloatArray
    mean: FloatArray

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
    names = set()
    for name, shaft in shafts.items():
        frame = shaft.get("frame")
        if frame is not None and math.dist(shaft["origin"][:2], shafts[frame]["origin"][:2]) > AXIS_AGREEMENT:
            names.add(name)
    return names
