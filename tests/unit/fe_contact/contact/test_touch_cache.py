"""The cache of touching points returns what is found without it, for the gaps that are asked for."""

from dataclasses import replace

import numpy as np
import pytest
from tooth_traces import KINDS, pair_with

from fe_contact.contact import PatchRule, Slices, contact_candidates, touch_cache, with_gaps
from fe_contact.contact.touch import modified_touch
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.geometry import FlankModification

POSITION = np.arange(4) / 4.0


@pytest.fixture(autouse=True)
def _empty():
    touch_cache._entries.clear()


def candidates_of(relief):
    flank = FlankModification(tip_relief=relief, tip_relief_length=1e-3)
    pair = pair_with(KINDS[0], 0, modification=flank)
    model, _ = compose(ContactScene(pair, np.array([100.0]), EFFECTS), {})
    plain = contact_candidates(pair, model, POSITION, PatchRule(0.3e-3, 0.025e-3), Slices.of_pair(pair, 1))
    return pair, model, plain


def test_variants_with_the_same_involutes_have_touching_points_of_their_gaps():
    for relief in (5e-6, 10e-6, 5e-6):
        pair, model, plain = candidates_of(relief)
        exact = modified_touch(pair, plain.touch, plain.face_position, model.gaps)
        cached = with_gaps(pair, plain, model).touch
        assert np.array_equal(cached.gap, exact.gap)
        assert np.array_equal(cached.curvature, exact.curvature)
    assert len(touch_cache._entries) == 2


def test_other_positions_are_found_anew():
    pair, model, plain = candidates_of(5e-6)
    with_gaps(pair, plain, model)
    moved = replace(plain, touch=plain.touch.rows(np.array([1, 0, 2, 3])))
    assert np.array_equal(with_gaps(pair, moved, model).gap[0], with_gaps(pair, plain, model).gap[1])


def test_the_cache_is_bounded(monkeypatch):
    monkeypatch.setattr(touch_cache, "_MAX", 3)
    for relief in np.linspace(1e-6, 9e-6, 6).tolist():
        pair, model, plain = candidates_of(relief)
        with_gaps(pair, plain, model)
    assert len(touch_cache._entries) == 3
    monkeypatch.setattr(touch_cache, "_MAX_BYTES", 0)
    pair, model, plain = candidates_of(2e-5)
    assert np.isfinite(with_gaps(pair, plain, model).gap).any()
    assert not touch_cache._entries
