"""The request of an optimization."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.checks import increasing
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.design_loads import DesignLoads, Misalignments
from fe_contact.microgeometry.design_study import DesignSpace, DesignStudy
from fe_contact.microgeometry.objective import NO_LIMITS, Limits, Objective, WeightedMean
from fe_contact.microgeometry.scatter import NO_SCATTER, Scatter
from fe_contact.microgeometry.search import Search
from fe_contact.microgeometry.variables import LENGTHS, DesignVariable, check_variables, start_of
from fe_contact.options import AnalysisOptions, Levels
from fe_contact.types import FloatArray, Json

MAP_PARTS = np.arange(1, 11) / 8.0
"""Torques of the Harris map in parts of the largest that counts."""
CLOSE = 0.03
"""Torques of the map this near to one that counts, in parts of the largest, are left out."""


@dataclass(frozen=True)
class OptimizationRequest:
    """A pair, its design variables, and the assessment of its designs.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
        Its own modifications are the start; those that are not varied stay.
    torques : sequence of float
        Design torques, N m on the driving gear, increasing; equal ones only at different misalignments.
    variables : tuple of DesignVariable
    scatter : Scatter
        Of misalignment and modifications, about the design.
    misalignment : float or sequence of float
        About which it scatters, m: one value, or one for each torque. Further torques of the maps have it
        linear in between, and held beyond the lowest and the highest design torque.
    objective : Objective
        `WeightedMean` or `Worst` of the expectations at the torques.
    limits : Limits
        Pressure, face load factor, load on tip edges.
    search : Search
        Method, seed, starts, evaluations, positions.
    options : AnalysisOptions
        `positions`, `receipt` and `on_violation` are ignored. Effects are decided once, for the design with
        every variable at the middle of its bounds and the scattered misalignment: all designs are assessed by
        one model.
    map_torques : sequence of float, optional
        Further torques of the Harris maps, N m; default: up to 1.25 times the largest design torque.
    """

    pair: ParallelAxes
    torques: Levels
    variables: tuple[DesignVariable, ...]
    scatter: Scatter = NO_SCATTER
    misalignment: Misalignments = 0.0
    objective: Objective = WeightedMean()  # noqa: RUF009 (frozen)
    limits: Limits = NO_LIMITS
    search: Search = Search()  # noqa: RUF009 (frozen)
    options: AnalysisOptions = AnalysisOptions()  # noqa: RUF009 (frozen)
    map_torques: Levels | None = None

    @property
    def own(self) -> tuple[float, ...]:
        """The start design: the variables as they are in the pair, m."""
        return start_of(self.pair, self.variables)

    @property
    def space(self) -> DesignSpace:
        """The designs, by one in which every variable acts."""
        acting = {variable.name: variable.acting for variable in self.variables}
        scattered = self.scatter, self.misalignment
        return DesignSpace(self.pair, acting, *scattered, self.search.positions, self.options)

    @property
    def outside(self) -> tuple[str, ...]:
        """Variables that start beyond their bounds; a length without a relief is ignored."""
        begun = zip(self.variables, self.own, strict=True)
        return tuple(
            v.name
            for v, value in begun
            if not v.low <= value <= v.high and not (v.quantity in LENGTHS and value == 0.0)
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
        self.objective.check(DesignLoads.of(self.torques, self.misalignment).torque.size)
        self.space.check(self.torques)

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
