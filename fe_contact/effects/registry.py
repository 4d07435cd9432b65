"""The effects of the contact analysis, one line each."""

from __future__ import annotations

from fe_contact.effects.corner_contact import CornerContact
from fe_contact.effects.effect import Effect
from fe_contact.effects.profile_modification import ProfileModification
from fe_contact.effects.tooth_coupling import ToothCoupling

EFFECTS: tuple[Effect, ...] = (
    ToothCoupling(),
    CornerContact(),
    ProfileModification(),
)
