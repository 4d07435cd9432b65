"""Errors at nodes are linear between them; those of an interval are nothing on its nodes."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from fe_contact.ste.node_errors import NodePlaces, error_band

AXES = ("force", "misalignment", "center_distance_change")


@pytest.fixture(scope="module")
def table(make):
    made = make(misalignment=np.array([-20e-6, 0.0, 30e-6]), center_distance_change=np.array([-1e-4, 2e-4]))
    draw = np.random.default_rng(4)
    shape = made.static_transmission_error.shape
    errors = {"error_estimate": shape, "interval_error": (3, *shape[1:])}
    return replace(made, **{name: draw.uniform(1e-9, 1e-7, size) for name, size in errors.items()})


def drawn(table, count=50):
    draw = np.random.default_rng(9)
    return [draw.uniform(getattr(table, axis)[0], getattr(table, axis)[-1], count) for axis in AXES]


def test_errors_that_are_linear_along_every_axis_are_reproduced(table):
    nodes = np.meshgrid(*(getattr(table, axis) / getattr(table, axis)[-1] for axis in AXES), indexing="ij")
    at = drawn(table)
    parts = [x / getattr(table, axis)[-1] for x, axis in zip(at, AXES, strict=True)]

    def linear(a, b, c):
        return 5.0 + 2.0 * a - b + 3.0 * c + 0.5 * a * b * c

    assert NodePlaces.of(table, *at).at_nodes(linear(*nodes)) == pytest.approx(linear(*parts), rel=1e-12)


def test_a_node_has_its_own_error_beside_unknown_ones(table):
    values = np.full(table.interval_error.shape[1:], np.nan)
    nodes = list(product(*(range(size) for size in values.shape)))
    for node in nodes[:: len(nodes) // 7]:
        values[node] = 7e-9
        at = (np.array([getattr(table, axis)[k]]) for axis, k in zip(AXES, node, strict=True))
        assert NodePlaces.of(table, *at).at_nodes(values).tolist() == [7e-9]
        values[node] = np.nan


def test_interpolation_has_no_error_on_the_nodes_of_its_axis_and_that_of_its_interval_elsewhere(table):
    force, skew, _ = drawn(table)
    lower = np.searchsorted(table.misalignment, skew) - 1
    places = NodePlaces.of(
        table, np.full(50, table.force[1]), skew, np.full(50, table.center_distance_change[0])
    )
    assert places.interval_error(table).tolist() == table.interval_error[1, 1, lower, 0].tolist()
    on_nodes = NodePlaces.of(
        table, force, np.resize(table.misalignment, 50), np.resize(table.center_distance_change, 50)
    )
    of_force = on_nodes.of_interval(table.interval_error[0], 0)
    assert np.array_equal(on_nodes.interval_error(table), of_force) and np.all(of_force > 0.0)
    beyond = NodePlaces.of(table, force[:1], np.array([1.0]), np.array([-1.0]))
    assert beyond.outside.tolist() == [True]
    assert beyond.of_interval(table.interval_error[1], 1).tolist() == [0.0]


def test_many_points_have_the_bands_of_each_alone(table):
    at, position = drawn(table), np.random.default_rng(2).uniform(-1.0, 2.0, 50)
    together = error_band(table, position, NodePlaces.of(table, *at))
    alone = [
        error_band(table, position[[k]], NodePlaces.of(table, *(values[[k]] for values in at)))[0]
        for k in range(50)
    ]
    assert together == pytest.approx(alone, rel=1e-12)
    curve = table.curve(
        force=float(at[0][3]),
        misalignment=float(at[1][3]),
        center_distance_change=float(at[2][3]),
        at=position,
    )
    assert curve.error[3] == pytest.approx(together[3], rel=1e-12)
