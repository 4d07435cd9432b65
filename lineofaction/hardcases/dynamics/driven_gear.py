"""Closed forms of the undamped driven gear: extreme speeds, torque step, tolerances, many steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.workspace import Count, Power
from dynamics.loads import TimeLaw
from dynamics.scene import Integration, Outputs
from dynamics.types import FloatArray
from lineofaction.hardcases.dynamics.laws import METHODS, common_figures, off_closed_form, run_both
from lineofaction.hardcases.dynamics.oscillators import (
    BASE_RADIUS,
    DEFLECTION,
    MASS,
    NATURAL,
    RPM,
    STIFFNESS,
    TEETH,
    TORQUE,
    damping_of,
    spring,
    torsional,
)
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("dynamics")

_WAVE, _DAMPING = 1e-6, 0.05
"""Amplitude of the teeth's error, m, and damping ratio."""

_STEP_TIME = 1e-3  # s
_STEP_TORQUE = 150.0  # size of the torque step, N m
_RISE = 1e-7  # time in which the torque rises, s

_MANY, _ROUNDING = 10_000_000, 1e-9
"""Steps of the longest run, and the relative energy that rounding may add."""


@SCENES.add(
    "speeds_0.1_and_30000_rpm",
    "A tooth passes in 30 s or in 100 us, the gear rings in 0.3 ms: steps too short or too long by 1e5 if "
    "chosen by the wrong of the two.",
    "The closed form of a damped oscillator to the tolerance; integrators agree, energy balances.",
)
def _extreme_speeds() -> Sequence[Measured]:
    """Mesh once in half a minute, and ten thousand times a second."""
    figures: list[Measured] = []
    for speed, periods in ((0.1, 1.0), (30_000.0, 100.0)):
        rate = speed / 60.0 * TEETH
        scene = torsional(
            spring(_WAVE, positions=256), speed=speed * RPM, damping=damping_of(_DAMPING),
            duration=periods / rate, outputs=Outputs(rate / periods * 4000.0),  # 4000 samples
            integration=Integration(tolerance=1e-10),
        )  # fmt: skip
        runs = run_both(scene)
        exact = _ringing(2.0 * np.pi * rate)
        measured = (*common_figures(runs, scene), off_closed_form(runs, scene, exact))
        figures += [replace(figure, name=f"{speed:g} rpm: {figure.name}") for figure in measured]
    return figures


def _ringing(rate: float) -> Callable[[FloatArray], FloatArray]:
    """Return d(t) at rest until t = 0, when the tooth's error begins to change at `rate` rad/s.

    m d'' + c d' + k (d - a cos(rate t)) = T/r: a steady part, and free vibration that decays from the start.
    """
    square = NATURAL**2 - rate**2 + 2j * _DAMPING * NATURAL * rate
    steady = _WAVE * NATURAL**2 / square
    decay, damped = _DAMPING * NATURAL, NATURAL * math.sqrt(1.0 - _DAMPING**2)
    cosine = _WAVE - steady.real
    sine = (decay * cosine + rate * steady.imag) / damped

    def exact(time: FloatArray) -> FloatArray:
        rest = np.exp(-decay * time) * (cosine * np.cos(damped * time) + sine * np.sin(damped * time))
        return np.asarray(DEFLECTION + (steady * np.exp(1j * rate * time)).real + rest)

    return exact


@SCENES.add(
    "torque_step",
    "The load rises to 2.5 times within 1e-4 of a natural period, without damping.",
    "The closed form to the measured error, a peak of twice the step; integrators agree, energy balances.",
)
def _torque_step() -> Sequence[Measured]:
    """Raise the load to two and a half times within a tenth of a microsecond."""
    torque = TimeLaw.ramp(TORQUE, TORQUE + _STEP_TORQUE, _RISE, begin=_STEP_TIME)
    scene = torsional(
        spring(), torque=torque, duration=0.01, outputs=Outputs(1e5),
        integration=Integration(tolerance=1e-9, estimate_error=True),
    )  # fmt: skip
    runs = run_both(scene)
    step = _STEP_TORQUE / BASE_RADIUS / STIFFNESS
    peak = float(runs.implicit.mesh_force.max()) * BASE_RADIUS
    return (
        *common_figures(runs, scene),
        off_closed_form(runs, scene, lambda time: after_ramp(time, NATURAL, step, _STEP_TIME, _RISE)),
        Measured(
            "peak force over the load before plus twice the step",
            peak / (TORQUE + 2.0 * _STEP_TORQUE),
            maximum=1.0001,
            minimum=0.999,
        ),
    )


def after_ramp(time: FloatArray, natural: float, step: float, begin: float, rise: float) -> FloatArray:
    """Return d(t) without damping under a load that rises linearly within `rise` from `begin`, in s.

    `step` is the rise of the static deflection, m.
    """
    # a ramp that never ends, less the same ramp from the end of the rise
    since, past = (np.maximum(time - start, 0.0) for start in (begin, begin + rise))
    ramp = since - np.sin(natural * since) / natural - past + np.sin(natural * past) / natural
    return np.asarray(DEFLECTION + step / rise * ramp)


@SCENES.add(
    "tolerances_1e-2_and_1e-9",
    "A tolerance that lets every step through, and one of 7e-15 m, close to rounding.",
    "The closed form of a damped oscillator to the tolerance requested, by both integrators.",
)
def _tolerances() -> Sequence[Measured]:
    """Ask for a hundredth and for a billionth of the deflection."""
    rate = 1000.0
    exact = _ringing(2.0 * np.pi * rate)
    figures: list[Measured] = []
    for share in (1e-2, 1e-9):
        scene = torsional(
            spring(_WAVE, positions=512), speed=2.0 * np.pi * rate / TEETH, damping=damping_of(_DAMPING),
            duration=5e-3, outputs=Outputs(1e5),
            integration=Integration(tolerance=share * DEFLECTION),
        )  # fmt: skip
        runs = run_both(scene)
        measured = (*common_figures(runs, scene), off_closed_form(runs, scene, exact))
        figures += [replace(figure, name=f"{share:g}: {figure.name}") for figure in measured]
        figures += [
            Measured(f"{share:g}: steps, {method}", run.statistics.accepted)
            for method, run in zip(METHODS, runs.both, strict=True)
        ]
    return figures


def _many_steps(method: str) -> Sequence[Measured]:
    """Vibrate without damping, the teeth at rest, for ten million steps and for a tenth of them."""
    tenth, drift = (_drift(method, steps) for steps in (_MANY // 10, _MANY))
    in_proportion = drift / (10.0 * tenth + _ROUNDING)
    return (
        Measured("steps", _MANY),
        Measured("energy drift", drift, maximum=1e-6),
        Measured("drift over ten times that of a tenth of the steps", in_proportion, maximum=1.1),
    )


for _method in METHODS:
    SCENES.add(
        f"ten_million_undamped_steps_{_method}",
        "Without damping every step's error stays, and rounding adds up over 1e7 of them.",
        "Energy drifts by less than 1e-6 of the vibration's, and no faster than in proportion to the steps.",
    )(partial(_many_steps, _method))


def _drift(method: str, steps: int) -> float:
    """Return the change of energy over `steps` steps of a 44th of a radian, relative to the vibration's.

    The teeth stand still, so their motion supplies no work. The energy audit still has an entry for it, the
    remainder of the mesh's balance. That entry is left out: it would cancel the drift.
    """
    fixed = Integration(method, fixed_step=1.0 / (44.0 * NATURAL))
    duration = steps * float(fixed.fixed_step or 0.0)
    scene = torsional(
        spring(),
        speed=TimeLaw.ramp(0.0, 1e-12, 1.0),  # practically at rest
        duration=duration,
        outputs=Outputs(1000.0),
        integration=fixed,
    )
    system = assemble(scene)
    speed = 0.5 * NATURAL * DEFLECTION  # half of what would end contact
    run = integrate(
        system, static_equilibrium(system), fixed, velocity=np.array([speed]) / system.arrays.direction[0]
    )
    if run.count[Count.ACCEPTED] < steps - 1:  # ended early; rounding of the duration may save one step
        return float("nan")
    supplied = float(np.delete(run.work, Power.POSITION).sum())
    return abs(float(np.diff(run.stored.sum(axis=1))[0]) - supplied) / (0.5 * MASS * speed**2)
