"""Errors of what excites at one load of a table."""

from dataclasses import replace

import numpy as np
import pytest

from fe_contact import Gear, GearPair, analyze
from fe_contact.analysis.estimates.excitation_errors import excitation_errors
from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.ste.curve_errors import all_sources
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, quantity_changes
from fe_contact.ste.extraction import sliding_sums

FORCES = (1500.0, 3000.0)


def spur_table(**how):
    gear = Gear(25, 2e-3, 20e-3, bore_diameter=20e-3)
    pair = GearPair(gear, gear, reference_center_distance(gear, gear))
    return analyze(pair, normal_forces=FORCES, model="plane_strain", **how)


@pytest.fixture(scope="module")
def rough():
    return spur_table(level="draft", positions=32)


@pytest.mark.law
def test_errors_at_a_stored_load_are_those_of_the_table(rough):
    for load, force in enumerate(FORCES):
        found = excitation_errors(rough, force)
        curve = rough.curve(force=force)
        assert found.transmission_error == pytest.approx([each.error for each in curve.harmonics])
        stated = all_sources(rough.load_arm_error[..., load, 0, 0])
        assert found.load_arm == pytest.approx(stated[FIRST_HARMONIC:])


@pytest.mark.law
def test_friction_of_two_tables_differs_by_no_more_than_both_state(rough):
    """Of a spur pair whose load shares step, on other meshes and at more positions."""
    fine = spur_table(level="standard", positions=256)
    shares = [sliding_sums(table)[0][:, :, 0, 0] for table in (rough, fine)]
    apart = quantity_changes(rough.position, *shares, 1, fine.position)[FIRST_HARMONIC : FIRST_HARMONIC + 6]
    for load, force in enumerate(FORCES):
        stated = sum(excitation_errors(table, force).friction[:6] for table in (rough, fine))
        assert np.all(apart[:, load] <= stated)
        assert np.median(stated / apart[:, load]) < 30.0


@pytest.mark.law
def test_what_a_table_does_not_state_is_unknown(rough):
    older = replace(rough, load_arm_error=np.empty((0,) * 5), curve_error=np.empty((0,) * 5))
    found = excitation_errors(older, FORCES[0])
    for each in (found.transmission_error, found.load_arm, found.friction):
        assert np.isnan(each).all()
