"""Flank compliance by finite elements: assembly, condensation to the flanks, checks, disk cache."""

from fe_contact.compliance.cache_coverage import free_ends_cached, section_cached, solid_cached
from fe_contact.compliance.condensation_cost import predict_cost
from fe_contact.compliance.cyclic_compliance import flank_compliance_3d, flank_compliances_3d
from fe_contact.compliance.finite_width import FiniteWidthCompliance, finite_width_compliances
from fe_contact.compliance.flank import ComplianceChecks, FlankCompliance, FlankCompliance3D
from fe_contact.compliance.flank_compliance_2d import flank_compliance, flank_compliances
from fe_contact.compliance.plane_hypothesis import PlaneHypothesis
from fe_contact.compliance.root_stress import UnitRootStress
from fe_contact.compliance.unit_root_stress import (
    stress_cached,
    unit_root_stress,
    unit_root_stress_3d,
    unit_root_stresses,
    unit_root_stresses_3d,
)
from host import default_cache_directory

__all__ = [
    "ComplianceChecks",
    "FiniteWidthCompliance",
    "FlankCompliance",
    "FlankCompliance3D",
    "PlaneHypothesis",
    "UnitRootStress",
    "default_cache_directory",
    "finite_width_compliances",
    "flank_compliance",
    "flank_compliance_3d",
    "flank_compliances",
    "flank_compliances_3d",
    "free_ends_cached",
    "predict_cost",
    "section_cached",
    "solid_cached",
    "stress_cached",
    "unit_root_stress",
    "unit_root_stress_3d",
    "unit_root_stresses",
    "unit_root_stresses_3d",
]
