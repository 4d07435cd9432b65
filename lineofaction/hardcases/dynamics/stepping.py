"""Hard dynamics for integrators: long runs, steps, unlike masses, planets, checkpoints."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from functools import partial
from pathlib import Path

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.workspace import Count, Power
from dynamics.joints import FreeRotation, ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.results import RunResult
from dynamics.scene import Integration, Outputs, PlanetarySet, Scene
from dynamics.shafts import Inertia
from dynamics.simulation import simulate_to_file
from dynamics.types import FloatArray, RunStatus
from lineofaction.hardcases.dynamics.laws import (
    BASE_RADIUS,
    DEFLECTION,
    INERTIA,
    MASS,
    METHODS,
    NATURAL,
    RPM,
    STIFFNESS,
    TEETH,
    TORQUE,
    by_method,
    coast,
    common_figures,
    damping_of,
    off_closed_form,
    run_both,
    spring,
    torsional,
)
from lineofaction.hardcases.scene import Measured, Scenes

STEPS = Scenes("dynamics")
TRAINS = Scenes("dynamics")

_RIPPLE = 1e-6
_FASTEST = 100.0  # rad/s
_LARGE_RIPPLE = 1.5e-6


@STEPS.add(
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
            1e-10,
        ),
        Measured("speeds at the end, rad/s", float(np.abs(result.speed[:, -1]).max()), most=1e-6),
        Measured(
            "largest speed of the driven gear over the drive's",
            float(np.abs(result.speed[1]).max()) / top,
            1.5,
            1.0,
        ),
    )


@STEPS.add(
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
    flying = (force[:-2] == 0.0) & (force[1:-1] == 0.0) & (force[2:] == 0.0)
    drive = 0.5 * fastest / duration
    fall = TORQUE / INERTIA.polar * BASE_RADIUS + drive * BASE_RADIUS
    bend = np.diff(error, 2)[flying] * rate**2 / fall
    return (
        *common_figures(runs, scene),
        Measured("share of time out of contact", float(np.mean(force == 0.0)), least=0.05),
        Measured("largest force over the load's", float(force.max()) * BASE_RADIUS / TORQUE, least=2.0),
        Measured(
            "in flight: acceleration over that of the load alone, largest off",
            float(np.abs(bend - 1.0).max()),
            1e-3,
        ),
    )


# Closed forms of the undamped driven gear: extreme speeds, a torque step, extreme tolerances, many steps.


_STEP_WAVE, _DAMPING = 1e-6, 0.05
_STEP_TIME, _STEP_TORQUE, _RISE = 1e-3, 150.0, 1e-7
_MANY, _ROUNDING = 10_000_000, 1e-9


@STEPS.add(
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
            spring(_STEP_WAVE, positions=256), speed=speed * RPM, damping=damping_of(_DAMPING),
            duration=periods / rate, outputs=Outputs(rate / periods * 4000.0),
            integration=Integration(tolerance=1e-10),
        )  # fmt: skip
        runs = run_both(scene)
        exact = _ringing(2.0 * np.pi * rate)
        measured = (*common_figures(runs, scene), off_closed_form(runs, scene, exact))
        figures += [replace(figure, name=f"{speed:g} rpm: {figure.name}") for figure in measured]
    return figures


def _ringing(rate: float) -> Callable[[FloatArray], FloatArray]:
    """Return d(t) at rest until t = 0, when the tooth's error begins to change at `rate` rad/s.

    m d'' + c d' + k (d - a cos(rate t)) = T/r: a steady part, and what rings off of the start.
    """
    square = NATURAL**2 - rate**2 + 2j * _DAMPING * NATURAL * rate
    steady = _STEP_WAVE * NATURAL**2 / square
    decay, own = _DAMPING * NATURAL, NATURAL * math.sqrt(1.0 - _DAMPING**2)
    cosine = _STEP_WAVE - steady.real
    sine = (decay * cosine + rate * steady.imag) / own

    def exact(time: FloatArray) -> FloatArray:
        rest = np.exp(-decay * time) * (cosine * np.cos(own * time) + sine * np.sin(own * time))
        return np.asarray(DEFLECTION + (steady * np.exp(1j * rate * time)).real + rest)

    return exact


@STEPS.add(
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
        off_closed_form(runs, scene, lambda time: _after_ramp(time, NATURAL, step, _STEP_TIME, _RISE)),
        Measured(
            "peak force over the load before plus twice the step",
            peak / (TORQUE + 2.0 * _STEP_TORQUE),
            1.0001,
            0.999,
        ),
    )


def _after_ramp(time: FloatArray, natural: float, step: float, begin: float, rise: float) -> FloatArray:
    """Return d(t) without damping as the load rises straight and the static deflection by `step` in m."""
    since, past = (np.maximum(time - start, 0.0) for start in (begin, begin + rise))
    ramp = since - np.sin(natural * since) / natural - past + np.sin(natural * past) / natural
    return np.asarray(DEFLECTION + step / rise * ramp)


@STEPS.add(
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
            spring(_STEP_WAVE, positions=512), speed=2.0 * np.pi * rate / TEETH, damping=damping_of(_DAMPING),
            duration=5e-3, outputs=Outputs(1e5),
            integration=Integration(tolerance=share * DEFLECTION),
        )  # fmt: skip
        runs = run_both(scene)
        measured = (*common_figures(runs, scene), off_closed_form(runs, scene, exact))
        figures += [replace(figure, name=f"{share:g}: {figure.name}") for figure in measured]
        figures += [
            Measured(f"{share:g}: steps, {method}", float(run.statistics.accepted))
            for method, run in zip(METHODS, runs.both, strict=True)
        ]
    return figures


def _many_steps(method: str) -> Sequence[Measured]:
    """Ring on without damping at a fixed place for ten million steps, and for ten times fewer."""
    tenth, whole = (_drift(method, steps) for steps in (_MANY // 10, _MANY))
    in_proportion = whole / (10.0 * tenth + _ROUNDING)
    return (
        Measured("steps", float(_MANY)),
        Measured("energy drift", whole, most=1e-6),
        Measured("drift over ten times that of a tenth of the steps", in_proportion, most=1.1),
    )


for _method in METHODS:
    STEPS.add(
        f"ten_million_undamped_steps_{_method}",
        "Without damping every step's error stays, and rounding adds up over 1e7 of them.",
        "Energy drifts by less than 1e-6 of the vibration's, and no faster than in proportion to the steps.",
    )(partial(_many_steps, _method))


def _drift(method: str, steps: int) -> float:
    """Return the change of energy over `steps` steps of a 44th of a radian, relative to the vibration's.

    The place of the teeth stands still, so it supplies no work: what the audit books to it closes the balance
    of the mesh, and would hide what the steps make of its energy.
    """
    fixed = Integration(method, fixed_step=1.0 / (44.0 * NATURAL))
    duration = steps * float(fixed.fixed_step or 0.0)
    scene = torsional(
        spring(),
        speed=TimeLaw.ramp(0.0, 1e-12, 1.0),
        duration=duration,
        outputs=Outputs(1000.0),
        integration=fixed,
    )
    system = assemble(scene)
    speed = 0.5 * NATURAL * DEFLECTION
    run = integrate(
        system, static_equilibrium(system), fixed, velocity=np.array([speed]) / system.arrays.direction[0]
    )
    if run.count[Count.ACCEPTED] < steps - 1:
        return float("nan")
    supplied = float(np.delete(run.work, Power.POSITION).sum())
    return abs(float(np.diff(run.stored.sum(axis=1))[0]) - supplied) / (0.5 * MASS * speed**2)


# A pinion ten thousand times as light as its wheel, and the other way round.


_RATIO, _SPEED, _BEGIN, _RISE_INERTIAS, _STEP = 1e4, 50.0, 1e-3, 1e-6, 20.0


@TRAINS.add(
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
        exact = partial(_after_ramp, natural=natural, step=step, begin=_BEGIN, rise=_RISE_INERTIAS)
        gained = _STEP * (float(runs.implicit.time[-1]) - _BEGIN - _RISE_INERTIAS / 2.0) / sum(inertia)
        pace = natural * scene.integration.tolerance / BASE_RADIUS
        off = max(abs(_mean_speed(run, inertia) - _SPEED - gained) for run in runs.both)
        measured = (
            *common_figures(runs, scene),
            off_closed_form(runs, scene, exact),
            Measured("speed of the train off the impulse's, over a tolerance per radian", off / pace, 1.0),
            Measured("speed gained by impulse over that", gained / pace, least=100.0),
        )
        figures += [replace(figure, name=f"{name}: {figure.name}") for figure in measured]
    return figures


def _mean_speed(run: RunResult, inertia: Sequence[float]) -> float:
    """Return the angular momentum at the end, the driven gear's sense turned, over all inertia, rad/s."""
    momentum = inertia[0] * run.speed[0, -1] - inertia[1] * run.speed[1, -1]
    return float(momentum) / sum(inertia)


def _free_train(inertia: Sequence[float]) -> Scene:
    """Return two gears between motor and brake of the same torque, until the motor's rises."""
    motor = TimeLaw.ramp(-TORQUE, -TORQUE - _STEP, _RISE_INERTIAS, begin=_BEGIN)
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


# A planetary set of which one planet carries nothing.


_PLANETS, _TEETH, _RADIUS_PER_TOOTH = 4, (28, 36, 100), 1.4e-3
_STIFFNESS, _BEARING, _ALPHA = 5e8, 1e8, math.radians(24.6)
_SUN_FORCE, _ERROR, _PLANET_WAVE = 8000.0, 200e-6, 0.2e-6


@TRAINS.add(
    "one_planet_without_load",
    "A pin 0.2 mm back takes its planet out of both meshes: it turns as it likes, and its row of the "
    "stiffness matrix is zero.",
    "The others carry a third each; integrators agree, energy balances.",
)
def _one_without_load() -> Sequence[Measured]:
    """Set one pin back so far that its planet touches nothing, and run."""
    gears = _set()
    scene = _driven(gears)
    start = static_equilibrium(assemble(scene))
    shares = start.mesh_force[::2] / _SUN_FORCE
    expected = np.array([0.0, *[1.0 / (_PLANETS - 1)] * (_PLANETS - 1)])
    runs = run_both(scene)
    mean = runs.implicit.mesh_force.mean(axis=1)
    off = np.abs(mean[2::2] / _SUN_FORCE - 1.0 / (_PLANETS - 1))
    return (
        Measured("equilibrium found", float(start.status.usable), least=1.0),
        Measured("shares at rest off 0, 1/3, 1/3, 1/3", float(np.abs(shares - expected).max()), most=1e-6),
        *common_figures(runs, scene),
        Measured("force on the planet set back, N", float(runs.implicit.mesh_force[:2].max()), most=0.0),
        Measured("mean shares of the others off 1/3", float(off.max()), most=1e-4),
    )


def _set() -> PlanetarySet:
    """Return four planets between a sun and a ring in fixed bearings, the first pin set back."""
    radius = tuple(_RADIUS_PER_TOOTH * z for z in _TEETH)
    distance = (radius[0] + radius[1]) / math.cos(_ALPHA)
    table = spring(_PLANET_WAVE, stiffness=_STIFFNESS)
    return PlanetarySet(
        teeth=_TEETH,
        base_radius=(radius[0], radius[1], radius[2]),
        center_distance=distance,
        face_width=0.025,
        sun_table=table,
        ring_table=table,
        planets=_PLANETS,
        sun_inertia=Inertia(0.4, 0.39 * radius[0] ** 2, 0.39 * radius[0] ** 2),
        planet_inertia=Inertia(0.66, 0.61 * radius[1] ** 2, 0.61 * radius[1] ** 2),
        ring_inertia=Inertia(2.35, 3.0 * radius[2] ** 2, 3.0 * radius[2] ** 2),
        carrier_inertia=Inertia(5.43, 6.29 * distance**2, 6.29 * distance**2),
        planet_stiffness=_BEARING,
        pin_errors=((0.0, _ERROR), *[(0.0, 0.0)] * (_PLANETS - 1)),
    )


def _driven(gears: PlanetarySet) -> Scene:
    """Return the set with its sun driven, its ring held and its carrier loaded."""
    parts = gears.parts()
    ratio = 1.0 + gears.teeth[2] / gears.teeth[0]
    return Scene(
        shafts=parts.shafts,
        gears=parts.gears,
        meshes=parts.meshes,
        bushings=parts.bushings,
        planet_bearings=parts.planet_bearings,
        drives=(
            ImposedRotation("input", "sun", TimeLaw.constant(100.0)),
            ImposedRotation("ring held", "ring", TimeLaw.constant(0.0)),
        ),
        loads=(LoadTorque("brake", "carrier", TimeLaw.constant(ratio * _SUN_FORCE * gears.base_radius[0])),),
        duration=0.02,
        effects={"backlash": "off", "gyroscopic": "off"},
        integration=Integration(tolerance=1e-10),
    )


# A run that is interrupted in the middle of impacts, and taken up again.


_BACKLASH, _COAST_WAVE = 20e-6, 30e-6


@TRAINS.add(
    "restart_from_checkpoint",
    "In chaotic rattle one bit lost at an interruption is another motion a few impacts later.",
    "Interrupted every seventh block and taken up again, all series are those of the whole run, bit by bit.",
)
def _taken_up_again() -> Sequence[Measured]:
    """Cancel a chaotic rattle every few blocks and resume it, until it has ended."""
    scene = torsional(
        spring(_COAST_WAVE), speed=1000.0 * RPM, torque=0.0, back=coast(_BACKLASH, _COAST_WAVE),
        damping=damping_of(0.1), duration=0.1, outputs=Outputs(displacements=True, accelerations=True),
        integration=Integration(tolerance=1e-9),
    )  # fmt: skip
    figures: list[Measured] = []
    for method in METHODS:
        own = by_method(scene, method)
        with tempfile.TemporaryDirectory() as folder:
            whole, parts = Path(folder, "whole.nc"), Path(folder, "parts.nc")
            simulate_to_file(own, whole)
            legs = _in_legs(own, parts)
            unbroken, resumed = (RunResult.from_netcdf(path) for path in (whole, parts))
        extra = abs(unbroken.statistics.accepted - resumed.statistics.accepted)
        changed = [
            name
            for name in [
                entry.name
                for entry in fields(unbroken)
                if isinstance(getattr(unbroken, entry.name), np.ndarray)
            ]
            if _bits(unbroken, name) != _bits(resumed, name)
        ]
        impacts = int(np.count_nonzero(np.diff(unbroken.contact[0] % 2.0) == 1.0))
        figures += [
            Measured(f"{method}: times it was taken up again", float(legs - 1), least=5.0),
            Measured(f"{method}: impacts on the driving flank", float(impacts), least=10.0),
            Measured(f"{method}: series with a bit that differs", float(len(changed)), most=0.0),
            Measured(f"{method}: steps more or fewer", float(extra), most=0.0),
        ]
    return figures


def _in_legs(scene: Scene, path: Path) -> int:
    """Run in legs of seven blocks, each from the checkpoint of the one before; return how many it took."""
    legs, status = 0, RunStatus.CANCELLED
    while status is RunStatus.CANCELLED:
        status = simulate_to_file(scene, path, resume=legs > 0, cancel=_after(7))
        legs += 1
    return legs


def _after(blocks: int) -> Callable[[], bool]:
    """Return what asks to stop when it is asked for the last of so many times."""
    left = iter(range(blocks - 1))
    return lambda: next(left, None) is None


def _bits(result: RunResult, name: str) -> bytes:
    return bytes(getattr(result, name).tobytes())
