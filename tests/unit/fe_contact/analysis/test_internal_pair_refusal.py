from __future__ import annotations

import pytest

from fe_contact.analysis import analyze
from fe_contact.errors import InputError
from fe_contact.geometry import Gear, InternalGearPair, RingGear


def test_a_ring_gear_is_refused_by_one_clear_error() -> None:
    pinion = Gear(teeth=30, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    ring = RingGear(
        teeth=80, normal_module=4e-3, face_width=25e-3, rim_diameter=0.4, addendum_coefficient=0.8
    )
    with pytest.raises(InputError, match="no contact analysis yet") as caught:
        analyze(InternalGearPair(pinion, ring), torques=[100.0])  # type: ignore[arg-type]
    assert caught.value.field == "pair"
