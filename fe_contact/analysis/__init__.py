"""The main flow: gear pair in, STE database out; and what happens on its flanks."""

from fe_contact.analysis.analyze import analyze, ste_database
from fe_contact.analysis.flanks.deformed_pair import DeformedPair, deformed_pairs
from fe_contact.analysis.flanks.flank_file import ContactPattern, contact_pattern, flank_results
from fe_contact.analysis.flanks.load_distribution import LoadDistribution, load_distribution, pressure_map
from fe_contact.analysis.flanks.root_stress import (
    RootPassage,
    RootPeak,
    RootStress,
    RootStressHistory,
    root_stress,
)
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.condensed_request import condensed_pair
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.run_plan import RunPlan, plan_run
from fe_contact.analysis.studies.ablation import Ablation, EffectAblation, ablate
from fe_contact.analysis.studies.frontier import Frontier, frontier
from fe_contact.analysis.studies.sensitivity import RippleCurve, Sensitivity, study_sensitivity

__all__ = [
    "Ablation",
    "CondensedPair",
    "ContactPattern",
    "DeformedPair",
    "EffectAblation",
    "Frontier",
    "LoadDistribution",
    "RippleCurve",
    "RootPassage",
    "RootPeak",
    "RootStress",
    "RootStressHistory",
    "RunPlan",
    "Sensitivity",
    "ablate",
    "analyze",
    "check_request",
    "condensed_pair",
    "contact_pattern",
    "deformed_pairs",
    "flank_results",
    "frontier",
    "load_distribution",
    "plan_run",
    "pressure_map",
    "root_stress",
    "ste_database",
    "study_sensitivity",
]
