"""Oscillators of known motion, and the laws of every scene in the time domain."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.meshes.technique import PlainTable
from dynamics.results import RunResult
from dynamics.scene import Scene
from dynamics.shafts import GearBody, Inertia, Shaft
from dynamics.simulation import simulate
from dynamics.types import FloatArray
from lineofaction.hardcases.scene import Measured

TEETH = 20
BASE_RADIUS = 0.04 * math.cos(math.radians(20.0))
STIFFNESS = 4e8
"""N/m along the line of action."""
INERTIA = Inertia(1.0, 1e-3, 1e-3)
MASS = INERTIA.polar / BASE_RADIUS**2
NATURAL = math.sqrt(STIFFNESS / MASS)
"""rad/s, of the driven gear on its mesh."""
RPM = math.pi / 30.0
TORQUE = 100.0
DEFLECTION = TORQUE / BASE_RADIUS / STIFFNESS
"""m, of the mesh under that torque."""
_LEVEL = TORQUE / BASE_RADIUS
POSITIONS = 64


def spring(amplitude: float = 0.0, positions: int = POSITIONS, stiffness: float = STIFFNESS) -> PlainTable:
    """Return the table F = stiffness (d - amplitude cos 2 pi x) in contact; amplitude in m."""
    x = np.arange(positions) / positions
    error = amplitude * np.cos(2.0 * np.pi * x)
    slope = -2.0 * np.pi * amplitude * np.sin(2.0 * np.pi * x)
    levels = np.array([0.0, _LEVEL])
    return _table(x, levels, error[:, None] + levels / stiffness, slope[:, None], stiffness, 0.0)


def changing_spring(ratio: float, positions: int = 256, mean: float = STIFFNESS) -> PlainTable:
    """Return F = k(x) d, k a cosine about `mean` whose highest value is `ratio` times its lowest."""
    x = np.arange(positions) / positions
    swing = (ratio - 1.0) / (ratio + 1.0)
    k = mean * (1.0 + swing * np.cos(2.0 * np.pi * x))
    k_slope = -2.0 * np.pi * mean * swing * np.sin(2.0 * np.pi * x)
    levels = np.array([0.0, _LEVEL])
    deflection = levels / k[:, None]
    return _table(x, levels, deflection, -deflection * (k_slope / k)[:, None], k[:, None], k_slope[:, None])


def coast(backlash: float, amplitude: float = 0.0, positions: int = POSITIONS) -> CoastFlank:
    """Return the backs of the teeth of `spring`: they touch at d = amplitude cos 2 pi x - backlash."""
    return CoastFlank(backlash, 0.0, spring(-amplitude, positions))


def torsional(
    mesh: PlainTable | None = None,
    *,
    speed: TimeLaw | float = 900.0 * RPM,
    torque: TimeLaw | float = TORQUE,
    duration: float = 0.05,
    back: CoastFlank | None = None,
    damping: float = 0.0,
    **changes: Any,
) -> Scene:
    """Return the scene with one freedom; speed in rad/s, torque in N m against it, damping in N s/m."""
    gears = tuple(
        GearBody(f"gear {k}", f"shaft {k}", 0.0, TEETH, BASE_RADIUS, 0.025, inertia=INERTIA) for k in (1, 2)
    )
    shafts = (Shaft("shaft 1", 0.2), Shaft("shaft 2", 0.2, (0.08, 0.0, 0.0)))
    table = mesh or spring()
    return Scene(
        shafts,
        gears,
        (GearMesh("mesh", "gear 1", "gear 2", table, damping=damping, coast=back),),
        (ImposedRotation("drive", "shaft 1", _law(speed)),),
        duration,
        loads=(LoadTorque("load", "shaft 2", _law(torque)),),
        effects={} if back is None else {"backlash": "on"},
        **changes,
    )


def damping_of(ratio: float) -> float:
    """Return the damping in N s/m of a damping ratio of the driven gear on its mesh."""
    return 2.0 * ratio * math.sqrt(STIFFNESS * MASS)


def _law(value: TimeLaw | float) -> TimeLaw:
    return value if isinstance(value, TimeLaw) else TimeLaw.constant(value)


def _table(
    position: FloatArray,
    level: FloatArray,
    deflection: FloatArray,
    deflection_slope: FloatArray,
    stiffness: FloatArray | float,
    stiffness_slope: FloatArray | float,
) -> PlainTable:

    def spread(values: FloatArray | float) -> FloatArray:
        return np.broadcast_to(np.asarray(values, float), (position.size, level.size))[None, None].copy()

    return PlainTable(
        position,
        level,
        np.zeros(1),
        np.zeros(1),
        spread(deflection),
        spread(deflection_slope),
        spread(stiffness),
        spread(stiffness_slope),
    )


# A mass thrown to and fro between two springs with a gap between them, in closed form.


def bounce(time: FloatArray, gap: float, speed: float, natural: float) -> FloatArray:
    """Return where the mass is, in m from the first spring's end, < 0 towards the second.

    Parameters
    ----------
    time : (T,) array
        s; at 0 it leaves the first spring.
    gap, speed : float
        m; m/s in the gap.
    natural : float
        rad/s, of the mass on either spring: each contact takes half a period.
    """
    flight, contact = gap / speed, math.pi / natural
    since = np.mod(time, 2.0 * (flight + contact))
    starts = np.array([flight, flight + contact, 2.0 * flight + contact])
    phase = np.searchsorted(starts, since, side="right")
    depth = speed / natural
    elapsed = since - np.r_[0.0, starts][phase]
    return np.choose(
        phase,
        [
            -speed * elapsed,
            -gap - depth * np.sin(natural * elapsed),
            -gap + speed * elapsed,
            depth * np.sin(natural * elapsed),
        ],
    )


def cycle(gap: float, speed: float, natural: float) -> float:
    """Return the time from leaving the first spring until leaving it again, s."""
    return 2.0 * (gap / speed + math.pi / natural)


# Laws of every scene in the time domain: two integrators agree, and the energy balance closes.


METHODS = ("implicit", "explicit")
LARGEST_GROWTH = 100.0
"""What a motion may make of errors of one tolerance: beyond it, agreement to measured errors says little."""
LARGEST_RATIO = 1.25
"""A measured error is 1.2 times the difference to a run at a tenth of the tolerance, for that run's error: a
sixth as large on average, more where a step level (2^(1/4), 2 in errors of order 4) rounds against it."""
LARGEST_MISSING = 1e-3
"""Energy that may be missing, over what was turned over: what the documentation promises."""


@dataclass(frozen=True)
class _Runs:
    """The same scene by both integrators."""

    implicit: RunResult
    explicit: RunResult

    @property
    def both(self) -> tuple[RunResult, RunResult]:
        """The runs."""
        return self.implicit, self.explicit


def run_both(scene: Scene) -> _Runs:
    """Run `scene` by both integrators, each at the tolerance of the scene, and take points of the motion."""
    points = replace(scene, outputs=replace(scene.outputs, anti_alias=False))
    return _Runs(*(simulate(by_method(points, method)) for method in METHODS))


def by_method(scene: Scene, method: str) -> Scene:
    """Return the scene with another integrator."""
    return replace(scene, integration=replace(scene.integration, method=method))


def common_figures(runs: _Runs, scene: Scene) -> tuple[Measured, ...]:
    """Return how far both integrators are apart, and the energy that the worse one misses.

    They agree to their tolerances; where the scene has errors measured (`Integration.estimate_error`), since
    its motion makes more of an error than one tolerance, to these.
    """
    first, second = (run.dynamic_transmission_error for run in runs.both)
    apart, tolerance = rms(first - second), scene.integration.tolerance
    audits = [run.energy for run in runs.both if run.energy is not None]
    energy = Measured(
        "energy missing, over what was turned over", max(audit.relative for audit in audits), LARGEST_MISSING
    )
    if not scene.integration.estimate_error:
        return (
            Measured("two integrators apart, rms over both tolerances", apart / (2.0 * tolerance), 1.0),
            energy,
        )
    errors = [_measured_error(run) for run in runs.both]
    return (
        Measured("two integrators apart, rms over their measured errors", apart / sum(errors), LARGEST_RATIO),
        Measured("larger measured error over the tolerance", max(errors) / tolerance, LARGEST_GROWTH),
        energy,
    )


def off_closed_form(runs: _Runs, scene: Scene, exact: Callable[[FloatArray], FloatArray]) -> Measured:
    """Return the rms distance of the worse integrator from `exact`, over the tolerance or its error."""
    off = [rms(run.dynamic_transmission_error[0] - exact(run.time)) for run in runs.both]
    if not scene.integration.estimate_error:
        return Measured(
            "off the closed form, rms over the tolerance", max(off) / scene.integration.tolerance, 1.0
        )
    ratio = max(distance / _measured_error(run) for distance, run in zip(off, runs.both, strict=True))
    return Measured("off the closed form, rms over the measured error", ratio, LARGEST_RATIO)


def _measured_error(run: RunResult) -> float:
    """Return what a run says its rms error is, m."""
    return float(run.receipt["error"]["time_step"]["rms"])


def rms(values: FloatArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
