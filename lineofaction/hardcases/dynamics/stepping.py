"""Hard dynamics for integrators from rest: smooth steps, and contact that is lost."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.loads import TimeLaw
from dynamics.scene import Integration, Outputs
from lineofaction.hardcases.dynamics.laws import common_figures, run_both
from lineofaction.hardcases.dynamics.oscillators import (
    BASE_RADIUS,
    DEFLECTION,
    INERTIA,
    NATURAL,
    TEETH,
    TORQUE,
    damping_of,
    spring,
    torsional,
)
from lineofaction.hardcases.scene import Measured, Scenes, largest

SCENES = Scenes("dynamics")

_RIPPLE = 1e-6
_FASTEST = 100.0  # highest speed of the runs, rad/s
_LARGE_RIPPLE = 1.5e-6


@SCENES.add(
    "start_from_rest_and_stop",
    "At standstill no tooth passes, so nothing but the speed law says how long a step may be; and there is "
    "no speed to scale by.",
    "The driven gear ends at rest, at the static deflection of the place to which the law's integral leads; "
    "integrators agree, energy balances.",
)
def _rest_to_rest() -> Sequence[Measured]:
    """Start from rest, turn, stop, and stand still for a while."""
    top = _FASTEST
    law = TimeLaw((0.0, 0.05, 0.1, 0.15), (0.0, top, top, 0.0), "smooth")
    turned = top * 0.1  # rad: each smooth ramp makes half of what its time would at the top
    scene = torsional(
        spring(_RIPPLE),
        speed=law,
        damping=damping_of(0.05),
        duration=0.2,
        integration=Integration(tolerance=1e-10),
    )
    runs = run_both(scene)
    result = runs.implicit
    phase = TEETH * turned / (2.0 * np.pi)
    rest = DEFLECTION + _RIPPLE * np.cos(2.0 * np.pi * phase)
    return (
        *common_figures(runs, scene),
        Measured(
            "off its place at the end, base pitches", abs(float(result.position[0, -1]) - phase % 1.0), 1e-9
        ),
        Measured(
            "at rest at the end, off the static deflection, m",
            abs(float(result.dynamic_transmission_error[0, -1]) - rest),
            maximum=1e-10,
        ),
        Measured("speeds at the end, rad/s", largest(result.speed[:, -1]), maximum=1e-6),
        Measured(
            "largest speed of the driven gear over the drive's",
            largest(result.speed[1]) / top,
            maximum=1.5,
            minimum=1.0,
        ),
    )


@SCENES.add(
    "contact_lost_in_run_up",
    "Force and stiffness are zero between impacts: what Newton's method and the step control scale by "
    "is gone.",
    "In flight the gear falls with the acceleration of its load; integrators agree to their measured errors, "
    "energy balances.",
)
def _contact_lost() -> Sequence[Measured]:
    """Run up with a ripple that in resonance exceeds the load: teeth part, with nothing behind them."""
    fastest = 1.3 * NATURAL / TEETH
    duration, rate = 0.2, 2e5
    scene = torsional(
        spring(_LARGE_RIPPLE, 256), speed=TimeLaw.ramp(0.5 * fastest, fastest, duration),
        damping=damping_of(0.05), duration=duration, outputs=Outputs(rate),
        integration=Integration(tolerance=1e-10, estimate_error=True),
    )  # fmt: skip
    runs = run_both(scene)
    result = runs.implicit
    error, force = result.dynamic_transmission_error[0], result.mesh_force[0]
    # a second difference of the error needs three samples in flight
    flying = (force[:-2] == 0.0) & (force[1:-1] == 0.0) & (force[2:] == 0.0)
    drive = 0.5 * fastest / duration
    # the gear falls under its load, away from an accelerating drive
    fall = TORQUE / INERTIA.polar * BASE_RADIUS + drive * BASE_RADIUS
    bend = np.diff(error, 2)[flying] * rate**2 / fall
    return (
        *common_figures(runs, scene),
        Measured("share of time out of contact", np.mean(force == 0.0), minimum=0.05),
        Measured("largest force over the load's", float(force.max()) * BASE_RADIUS / TORQUE, minimum=2.0),
        Measured(
            "in flight: acceleration over that of the load alone, largest off",
            largest(bend - 1.0),
            maximum=1e-3,
        ),
    )
