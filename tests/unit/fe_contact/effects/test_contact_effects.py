"""What each effect on flanks contributes, when it is called for, and that neutral settings change no bit."""

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
import pytest
from spur_gears import GEAR

from fe_contact import FlankGrid, FlankModification, Gear, GearPair
from fe_contact.contact import ContactModel, PatchRule, Slices, contact_candidates, with_gaps
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.effects.corner_contact import CornerContact
from fe_contact.effects.flank_modification import LeadModification, ProfileModification
from fe_contact.effects.tooth_coupling import ToothCoupling

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
    verdict = ToothCoupling().called_for(scene())
    assert verdict.on
    assert "1.557" in verdict.reason


def test_corner_contact_is_called_for_unless_relief_outgrows_deflection():
    effect = CornerContact()
    deep = FlankModification(tip_relief=200e-6, tip_relief_length=1e-3)
    assert effect.called_for(scene()).on
    assert effect.called_for(scene(deep, None)).on, "the other gear's tip edge is not relieved"
    assert not effect.called_for(scene(deep, deep)).on
    assert effect.called_for(scene(deep, deep, torque=1e5)).on
    rounding = FlankModification(tip_relief=200e-6, tip_relief_length=0.15e-3, tip_relief_shape="parabolic")
    verdict = CornerContact().called_for(scene(rounding, rounding))
    assert verdict.on


WIDE = Gear(teeth=20, normal_module=4e-3, face_width=24e-3, bore_diameter=40e-3)
FEW_POSITIONS = np.arange(16) / 16
SLICES = 8
TWIST = 30e-6


def lead_scene(torque: float = 100.0, **modification: Any) -> ContactScene:
    gear = replace(WIDE, modification=FlankModification(**modification))
    return ContactScene(GearPair(gear, WIDE, center_distance=80e-3), np.array([torque]), EFFECTS)


def over_face(case: ContactScene, model: ContactModel):
    slices = Slices.of_pair(case.pair, SLICES)
    plain = contact_candidates(case.pair, model, FEW_POSITIONS, PatchRule(3e-4, 2e-4), slices)
    return with_gaps(case.pair, plain, model)


def test_twist_calls_for_the_lead_and_not_for_the_profile():
    twisted = lead_scene(flank_twist=TWIST)
    assert LeadModification().called_for(twisted).on
    assert not ProfileModification().called_for(twisted).on
    model, ledger = compose(twisted, {})
    assert model.across_face
    assert len(model.gaps) == 1
    assert {entry.name for entry in ledger if entry.on} >= {"lead_modification", "face_load_distribution"}


def test_each_slice_of_a_twisted_flank_is_a_sloped_profile():
    """The touching points move off the line of action as on a profile slope of that slice's amount."""
    twisted = lead_scene(flank_twist=TWIST)
    found = over_face(twisted, LeadModification().contribute(twisted, ContactModel()))
    for place in np.unique(found.face_position):
        amount = 4.0 * TWIST * place / WIDE.face_width  # tip minus form point
        sloped = lead_scene(profile_slope=amount)
        expected = over_face(sloped, ProfileModification().contribute(sloped, ContactModel()))
        ours, theirs = found.face_position == place, expected.face_position == place
        for name in ("s_1", "s_2", "gap"):
            values = getattr(found.touch, name)[:, ours], getattr(expected.touch, name)[:, theirs]
            # the search ends on a grid of about 1e-4 of its reach
            assert values[0] == pytest.approx(values[1], rel=0.0, abs=3e-7 if name != "gap" else 1e-11)
    plain = over_face(twisted, ContactModel())
    assert np.abs(found.touch.s_1 - plain.touch.s_1)[np.isfinite(found.gap)].max() > 3e-5


def test_a_free_flank_made_of_a_twist_is_that_twist():
    twisted = lead_scene(flank_twist=TWIST)
    roll = (WIDE.form_roll_length, WIDE.tip_roll_length)
    face = (-0.5 * WIDE.face_width, 0.5 * WIDE.face_width)
    free = lead_scene(flank_grid=FlankGrid(roll, face, ((TWIST, -TWIST), (-TWIST, TWIST))))
    assert LeadModification().called_for(free).on
    first, second = (
        over_face(case, LeadModification().contribute(case, ContactModel())).touch for case in (free, twisted)
    )
    # On a surface that may be rough the least gap is searched; beside it by 10 nm the gap is 1e-14 m larger.
    for name, off in (("s_1", 1e-8), ("s_2", 1e-8), ("gap", 1e-14)):
        assert getattr(first, name) == pytest.approx(getattr(second, name), rel=0.0, abs=off)


def test_a_tip_edge_is_clear_only_if_it_is_so_all_over_the_face():
    relief = {"tip_relief": 200e-6, "tip_relief_length": 1e-3}
    deep = replace(WIDE, modification=FlankModification(**relief))
    low = replace(WIDE, modification=FlankModification(**relief, flank_twist=200e-6))
    clear, touching = (
        ContactScene(GearPair(deep, g, 80e-3), np.array([100.0]), EFFECTS) for g in (deep, low)
    )
    assert not CornerContact().called_for(clear).on
    assert CornerContact().called_for(touching).on
