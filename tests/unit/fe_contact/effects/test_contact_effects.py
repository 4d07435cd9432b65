"""What each effect contributes, when it is called for, and that neutral settings change no bit."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from fe_contact.contact import PatchRule, Slices, contact_candidates, with_gaps
from fe_contact.contact.model import ContactModel
from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.corner_contact import CornerContact
from fe_contact.effects.flank_modification import ProfileModification
from fe_contact.effects.tooth_coupling import ToothCoupling
from fe_contact.geometry import FlankModification, Gear, GearPair

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
RELIEF = FlankModification(tip_relief=30e-6, tip_relief_length=1e-3)
POSITIONS = np.arange(64) / 64
RULE = PatchRule(half_width=3e-4, edge_length=2e-4)


def scene(
    pinion: FlankModification | None = None, wheel: FlankModification | None = None, torque: float = 100.0
) -> ContactScene:
    gears = (replace(GEAR, modification=m or FlankModification()) for m in (pinion, wheel))
    return ContactScene(GearPair(*gears, center_distance=80e-3), np.array([torque]), EFFECTS)


def candidates(case: ContactScene, model: ContactModel):
    plain = contact_candidates(case.pair, model, POSITIONS, RULE, Slices.of_pair(case.pair, 1))
    return with_gaps(case.pair, plain, model)


def assert_identical(first, second):
    """Compare every array of two sets of candidates and of what they hold, bit for bit."""
    assert type(first) is type(second)
    for entry in fields(first):
        a, b = getattr(first, entry.name), getattr(second, entry.name)
        if is_dataclass(a):
            assert_identical(a, b)
        else:
            np.testing.assert_array_equal(a, b, err_msg=entry.name, strict=isinstance(a, np.ndarray))


@pytest.mark.parametrize("model", [ContactModel(), ContactModel(corner_contact=True)])
def test_neutral_modification_changes_no_bit(model):
    case = scene()
    with_effect = ProfileModification().contribute(case, model)
    assert_identical(candidates(case, with_effect), candidates(case, model))


@pytest.mark.parametrize("effect", [ToothCoupling(), CornerContact(), ProfileModification()])
def test_contributions_touch_nothing_else(effect):
    model = ContactModel()
    after = effect.contribute(scene(), model)
    changed = [f.name for f in fields(model) if getattr(after, f.name) != getattr(model, f.name)]
    expected = {
        "tooth_coupling": "couple_teeth",
        "corner_contact": "corner_contact",
        "profile_modification": "gaps",
    }
    assert changed == [expected[effect.name]]
    assert model == ContactModel()


def test_modification_opens_a_gap_of_the_material_removed():
    case = scene(pinion=RELIEF)
    plain = candidates(case, ContactModel())
    relieved = candidates(case, ProfileModification().contribute(case, ContactModel()))
    roll_1, _ = case.pair.roll_lengths(POSITIONS[:, None], plain.pair[None, :])
    touching = np.isfinite(plain.gap)
    removed = case.pair.pinion.modification.material_removed(case.pair.pinion, roll_1)
    early = (removed - relieved.gap)[touching]
    # sloping flanks of relative radius R touch R m' off the line of action, R m'^2/2 before they would on it
    tip, start = GEAR.tip_roll_length, GEAR.roll_length(GEAR.tip_radius - RELIEF.tip_relief_length)
    slope = RELIEF.tip_relief / (tip - start) * GEAR.base_radius / start
    assert np.all(early > -1e-12)
    assert np.all(early < 0.5 * plain.radius.max() * slope**2)
    assert np.all(np.abs(early[removed[touching] == 0.0]) < 1e-12)
    assert relieved.gap[touching].max() > 25e-6


def test_both_gears_contribute():
    one, other, both = (scene(RELIEF, None), scene(None, RELIEF), scene(RELIEF, RELIEF))
    first, second, sum_ = (
        candidates(case, ProfileModification().contribute(case, ContactModel())).gap
        for case in (one, other, both)
    )
    touching = np.isfinite(sum_)
    assert sum_[touching] == pytest.approx((first + second)[touching], abs=1e-12)
    assert first[touching].max() > 25e-6
    assert second[touching].max() > 25e-6


def test_corner_contact_leaves_the_line_of_action_alone():
    case = scene()
    plain, cornered = (candidates(case, ContactModel(corner_contact=on)) for on in (False, True))
    columns = np.isin(cornered.pair, plain.pair)
    inside = np.isfinite(plain.gap)
    assert np.array_equal(cornered.gap[:, columns][inside], plain.gap[inside])
    assert np.array_equal(cornered.radius[:, columns][inside], plain.radius[inside])
    assert np.all(plain.gap[inside] == 0.0)
    more = np.isfinite(cornered.gap).sum() - inside.sum()
    assert more > 0
    outside = np.isfinite(cornered.gap)
    outside[:, columns] &= ~inside
    assert np.all(cornered.gap[outside] > 0.0)


def test_modification_is_called_for_by_a_modified_flank_only():
    effect = ProfileModification()
    assert not effect.called_for(scene()).on
    assert "pinion" in effect.called_for(scene(RELIEF)).reason
    assert "wheel" in effect.called_for(scene(None, RELIEF)).reason
    assert effect.called_for(scene(None, RELIEF)).on


def test_corner_contact_is_called_for_unless_relief_outgrows_deflection():
    effect = CornerContact()
    deep = FlankModification(tip_relief=200e-6, tip_relief_length=1e-3)
    assert effect.called_for(scene()).on
    assert effect.called_for(scene(deep, None)).on, "the other gear's tip edge is not relieved"
    assert not effect.called_for(scene(deep, deep)).on
    assert effect.called_for(scene(deep, deep, torque=1e5)).on


def test_corner_contact_is_called_for_where_steep_relief_only_moves_the_touching_point():
    # 200 um at the very edge, but 0.15 mm beside it the flanks are 4 um apart
    rounding = FlankModification(tip_relief=200e-6, tip_relief_length=0.15e-3, tip_relief_shape="parabolic")
    verdict = CornerContact().called_for(scene(rounding, rounding))
    assert verdict.on


def test_coupling_is_always_called_for_and_changes_more_with_more_pairs():
    verdict = ToothCoupling().called_for(scene())
    assert verdict.on
    assert "1.557" in verdict.reason
