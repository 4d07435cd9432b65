"""One period of a periodic motion: transmission error, mesh and bearing forces, and their orders."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from dynamics.motion.observation import observe, static_deflections
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap
from dynamics.periodic.shooting import Orbit
from dynamics.types import ComplexArray, FloatArray

SAMPLES_PER_PITCH = 64  # at least; as many powers of 2 more as there are steps


@dataclass(frozen=True)
class PeriodicMotion:
    """Series over one period on a uniform grid of T samples, its end left out; m meshes, b bearings.

    Attributes
    ----------
    time : (T,) array
        s.
    position : (m, T) array
        Base pitches in [0, period of the table).
    dynamic_transmission_error, static_transmission_error : (m, T) arrays
        m; the static one at the nominal force, misaligned and apart as the bodies rest.
    mesh_force, coast_force : (m, T), (c, T) arrays
        Transverse, of the driving flanks and of the coast flanks in use, N.
    bearing_force : (b, 3, T) array
        On the ground or the pin, in the bearing's own frame, N; with seats (b, 6, T), moments in N m.
    displacement, velocity : (n, T) arrays
        Deviations from the kinematic motion, m and rad (and per s).
    order : (T // 2 + 1,) array
        Of the lines of `spectrum`: multiples of the frequency of the first mesh that turns.
    """

    time: FloatArray
    position: FloatArray
    dynamic_transmission_error: FloatArray
    static_transmission_error: FloatArray
    mesh_force: FloatArray
    coast_force: FloatArray
    bearing_force: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    order: FloatArray

    @property
    def parted(self) -> FloatArray:
        """Share of the period that each driving flank is out of contact, (m,)."""
        return np.asarray(np.mean(self.mesh_force <= 0.0, axis=1))


def spectrum(values: FloatArray) -> ComplexArray:
    """Return complex peak amplitudes (..., T // 2 + 1) of a series (..., T) of a motion; the mean first."""
    lines = 2.0 * np.fft.rfft(values, axis=-1) / values.shape[-1]
    lines[..., 0] *= 0.5
    if values.shape[-1] % 2 == 0:
        lines[..., -1] *= 0.5
    return np.asarray(lines)


def motion(
    problem: PeriodicProblem, orbit: Orbit, samples_per_pitch: int = SAMPLES_PER_PITCH
) -> PeriodicMotion:
    """Return the series of `orbit`, a motion that `problem` has, at least so many samples per base pitch."""
    over_period = PeriodMap(problem, orbit.speed)
    path = over_period.path(orbit.state)
    once = over_period.times
    step_end = np.concatenate([once[:-1] + k * once[-1] for k in range(problem.repeat)] + [[orbit.duration]])
    pitches = problem.repeat * problem.period.counted
    finest = max((step_end.size - 1) / pitches, samples_per_pitch)
    samples = pitches * 2 ** int(np.ceil(np.log2(finest)))
    time = orbit.duration * np.arange(samples) / samples
    q = np.ascontiguousarray(CubicHermiteSpline(step_end, path[0], path[1])(time))
    v = np.ascontiguousarray(CubicHermiteSpline(step_end, path[1], path[2])(time))
    system, arrays = problem.system, over_period.arrays
    seen = observe(arrays, time, q, v)
    meshes, driving = len(system.scene.meshes), system.driving_rows
    coast = arrays.elements.first[meshes : meshes + len(system.flanks.coast)]
    static = np.empty((meshes, samples))
    for f, force in enumerate(system.flanks.nominal_force):
        static_deflections(system.flanks.static, f, seen.position[f], float(force), static[f])
    return PeriodicMotion(
        time,
        seen.position[:meshes],
        seen.coordinate[driving],
        static,
        seen.force[driving],
        seen.force[coast],
        system.bearing_force(seen.force, q, v),
        np.ascontiguousarray(q.T),
        np.ascontiguousarray(v.T),
        np.arange(samples // 2 + 1) / pitches,
    )
