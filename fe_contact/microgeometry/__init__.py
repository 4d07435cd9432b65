"""Studies of micro-geometry: many designs of one pair on one compliance."""

from fe_contact.microgeometry.confirmation import ConfirmedDesign, HarrisMap
from fe_contact.microgeometry.linearized_design import CurveDerivatives, FlankDerivatives, curve_derivatives
from fe_contact.microgeometry.objective import Limits, Objective, WeightedMean, Worst
from fe_contact.microgeometry.optimization import Optimization, OptimizationRequest, Outcome, Perturbation
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.scatter import GaussHermite, Scatter, ScatterNodes, SobolSample
from fe_contact.microgeometry.search import Ended, Search, SearchRun
from fe_contact.microgeometry.search_method import (
    DifferentialEvolution,
    Method,
    NelderMead,
    SequentialLinearProgramming,
)
from fe_contact.microgeometry.sweep import Sweep, SweepAxis, SweepRequest, sweep
from fe_contact.microgeometry.tolerance_study import Sampling, ToleranceStudy, scatter
from fe_contact.microgeometry.tolerances import Tolerances, iso1328_tolerances
from fe_contact.microgeometry.variables import QUANTITIES, DesignVariable

__all__ = [
    "QUANTITIES",
    "ConfirmedDesign",
    "CurveDerivatives",
    "DesignVariable",
    "DifferentialEvolution",
    "Ended",
    "FlankDerivatives",
    "GaussHermite",
    "HarrisMap",
    "Limits",
    "Method",
    "NelderMead",
    "Objective",
    "Optimization",
    "OptimizationRequest",
    "Outcome",
    "Perturbation",
    "Sampling",
    "Scatter",
    "ScatterNodes",
    "Search",
    "SearchRun",
    "SequentialLinearProgramming",
    "SobolSample",
    "Sweep",
    "SweepAxis",
    "SweepRequest",
    "ToleranceStudy",
    "Tolerances",
    "WeightedMean",
    "Worst",
    "curve_derivatives",
    "iso1328_tolerances",
    "optimize",
    "scatter",
    "sweep",
]
