"""Sliding of pairs in closed form: against the loss factor of Ohlendorf, and in a run."""

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_trains import PER_TOOTH, Train

from dynamics import Bushing, LoadTorque, Outputs, TimeLaw, simulate
from dynamics.errors import InputError
from dynamics.meshes.standard_sliding import StandardTeeth, standard_sliding
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table, straight_table

ANGLE, MU = math.radians(20.0), 0.05
FINE = (np.arange(4096) + 0.5) / 4096


def teeth_of(first: int, second: int, helix: float = 0.0, *, internal: bool = False) -> StandardTeeth:
    return StandardTeeth((first, second), PER_TOOTH * first, ANGLE, helix, 0.02, internal)


def loss_factor(teeth: StandardTeeth) -> float:
    """H_v / (pi (1/z_1 + 1/z_2)) = 1 - e_a + e_1^2 + e_2^2 (Niemann and Winter, Maschinenelemente II)."""
    before, beyond = (abs(end) / teeth.base_pitch for end in teeth.path)
    return 1.0 - before - beyond + before**2 + beyond**2


@pytest.mark.parametrize(("first", "second"), [(20, 20), (19, 57), (40, 25)])
def test_the_mean_lever_is_that_of_the_loss_factor(first, second):
    teeth = teeth_of(first, second)
    _, lever = standard_sliding(teeth, FINE)
    smoothed = 2e-3  # of the change of direction at the pitch point
    assert np.mean(lever) == pytest.approx(0.5 * teeth.base_pitch * loss_factor(teeth), rel=smoothed)


def test_the_path_of_contact_is_that_of_standard_teeth():
    """A 20/20 pair with an addendum of one module has a contact ratio of 1.557 at 20 degrees (ISO 21771)."""
    first, last = teeth_of(20, 20).path
    assert (last - first) / PER_TOOTH / 2.0 / math.pi == pytest.approx(1.557, abs=1e-3)
    assert first == pytest.approx(-last, rel=1e-12)


@pytest.mark.parametrize("internal", [False, True])
def test_the_path_ends_where_the_tip_circles_cut_the_line_of_action(internal):
    teeth = teeth_of(21, 71, internal=internal)
    radii = [PER_TOOTH * count / math.cos(ANGLE) for count in (21, 71)]
    module = 2.0 * radii[0] / 21
    side = -1.0 if internal else 1.0
    centers = (-radii[0], side * radii[1])  # on the line of centers, the pitch point at 0
    tips = (radii[0] + module, radii[1] + side * module)
    line = np.array([math.sin(ANGLE), math.cos(ANGLE)])
    first, last = teeth.path
    for end, center, tip in ((last, centers[0], tips[0]), (first, centers[1], tips[1])):
        assert np.linalg.norm(end * line - np.array([center, 0.0])) == pytest.approx(tip, rel=1e-12)
    assert first < 0.0 < last


def test_a_pair_slides_towards_recess_where_it_recedes():
    teeth = teeth_of(20, 20)
    share, lever = standard_sliding(teeth, np.array([0.0, 0.15, 0.85]))
    assert share[0] == pytest.approx(0.0, abs=1e-12)
    assert share[1] == pytest.approx(1.0, abs=1e-2) and share[2] == pytest.approx(-1.0, abs=1e-2)
    assert np.all(lever >= 0.0)


def test_helical_teeth_slide_alike_at_all_positions():
    """A whole overlap: what enters at one end leaves at the other."""
    pitch = teeth_of(20, 20).base_pitch
    share, lever = standard_sliding(teeth_of(20, 20, math.atan(pitch / 0.02)), FINE[::64])
    spur = standard_sliding(teeth_of(20, 20), FINE[::64])
    assert np.ptp(lever) < 0.15 * np.ptp(spur[1])
    assert np.ptp(share) < 0.15 * np.ptp(spur[0])


def test_the_force_of_a_table_is_the_same_with_sliding():
    stiffness = PeriodicCurve.harmonic(2e8, [3e7, 1e7], [0.3, 1.0])
    plain, sliding = stiffness_table(stiffness), stiffness_table(stiffness, teeth=teeth_of(20, 30))
    at = np.searchsorted(sliding.position, plain.position)
    np.testing.assert_array_equal(sliding.stiffness[0, 0, at], plain.stiffness[0, 0])
    assert plain.sliding_lever is None


def test_a_run_loses_what_the_loss_factor_says():
    train = Train(speed=150.0)
    train.add("pinion", 20, share=0.6, position=0.1)
    train.add("wheel", 30, share=0.6, position=0.1)
    train.mesh("pinion", "wheel", ANGLE, 0.0)
    scene = train.scene()
    teeth = teeth_of(20, 30)
    mesh = replace(scene.meshes[0], table=straight_table(2e8, teeth), friction=MU)
    torque, pitches = 20.0, 20
    scene = replace(
        scene,
        duration=pitches * 2.0 * math.pi / 20 / 150.0,
        meshes=(mesh,),
        bushings=tuple(
            Bushing(f"{shaft.name} {z}", shaft.name, z, 1e9) for shaft in scene.shafts for z in (0.0, 0.2)
        ),
        loads=(LoadTorque("brake", "wheel", TimeLaw.constant(torque)),),
        outputs=Outputs(energy_audit=True),
    )
    result = simulate(scene)
    part = MU * math.pi * (1.0 / 20 + 1.0 / 30) * loss_factor(teeth)
    passed = torque * 150.0 * 20.0 / 30.0 * scene.duration
    assert result.energy.friction == pytest.approx(part * passed, rel=0.03)


def test_friction_on_a_table_without_sliding_is_refused():
    train = Train()
    train.add("pinion", 20)
    train.add("wheel", 30)
    train.mesh("pinion", "wheel", ANGLE, 0.0)
    scene = train.scene()
    scene = replace(scene, meshes=(replace(scene.meshes[0], friction=MU),))
    with pytest.raises(InputError, match=r"meshes\[0\].friction = 0.05: must be left out"):
        simulate(scene)
    assert simulate(replace(scene, duration=0.001, effects={"friction": "off"})).status.usable
