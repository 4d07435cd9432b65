"""What an optimization is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.checks import increasing
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.design_study import Accuracies, DesignStudy, check_study
from fe_contact.microgeometry.objective import Limits, Objective
from fe_contact.microgeometry.scatter import Scatter
from fe_contact.microgeometry.search import Search
from fe_contact.microgeometry.variables import LENGTHS, DesignVariable, check_variables, start_of
from fe_contact.types import FloatArray, Json

MAP_PARTS = np.arange(1, 11) / 8.0
"""Torques of the Harris map in parts of the largest that counts."""
CLOSE = 0.03
"""Torques of the map this near to one that counts, in parts of the largest, are left out."""


@dataclass(frozen=True)
class OptimizationRequest:
    """Arguments of `optimize`, which describes them; those of `analyze` are in `accuracy`."""

    pair: ParallelAxes
    torques: Sequence[float] | FloatArray
    variables: tuple[DesignVariable, ...]
    scatter: Scatter
    misalignment: float
    objective: Objective
    limits: Limits
    search: Search
    accuracy: Accuracies
    map_torques: Sequence[float] | FloatArray | None = None

    @property
    def own(self) -> tuple[float, ...]:
        """The design to begin with: the variables as they are in the pair, m."""
        return start_of(self.pair, self.variables)

    @property
    def acting(self) -> dict[str, float]:
        """A design in which every variable acts, ``gear.quantity`` to m."""
        return {one.name: one.acting for one in self.variables}

    @property
    def outside(self) -> tuple[str, ...]:
        """Variables that begin beyond their bounds; a length without a relief does not count."""
        begun = zip(self.variables, self.own, strict=True)
        return tuple(
            one.name
            for one, value in begun
            if not one.low <= value <= one.high and not (one.quantity in LENGTHS and value == 0.0)
        )

    @property
    def further_torques(self) -> FloatArray:
        """Torques that only the maps show, N m."""
        if self.map_torques is not None:
            return increasing("map_torques", self.map_torques)
        counted = np.asarray(self.torques, dtype=float)
        parts = MAP_PARTS * counted[-1]
        return np.asarray(parts[np.abs(parts[:, None] - counted).min(axis=1) > CLOSE * counted[-1]])

    def check(self) -> None:
        """Check everything without computing anything.

        Raises
        ------
        InputError
            As `optimize`.
        """
        check_variables(self.pair, self.variables)
        counted = increasing("torques", self.torques)
        self.objective.check(counted.size)
        wanted = self.acting, self.scatter, self.misalignment, self.search.positions, self.accuracy
        check_study(self.pair, counted, *wanted)

    def to_json(self, study: DesignStudy) -> Json:
        """Return plain JSON, with what the study decided."""
        return {
            "scatter": self.scatter.to_json(),
            "objective": self.objective.to_json(),
            "limits": self.limits.to_json(),
            "search": self.search.to_json(),
            "level": study.decided.mesh.level,
            "effects": study.decided.checked.decided,
        }
