"""Involute gear geometry: one gear, its exact tooth profile, and the pair (ISO 21771-1 vocabulary)."""

from fe_contact.geometry.basic_rack import BasicRack
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.gear_pair import GearPair
from fe_contact.geometry.modification import FlankModification
from fe_contact.geometry.path_of_contact import PathOfContact
from fe_contact.geometry.tooth_profile import ToothProfile, tooth_profile

__all__ = [
    "BasicRack",
    "FlankModification",
    "Gear",
    "GearPair",
    "PathOfContact",
    "ToothProfile",
    "tooth_profile",
]
