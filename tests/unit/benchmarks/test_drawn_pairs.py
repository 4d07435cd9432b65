"""Pairs drawn at random are the same every time, of the kinds that are promised, and none is drawn twice."""

from benchmarks.drawn_pairs import assessed_pairs, drawn_pairs, fresh_pairs, in_plane
from fe_contact.analysis.request.request_check import check_request


def test_a_seed_has_the_same_pairs_every_time_and_more_of_them_begin_alike():
    assert repr(drawn_pairs(7, 5)) == repr(drawn_pairs(7, 8)[:5])
    assert repr(drawn_pairs(7, 5)) != repr(drawn_pairs(8, 5))


def test_of_ten_five_are_helical_three_misaligned_and_one_internal():
    cases = drawn_pairs(3, 10)
    assert sum(case.pair.base_helix_angle != 0.0 for case in cases) == 5
    assert sum("misalignments" in case.options for case in cases) == 3
    assert sum(case.pair.internal for case in cases) == 1


def test_none_of_the_fresh_pairs_is_among_the_others():
    assert not {repr(case.pair) for case in assessed_pairs()} & {repr(case.pair) for case in fresh_pairs()}


def test_the_plane_is_what_the_effects_choose():
    for case in drawn_pairs(3, 10):
        checked = check_request(case.pair, *case.request(level="draft"))
        assert checked.model.across_face is not in_plane(case)
