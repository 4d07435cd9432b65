"""Peaks and rms of forces over a run, and what its anti-alias filter took away."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.integrators.sample_ring import SampleRing
from dynamics.types import FloatArray, Json


@dataclass(frozen=True)
class SampleFigures:
    """Figures over the inner grid of a run: m meshes, c coast flanks, b supports, N.

    Attributes
    ----------
    mesh_peak, mesh_rms : (m,) arrays
        Largest magnitude and rms of the driving flanks' forces.
    coast_peak, coast_rms : (m,) arrays
        Of the coast flanks; zero where there is none.
    bearing_peak, bearing_rms : (b, 3 or 6) arrays
        Of forces (and moments, N m) in the frame of each support.
    removed, folded : (m,) arrays
        Rms of what the filter took away from the mesh force; of its content near half the inner rate, a
        bound on what may have folded into the output.
    """

    mesh_peak: FloatArray
    mesh_rms: FloatArray
    coast_peak: FloatArray
    coast_rms: FloatArray
    bearing_peak: FloatArray
    bearing_rms: FloatArray
    removed: FloatArray
    folded: FloatArray

    def to_json(self, system: System) -> Json:
        """Return peaks and rms by part, and the sampling error of the mesh forces."""
        meshes = [mesh.name for mesh in system.scene.meshes]
        coast = [meshes[mesh] for mesh in system.flanks.coast]
        stored = system.supports.name if system.scene.outputs.bearing_forces else ()
        return {
            "mesh_force": _by_part(meshes, self.mesh_peak, self.mesh_rms),
            "coast_force": {
                name: part
                for name, part in _by_part(meshes, self.coast_peak, self.coast_rms).items()
                if name in coast
            },
            "bearing_force": _by_part(stored, self.bearing_peak[:, :3], self.bearing_rms[:, :3]),
        }

    def error(self, system: System) -> Json:
        """Return the sampling error of the mesh forces, N rms."""
        names = (mesh.name for mesh in system.scene.meshes)
        return {
            "unit": "N",
            "source": "removed: above the pass band, not in the output; folded: bound on content above the "
            "inner grid, which the output may hold at a wrong frequency",
            "mesh_force": {
                name: {"removed": float(removed), "folded": float(folded)}
                for name, removed, folded in zip(names, self.removed, self.folded, strict=True)
            },
        }


def sample_figures(system: System, ring: SampleRing, points: int, samples: int) -> SampleFigures:
    """Read the figures off a ring after `points` of the inner grid and `samples` of the output."""
    rows, supports = ring.local.force.size, system.bearing_stiffness.shape[:2]
    largest, rms = ring.peaks.largest, np.sqrt(ring.peaks.square / max(points, 1))
    driving = system.driving_rows
    coast = np.zeros((2, driving.size))
    for element, mesh in enumerate(system.flanks.coast, start=driving.size):
        row = system.arrays.elements.first[element]
        coast[:, mesh] = largest[row], rms[row]
    removed, folded = (np.sqrt(part[driving] / max(samples, 1)) for part in (ring.removed, ring.folded))
    return SampleFigures(
        largest[driving],
        rms[driving],
        coast[0],
        coast[1],
        largest[rows:].reshape(supports),
        rms[rows:].reshape(supports),
        removed,
        folded,
    )


def _by_part(names: list[str] | tuple[str, ...], peak: FloatArray, rms: FloatArray) -> Json:
    """Peak and rms of each part."""
    return {
        name: {"peak": np.asarray(p).tolist(), "rms": np.asarray(r).tolist()}
        for name, p, r in zip(names, peak, rms, strict=False)
    }
