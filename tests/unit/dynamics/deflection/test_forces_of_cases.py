"""Forces under load cases: reactions by statics, scaling, both sides of the teeth, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from two_stage_scenes import two_stages

from dynamics.deflection import CaseForce, LoadCase, deflect, loaded_scene
from dynamics.errors import InputError
from dynamics.loads import AppliedForce, BySpeed, SpeedCurve

LEFT, RIGHT, AT = 0.01, 0.19, 0.16
FORCE, MOMENT = np.array([300.0, -500.0, 120.0]), np.array([7.0, -4.0, 0.0])
RATIO = 52.0 / 17.0 * 61.0 / 19.0
NOTHING = (0.0, 0.0, 0.0)


def with_force(force=NOTHING, moment=NOTHING, shaft="mid", **changes):
    part = AppliedForce("belt", shaft, AT, tuple(map(float, force)), tuple(map(float, moment)), **changes)
    return two_stages(forces=(part,))


def under(scene, *stated, **changes):
    return deflect(scene, (LoadCase("load", forces=stated, **changes),), 3).cases[0]


def on_bearings(case, shaft="mid"):
    """Forces on what holds the shaft, (left and right, 3)."""
    return np.array([load.force[:3] for load in case.bearings if load.shaft == shaft])


def reactions(force, moment):
    """Of a shaft on two bearings, the left of which holds it along the axis."""
    x = (force[0] * (AT - LEFT) + moment[1]) / (RIGHT - LEFT)
    y = (force[1] * (AT - LEFT) - moment[0]) / (RIGHT - LEFT)
    right = np.array([x, y, 0.0])
    return np.array([force - right, right])


@pytest.mark.parametrize("direction", ["drive", "coast"])
def test_bearings_take_the_force_of_a_case_by_statics_on_either_side(direction):
    """It is fixed in space: turning the torques round does not turn it."""
    own = CaseForce("belt", tuple(FORCE), tuple(MOMENT))
    without, loaded = (
        on_bearings(under(with_force(), *stated, direction=direction)) for stated in ((), (own,))
    )
    assert loaded - without == pytest.approx(reactions(FORCE, MOMENT), rel=1e-9, abs=1e-6)


def test_a_moment_about_y_pushes_the_right_bearing_along_x():
    scene = with_force()
    pushed = on_bearings(under(scene, CaseForce("belt", moment=(0.0, 9.0, 0.0)))) - on_bearings(under(scene))
    expected = np.array([[-50.0, 0.0, 0.0], [50.0, 0.0, 0.0]])
    assert pushed == pytest.approx(expected, rel=1e-9, abs=1e-6)


def test_what_a_case_does_not_state_is_as_in_the_scene():
    scene = with_force(FORCE, MOMENT)
    for stated in ((), (CaseForce("belt", factor=1.0),), (CaseForce("belt", force=tuple(FORCE)),)):
        for case in (LoadCase("load", forces=stated), LoadCase("load", factor=3.0, forces=stated)):
            assert loaded_scene(scene, case).forces == scene.forces
    own = CaseForce("belt", moment=(0.0, 0.0, 1.0))
    (other,) = loaded_scene(scene, LoadCase("load", forces=(own,))).forces
    assert other == replace(scene.forces[0], moment=(0.0, 0.0, 1.0))


def test_on_linear_bearings_motion_follows_the_factor():
    scene = with_force(FORCE, MOMENT)
    none, once, twice, back = (
        under(scene, CaseForce("belt", factor=factor)).shafts.motion for factor in (0.0, 1.0, 2.0, -1.0)
    )
    assert np.max(np.abs(once - none)) > 1e-6
    assert twice - none == pytest.approx(2.0 * (once - none), rel=1e-6, abs=1e-14)
    assert back - none == pytest.approx(none - once, rel=1e-6, abs=1e-14)


def test_a_force_of_zero_is_none():
    own, without = under(with_force()), under(two_stages())
    for first, second in zip(own.meshes, without.meshes, strict=True):
        assert first.causes == pytest.approx(second.causes, rel=1e-9, abs=1e-15)
    assert on_bearings(own) == pytest.approx(on_bearings(without), rel=1e-9, abs=1e-6)


@pytest.mark.parametrize(("direction", "helps"), [("drive", 1.0), ("coast", -1.0)])
def test_a_moment_about_the_axis_is_a_torque_about_z(direction, helps):
    """The output turns as the input does, about +z when it drives: there 100 N m of 900 are taken over."""
    curve = BySpeed(SpeedCurve.table([0.0, 300.0], [0.0, 1.0]), "in")  # at 150 rad/s a half
    for course in ({}, {"course": curve}):
        scene = with_force(moment=(0.0, 0.0, 100.0), shaft="out", **course)
        factor = 0.5 if course else 1.0
        case = under(scene, direction=direction)
        assert case.torque == pytest.approx((900.0 - helps * factor * 100.0) / RATIO, rel=1e-12)
        given = under(scene, direction=direction, torque=200.0)
        plain = under(two_stages(), direction=direction, torque=200.0)
        assert given.torque == pytest.approx(200.0, rel=1e-12)
        for own, other in zip(given.meshes, plain.meshes, strict=True):
            assert own.force == pytest.approx(other.force, rel=1e-9)


@pytest.mark.parametrize(
    ("stated", "field"),
    [
        ({"factor": 2.0, "force": (1.0, 0.0, 0.0)}, "factor"),
        ({"factor": 2.0, "moment": (1.0, 0.0, 0.0)}, "factor"),
        ({}, "force"),
        ({"force": (0.0, float("nan"), 0.0)}, "force.y"),
        ({"factor": 2e6}, "factor"),
    ],
)
def test_a_force_of_a_case_is_its_own_or_a_factor(stated, field):
    with pytest.raises(InputError) as refused:
        CaseForce("belt", **stated)
    assert refused.value.field == field


def test_forces_that_the_scene_has_not_are_refused_before_anything_is_deflected():
    cases = LoadCase("a"), LoadCase("b", forces=(CaseForce("weight", factor=2.0),))
    for scene, words in ((with_force(), '"belt"'), (two_stages(), "which has none")):
        with pytest.raises(InputError, match=words) as refused:
            deflect(scene, cases)
        assert refused.value.field == "load_cases[1].forces[0].name"
    with pytest.raises(InputError, match=r"forces\[1\]"):
        LoadCase("a", forces=(CaseForce("belt", factor=1.0), CaseForce("belt", factor=2.0)))
