"""Support loads: the force axis is what was asked, the extraction rests on more."""

import dataclasses

import numpy as np
import pytest

from fe_contact import Gear, GearPair, SteDatabase, analyze
from fe_contact.errors import DatabaseError
from fe_contact.ste import Validity


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


@pytest.fixture(scope="module")
def pair():
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    return GearPair(gear, gear, 80e-3)


@pytest.fixture(scope="module")
def table(pair, cache):
    return analyze(pair, torques=[100.0], level="draft", positions=32, cache=cache)


def test_the_force_axis_is_what_was_asked(table):
    assert table.torque == pytest.approx([100.0])
    assert table.support_force[0] < 2e-3 * table.force[0]
    assert table.support_force[-1] == pytest.approx(2.0 * table.force[0])


def test_loads_below_and_above_the_only_asked_one_are_true(table, pair, cache):
    """A solve at 30 and 150 N m is met by the table of 100 N m alone, outside the moving handover."""
    solved = analyze(pair, torques=[30.0, 150.0], level="draft", positions=32, cache=cache)
    steady = (np.abs(table.position - 0.5) < 0.2) | (np.abs((table.position + 0.5) % 1.0 - 0.5) < 0.12)
    for k, force in enumerate(solved.force):
        expected = solved.static_transmission_error[steady, k, 0, 0]
        assert table.ste(table.position[steady], force) == pytest.approx(expected, rel=2e-3)


def test_validity_ends_at_the_highest_support_load(table):
    at = np.array([0.4])
    inside = table.force_at(at, table.ste(at, 1.9 * table.force[0]))
    above = table.force_at(at, table.ste(at, 2.1 * table.force[0]))
    assert inside.validity[0] == Validity.INSIDE
    assert above.validity[0] == Validity.ABOVE_TABLE


def test_the_file_keeps_them(table, tmp_path):
    table.to_netcdf(tmp_path / "table.nc")
    assert SteDatabase.from_netcdf(tmp_path / "table.nc").identical(table)


def test_a_support_load_may_not_repeat_a_stored_one(table):
    with pytest.raises(DatabaseError, match="support_force"):
        dataclasses.replace(
            table,
            support_force=table.force,
            support_transmission_error=table.static_transmission_error,
            support_tangent_compliance=table.tangent_compliance,
            support_pairs_in_contact=table.pairs_in_contact,
        )
