"""The effects of the contact analysis, one line each."""

from __future__ import annotations

from fe_contact.effects.bore_seat import BoreSeatElasticity
from fe_contact.effects.corner_contact import CornerContact
from fe_contact.effects.effect import Effect
from fe_contact.effects.face_load_distribution import FaceLoadDistribution
from fe_contact.effects.finite_width import FiniteWidth
from fe_contact.effects.flank_modification import LeadModification, ProfileModification
from fe_contact.effects.misalignment import Misalignment
from fe_contact.effects.pitch_error import PitchError
from fe_contact.effects.shaft_deflection import ShaftDeflection
from fe_contact.effects.thin_rim import ThinRim
from fe_contact.effects.tooth_coupling import ToothCoupling
from fe_contact.effects.tooth_deviations import ToothDeviations

EFFECTS: tuple[Effect, ...] = (
    ToothCoupling(),
    CornerContact(),
    ProfileModification(),
    FaceLoadDistribution(),
    FiniteWidth(),
    LeadModification(),
    Misalignment(),
    PitchError(),
    ToothDeviations(),
    ShaftDeflection(),
    ThinRim(),
    BoreSeatElasticity(),
)
