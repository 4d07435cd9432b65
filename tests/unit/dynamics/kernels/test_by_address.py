"""Tuples by address read and write as the tuples do; routines are compiled for the scenes that need them."""

import pickle
from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table

from dynamics.assembly.assemble import assemble
from dynamics.forces import SpeedTorque
from dynamics.forces import elements as element_laws
from dynamics.forces.laws import Law
from dynamics.kernels.by_address import by_address, by_value
from dynamics.kernels.compiled import compiled
from dynamics.kernels.routine import routine
from dynamics.loads import SpeedCurve
from dynamics.loads.speed_torque_law import SpeedTorqueLaws


class Inside(NamedTuple):
    table: np.ndarray
    yes: np.ndarray


class Whole(NamedTuple):
    rate: float
    count: int
    on: bool
    inside: Inside
    location: np.ndarray
    block: np.ndarray


def whole(on=True):
    rng = np.random.default_rng(0)
    inside = Inside(rng.normal(size=(3, 4)), np.array([True, False]))
    return Whole(-2.5e-3, -7, on, inside, np.arange(5), rng.normal(size=(2, 3, 4)))


@compiled
def read(whole_tuple: Whole, found: np.ndarray) -> None:
    found[0], found[1], found[2] = whole_tuple.rate, whole_tuple.count, whole_tuple.on
    found[3], found[4] = whole_tuple.inside.table[2, 3], whole_tuple.inside.table[-1, 0]
    found[5], found[6] = whole_tuple.inside.yes[0], whole_tuple.inside.yes[1]
    found[7], found[8] = whole_tuple.location[4], whole_tuple.block[1, 2, 3]
    found[9], found[10] = whole_tuple.block.size, whole_tuple.block.shape[1]
    row = whole_tuple.block[1]
    found[11] = row[2, 0] + whole_tuple.inside.table[1].sum()
    column = whole_tuple.inside.table[:, 1]
    found[12] = column[2]
    whole_tuple.block[0, 0, 0] = 42.0


@routine
def doubled(whole_tuple: Whole, factor: float, count: int) -> tuple[float, float]:
    return 2.0 * factor * whole_tuple.rate, float(count)


@compiled
def call(whole_tuple: Whole, found: np.ndarray) -> None:
    found[0], found[1] = doubled(whole_tuple, 3, 4)
    found[2], found[3] = doubled(whole_tuple, 5, 6)


@pytest.mark.parametrize("on", [True, False])
def test_compiled_functions_read_the_same_and_write_into_the_same_arrays(on):
    value, found = whole(on), np.zeros((2, 13))
    read(value, found[0])
    whole_tuple = by_address(value)
    read(whole_tuple, found[1])
    np.testing.assert_array_equal(found[0], found[1])
    assert found[1, 0] == -2.5e-3
    assert found[1, 1:3].tolist() == [-7.0, float(on)]
    assert value.block[0, 0, 0] == 42.0
    assert whole_tuple.inside.table is value.inside.table
    assert by_value(whole_tuple) is value
    assert by_address(whole_tuple) is whole_tuple


def test_numbers_of_numpy_are_numbers():
    value, found = whole(), np.zeros((2, 13))
    read(by_address(value), found[0])
    read(
        by_address(value._replace(rate=np.float64(-2.5e-3), count=np.int32(-7), on=np.bool_(True))), found[1]
    )
    np.testing.assert_array_equal(found[0, :12], found[1, :12])


def test_arrays_that_may_not_be_written_have_an_address_too():
    value, found = whole(), np.zeros((2, 13))
    read(value, found[0])
    value.inside.table.flags.writeable = False
    read(by_address(value), found[1])
    np.testing.assert_array_equal(found[0], found[1])


def test_an_address_does_not_outlive_its_process():
    whole_tuple = pickle.loads(pickle.dumps(by_address(whole())))
    found = np.zeros(13)
    read(whole_tuple, found)
    assert found[3] == whole().inside.table[2, 3]


def test_layouts_that_compiled_functions_would_misread_are_refused():
    by_address(whole())
    with pytest.raises(TypeError, match="C-contiguous"):
        by_address(whole()._replace(block=np.zeros((4, 3, 2)).T))
    with pytest.raises(TypeError, match="other arrays"):
        by_address(whole()._replace(location=np.zeros(5)))


def test_a_routine_runs_once_it_is_prepared_as_often_as_it_is_called():
    whole_tuple, found = by_address(whole()), np.zeros(4)
    with pytest.raises(RuntimeError, match="prepared"):
        call(whole_tuple, found)
    doubled.prepare(whole_tuple)
    call(whole_tuple, found)
    assert found[:2].tolist() == [6.0 * whole_tuple.rate, 4.0] == list(doubled(whole_tuple, 3, 4))
    assert found[2:].tolist() == [10.0 * whole_tuple.rate, 6.0]


def test_a_scene_prepares_the_laws_it_has_and_no_others(monkeypatch):
    prepared = []

    class Noted:
        prepared = False

        def __init__(self, law):
            self.law = law

        def prepare(self, laws, local):
            prepared.append((self.law, type(by_value(laws))))

    rows = {law: SimpleNamespace(routines=(Noted(law),) if law != Law.FLANK else ()) for law in Law}
    monkeypatch.setattr(element_laws, "COMPILED", rows)
    scene = gear_pair_scene(square_wave_table())
    assemble(scene)
    assert prepared == []
    assemble(replace(scene, speed_torques=(SpeedTorque("fan", "output", SpeedCurve.quadratic(1.0, 100.0)),)))
    assert prepared == [(Law.SPEED_TORQUE, SpeedTorqueLaws)]


def test_a_scene_that_comes_to_another_process_prepares_its_laws_there(monkeypatch):
    system = pickle.dumps(assemble(gear_pair_scene(square_wave_table())))
    monkeypatch.setattr(element_laws.evaluate_all, "_slot", np.zeros(1, dtype=np.int64))
    pickle.loads(system)
    assert element_laws.evaluate_all.prepared
