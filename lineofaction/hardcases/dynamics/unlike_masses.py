"""A pinion ten thousand times as light as its wheel, and the other way round."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from dynamics.joints import FreeRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.results import RunResult
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import Inertia
from lineofaction.hardcases.dynamics.driven_gear import after_ramp
from lineofaction.hardcases.dynamics.laws import common_figures, off_closed_form, run_both
from lineofaction.hardcases.dynamics.oscillators import (
    BASE_RADIUS,
    INERTIA,
    STIFFNESS,
    TORQUE,
    spring,
    torsional,
)
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("dynamics")

_RATIO, _SPEED = 1e4, 50.0
"""Ratio of the moments of inertia, and speed of the train at the start, rad/s."""

_BEGIN = 1e-3  # of the torque's rise, s
_RISE = 1e-6  # duration of the rise, s
_STEP = 20.0  # size of the rise, N m


@SCENES.add(
    "mass_ratio_1e4",
    "One gear is ten thousand times as heavy as the other, and nothing but torques holds the train: the mass "
    "matrix loses four digits.",
    "The closed form of two masses on a spring to the measured error; momentum gained is the impulse; "
    "integrators agree, energy balances.",
)
def _unlike_masses() -> Sequence[Measured]:
    """Kick a free train of two gears by a step of the motor's torque."""
    figures: list[Measured] = []
    for name, polar in (("light drives", (1.0, _RATIO)), ("heavy drives", (_RATIO, 1.0))):
        inertia = [INERTIA.polar * factor for factor in polar]
        scene = _free_train(inertia)
        runs = run_both(scene)
        mass = [value / BASE_RADIUS**2 for value in inertia]
        natural = math.sqrt(STIFFNESS * (1.0 / mass[0] + 1.0 / mass[1]))
        step = _STEP / BASE_RADIUS / mass[0] / natural**2
        exact = partial(after_ramp, natural=natural, step=step, begin=_BEGIN, rise=_RISE)
        gained = _STEP * (float(runs.implicit.time[-1]) - _BEGIN - _RISE / 2.0) / sum(inertia)
        allowed = natural * scene.integration.tolerance / BASE_RADIUS  # one tolerance per radian, rad/s
        off = max(abs(_mean_speed(run, inertia) - _SPEED - gained) for run in runs.both)
        measured = (
            *common_figures(runs, scene),
            off_closed_form(runs, scene, exact),
            Measured("speed of the train off the impulse's, over a tolerance per radian", off / allowed, 1.0),
            Measured("speed gained by impulse over that", gained / allowed, minimum=100.0),
        )
        figures += [replace(figure, name=f"{name}: {figure.name}") for figure in measured]
    return figures


def _mean_speed(run: RunResult, inertia: Sequence[float]) -> float:
    """Return the speed of the train at the end, rad/s: its momentum over its inertia, in gear 1's sense."""
    momentum = inertia[0] * run.speed[0, -1] - inertia[1] * run.speed[1, -1]
    return float(momentum) / sum(inertia)


def _free_train(inertia: Sequence[float]) -> Scene:
    """Return two gears between motor and brake of the same torque, until the motor's rises."""
    motor = TimeLaw.ramp(-TORQUE, -TORQUE - _STEP, _RISE, begin=_BEGIN)
    scene = torsional(
        spring(), duration=0.01, outputs=Outputs(2e5),
        integration=Integration(tolerance=1e-11, estimate_error=True),
    )  # fmt: skip
    gears = tuple(
        replace(gear, inertia=Inertia(1.0, polar, polar))
        for gear, polar in zip(scene.gears, inertia, strict=True)
    )
    free = (FreeRotation("train", "shaft 1", _SPEED),)
    loads = (LoadTorque("motor", "shaft 1", motor), *scene.loads)
    return replace(scene, gears=gears, drives=(), free_rotations=free, loads=loads)
