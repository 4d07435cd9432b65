"""Checks that linear bearings stayed loaded: a real one has clearance and lets an unloaded shaft float."""

from __future__ import annotations

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.mechanism.additions import BEARING_LAWS
from dynamics.motion.sampled_states import States
from dynamics.results.checks import Check, SeriesBlock
from dynamics.types import FloatArray

LIGHT = 1e-3
"""Part of the largest bearing force at the start below which a bearing counts as unloaded from the start."""


class BearingLoadChecks:
    """Time, gathered block by block, for which radial forces pointed away from the static load."""

    def __init__(self, system: System) -> None:
        scene = system.scene
        laws = {law.bushing for law in scene.bearing_laws}
        self._effect = system.ledger.effect_adding(BEARING_LAWS)
        off = scene.effects.get(self._effect) == "off"
        self._name = system.supports.name
        # linear are the bearings without a law, and all where the effect that adds the laws is off
        self._watched = [i for i, name in enumerate(self._name) if off or name not in laws]
        self._has_law = [self._name[i] in laws for i in self._watched]
        self._direction: FloatArray | None = None
        self._samples = 0
        self._unloaded = np.zeros(len(self._watched), dtype=np.int64)

    def see(self, series: SeriesBlock, _states: States) -> None:
        """Count the samples of a block at which a bearing is unloaded."""
        force = series["bearing_force"]  # (0, 3, T) where it is not stored
        if force.shape[0] != len(self._name) or force.shape[2] == 0:
            return
        radial = force[self._watched, :2]
        if self._direction is None:  # unit vectors of the forces at the start, zero where a bearing is light
            size = np.linalg.norm(radial[:, :, 0], axis=1)
            carries = size > LIGHT * np.max(size, initial=0.0)
            unit = radial[:, :, 0] / np.where(carries, size, 1.0)[:, None]
            self._direction = np.where(carries[:, None], unit, 0.0)
        along = np.einsum("bct,bc->bt", radial, self._direction)
        loaded = np.any(self._direction != 0.0, axis=1)
        self._unloaded += np.where(loaded, np.count_nonzero(along <= 0.0, axis=1), 0)
        self._samples += force.shape[2]

    def checks(self) -> list[Check]:
        """Return one check per linear bearing that carries load at the start.

        ``unloaded`` is the share of the samples in which the force along the static load was not positive.
        """
        if self._direction is None:
            return []
        loaded = np.any(self._direction != 0.0, axis=1)
        return [self._check(row, index) for row, index in enumerate(self._watched) if loaded[row]]

    def _check(self, row: int, index: int) -> Check:
        share = float(self._unloaded[row] / max(self._samples, 1))
        reason = "the bearing stayed loaded"
        if share > 0.0:
            remedy = "enable the effect" if self._has_law[row] else "give the bearing its clearance"
            reason = f"the load reversed in {100.0 * share:.3g} % of the run: {remedy}"
        assumption, name = "linear bearing stays loaded", self._name[index]
        return Check(self._effect, assumption, name, share == 0.0, reason, {"unloaded": share})
