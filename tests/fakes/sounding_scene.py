"""A gear pair in a sounding housing: its response, radiation and sound; a rigid sphere on springs."""

from dataclasses import replace
from functools import cache

import numpy as np
from geared_scenes import gear_pair_scene, square_wave_table
from hulls import box, sphere
from reduced_housings import bare_housing
from sounding_housings import part_of_scene, rigid_housing, smooth_motion, with_surface

from dynamics.acoustics import Air, ElementalRadiators
from dynamics.assembly.assemble import assemble
from dynamics.linearize import forced_response
from dynamics.noise import RadiatedSound, housing_radiation, radiated_sound

ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
SPEEDS = np.array([60.0, 150.0, 420.0])
AIR = Air()


@cache
def housing():
    bare, hull = bare_housing(), box((0.36, 0.24, 0.18), (9, 6, 5))
    return with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))


@cache
def response():
    scene = gear_pair_scene(square_wave_table(), effects=ON)
    return forced_response(assemble(replace(scene, housings=(part_of_scene(housing()),))), SPEEDS, orders=4)


@cache
def radiation():
    return housing_radiation(housing(), ElementalRadiators(), response().frequency, AIR)


@cache
def sound() -> RadiatedSound:
    return radiated_sound(response(), housing(), None, radiation())


def oscillating(mass: float, stiffness: float):
    """A rigid sphere of radius 0.1 m on springs, under forces on its one bearing, and what theory says."""
    radius, damping, hertz = 0.1, 0.02, np.array([[150.0, 400.0], [300.0, 800.0]])
    body = rigid_housing(mass, stiffness, damping, sphere(16, radius))
    signals = np.zeros((1, 6, 2, 2), dtype=complex)
    signals[0, 1] = 3.0  # N, along y
    driven = replace(
        response(),
        bearing=("seat",),
        bearing_force=signals,
        frequency=hertz,
        speed=SPEEDS[:2],
        order=np.array([1.0, 2.0]),
        least_mesh_force=np.ones((1, 2)),
    )
    omega = 2.0 * np.pi * hertz
    loss = 2.0 * damping * np.sqrt(stiffness * mass)
    velocity = 3.0 * omega / np.abs(stiffness - mass * omega**2 + 1j * omega * loss)
    plane = AIR.impedance * 4.0 * np.pi * radius**2 * velocity**2 / 6.0  # mean of cos^2, half for the peak
    return body, driven, plane, omega / AIR.sound_speed * radius
