"""Checks of a run on contact: flanks that parted without a coast flank."""

from __future__ import annotations

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.mechanism.additions import COAST_FLANKS
from dynamics.motion.observation import static_deflections
from dynamics.motion.sampled_states import States
from dynamics.results.checks import Check, SeriesBlock


class ContactChecks:
    """Gap, gathered block by block, by which driving flanks of meshes without backlash parted."""

    def __init__(self, system: System) -> None:
        meshes = system.scene.meshes
        self._system, self._samples = system, 0
        self._watched = [
            i for i, mesh in enumerate(meshes) if not system.ledger.adds(COAST_FLANKS, mesh.name)
        ]
        self._parted = np.zeros(len(meshes), dtype=np.int64)
        self._gap = np.zeros(len(meshes))
        self._first = np.full(len(meshes), -1, dtype=np.int64)

    def see(self, series: SeriesBlock, _states: States) -> None:
        """Count the samples of a block at which flanks have parted."""
        position, deflection = series["position"], series["dynamic_transmission_error"]
        force, minimum = series["mesh_force"], series["least_mesh_force"]
        before = self._samples
        self._samples += position.shape[1]
        for index in self._watched:
            parted = minimum[index] <= 0.0
            if self._first[index] < 0 and np.any(parted):
                self._first[index] = before + int(np.argmax(parted))
            touch = np.empty(position.shape[1])
            table = self._system.arrays.elements.laws.flank.table
            static_deflections(table, index, position[index], 0.0, touch)
            self._parted[index] += np.count_nonzero(force[index] <= 0.0)
            gap = float(np.max((touch - deflection[index])[parted], initial=0.0))
            self._gap[index] = max(self._gap[index], gap)

    def checks(self) -> list[Check]:
        """Return one check per mesh that ran without backlash.

        ``parted`` is the share of the samples out of contact, ``widest_gap`` in m how far flanks were apart
        along the line of action, ``holds`` whether leaving the coast flank out changed nothing: none parted,
        or the gap stayed below a backlash that is given. ``since`` is the time of the last sample before they
        parted first, s, up to which the result holds; None if they never parted, or from the start.
        """
        return [self._check(index) for index in self._watched]

    def _check(self, index: int) -> Check:
        mesh, gap = self._system.scene.meshes[index], float(self._gap[index])
        first = int(self._first[index])
        backlash = mesh.coast.backlash if mesh.coast is not None else 0.0
        return Check(
            self._system.ledger.effect_adding(COAST_FLANKS),
            "coast flanks are not reached",
            mesh.name,
            bool(gap <= backlash),
            _contact_text(gap, mesh.coast is not None, backlash),
            {
                "parted": float(self._parted[index] / max(self._samples, 1)),
                "widest_gap": gap,
                "since": (first - 1) / self._system.sampling.rate if first > 0 else None,
            },
        )


def _contact_text(gap: float, known: bool, backlash: float) -> str:
    if gap == 0.0:
        return "the driving flanks stayed in contact"
    if known and gap <= backlash:
        return "the flanks lifted off by less than the backlash: the coast flank was not reached"
    if known:
        return "the flanks lifted off by more than the backlash: enable the effect"
    return "the flanks lifted off: valid only if the backlash is larger; give the mesh its coast flank"
