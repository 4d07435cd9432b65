"""Whether a run stayed below the highest load of its mesh-force tables."""

from __future__ import annotations

import numpy as np

from dynamics.system.assemble import System
from dynamics.types import FloatArray, Json


class ForceChecks:
    """Gathers, block by block, how far driving flanks were pressed beyond the loads of their tables."""

    def __init__(self, system: System) -> None:
        self._meshes = system.scene.meshes
        self._samples = 0
        self._highest = np.array([float(mesh.table.level[-1]) for mesh in self._meshes])
        self._beyond = np.zeros(len(self._meshes), dtype=np.int64)
        self._largest = np.zeros(len(self._meshes))

    def see(self, force: FloatArray) -> None:
        """Take the mesh forces (m, T), N."""
        self._samples += force.shape[1]
        self._beyond += np.count_nonzero(force > self._highest[:, None], axis=1)
        self._largest = np.maximum(self._largest, np.max(force, axis=1, initial=0.0))

    def found(self) -> list[Json]:
        """Return one entry per mesh whose table is read between its loads.

        A table of two levels is a closed form and holds everywhere. ``beyond`` is the share of the samples
        above the highest load, where the table goes on straight, ``largest`` the largest force in N.
        """
        return [self._entry(i) for i, mesh in enumerate(self._meshes) if mesh.table.level.size > 2]

    def _entry(self, index: int) -> Json:
        """One mesh."""
        largest, highest = float(self._largest[index]), float(self._highest[index])
        reason = f"forces up to {largest:.4g} N of {highest:.4g} N in the table"
        if largest > highest:
            reason = f"{reason}: beyond it goes on straight. Compute the table to a higher load"
        return {
            "effect": "",
            "assumption": "force inside the table",
            "part": self._meshes[index].name,
            "holds": largest <= highest,
            "beyond": float(self._beyond[index] / max(self._samples, 1)),
            "largest": largest,
            "reason": reason,
        }
