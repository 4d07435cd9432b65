"""Contact analysis of gear pairs: static transmission error by finite elements and Hertz contact.

Names are imported on first use, so that reading a database does not load the mesher or the finite-element
library.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fe_contact.allowed_error import AllowedError
    from fe_contact.analysis import (
        Ablation,
        ContactPattern,
        DeformedPair,
        Frontier,
        LoadDistribution,
        RootStress,
        Sensitivity,
        ablate,
        analyze,
        contact_pattern,
        deformed_pairs,
        flank_results,
        frontier,
        root_stress,
        study_sensitivity,
    )
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
        Shaft,
    )
    from fe_contact.material import STEEL, Material
    from fe_contact.microgeometry import (
        DesignVariable,
        Limits,
        Optimization,
        Scatter,
        Search,
        Tolerances,
        ToleranceStudy,
        optimize,
        scatter,
    )
    from fe_contact.ste import SteDatabase
    from fe_contact.types import Estimate, Status

__all__ = [
    "STEEL",
    "Ablation",
    "AllowedError",
    "BoreSeat",
    "ContactPattern",
    "DeformedPair",
    "DesignVariable",
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
    "Optimization",
    "PitchDeviation",
    "RingGear",
    "RootStress",
    "Scatter",
    "Search",
    "Sensitivity",
    "Shaft",
    "Status",
    "SteDatabase",
    "ToleranceStudy",
    "Tolerances",
    "ablate",
    "analyze",
    "contact_pattern",
    "deformed_pairs",
    "flank_results",
    "frontier",
    "optimize",
    "root_stress",
    "scatter",
    "study_sensitivity",
]

_HOME = {
    "ablate": "fe_contact.analysis",
    "Ablation": "fe_contact.analysis",
    "analyze": "fe_contact.analysis",
    "contact_pattern": "fe_contact.analysis",
    "deformed_pairs": "fe_contact.analysis",
    "flank_results": "fe_contact.analysis",
    "frontier": "fe_contact.analysis",
    "Frontier": "fe_contact.analysis",
    "root_stress": "fe_contact.analysis",
    "study_sensitivity": "fe_contact.analysis",
    "ContactPattern": "fe_contact.analysis",
    "DeformedPair": "fe_contact.analysis",
    "LoadDistribution": "fe_contact.analysis",
    "RootStress": "fe_contact.analysis",
    "Sensitivity": "fe_contact.analysis",
    "BoreSeat": "fe_contact.geometry",
    "FlankGrid": "fe_contact.geometry",
    "FlankModification": "fe_contact.geometry",
    "Gear": "fe_contact.geometry",
    "GearBlank": "fe_contact.geometry",
    "GearPair": "fe_contact.geometry",
    "InternalGearPair": "fe_contact.geometry",
    "PitchDeviation": "fe_contact.geometry",
    "RingGear": "fe_contact.geometry",
    "Shaft": "fe_contact.geometry",
    "STEEL": "fe_contact.material",
    "Material": "fe_contact.material",
    "DesignVariable": "fe_contact.microgeometry",
    "Limits": "fe_contact.microgeometry",
    "Optimization": "fe_contact.microgeometry",
    "optimize": "fe_contact.microgeometry",
    "Scatter": "fe_contact.microgeometry",
    "scatter": "fe_contact.microgeometry",
    "Search": "fe_contact.microgeometry",
    "Tolerances": "fe_contact.microgeometry",
    "ToleranceStudy": "fe_contact.microgeometry",
    "AllowedError": "fe_contact.allowed_error",
    "SteDatabase": "fe_contact.ste",
    "Estimate": "fe_contact.types",
    "Status": "fe_contact.types",
}


def __getattr__(name: str) -> object:
    """Import a public name from the room that holds it."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
