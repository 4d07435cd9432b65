from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from bounds import DEPTHS, Direction, Kind
from fe_contact.errors import InputError
from fe_contact.flank.modification import FLANK_FIELDS, fields_of
from fe_contact.geometry import FlankModification, Gear


def over_profile(gear: Gear, count: int = 201) -> np.ndarray:
    return np.linspace(gear.form_roll_length, gear.tip_roll_length, count)


def test_neutral_modification_is_exactly_zero(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear()
    assert FlankModification().neutral
    removed = FlankModification().material_removed(gear, over_profile(gear), 0.01)
    assert removed.tobytes() == np.zeros(201).tobytes()
    # a length without an amount is neutral as well
    assert FlankModification(tip_relief_length=1e-3).neutral
    lengths = FlankModification(tip_relief_length=1e-3, root_relief_length=1e-3, end_relief_length=1e-3)
    assert not np.any(lengths.material_removed(gear, over_profile(gear), 0.0125))


@pytest.mark.parametrize("shape", ["linear", "parabolic"])
def test_tip_relief_starts_at_its_radius_and_reaches_its_amount_at_the_tip(
    make_gear: Callable[..., Gear], shape: Any
) -> None:
    gear = make_gear()
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=1.5e-3, tip_relief_shape=shape)
    start, tip = gear.roll_length(gear.tip_radius - 1.5e-3), gear.tip_roll_length
    removed = relief.material_removed(gear, [gear.form_roll_length, start, 0.5 * (start + tip), tip])
    middle = 10e-6 if shape == "linear" else 5e-6
    assert removed == pytest.approx([0.0, 0.0, middle, 20e-6], rel=1e-12, abs=1e-18)


@pytest.mark.parametrize("shape", ["linear", "parabolic"])
def test_root_relief_is_the_mirror_of_tip_relief(make_gear: Callable[..., Gear], shape: Any) -> None:
    gear = make_gear()
    relief = FlankModification(root_relief=8e-6, root_relief_length=1e-3, root_relief_shape=shape)
    start, form = gear.roll_length(gear.form_radius + 1e-3), gear.form_roll_length
    removed = relief.material_removed(gear, [form, 0.5 * (start + form), start, gear.tip_roll_length])
    middle = 4e-6 if shape == "linear" else 2e-6
    assert removed == pytest.approx([8e-6, middle, 0.0, 0.0], rel=1e-12, abs=1e-18)


def test_profile_crowning_is_a_parabola_with_zero_in_the_middle(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear()
    removed = FlankModification(profile_crowning=6e-6).material_removed(gear, over_profile(gear, 5))
    assert removed == pytest.approx([6e-6, 1.5e-6, 0.0, 1.5e-6, 6e-6], abs=1e-18)


def test_profile_slope_removes_at_the_tip_and_adds_at_the_form_point(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear()
    removed = FlankModification(profile_slope=10e-6).material_removed(gear, over_profile(gear, 5))
    assert removed == pytest.approx([-5e-6, -2.5e-6, 0.0, 2.5e-6, 5e-6], abs=1e-18)


def test_helix_crowning_and_slope_over_the_face(make_gear: Callable[..., Gear]) -> None:
    gear, roll = make_gear(), 0.012
    face = np.array([-12.5e-3, -6.25e-3, 0.0, 6.25e-3, 12.5e-3])
    crowned = FlankModification(helix_crowning=8e-6).material_removed(gear, roll, face)
    assert crowned == pytest.approx([8e-6, 2e-6, 0.0, 2e-6, 8e-6], abs=1e-18)
    sloped = FlankModification(helix_slope=8e-6).material_removed(gear, roll, face)
    assert sloped == pytest.approx([-4e-6, -2e-6, 0.0, 2e-6, 4e-6], abs=1e-18)


@pytest.mark.parametrize("shape", ["linear", "parabolic"])
def test_end_relief_acts_at_both_ends_only(make_gear: Callable[..., Gear], shape: Any) -> None:
    relief = FlankModification(end_relief=12e-6, end_relief_length=2e-3, end_relief_shape=shape)
    face = np.array([-12.5e-3, -11.5e-3, -10.5e-3, 0.0, 10.5e-3, 11.5e-3, 12.5e-3])
    middle = 6e-6 if shape == "linear" else 3e-6
    removed = relief.material_removed(make_gear(), 0.012, face)
    assert removed == pytest.approx([12e-6, middle, 0.0, 0.0, 0.0, middle, 12e-6], rel=1e-9, abs=1e-18)


def test_twist_is_a_profile_slope_that_grows_along_the_face(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear()
    twisted = FlankModification(flank_twist=4e-6)
    roll, face = over_profile(gear, 5)[:, None], np.linspace(-12.5e-3, 12.5e-3, 3)
    removed = twisted.material_removed(gear, roll, face)
    across = np.linspace(-1.0, 1.0, 5)
    assert removed == pytest.approx(4e-6 * np.outer(across, [-1.0, 0.0, 1.0]), rel=1e-12, abs=1e-20)
    end = FlankModification(profile_slope=8e-6).material_removed(gear, roll, 0.0)
    assert removed[:, 2:] == pytest.approx(end, rel=1e-12, abs=1e-20)
    beyond = twisted.material_removed(gear, [0.0, 1.0], 12.5e-3)
    assert beyond == pytest.approx([-4e-6, 4e-6], rel=1e-12, abs=0.0)


def test_what_differs_over_the_face_and_what_does_not_add_up_to_all(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear()
    whole = FlankModification(
        tip_relief=20e-6, tip_relief_length=1e-3, profile_slope=3e-6, helix_crowning=5e-6, flank_twist=4e-6
    )
    roll, face = over_profile(gear, 9)[:, None], np.linspace(-12.5e-3, 12.5e-3, 5)
    parts = [part.material_removed(gear, roll, face) for part in (whole.along_profile, whole.along_face)]
    assert sum(parts) == pytest.approx(whole.material_removed(gear, roll, face), rel=1e-12, abs=1e-20)
    assert np.all(np.ptp(parts[0], axis=1) == 0.0)
    assert not whole.along_profile.varies_along_face
    twist = FlankModification(flank_twist=-1e-6)
    assert twist.along_profile.neutral
    assert twist.along_face == twist
    assert twist.varies_along_profile
    assert twist.varies_along_face
    assert not twist.neutral


def test_effects_add_and_broadcast(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear()
    tip = FlankModification(tip_relief=20e-6, tip_relief_length=1e-3)
    lead = FlankModification(helix_crowning=5e-6)
    both = FlankModification(tip_relief=20e-6, tip_relief_length=1e-3, helix_crowning=5e-6)
    roll, face = over_profile(gear, 7)[:, None], np.linspace(-12.5e-3, 12.5e-3, 3)
    total = tip.material_removed(gear, roll, face) + lead.material_removed(gear, roll, face)
    assert both.material_removed(gear, roll, face) == pytest.approx(total, abs=1e-20)
    assert total.shape == (7, 3)
    assert both.varies_along_face
    assert not tip.varies_along_face


def test_beyond_the_involute_the_end_value_holds(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear()
    relief = FlankModification(
        tip_relief=20e-6, tip_relief_length=1e-3, root_relief=5e-6, root_relief_length=1e-3
    )
    removed = relief.material_removed(gear, [0.0, 2.0 * gear.tip_roll_length])
    assert removed == pytest.approx([5e-6, 20e-6])
    curved = FlankModification(profile_crowning=6e-6, profile_slope=2e-6)
    removed = curved.material_removed(gear, [0.0, 2.0 * gear.tip_roll_length])
    assert removed == pytest.approx([5e-6, 7e-6])


def alone(name: str) -> FlankModification:
    """Return the modification of one depth as its declaration has it, over its length if it needs one."""
    length = f"{name}_length"
    names = [name, length] if length in FLANK_FIELDS else [name]
    return FlankModification(**{each: FLANK_FIELDS[each].example for each in names})


@pytest.mark.parametrize("name", fields_of(*DEPTHS, Kind.EDGE))
def test_a_figure_acts_along_what_it_is_declared_to(make_gear: Callable[..., Gear], name: str) -> None:
    gear, modification, along = make_gear(helix_angle=0.2), alone(name), FLANK_FIELDS[name].along
    roll, face = over_profile(gear)[:, None], np.linspace(-12.5e-3, 12.5e-3, 5)
    removed = modification.material_removed(gear, roll, face)
    assert bool(np.ptp(removed, axis=0).max() > 0.0) == (Direction.PROFILE in along)
    assert bool(np.ptp(removed, axis=1).max() > 0.0) == (Direction.FACE in along)
    assert modification.varies is along
    assert modification.along_face.neutral == (Direction.FACE not in along)
    assert modification.along_profile.neutral == (Direction.FACE in along)


def test_the_whole_is_the_sum_of_its_parts_and_begins_where_they_do(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(helix_angle=0.2)
    parts = [alone(name) for name in (*fields_of(*DEPTHS), "tip_rounding")]
    plain = FlankModification()
    facts = [(f.name, getattr(part, f.name)) for part in parts for f in fields(part)]
    whole = FlankModification(**{name: value for name, value in facts if value != getattr(plain, name)})
    roll, face = over_profile(gear, 41)[:, None], np.linspace(-12.5e-3, 12.5e-3, 5)
    apart = sum(part.material_removed(gear, roll, face) for part in parts)
    assert whole.material_removed(gear, roll, face) == pytest.approx(apart, rel=1e-12, abs=1e-20)
    assert set(map(repr, whole.relief_starts(gear))) == {
        repr(start) for part in parts for start in part.relief_starts(gear)
    }
    (edge,) = [start for start in whole.relief_starts(gear) if start.ends_flank]
    assert whole.tip_form_roll_length(gear) == edge.roll_length < gear.tip_roll_length


@pytest.mark.parametrize(
    ("fields", "named"),
    [
        ({"tip_relief": 2e-5}, "tip_relief_length"),
        ({"root_relief": 2e-5}, "root_relief_length"),
        ({"end_relief": 2e-5}, "end_relief_length"),
        ({"tip_relief": 20.0, "tip_relief_length": 1e-3}, "tip_relief"),
        ({"tip_relief": -1e-6, "tip_relief_length": 1e-3}, "tip_relief"),
        ({"tip_relief_length": -1e-3}, "tip_relief_length"),
        ({"tip_relief_length": math.nan}, "tip_relief_length"),
        ({"tip_relief_shape": "cubic"}, "tip_relief_shape"),
        ({"profile_crowning": -1e-6}, "profile_crowning"),
        ({"profile_slope": math.nan}, "profile_slope"),
        ({"helix_crowning": 5.0}, "helix_crowning"),
        ({"helix_slope": -5.0}, "helix_slope"),
        ({"flank_twist": 5.0}, "flank_twist"),
    ],
)
def test_unusable_modification_names_its_field(fields: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError) as caught:
        FlankModification(**fields)
    assert caught.value.field == named
