"""Involute gear geometry: one gear, its exact tooth profile, and the pair (ISO 21771-1 vocabulary)."""

from fe_contact.body import CLAMPED, BoreSeat, GearBlank, Key
from fe_contact.flank.flank_grid import FlankGrid
from fe_contact.flank.modification import FlankModification
from fe_contact.geometry.basic_rack import BasicRack
from fe_contact.geometry.corner_contact import CornerContact, Side, corner_contact, edge_gap
from fe_contact.geometry.flank_profile import ToothProfile, tooth_profile
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.gear_pair import GearPair, InternalGearPair
from fe_contact.geometry.gear_seat import seat_compliance
from fe_contact.geometry.iso6336_stiffness import blank_factor, iso6336_stiffness
from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.geometry.pitch_deviation import PitchDeviation
from fe_contact.geometry.ring_gear import RingGear
from fe_contact.geometry.sliding import sliding_factor, specific_sliding
from fe_contact.geometry.tooth_deviations import NO_RUN_OUT, RunOut, Wave, deviations_period
from fe_contact.geometry.tooth_flank import ToothFlank, flanks_excess
from fe_contact.geometry.toothing import Toothing
from fe_contact.geometry.web_compliance import web_compliance
from fe_contact.shaft import Shaft

__all__ = [
    "CLAMPED",
    "NO_RUN_OUT",
    "BasicRack",
    "BoreSeat",
    "CornerContact",
    "FlankGrid",
    "FlankModification",
    "Gear",
    "GearBlank",
    "GearPair",
    "InternalGearPair",
    "Key",
    "ParallelAxes",
    "PitchDeviation",
    "RingGear",
    "RunOut",
    "Shaft",
    "Side",
    "ToothFlank",
    "ToothProfile",
    "Toothing",
    "Wave",
    "blank_factor",
    "corner_contact",
    "deviations_period",
    "edge_gap",
    "flanks_excess",
    "iso6336_stiffness",
    "seat_compliance",
    "sliding_factor",
    "specific_sliding",
    "tooth_profile",
    "web_compliance",
]
