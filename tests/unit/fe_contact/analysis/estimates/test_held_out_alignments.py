"""Alignments are inserted between those requested until every interval meets the tolerance."""

from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair, Run, SteDatabase, analyze
from fe_contact.analysis import tables
from fe_contact.analysis.checks.table_laws import check_laws
from fe_contact.analysis.database import compute_database
from fe_contact.analysis.estimates import inserted_places, validation_alignments
from fe_contact.analysis.request.request_check import check_request, checked_request
from fe_contact.errors import DatabaseError
from fe_contact.ste.fields import DIMENSIONS

DISTANCE = "center_distance_change"
CHANGES = (0.0, 4e-4)
GRID = tuple(name for name, dimensions in DIMENSIONS.items() if {"position", DISTANCE} <= set(dimensions))
"""Arrays of the contact at the nodes, without load and at support loads as well."""


GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
PAIR = GearPair(GEAR, GEAR, 80e-3)
FIXED = {"model": "plane_strain", "torques": [100.0], "positions": 48, "tolerance": 0.02}


def spur(**options) -> SteDatabase:
    return analyze(PAIR, **(FIXED | options))


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module")
def refined(cache):
    return spur(center_distance_changes=CHANGES, cache=cache)


def requested(table: SteDatabase, name: str) -> np.ndarray:
    axis = DIMENSIONS[name].index(DISTANCE)
    return np.compress(table.requested_rows(DISTANCE), getattr(table, name), axis=axis)


def test_center_distances_are_inserted_until_every_interval_meets_the_tolerance(refined):
    receipt, inserted = refined.metadata.receipt, refined.inserted_center_distance_change
    assert refined.requested_nodes(DISTANCE).tolist() == list(CHANGES)
    assert inserted.size >= 1
    assert receipt["held_out"][DISTANCE]["inserted"] == inserted.tolist()
    assert f"{inserted.size} center distances inserted" in refined.summary()
    assert (receipt["tolerance"]["met"], receipt["tolerance"]["between_nodes"]) == (True, [])


def test_without_halvings_the_interval_is_named_with_its_limit(cache, monkeypatch):
    monkeypatch.setattr(validation_alignments, "MAX_HALVINGS", 0)
    table = spur(center_distance_changes=CHANGES, cache=cache)
    kept = table.metadata.receipt["tolerance"]
    (beyond,) = kept["between_nodes"]
    assert (beyond["axis"], beyond["between"]) == (DISTANCE, list(CHANGES))
    assert kept["met"] is False
    assert kept["reason"].endswith("the limit of 0 halvings is reached")
    assert table.inserted_center_distance_change.size == 0


def test_inserted_nodes_change_nothing_at_those_requested(refined, cache, monkeypatch):
    """They agree with those of a table without to the last bit."""
    monkeypatch.setattr(validation_alignments, "MAX_HALVINGS", 0)
    plain = spur(center_distance_changes=CHANGES, cache=cache)
    for name in GRID:
        assert requested(refined, name).tobytes() == getattr(plain, name).tobytes(), name
    at_nodes = refined.curve_error[:6][..., refined.requested_rows(DISTANCE)]
    assert np.array_equal(at_nodes, plain.curve_error[:6])
    for change in CHANGES:
        ours, theirs = (one.curve(torque=100.0, center_distance_change=change) for one in (refined, plain))
        assert (ours.mean, ours.peak_to_peak) == (theirs.mean, theirs.peak_to_peak)


@pytest.mark.law
def test_a_refined_table_answers_as_one_whose_caller_requested_all_nodes(refined, cache):
    whole = spur(center_distance_changes=refined.center_distance_change, cache=cache)
    assert whole.inserted_center_distance_change.size == 0
    for name in set(GRID) - {"error_estimate"}:  # interpolated at inserted nodes
        assert getattr(refined, name).tobytes() == getattr(whole, name).tobytes(), name
    for change in (3e-5, 1.7e-4, 3.9e-4):
        for torque in (70.0, 100.0):
            point = {"torque": torque, "center_distance_change": change}
            ours, theirs = (one.curve(**point) for one in (refined, whole))
            assert np.array_equal(ours.ste, theirs.ste)


@pytest.mark.law
def test_what_is_said_of_an_interval_holds_where_nothing_was_solved(refined, cache):
    for change in (3e-5, 1.1e-4, 2.2e-4, 3.3e-4):
        truth = spur(center_distance_changes=[change], cache=cache)
        ours, true = (one.curve(torque=100.0, center_distance_change=change) for one in (refined, truth))
        assert ours.interval_error > 0.0
        assert np.mean(np.abs(ours.ste - true.ste) > ours.error) <= 0.05
        for figure in ("mean", "peak_to_peak"):
            value, exact = getattr(ours, figure), getattr(true, figure)
            assert abs(value.value - exact.value) <= min(value.error, max(0.02 * exact.value, 20e-9))


def test_the_file_keeps_what_was_inserted(refined, tmp_path):
    refined.to_netcdf(tmp_path / "STE.nc")
    again = SteDatabase.from_netcdf(tmp_path / "STE.nc")
    assert again.identical(refined)
    assert again.inserted_center_distance_change.tolist() == refined.inserted_center_distance_change.tolist()
    marks = refined.to_xarray()["center_distance_inserted"]
    assert (marks.dims, int(marks.sum())) == ((DISTANCE,), refined.inserted_center_distance_change.size)


def test_nothing_is_solved_twice(cache, monkeypatch):
    """Operating points of the table are those of its axis, each solved once at all positions."""
    solved: list[float] = []

    def counted(original):
        def solve(points, *rest, **options):
            solved.extend(place.contact.pair.center_distance for place in points.places)
            return original(points, *rest, **options)

        return solve

    for module in (tables, inserted_places):
        monkeypatch.setattr(module, "solve_operating_points", counted(module.solve_operating_points))
    table = spur(center_distance_changes=CHANGES, cache=cache)
    assert len(table.metadata.receipt["passes"]) == 1
    assert sorted(solved) == pytest.approx(0.08 + table.center_distance_change, rel=1e-12)


def test_laws_are_checked_with_what_was_inserted(cache, monkeypatch):
    sizes = []

    def checked(table, *contact):
        sizes.append(table.center_distance_change.size)
        return check_laws(table, *contact)

    monkeypatch.setattr(compute_database, "check_laws", checked)
    table = spur(center_distance_changes=CHANGES, cache=cache)
    assert sizes == [2, table.center_distance_change.size]
    assert table.center_distance_change.size > 2


def test_a_study_that_reads_nodes_alone_gets_nothing_between_them(cache):
    axes, options = table_request(center_distance_changes=CHANGES, **FIXED)
    checked = check_request(PAIR, axes, options)
    alone = checked_request(replace(checked.request, nodes_alone=True))
    table = analyze(alone, run=Run(cache=cache))
    assert table.center_distance_change.tolist() == list(CHANGES)
    assert table.metadata.receipt["tolerance"]["used_at_nodes"] <= 1.0


def test_misalignments_are_inserted_until_every_interval_meets_the_tolerance(tmp_path):
    def gear(hand):
        flank = FlankModification(helix_crowning=4e-6)
        return Gear(24, 2e-3, 15e-3, 24e-3, helix_angle=hand * 0.3, modification=flank)

    def helical(skews, force):
        pair = GearPair(gear(1.0), gear(-1.0), 48e-3 / np.cos(0.3))
        wish = {"tolerance": 0.05, "model": "3d", "cache": tmp_path}
        return analyze(pair, normal_forces=force, misalignments=skews, **wish)

    load = 900.0
    table = helical((0.0, 2e-5), [load])
    inserted = table.inserted_misalignment
    assert table.metadata.receipt["tolerance"]["met"] is True
    assert inserted.size >= 1
    assert table.requested_nodes("misalignment").tolist() == [0.0, 2e-5]
    assert table.metadata.receipt["held_out"]["misalignment"]["inserted"] == inserted.tolist()
    for skew in (2e-6, 9e-6, 1.6e-5):
        truth = helical((skew,), [load])
        ours, true = (one.curve(force=load, misalignment=skew) for one in (table, truth))
        for figure in ("mean", "peak_to_peak"):
            value, exact = getattr(ours, figure), getattr(true, figure)
            assert abs(value.value - exact.value) <= min(value.error, max(0.05 * exact.value, 20e-9))


def test_marks_are_as_long_as_their_axis(refined):
    with pytest.raises(DatabaseError, match="center_distance_inserted must have the dimension"):
        replace(refined, center_distance_inserted=np.zeros(1))
