"""Scenes name what is wrong with them."""

import math
import pickle
from dataclasses import replace

import pytest
from geared_scenes import gear_pair_scene, with_gear, with_mesh

from bounds import above
from dynamics import ImposedRotation, Integration, TimeLaw
from dynamics.errors import InputError

SCENE = gear_pair_scene()


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: replace(SCENE, duration=-1.0), "duration"),
        (lambda: replace(SCENE, duration=math.nan), "duration"),
        (lambda: replace(SCENE, duration=1e9), "duration"),
        (lambda: replace(SCENE, drives=()), "drives"),
        (
            lambda: replace(SCENE, drives=(ImposedRotation("d", "input", TimeLaw.constant(0.0)),)),
            "drives[0].speed",
        ),
        (
            lambda: replace(SCENE, drives=(ImposedRotation("d", "none", TimeLaw.constant(1.0)),)),
            "drives[0].shaft",
        ),
        (lambda: replace(SCENE, shafts=(SCENE.shafts[0],) * 2), "shafts[1].name"),
        (lambda: with_gear(SCENE, 1, shaft="third"), "gears[1].shaft"),
        (lambda: with_gear(SCENE, 1, teeth=0), "teeth"),
        (lambda: with_gear(SCENE, 1, base_radius=-1.0), "base_radius"),
        (lambda: with_mesh(SCENE, driver="nobody"), "meshes[0].driver"),
        (lambda: Integration(largest_step=1e-13), "largest_step"),
        (lambda: Integration(step_limit=0), "step_limit"),
    ],
)
def test_bad_values_are_refused_by_name(make, field):
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.field == field
    assert str(caught.value.bound)


def test_errors_cross_process_boundaries_whole():
    error = InputError("a.b", 3, above(4), "Try 5.")
    copy = pickle.loads(pickle.dumps(error))
    facts = (copy.field, copy.value, copy.bound, str(copy.suggestion), str(copy))
    assert facts == ("a.b", 3, above(4), "Try 5.", "a.b = 3: must be above 4. Try 5.")
    assert error.within("c").field == "c.a.b"
