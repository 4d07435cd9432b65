"""Contact analysis of gear pairs: static transmission error by finite elements and Hertz contact.

Names are imported on first use, so that reading a database does not load the mesher or the finite-element
library.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fe_contact.allowed_error import AllowedError
    from fe_contact.analysis.analyze import analyze
    from fe_contact.analysis.deviating_cycle import DeviatingCycle, deviating_cycle
    from fe_contact.analysis.flanks.contact_pattern import ContactPattern, contact_pattern
    from fe_contact.analysis.flanks.deformed_pair import DeformedPair, deformed_pairs
    from fe_contact.analysis.flanks.flank_results import flank_results
    from fe_contact.analysis.flanks.load_distribution import LoadDistribution
    from fe_contact.analysis.flanks.root_stress import RootStress, root_stress
    from fe_contact.analysis.studies.ablation import Ablation, ablate
    from fe_contact.analysis.studies.frontier import Frontier, frontier
    from fe_contact.analysis.studies.sensitivity import Sensitivity, study_sensitivity
    from fe_contact.geometry import (
        BoreSeat,
        FlankGrid,
        FlankModification,
        Gear,
        GearBlank,
        GearPair,
        InternalGearPair,
        PitchDeviation,
        RingGear,
        RunOut,
        Shaft,
        ToothFlank,
        Wave,
    )
    from fe_contact.material import STEEL, Material
    from fe_contact.microgeometry.objective import Limits
    from fe_contact.microgeometry.optimization import Optimization, OptimizationRequest
    from fe_contact.microgeometry.optimize import optimize
    from fe_contact.microgeometry.scatter import Scatter
    from fe_contact.microgeometry.search import Search
    from fe_contact.microgeometry.tolerance_study import Sampling, ToleranceStudy, scatter
    from fe_contact.microgeometry.tolerances import Tolerances
    from fe_contact.microgeometry.variables import DesignVariable
    from fe_contact.options import AnalysisOptions, OperatingPoint, Run, TableAxes
    from fe_contact.ste import SteDatabase
    from fe_contact.types import Estimate, Status

__all__ = [
    "STEEL",
    "Ablation",
    "AllowedError",
    "AnalysisOptions",
    "BoreSeat",
    "ContactPattern",
    "DeformedPair",
    "DesignVariable",
    "DeviatingCycle",
    "Estimate",
    "FlankGrid",
    "FlankModification",
    "Frontier",
    "Gear",
    "GearBlank",
    "GearPair",
    "InternalGearPair",
    "Limits",
    "LoadDistribution",
    "Material",
    "OperatingPoint",
    "Optimization",
    "OptimizationRequest",
    "PitchDeviation",
    "RingGear",
    "RootStress",
    "Run",
    "RunOut",
    "Sampling",
    "Scatter",
    "Search",
    "Sensitivity",
    "Shaft",
    "Status",
    "SteDatabase",
    "TableAxes",
    "ToleranceStudy",
    "Tolerances",
    "ToothFlank",
    "Wave",
    "ablate",
    "analyze",
    "contact_pattern",
    "deformed_pairs",
    "deviating_cycle",
    "flank_results",
    "frontier",
    "optimize",
    "root_stress",
    "scatter",
    "study_sensitivity",
]

_NAMES = {
    "fe_contact.allowed_error": "AllowedError",
    "fe_contact.analysis.analyze": "analyze",
    "fe_contact.analysis.deviating_cycle": "DeviatingCycle deviating_cycle",
    "fe_contact.analysis.flanks.contact_pattern": "ContactPattern contact_pattern",
    "fe_contact.analysis.flanks.deformed_pair": "DeformedPair deformed_pairs",
    "fe_contact.analysis.flanks.flank_results": "flank_results",
    "fe_contact.analysis.flanks.load_distribution": "LoadDistribution",
    "fe_contact.analysis.flanks.root_stress": "RootStress root_stress",
    "fe_contact.analysis.studies.ablation": "Ablation ablate",
    "fe_contact.analysis.studies.frontier": "Frontier frontier",
    "fe_contact.analysis.studies.sensitivity": "Sensitivity study_sensitivity",
    "fe_contact.geometry": (
        "BoreSeat FlankGrid FlankModification Gear GearBlank GearPair InternalGearPair PitchDeviation "
        "RingGear RunOut Shaft ToothFlank Wave"
    ),
    "fe_contact.material": "STEEL Material",
    "fe_contact.microgeometry.objective": "Limits",
    "fe_contact.microgeometry.optimization": "Optimization OptimizationRequest",
    "fe_contact.microgeometry.optimize": "optimize",
    "fe_contact.microgeometry.scatter": "Scatter",
    "fe_contact.microgeometry.search": "Search",
    "fe_contact.microgeometry.tolerance_study": "Sampling ToleranceStudy scatter",
    "fe_contact.microgeometry.tolerances": "Tolerances",
    "fe_contact.microgeometry.variables": "DesignVariable",
    "fe_contact.options": "AnalysisOptions OperatingPoint Run TableAxes",
    "fe_contact.ste": "SteDatabase",
    "fe_contact.types": "Estimate Status",
}
_HOME = {name: home for home, names in _NAMES.items() for name in names.split()}


def __getattr__(name: str) -> object:
    """Import a public name from the room that holds it."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
