"""The mean mesh forces that carry the loads in the kinematic motion.

A moment is a time here; turning moments are called torques.
"""

from __future__ import annotations

import numpy as np

from dynamics.arrays.arrays import slope
from dynamics.loads.time_law import TimeLaw
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.nominal_forces import levers, load_moments, shaft_acceleration, shafts_without_drive
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

BETWEEN_KNOTS = 8  # moments from one knot of a law to the next, the first at the knot


def mean_forces(mechanism: Mechanism) -> FloatArray:
    """Return the mesh forces that balance loads and imposed accelerations at T moments, (m, T) in N.

    Negative: the coast flank carries it. Where several sets of forces balance the loads, the one with the
    least sum of squares counts. The moments are knots of the laws, times just before them, and between.
    """
    scene, kinematics, inertia = mechanism.scene, mechanism.kinematics, mechanism.rotational_inertia
    moments = _sample_moments(scene)
    torque = load_moments(scene, kinematics, moments)
    imposed = np.array([slope(drive.speed, moments) for drive in scene.drives]).reshape(-1, moments.size)
    ratio = kinematics.float_ratio[:, : len(scene.drives)]  # laws of drives precede those of other trains
    torque -= inertia[:, None] * (ratio @ imposed)
    # what is left accelerates the trains without a drive
    torque -= inertia[:, None] * shaft_acceleration(scene, kinematics, inertia, torque)
    free = shafts_without_drive(scene, kinematics)
    lever = levers(scene, kinematics)[free]
    force = np.linalg.lstsq(lever, torque[free], rcond=1e-12)[0]
    return np.asarray(force[: len(scene.meshes)], dtype=float)  # torques of couplings follow them


def _sample_moments(scene: Scene) -> FloatArray:
    """Return the knots of the laws of loads and drives, times just before them, and between, s."""
    courses = [force.course for force in scene.forces if isinstance(force.course, TimeLaw)]
    laws = [*(drive.speed for drive in scene.drives), *(load.torque for load in scene.loads), *courses]
    times = np.concatenate([np.empty(0), *(np.asarray(law.time, dtype=float) for law in laws)])
    inside = times[(times > 0.0) & (times < scene.duration)]
    knots = np.unique(np.concatenate([[0.0, scene.duration], inside]))
    part = np.linspace(0.0, 1.0, BETWEEN_KNOTS, endpoint=False)
    between = knots[:-1, None] + np.diff(knots)[:, None] * part
    return np.concatenate([knots[:1], between.ravel(), np.nextafter(knots[1:], 0.0)])
