"""Hard dynamics of contact that is lost in backlash: no mean load, reversal, impacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.integrators import Trajectory, integrate, static_equilibrium
from dynamics.loads import TimeLaw
from dynamics.scene import Integration, Outputs
from dynamics.types import FloatArray
from lineofaction.hardcases.dynamics.bouncing_mass import bounce, cycle
from lineofaction.hardcases.dynamics.laws import METHODS, common_figures, rms, run_both
from lineofaction.hardcases.dynamics.oscillators import (
    BASE_RADIUS,
    MASS,
    NATURAL,
    RPM,
    STIFFNESS,
    TEETH,
    TORQUE,
    coast,
    damping_of,
    spring,
    torsional,
)
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("dynamics")

_BACKLASH, _RIPPLE = 20e-6, 15e-6
"""Backlash and amplitude of the transmission error, m."""
_PERIODS, _SAMPLES = 60, 64
"""Mesh periods of the rattle, and samples in each."""
_IMPACTS = 40
_SPEED = 0.1  # in the gap, m/s
_TOLERANCE = 1e-9  # of the integrators, m


@SCENES.add(
    "rattle_without_load",
    "No load presses the teeth to either side: there is no equilibrium to start from, and every "
    "impact starts anew.",
    "Steady rattle is mirrored in the gap half a period later, and repeats; integrators agree to their "
    "measured errors, energy balances.",
)
def _no_mean_load() -> Sequence[Measured]:
    """Throw an unloaded gear to and fro by the other's transmission error."""
    frequency = 6000.0 / 60.0 * TEETH
    scene = torsional(
        spring(_RIPPLE), speed=6000.0 * RPM, torque=0.0, back=coast(_BACKLASH, _RIPPLE),
        damping=damping_of(0.3), duration=_PERIODS / frequency, outputs=Outputs(_SAMPLES * frequency),
        integration=Integration(tolerance=1e-9, estimate_error=True),
    )  # fmt: skip
    runs = run_both(scene)
    result = runs.implicit
    drive, back = result.mesh_force[0], result.coast_force[0]
    last = result.dynamic_transmission_error[0][-_SAMPLES - 1 :]
    half = _SAMPLES // 2
    mirrored = rms(last[:half] + last[half:-1] + _BACKLASH) / float(np.std(last))
    return (
        *common_figures(runs, scene),
        Measured("half a period later mirrored in the gap, relative", mirrored, maximum=1e-3),
        Measured("a period later the same, m", abs(float(last[-1] - last[0])), maximum=1e-8),
        Measured("share of time on the driving flank", np.mean(drive > 0.0), minimum=0.1),
        Measured("share of time on the coast flank", np.mean(back > 0.0), minimum=0.1),
        Measured("both flanks at once, samples", ((drive > 0.0) & (back > 0.0)).sum(), maximum=0.0),
    )


@SCENES.add(
    "torque_reversal",
    "The load reverses and takes the teeth through backlash: for a while nothing holds the gear.",
    "Teeth rest at T/(r k) on the driving flank before, and a backlash further on the coast flank after; "
    "integrators agree, energy balances.",
)
def _reversal() -> Sequence[Measured]:
    """Reverse the load slowly enough to settle: teeth cross the gap and rest on their backs."""
    torque = TimeLaw((0.0, 0.01, 0.03), (TORQUE, TORQUE, -TORQUE))
    scene = torsional(
        torque=torque, back=coast(_BACKLASH), damping=damping_of(0.1), duration=0.06,
        integration=Integration(tolerance=1e-9),
    )  # fmt: skip
    runs = run_both(scene)
    rest = TORQUE / BASE_RADIUS / STIFFNESS
    error = runs.implicit.dynamic_transmission_error[0]
    force, back = runs.implicit.mesh_force[0], runs.implicit.coast_force[0]
    return (
        *common_figures(runs, scene),
        Measured("rest on the driving flank, off the closed form, m", abs(error[0] - rest), maximum=1e-12),
        Measured("rest on the coast flank, off the closed form, m", abs(error[-1] + _BACKLASH + rest), 1e-9),
        Measured("force of the driving flank at the end, N", force[-1], maximum=0.0),
        Measured(
            "force of the coast flank at the end, off the load",
            abs(back[-1] * BASE_RADIUS / TORQUE - 1.0),
            maximum=1e-4,
        ),
        Measured("both flanks at once, samples", ((force > 0.0) & (back > 0.0)).sum(), maximum=0.0),
    )


@SCENES.add(
    "impacts_on_both_sides",
    "Forty undamped impacts: what is wrong after one is wrong in all that follow, and grows in every flight.",
    "The closed form of flights and half sines, to one tolerance per impact; so does the energy.",
)
def _impacts() -> Sequence[Measured]:
    """Throw a gear between both flanks, without load or damping, twenty times to and fro."""
    coarse, fine = _TOLERANCE, 1e-2 * _TOLERANCE
    runs = {
        (method, tolerance): _thrown_trajectory(method, tolerance)
        for method in METHODS
        for tolerance in (coarse, fine)
    }
    off = {
        key: rms(_transmission_error(run) - bounce(run.time, _BACKLASH, _SPEED, NATURAL))
        for key, run in runs.items()
    }
    energy = {
        key: (abs(float(np.diff(run.stored.sum(axis=1))[0] - run.work.sum())) / (0.5 * MASS * _SPEED**2))
        for key, run in runs.items()
    }
    depth = _SPEED / NATURAL  # deflection of the flank at an impact, m
    # An error e at an impact is one of speed, e / depth relative. It delays every later flight: e backlash /
    # depth each. So the error after all impacts is the sum over impacts of the flights that follow.
    grown = _TOLERANCE * _BACKLASH / depth * _IMPACTS**2 / 2.0
    difference = rms(
        _transmission_error(runs[METHODS[0], fine]) - _transmission_error(runs[METHODS[1], fine])
    )
    return (
        Measured(
            "two integrators apart, over a tolerance per impact and what flights make of it",
            difference / (2.0 * 1e-2 * grown), maximum=1.0,
        ),
        Measured("off the closed form, likewise", max(off[m, coarse] for m in METHODS) / grown, maximum=1.0),
        Measured(
            "likewise at a hundredth of the tolerance",
            1e2 * max(off[m, fine] for m in METHODS) / grown, maximum=1.0,
        ),
        Measured(
            "energy lost over forty impacts, over a tolerance per impact",
            max(energy[m, coarse] for m in METHODS) / (2.0 * _TOLERANCE / depth * _IMPACTS), maximum=1.0,
        ),
        Measured("energy lost at a hundredth of the tolerance", max(energy[m, fine] for m in METHODS), 1e-3),
    )  # fmt: skip


def _thrown_trajectory(method: str, tolerance: float) -> Trajectory:
    """Let the gear leave the driving flank at `_SPEED`, and integrate over all impacts."""
    duration = 0.5 * _IMPACTS * cycle(_BACKLASH, _SPEED, NATURAL)
    scene = torsional(
        torque=0.0, back=coast(_BACKLASH), duration=duration, outputs=Outputs(2e5),
        integration=Integration(method, tolerance),
    )  # fmt: skip
    system = assemble(scene)
    start = replace(static_equilibrium(system), displacement=np.zeros(1))
    return integrate(
        system, start, scene.integration, velocity=np.array([-_SPEED]) / system.arrays.direction[0]
    )


def _transmission_error(run: Trajectory) -> FloatArray:
    """Return the transmission error: the one freedom is a rotation that lags by it."""
    return np.asarray(run.q[:, 0] * BASE_RADIUS)
