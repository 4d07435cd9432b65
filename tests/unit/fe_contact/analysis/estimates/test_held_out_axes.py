"""What a table says of its error between the nodes of its axes is what it misses there."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from fe_contact import Gear, GearPair, Status, analyze
from fe_contact.analysis.estimates.validation_alignments import AWAY as AWAY_BETWEEN_ALIGNMENTS
from fe_contact.analysis.estimates.validation_axes import validation_axes
from fe_contact.analysis.estimates.validation_loads import AWAY

TORQUES = (50.0, 100.0, 200.0)
CHANGES = (0.0, 2e-4, 4e-4)


@pytest.fixture(scope="module")
def made():
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)

    def make(**options):
        arguments = {"torques": TORQUES, "level": "draft", "positions": 32, "model": "plane_strain"} | options
        return analyze(GearPair(gear, gear, 80e-3), **arguments)

    return make


@pytest.fixture(scope="module")
def coarse(made):
    return made(center_distance_changes=CHANGES)


def stated(table, axis):
    """Held-out points (I,) and errors (I, L) in m."""
    found = table.metadata.receipt["held_out"][axis]
    return np.array(found["at"]), np.array(found["error_m"])


def missed(table, truth):
    """Largest difference (L,) over the positions, of a table and one solved where it has no node."""
    force = truth.force[None, :]
    place = (truth.position[:, None], force, truth.misalignment[0], truth.center_distance_change[0])
    return np.abs(table.ste(*place) - truth.static_transmission_error[..., 0, 0]).max(axis=0)


def test_axes_of_one_node_have_no_error_and_more_nodes_less(made, coarse):
    assert made(torques=[100.0]).metadata.receipt["held_out"] == {}
    assert set(made().metadata.receipt["held_out"]) == {"force"}
    dense = made(center_distance_changes=np.linspace(0.0, 4e-4, 17))
    few, many = (stated(table, "center_distance_change")[1].max() for table in (coarse, dense))
    assert many < 0.5 * few


def test_the_points_are_the_middles_and_the_error_what_is_missed_there(coarse, made):
    assert stated(coarse, "center_distance_change")[0] == pytest.approx([1e-4, 3e-4])
    at, error = stated(coarse, "force")
    assert at == pytest.approx(np.sqrt(coarse.force[:-1] * coarse.force[1:]))
    assert error.shape == (2, 1)
    assert stated(coarse, "center_distance_change")[1].shape == (2, 3)
    # another way to the same number
    for k, change in enumerate((1e-4, 3e-4)):
        error = stated(coarse, "center_distance_change")[1][k]
        there = missed(coarse, made(center_distance_changes=[change]))
        assert error == pytest.approx(AWAY_BETWEEN_ALIGNMENTS * there, rel=1e-9)


def test_the_estimate_of_a_coarse_axis_covers_the_true_error_all_over_its_intervals(coarse, made):
    error = stated(coarse, "center_distance_change")[1]
    truths = [made(center_distance_changes=[change]) for change in (0.5e-4, 1.5e-4, 2.5e-4, 3.5e-4)]
    found = [missed(coarse, truth) for truth in truths]
    assert np.max(found) <= 1.3 * error.max()
    assert np.max(found) > 1e-7  # of 10 um: the axis is coarse


@pytest.mark.law
def test_the_estimate_between_loads_covers_the_true_error(coarse, made):
    error = stated(coarse, "force")[1]
    truths = {}
    for part in (0.25, 0.4, 0.5, 0.6, 0.75):
        between = coarse.force[:-1] ** (1.0 - part) * coarse.force[1:] ** part
        alike = np.append(between, coarse.force[-1])  # the largest load decides on the patches
        truths[part] = missed(coarse, made(torques=None, normal_forces=alike))[:-1]
    probed = np.max([truths[part] for part in (0.25, 0.5, 0.75)], axis=0)
    assert error[:, 0] == pytest.approx(AWAY * probed, rel=1e-6)
    assert np.all(np.max([truths[0.4], truths[0.6]], axis=0) <= error[:, 0])


def test_a_point_between_the_loads_states_the_error_of_its_interval(coarse, made):
    """The band and the figures of a curve between two loads cover what is solved there."""
    load = float(np.sqrt(coarse.force[0] * coarse.force[1]))
    between, at_node = coarse.curve(force=load), coarse.curve(force=float(coarse.force[0]))
    below, above = coarse.error_estimate[:, :2, 0, 0].T
    part = (load - coarse.force[0]) / (coarse.force[1] - coarse.force[0])
    error = stated(coarse, "force")[1][0, 0]
    assert coarse.interval_error.shape == (3, *coarse.static_transmission_error.shape[1:])
    assert between.interval_error == pytest.approx(error, rel=1e-12)
    assert between.error == pytest.approx((1.0 - part) * below + part * above + error, rel=1e-9)
    assert at_node.interval_error == 0.0
    assert np.all(at_node.error == coarse.error_estimate[:, 0, 0, 0])
    truth = made(torques=None, normal_forces=[load, float(coarse.force[-1])]).curve(force=load)
    assert np.all(np.abs(between.ste - truth.ste) <= between.error)


def test_misalignment_in_three_dimensions(made):
    """Nodes at the held-out points turn the stated error into a stored difference."""
    options = {"model": "3d", "torques": [100.0], "positions": 16}
    quarters = np.array([1.5e-5, 3e-5, 4.5e-5])
    two, five = (made(**options, misalignments=axis) for axis in ([0.0, 6e-5], [0.0, *quarters, 6e-5]))
    at, error = stated(two, "misalignment")
    assert at == pytest.approx([3e-5])
    tabulated = two.ste(two.position[:, None], float(two.force[0]), quarters)
    found = np.abs(tabulated - five.static_transmission_error[:, 0, 1:4, 0]).max()
    assert error[0, 0] == pytest.approx(AWAY_BETWEEN_ALIGNMENTS * found, rel=1e-9)
    assert error[0, 0] > 1e-6
    assert stated(five, "misalignment")[1].max() < 0.5 * error[0, 0]


def test_a_table_that_cannot_be_interpolated_has_no_estimate(coarse):
    ste, status = coarse.static_transmission_error.copy(), coarse.status.copy()
    ste[0, 0, 0, 0], status[0, 0, 0, 0] = np.nan, Status.SINGULAR
    failed = replace(coarse, static_transmission_error=ste, status=status)
    falling = replace(
        coarse, static_transmission_error=coarse.static_transmission_error[:, ::-1], support_force=np.empty(0)
    )
    for table in (failed, falling):
        assert validation_axes(SimpleNamespace(table=table)).axes == {}
    with pytest.raises(AttributeError):  # a good table asks its places
        validation_axes(SimpleNamespace(table=coarse))
