"""Whirl: closed forms of a disc on bearings, the same from a fixed and from a rotating frame."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table
from planetary_scenes import driven_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.bearings import Bushing
from dynamics.joints import Coupling
from dynamics.linearize import natural_modes, whirl_modes
from dynamics.loads import TimeLaw
from dynamics.shafts import Inertia, Shaft

SPIN = 300.0  # rad/s
DISC = Inertia(4.0, 0.02, 0.0104)
STIFFNESS, DAMPING, LENGTH = 1e6, 200.0, 0.2
TILT_STIFFNESS = 2.0 * STIFFNESS * (LENGTH / 2.0) ** 2


def disc_scene(frame):
    """A disc on two bearings, turned through a soft coupling, in the fixed or its own rotating frame."""
    scene = gear_pair_scene(
        spring_table(4e8), speed=TimeLaw.constant(SPIN), effects={"tilt": "on", "lateral": "on"}
    )
    disc = Shaft("disc", LENGTH, (0.0, 0.0, 0.4), DISC, frame)
    ends = tuple(Bushing(f"disc.{z}", "disc", z, STIFFNESS, radial_damping=DAMPING) for z in (0.0, LENGTH))
    joint = Coupling("joint", "input", "disc", 100.0)
    return replace(scene, shafts=(*scene.shafts, disc), bushings=(*scene.bushings, *ends), couplings=(joint,))


def of_the_disc(frame, kinds):
    """Frequencies (rad/s) and decay rates (1/s) of the modes of the disc's freedoms `kinds`."""
    modes = whirl_modes(assemble(disc_scene(frame)))
    columns = [modes.freedom.index(f"disc.{kind}") for kind in kinds]
    size = np.abs(modes.shape * modes.scale)
    chosen = np.max(size[:, columns], axis=1) > 0.5 * np.max(size, axis=1)
    omega = 2.0 * np.pi * modes.frequency[chosen]
    ratio = modes.damping_ratio[chosen]
    return omega, ratio * omega / np.sqrt(1.0 - ratio**2)


def test_a_tilting_disc_whirls_forward_and_backward_as_the_closed_form_says():
    omega, decay = of_the_disc(None, ("tilt_x", "tilt_y"))
    damping = 2.0 * DAMPING * (LENGTH / 2.0) ** 2
    spin = DISC.polar * SPIN
    # I_t a'' + (c - i I_p w) a' + k a = 0 for the complex tilt a = a_x + i a_y
    roots = np.roots([DISC.transverse, damping - 1j * spin, TILT_STIFFNESS])
    np.testing.assert_allclose(np.sort(omega), np.sort(np.abs(roots.imag)), rtol=1e-9)
    np.testing.assert_allclose(np.sort(decay), np.sort(-roots.real), rtol=1e-7)
    assert omega.max() > 1.3 * omega.min()


@pytest.mark.parametrize("kinds", [("x", "y"), ("tilt_x", "tilt_y")])
def test_a_rotating_frame_shifts_frequencies_by_its_speed_and_nothing_else(kinds):
    fixed, decay = of_the_disc(None, kinds)
    rotating, decay_rotating = of_the_disc("disc", kinds)
    backward, forward = np.sort(fixed)
    np.testing.assert_allclose(np.sort(rotating), np.sort([forward - SPIN, backward + SPIN]), rtol=1e-8)
    np.testing.assert_allclose(np.sort(decay_rotating), np.sort(decay), rtol=1e-6)


def test_at_standstill_they_are_the_natural_modes():
    scene = driven_scene(published_set(3), speed=TimeLaw((0.0, 1.0), (0.0, 100.0)))
    system = assemble(without_damping(scene))
    still, plain = whirl_modes(system, 0.0), natural_modes(system)
    np.testing.assert_allclose(still.frequency, plain.frequency, rtol=1e-9)
    np.testing.assert_allclose(still.damping_ratio, 0.0, atol=1e-9)


def without_damping(scene):
    """The scene with no damper in bearings and meshes."""
    bearings = tuple(replace(part, damping_ratio=0.0) for part in scene.bushings)
    pins = tuple(replace(part, damping_ratio=0.0) for part in scene.planet_bearings)
    meshes = tuple(replace(mesh, damping=0.0) for mesh in scene.meshes)
    return replace(scene, bushings=bearings, planet_bearings=pins, meshes=meshes)


def test_speed_splits_the_double_modes_of_a_planetary_set():
    """Translational modes of equally spaced planets are double at rest; Coriolis terms split them."""
    scene = driven_scene(published_set(3), speed=TimeLaw.constant(2000.0))
    system = assemble(scene)
    at_rest, rotating = natural_modes(system).frequency, whirl_modes(system).frequency
    gaps = np.diff(at_rest)
    doubles = np.flatnonzero(gaps < 1e-6 * at_rest[1:])
    assert doubles.size == 6
    carrier = 2000.0 * 27 / 126 / (2.0 * math.pi)
    lowest = np.sort(rotating)[:2]
    assert lowest[1] - lowest[0] > 0.2 * carrier
