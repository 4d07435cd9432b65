"""Maps of teeth as made: what stands out stands out by its amount, at its tooth and its place."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact import Gear, GearPair, PitchDeviation, RunOut, ToothFlank
from fe_contact.effects import EFFECTS, ContactScene, compose
from lineofaction.report.drawing.figure import HeatMap, Panel
from lineofaction.report.teeth_as_made import excess_of_teeth, teeth_as_made

PAIR = GearPair(*(Gear(z, normal_module=2e-3, face_width=20e-3, bore_diameter=16e-3) for z in (19, 28)))


def made(name, **fields):
    return replace(PAIR, **{name: replace(getattr(PAIR, name), **fields)})


def shades(pair):
    panels = [panel for figure in teeth_as_made(pair) for panel in figure.content]
    assert all(isinstance(panel, Panel) and isinstance(panel.shade, HeatMap) for panel in panels)
    return [panel.shade for panel in panels]


def test_designed_teeth_have_no_map():
    assert teeth_as_made(PAIR) == ()
    assert teeth_as_made(made("wheel", pitch_deviation=PitchDeviation((0.0,) * 28))) == ()


@pytest.mark.parametrize("name", ["pinion", "wheel"])
def test_a_tooth_that_stands_out_is_marked_at_its_number(name):
    teeth = getattr(PAIR, name).teeth
    late = [0.0] * teeth
    late[6] = 5e-6
    (all_teeth,) = shades(made(name, pitch_deviation=PitchDeviation(tuple(late))))
    transverse = 5.0 * math.cos(PAIR.pinion.transverse_pressure_angle)
    np.testing.assert_allclose(all_teeth.z[:, 6], transverse)
    assert not np.delete(all_teeth.z, 6, axis=1).any()
    assert all_teeth.x[6] == 7.0 and all_teeth.largest == -all_teeth.minimum == pytest.approx(transverse)


@pytest.mark.parametrize("name", ["pinion", "wheel"])
def test_the_flank_that_differs_most_is_drawn_alone(name):
    flanks = ToothFlank(3, profile_slope=6e-6), ToothFlank(9, helix_slope=8e-6)
    all_teeth, one = shades(made(name, tooth_flanks=flanks))
    gear = getattr(PAIR, name)
    # slope over the profile: half in excess at the tip, half missing at the root
    tip_at_top = 1.0 if gear.tip_form_roll_length > gear.form_roll_length else -1.0
    np.testing.assert_allclose(all_teeth.z[[0, -1], 2], [-3.0 * tip_at_top, 3.0 * tip_at_top], atol=1e-9)
    assert not all_teeth.z[:, 8].any()  # at mid-face
    np.testing.assert_allclose(one.z[:, [0, -1]], [[-4.0, 4.0]] * len(one.y), atol=1e-9)


def test_run_out_turns_with_the_gear():
    pair = made("pinion", run_out=RunOut(7e-6, 0.4))
    model, _ = compose(ContactScene(pair, np.array([1.0]), EFFECTS), {})
    at_pitch = np.array([pair.path_of_contact.pitch_point])
    found = excess_of_teeth(pair, model, 0, at_pitch, np.zeros(1))[:, 0, 0]
    turn = 2.0 * math.pi * np.arange(19) / 19
    np.testing.assert_allclose(found, 7e-6 * np.cos(turn - 0.4), rtol=1e-12, atol=1e-18)
