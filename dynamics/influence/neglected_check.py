"""Check that effects neglected for a tolerance were too small to be seen in the run without them."""

from __future__ import annotations

from typing import Any

import numpy as np

from bounds import engineering
from dynamics.influence.decide import Decided
from dynamics.influence.estimate import Influence
from dynamics.types import FloatArray, Json

ANY_PART = ""


class NeglectedChecks:
    """Gathers, block by block, what the estimates of neglected effects are compared with."""

    def __init__(self, decided: Decided) -> None:
        self._decided = decided
        meshes = len(decided.scene.meshes)
        self._low, self._high = np.full(meshes, np.inf), np.full(meshes, -np.inf)
        self._sum, self._samples, self._parted = np.zeros(meshes), 0, False

    def see(self, series: dict[str, Any]) -> None:
        """Take a block of series."""
        error: FloatArray = series["dynamic_transmission_error"]
        self._low = np.minimum(self._low, np.min(error, axis=1, initial=np.inf))
        self._high = np.maximum(self._high, np.max(error, axis=1, initial=-np.inf))
        self._sum = self._sum + np.sum(error, axis=1)
        self._samples += error.shape[1]
        self._parted = self._parted or bool(np.any(series["mesh_force"] <= 0.0))

    def found(self) -> list[Json]:
        """Return one entry per neglected effect.

        ``change`` is its estimate over the computed mean and peak-to-peak transmission error, and of bearing
        forces as estimated. Where flanks parted the linear theory of the estimate says nothing: it does not
        hold.
        """
        left = self._decided.neglected if self._samples else {}
        return [self._entry(name, influence) for name, influence in left.items()]

    def _entry(self, name: str, influence: Influence) -> Json:
        """One effect."""
        mean, ripple = np.abs(self._sum) / self._samples, self._high - self._low
        parts = [
            np.max(np.abs(influence.mean) / np.maximum(mean, 1e-300)),
            np.max(np.abs(influence.peak_to_peak) / np.maximum(ripple, 1e-300)),
        ]
        change = max(*(float(part) for part in parts), influence.relative_bearing_force)
        reason = (
            f"estimated at {engineering(100.0 * change, 2)} % "
            "of the computed mean, peak-to-peak or bearing force"
        )
        if self._parted:
            reason = "flanks lifted off: the linear theory that neglected it is invalid"
        return {
            "effect": name,
            "assumption": "neglected effects are negligible",
            "part": ANY_PART,
            "holds": not self._parted and change <= (self._decided.scene.tolerance or 0.0),
            "change": change,
            "reason": reason,
        }
