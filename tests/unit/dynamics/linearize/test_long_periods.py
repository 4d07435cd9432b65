"""Tables of long periods: the response of one that repeats a short one, which lines are solved in, memory."""

import sys
import tracemalloc
from dataclasses import fields

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_mesh
from long_tables import repeated

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import ForcedResponse, flank_transfer, forced_response
from dynamics.linearize.strongest_lines import ALWAYS
from dynamics.meshes.grid_tables import GridTables

SPEED = np.linspace(20.0, 200.0, 50)
LONG = 67


def ripple():
    return spring_table(4e8, 1e-7)


def response(table, orders=10, speed=SPEED):
    scene = with_mesh(gear_pair_scene(table), damping_ratio=0.05, damping=None)
    return forced_response(assemble(scene), speed, orders)


@pytest.fixture
def few(monkeypatch):
    """As many lines as every response has."""
    monkeypatch.setattr("dynamics.linearize.strongest_lines.MAX_AMPLITUDES", 0.0)


def test_a_long_table_that_repeats_a_short_one_has_its_response(few):
    short, long = response(ripple()), response(repeated(ripple(), LONG))
    assert LONG * 10 > ALWAYS
    assert 0.0 <= long.metadata["lines_left_out"]["force"] <= 1.0
    shared = np.isin(np.round(long.order, 9), np.round(short.order, 9))
    assert np.count_nonzero(shared) == short.order.size
    for name in ("static_transmission_error", "dynamic_transmission_error", "mesh_force", "displacement"):
        expected, found = getattr(short, name), getattr(long, name)[..., shared]
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * np.max(np.abs(expected)))
        rest = getattr(long, name)[..., ~shared]
        assert np.max(np.abs(rest), initial=0.0) < 1e-6 * np.max(np.abs(expected))  # of fewer samples


def test_of_a_long_period_every_mesh_order_keeps_its_strongest_lines_and_says_what_it_leaves_out(few):
    errors = 1e-6 * np.random.default_rng(1).normal(size=LONG)
    found = response(repeated(ripple(), LONG, errors))
    whole = found.order.size + found.metadata["lines_left_out"]["count"]
    assert 9.8 * LONG < whole <= 10 * LONG  # a pitch alone has no mesh orders but that of the ripple
    assert 0.9 * ALWAYS < found.order.size <= ALWAYS + 10
    assert 0.0 < found.metadata["lines_left_out"]["force"] < 0.5
    assert 1.0 in found.order
    in_order = np.bincount(np.rint(found.order).astype(int), minlength=11)
    assert in_order[1:-1].min() >= 0.6 * LONG
    assert "lines_left_out" not in response(repeated(ripple(), 3, errors[:3])).metadata


def test_its_lines_are_those_of_the_same_response_in_all_lines(monkeypatch):
    table = repeated(ripple(), LONG, 1e-6 * np.random.default_rng(1).normal(size=LONG))
    every = response(table)
    monkeypatch.setattr("dynamics.linearize.strongest_lines.MAX_AMPLITUDES", 0.0)
    some = response(table)
    assert every.order.size > ALWAYS and "lines_left_out" not in every.metadata
    own = np.isin(np.round(every.order * LONG), np.round(some.order * LONG))
    for field in fields(ForcedResponse):
        if field.metadata.get("stored") and field.metadata["stored"].dimensions[-1:] == ("order",):
            expected, value = getattr(every, field.name), getattr(some, field.name)
            if expected.size:
                size = np.max(np.abs(expected[..., own]))
                np.testing.assert_allclose(
                    value, expected[..., own], rtol=0.0, atol=1e-12 * max(size, 1e-300)
                )


def test_fewer_speeds_hold_more_lines(monkeypatch):
    table = repeated(ripple(), LONG, 1e-6 * np.random.default_rng(1).normal(size=LONG))
    freedoms = len(response(table, speed=SPEED[:2]).freedom)
    monkeypatch.setattr("dynamics.linearize.strongest_lines.MAX_AMPLITUDES", 12.0 * freedoms * ALWAYS)
    lines, left = zip(*(_held(response(table, speed=SPEED[:count])) for count in (50, 10, 5)), strict=True)
    assert lines[0] < lines[1] < lines[2] and left[0] > left[1] > left[2] == 0.0


def _held(found):
    return found.order.size, found.metadata.get("lines_left_out", {"force": 0.0})["force"]


def peak_of(work):
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_hunting_cycle_of_1541_pitches_takes_no_more_memory_than_its_lines():
    errors = 1e-6 * np.random.default_rng(1).normal(size=1541)
    table = repeated(ripple(), 1541, errors)
    scene = assemble(with_mesh(gear_pair_scene(table), damping_ratio=0.05, damping=None))
    found = forced_response(scene, SPEED)
    lines = found.displacement.nbytes
    assert peak_of(lambda: forced_response(scene, SPEED)) < 6 * lines + 60e6


def test_what_cannot_be_held_is_refused_before_it_is_solved(monkeypatch):
    module = sys.modules["dynamics.linearize.forced_response"]  # a function of the package has its name
    monkeypatch.setattr(module, "varied_vibration", lambda *_: pytest.fail("solved"))
    table = repeated(ripple(), LONG, 1e-6 * np.random.default_rng(1).normal(size=LONG))
    with pytest.raises(InputError, match=r"speed.*at most \d+ values in \d+ orders.*8 GB.*wider steps"):
        response(table, speed=np.linspace(1.0, 200.0, 100_000))


def test_transfer_functions_are_those_of_the_strongest_lines(monkeypatch):
    table = repeated(ripple(), LONG, 1e-6 * np.random.default_rng(1).normal(size=LONG))
    system = assemble(with_mesh(gear_pair_scene(table), damping_ratio=0.05, damping=None))
    every = flank_transfer(system, SPEED)
    monkeypatch.setattr("dynamics.linearize.strongest_lines.MAX_AMPLITUDES", 0.0)
    some = flank_transfer(system, SPEED)
    assert every.harmonics.size > ALWAYS >= some.harmonics.size
    assert np.all(np.isin(LONG * np.arange(1, 11), some.harmonics))
    own = np.isin(every.harmonics, some.harmonics)
    np.testing.assert_array_equal(some.bearing_force, every.bearing_force[:, :, :, own])


def test_transfer_functions_that_cannot_be_held_are_refused_before_they_are_solved(monkeypatch):
    monkeypatch.setattr("dynamics.linearize.transfer.with_receptances", lambda *_: pytest.fail("solved"))
    system = assemble(gear_pair_scene(repeated(ripple(), LONG)))
    with pytest.raises(InputError, match=r"speed.*at most \d+ values in \d+ orders.*8 GB.*wider steps"):
        flank_transfer(system, np.linspace(1.0, 200.0, 50_000))


def test_a_table_is_laid_out_in_little_more_than_its_numbers():
    table = repeated(ripple(), 500)
    whole = sum(part.nbytes for part in _arrays(GridTables.packed([table])))
    peak = peak_of(lambda: GridTables.packed([repeated(ripple(), 500)]))
    assert peak < 1.6 * whole


def _arrays(packed):
    for part in packed:
        if isinstance(part, np.ndarray):
            yield part
        else:
            yield from (each for each in part.value if isinstance(each, np.ndarray))
