"""The result of an optimization: both designs, the gain, and the search."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from fe_contact.microgeometry.confirmation import ConfirmedDesign
from fe_contact.microgeometry.design_loads import DesignLoads
from fe_contact.microgeometry.harris_map import rising
from fe_contact.microgeometry.scatter import ScatterNodes
from fe_contact.microgeometry.search import SearchRun
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.types import Estimate, FloatArray, IntArray, Json
from model_studies import Record, in_unit


class Outcome(StrEnum):
    """The outcome of an optimization."""

    IMPROVED = "improved"  # by more than the errors of both designs
    WITHIN_ERROR = "within_error"  # lower, but no more than the errors
    NOT_IMPROVED = "not_improved"  # the full analysis does not find it lower
    LIMITS_KEPT = "limits_kept"  # no lower beyond the errors, but the start exceeds the limits
    LIMITS_EXCEEDED = "limits_exceeded"  # no design was found that keeps the limits


@dataclass(frozen=True)
class Perturbation(Record):
    """The change by a small step of one variable from the optimum.

    Attributes
    ----------
    name : str
    low, high : float
        Values of the variable on both sides, m: a standard deviation away where it scatters, else a twentieth
        of its range, kept within its bounds.
    change_low, change_high : float
        Of the objective there, m.
    """

    name: str
    low: float = field(metadata=in_unit("m"))
    high: float = field(metadata=in_unit("m"))
    change_low: float = field(metadata=in_unit("m"))
    change_high: float = field(metadata=in_unit("m"))


@dataclass(frozen=True)
class Optimization:
    """Result of `optimize`.

    Attributes
    ----------
    outcome : Outcome
    reason : str
        The outcome, and how the search ended, in words.
    variables : tuple of DesignVariable
    torque : ndarray, shape (L,)
        Torques that count, N m.
    misalignment : ndarray, shape (L,)
        Of each, about which it scatters, m.
    nodes : ScatterNodes
    start, optimum : ConfirmedDesign
    runs : tuple of SearchRun
        One for each start, and one more each time the best design had to be brought back within the limits;
        `best_run` is the index of the decisive one.
    best_run : int
    sensitivity : tuple of Perturbation
    not_tried : tuple of str
        What the search did not vary, in words.
    cost : dict
        Evaluations and CPU seconds by stage; the search's are those of all its processes.
    asked : dict
        What was requested, in SI units.
    """

    outcome: Outcome
    reason: str
    variables: tuple[DesignVariable, ...]
    torque: FloatArray = field(metadata=in_unit("n_m", "torque"))
    misalignment: FloatArray = field(metadata=in_unit("m", "torque"))
    nodes: ScatterNodes
    start: ConfirmedDesign
    optimum: ConfirmedDesign
    runs: tuple[SearchRun, ...]
    best_run: int
    sensitivity: tuple[Perturbation, ...]
    not_tried: tuple[str, ...]
    cost: Json
    asked: Json

    def __post_init__(self) -> None:
        # files of version 0.2 hold one value for all torques
        object.__setattr__(self, "misalignment", np.broadcast_to(self.misalignment, self.torque.shape))

    @property
    def gain(self) -> Estimate:
        """Reduction of the objective, m; the errors are added, although both designs have one mesh."""
        start, optimum = self.start.objective, self.optimum.objective
        return Estimate(start.value - optimum.value, start.error + optimum.error, "m")

    @property
    def rising(self) -> IntArray:
        """Indices of the torques of the Harris maps at which the optimum ripples more, beyond both errors."""
        return rising(self.start.harris_map, self.optimum.harris_map)

    @property
    def map_misalignment(self) -> FloatArray:
        """Misalignments of the torques of the Harris maps (T,), m: see `OptimizationRequest`."""
        loads, _ = DesignLoads(self.torque, self.misalignment).with_torques(self.start.harris_map.torque)
        return loads.misalignment

    @property
    def evaluations(self) -> int:
        """Designs that the search evaluated."""
        return sum(run.evaluations for run in self.runs)

    def to_json(self) -> Json:
        """Return plain JSON in SI units."""
        return {
            "outcome": self.outcome.value,
            "reason": self.reason,
            "variables": [each.to_json() for each in self.variables],
            "torque_n_m": self.torque.tolist(),
            "misalignment_m": self.misalignment.tolist(),
            "nodes": self.nodes.to_json(),
            "gain_m": self.gain.value,
            "gain_error_m": self.gain.error,
            "start": self.start.to_json(),
            "optimum": self.optimum.to_json(),
            "evaluations": self.evaluations,
            "runs": [run.to_json() for run in self.runs],
            "best_run": self.best_run,
            "sensitivity": [each.to_json() for each in self.sensitivity],
            "not_tried": list(self.not_tried),
            "cost": self.cost,
            "asked": self.asked,
        }
