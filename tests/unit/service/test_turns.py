"""Whose turn it is: keys in turn, sliders within a key, submissions first, nobody refused for another."""

import random
from itertools import pairwise

import pytest

from lineofaction.gearbox.problems import QueueFull, Superseded, TooManyHeld
from service.live.order import LiveOrder
from service.live.turns import Asker, Limits, Question, Turns


def question(key: str = "", slider: str | None = None, *, word: str = "", submits: bool = False) -> Question:
    return Question(LiveOrder("entry", {"word": word}), Asker(key, slider, submits))


def turns(**limits: int) -> Turns:
    return Turns(Limits(**{"outstanding": 100, "in_all": 1000} | limits), "questions")


def asked_next(line: Turns) -> str:
    found = line.next()
    line.ended(found)
    return str(found.order.inputs["word"])


def test_a_flood_of_one_key_lets_each_other_key_have_every_second_turn():
    line = turns()
    for number in range(40):
        line.enter(question("flood", word=f"flood {number}"))
    for number in range(3):
        line.enter(question("victim", word=f"victim {number}"))
    assert [asked_next(line) for _ in range(6)] == [
        *("flood 0", "victim 0", "flood 1", "victim 1", "flood 2", "victim 2")
    ]


def test_a_key_has_one_answered_at_a_time():
    line = turns()
    for key in "aab":
        line.enter(question(key, word=key))
    first, second = line.next(), line.next()
    assert (first.asker.key, second.asker.key) == ("a", "b")
    assert line.next() is None
    line.ended(first)
    assert asked_next(line) == "a"


def test_callers_without_a_key_are_answered_at_the_same_time():
    line = turns()
    for word in "ab":
        line.enter(question(word=word))
    assert line.next() is not None and line.next() is not None


def test_a_slider_that_never_rests_keeps_its_turn():
    line = turns()
    oldest = question("key", "slider", word="oldest")
    line.enter(oldest)
    line.enter(question("key", word="other"))
    line.enter(question("key", "slider", word="newest"))
    assert isinstance(oldest.answer.exception(timeout=0), Superseded)
    assert [asked_next(line), asked_next(line)] == ["newest", "other"]


def test_the_name_of_a_slider_means_nothing_beside_another_key():
    line = turns()
    for key in "ab":
        line.enter(question(key, "slider", word=key))
    running = line.next()
    line.enter(question("b", "slider", word="b again"))
    assert running is not None and not running.obsolete
    line.ended(running)
    assert asked_next(line) == "b again"


def test_the_answer_to_an_older_question_of_a_slider_is_obsolete():
    line = turns()
    line.enter(question("key", "slider"))
    running = line.next()
    line.enter(question("key"))
    line.enter(question("key", "another"))
    assert not running.obsolete
    line.enter(question("key", "slider"))
    assert running.obsolete


def test_submissions_come_first_and_hold_their_own_number():
    line = turns(submissions=2)
    line.enter(question("key", word="slider"))
    for word in ("first", "second"):
        line.enter(question("key", word=word, submits=True))
    with pytest.raises(TooManyHeld, match="Key 'key' has 2 questions"):
        line.enter(question("key", submits=True))
    assert [asked_next(line) for _ in range(3)] == ["first", "second", "slider"]


def test_a_key_is_refused_for_its_own_sake_alone():
    line = turns(outstanding=64)
    for number in range(64):
        line.enter(question("flood", f"slider {number}"))
    with pytest.raises(TooManyHeld) as refused:
        line.enter(question("flood"))
    assert (refused.value.status, refused.value.retry_after_s) == (429, 1)
    line.enter(question("flood", "slider 5"))  # in the place of its older one
    line.enter(question("victim"))


def test_so_many_are_held_in_all():
    line = turns(in_all=3)
    for key in "abc":
        line.enter(question(key))
    assert line.next() is not None  # it counts as long as it is answered
    with pytest.raises(QueueFull):
        line.enter(question("d"))


def test_random_askers_are_all_answered_in_turn():
    """Between two answers of a key each other key that waits has one."""
    draw, line = random.Random(75), turns()
    for _ in range(300):
        key = draw.choice("aaaaabc")
        line.enter(question(key, draw.choice([None, *"xyz"]), word=key))
    order = []
    while (found := line.next()) is not None:
        line.ended(found)
        order.append(found.asker.key)
    for key in "abc":
        behind = len(order) - 1 - order[::-1].index(key)
        places = [place for place, name in enumerate(order[: behind + 1]) if name == key]
        assert all(later - former <= 3 for former, later in pairwise(places))
