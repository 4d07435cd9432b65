"""Tooth deviations of scenes: what tables of many pitches hold, and what nominal ones leave out."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from geared_scenes import Table, gear_pair_scene, repeated, spring_table, with_mesh

from dynamics import Scene, forced_response
from dynamics.assembly.assemble import assemble
from dynamics.influence import estimate_influences
from dynamics.meshes.nominal_table import nominal_table, table_as_made
from fe_contact import Gear
from fe_contact.geometry.flank_tolerances import run_out_tolerance

STIFFNESS, RIPPLE, ECCENTRICITY, TEETH = 4e8, 1e-6, 10e-6, 20
NAME = "tooth_deviations"


def eccentric(period: int = TEETH) -> Table:
    """A spring table of one revolution, its error that of the mesh and of an eccentric pinion."""
    table = repeated(spring_table(STIFFNESS, RIPPLE), period)
    angle = 2.0 * np.pi * table.position / period
    error = ECCENTRICITY * np.cos(angle)[:, None]
    slope = -ECCENTRICITY * 2.0 * np.pi / period * np.sin(angle)[:, None]
    return replace(
        table, deflection=table.deflection + error, deflection_slope=table.deflection_slope + slope
    )


def entry_of(scene: Scene) -> Any:
    (entry,) = assemble(scene).ledger.of(NAME)
    return entry


def test_the_mean_of_all_pitches_is_the_table_of_nominal_teeth():
    """A wave that closes over the period has no part in it."""
    made, nominal = eccentric(), spring_table(STIFFNESS, RIPPLE)
    mean = nominal_table(made)
    assert mean.period == 1 and table_as_made(mean) is made and nominal_table(mean) is mean
    np.testing.assert_allclose(mean.position, nominal.position)
    for name in ("deflection", "deflection_slope", "stiffness", "stiffness_slope"):
        value = getattr(nominal, name)
        np.testing.assert_allclose(getattr(mean, name), value, atol=1e-12 * np.max(np.abs(value)) + 1e-18)


def test_a_table_of_many_pitches_switches_it_on_with_its_size():
    entry = entry_of(gear_pair_scene(eccentric()))
    assert entry.on and entry.possible and "after 20 base pitches" in entry.reason
    assert entry.influence == pytest.approx(ECCENTRICITY, rel=1e-9)


def test_off_it_leaves_the_scene_of_nominal_teeth():
    """No order of a shaft remains, and the mesh orders are those of the nominal table."""
    speed = np.array([150.0, 200.0])
    off = forced_response(assemble(gear_pair_scene(eccentric(), effects={NAME: "off"})), speed, 3)
    nominal = forced_response(assemble(gear_pair_scene(spring_table(STIFFNESS, RIPPLE))), speed, 3)
    np.testing.assert_array_equal(off.order, nominal.order)
    np.testing.assert_allclose(off.bearing_force, nominal.bearing_force, rtol=1e-9, atol=1e-9)
    entry = entry_of(gear_pair_scene(eccentric(), effects={NAME: "off"}))
    assert not entry.on and entry.possible and "10 µm" in entry.price


@pytest.mark.parametrize("choice", ["auto", "off"])
def test_its_influence_is_estimated_whatever_is_chosen(choice):
    """The order of the shaft goes, with all of its level, whether the scene has it or not."""
    found = estimate_influences(gear_pair_scene(eccentric(), effects={NAME: choice}))[NAME]
    assert found.on == (choice == "auto")
    np.testing.assert_allclose(found.peak_to_peak, -2.0 * ECCENTRICITY, rtol=0.15)
    assert found.level.order == pytest.approx(1.0 / TEETH) and found.level.decibels < -59.0


def test_nominal_teeth_say_what_the_run_out_of_a_class_would_be():
    """Half of F_r of ISO 1328-1 on both gears, beside the mesh order of the table; nothing switches it on."""
    gear = Gear(teeth=TEETH, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    half = 0.5 * run_out_tolerance(gear, 6)
    for choice in ("auto", "on", "off"):
        entry = entry_of(gear_pair_scene(spring_table(STIFFNESS, RIPPLE), effects={NAME: choice}))
        assert not entry.on and not entry.possible
        assert entry.influence == pytest.approx(2.0 * half, abs=0.5e-6)  # the tolerance is rounded
        assert "class 6 (assumed)" in entry.reason and entry.reason.endswith("mesh order 1, 0.999 µm")


def test_knots_that_differ_from_pitch_to_pitch_have_no_mean():
    table = eccentric()
    moved = replace(table, position=table.position + 1e-3 * np.sin(np.pi * table.position / TEETH))
    entry = entry_of(with_mesh(gear_pair_scene(), table=moved))
    assert nominal_table(moved) is moved and entry.on and not entry.possible
