"""Hard dynamics of contact that is lost: backlash, jumps, stiffness that varies, clearance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from dynamics.assembly.assemble import System, assemble
from dynamics.bearings import Bushing
from dynamics.forces import RollingContact
from dynamics.integrators import Trajectory, integrate, static_equilibrium
from dynamics.joints import Coupling, ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.periodic import (
    Orbit,
    PeriodicProblem,
    find_orbit,
    follow_branch,
    motion,
    periodic_problem,
    settled,
)
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import GearBody, Inertia, Shaft
from dynamics.types import FloatArray
from lineofaction.hardcases.dynamics.laws import (
    BASE_RADIUS,
    MASS,
    METHODS,
    NATURAL,
    RPM,
    STIFFNESS,
    TEETH,
    TORQUE,
    bounce,
    changing_spring,
    coast,
    common_figures,
    cycle,
    damping_of,
    rms,
    run_both,
    spring,
    torsional,
)
from lineofaction.hardcases.scene import Measured, Scenes

GAPS = Scenes("dynamics")
STIFFNESSES = Scenes("dynamics")

_BACKLASH, _RIPPLE = 20e-6, 15e-6
_PERIODS, _SAMPLES = 60, 64
_IMPACTS, _SPEED, _TOLERANCE = 40, 0.1, 1e-9


@GAPS.add(
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
        Measured("half a period later mirrored in the gap, relative", mirrored, most=1e-3),
        Measured("a period later the same, m", abs(float(last[-1] - last[0])), most=1e-8),
        Measured("share of time on the driving flank", float(np.mean(drive > 0.0)), least=0.1),
        Measured("share of time on the coast flank", float(np.mean(back > 0.0)), least=0.1),
        Measured("both flanks at once, samples", float(np.count_nonzero((drive > 0.0) & (back > 0.0))), 0.0),
    )


@GAPS.add(
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
        Measured("rest on the driving flank, off the closed form, m", abs(error[0] - rest), most=1e-12),
        Measured("rest on the coast flank, off the closed form, m", abs(error[-1] + _BACKLASH + rest), 1e-9),
        Measured("force of the driving flank at the end, N", force[-1], most=0.0),
        Measured(
            "force of the coast flank at the end, off the load",
            abs(back[-1] * BASE_RADIUS / TORQUE - 1.0),
            1e-4,
        ),
        Measured("both flanks at once, samples", float(np.count_nonzero((force > 0.0) & (back > 0.0))), 0.0),
    )


@GAPS.add(
    "impacts_on_both_sides",
    "Forty undamped impacts: what is wrong after one is wrong in all that follow, and grows in every flight.",
    "The closed form of flights and half sines, to one tolerance per impact; so does the energy.",
)
def _impacts() -> Sequence[Measured]:
    """Throw a gear between both flanks, without load or damping, twenty times to and fro."""
    coarse, fine = _TOLERANCE, 1e-2 * _TOLERANCE
    runs = {
        (method, tolerance): _thrown(method, tolerance) for method in METHODS for tolerance in (coarse, fine)
    }
    off = {key: rms(_place(run) - bounce(run.time, _BACKLASH, _SPEED, NATURAL)) for key, run in runs.items()}
    energy = {
        key: (abs(float(np.diff(run.stored.sum(axis=1))[0] - run.work.sum())) / (0.5 * MASS * _SPEED**2))
        for key, run in runs.items()
    }
    depth = _SPEED / NATURAL
    # an error of one tolerance at an impact is one of speed, which every flight after it makes more of
    grown = _TOLERANCE * _BACKLASH / depth * _IMPACTS**2 / 2.0
    apart = rms(_place(runs[METHODS[0], fine]) - _place(runs[METHODS[1], fine]))
    return (
        Measured(
            "two integrators apart, over a tolerance per impact and what flights make of it",
            apart / (2.0 * 1e-2 * grown), most=1.0,
        ),
        Measured("off the closed form, likewise", max(off[m, coarse] for m in METHODS) / grown, most=1.0),
        Measured(
            "likewise at a hundredth of the tolerance",
            1e2 * max(off[m, fine] for m in METHODS) / grown, most=1.0,
        ),
        Measured(
            "energy lost over forty impacts, over a tolerance per impact",
            max(energy[m, coarse] for m in METHODS) / (2.0 * _TOLERANCE / depth * _IMPACTS), most=1.0,
        ),
        Measured("energy lost at a hundredth of the tolerance", max(energy[m, fine] for m in METHODS), 1e-3),
    )  # fmt: skip


def _thrown(method: str, tolerance: float) -> Trajectory:
    """Let the gear leave the driving flank at the speed given."""
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


def _place(run: Trajectory) -> FloatArray:
    """Return the transmission error: the one freedom is a rotation that lags by it."""
    return np.asarray(run.q[:, 0] * BASE_RADIUS)


# Resonance with loss of contact: two motions at one speed, and jumps between them.


_ZETA, _MEAN, _AMPLITUDE, _TEETH = 0.05, 0.1, 0.05, 20
_SLOWEST = 0.5
_CONVERGED = {
    0.5: (0.011759, 0.011759),
    0.7: (0.033653, 0.033653),
    0.75: (0.044803, 0.224724),
    0.8: (0.061357, 0.202258),
    0.85: (0.181301, 0.181301),
    1.0: (0.133083, 0.133083),
    1.2: (0.094212, 0.094212),
    1.6: (0.057716, 0.057716),
}
"""Frequency: rms of the alternating part at rising and at falling frequencies, converged independently."""
_JUMP_UP, _JUMP_DOWN = 0.8285, 0.7080


@GAPS.add(
    "jumps_of_resonance",
    "Between two jumps three motions exist at one speed, the middle one unstable; at the folds Newton's "
    "matrix is singular.",
    "Sixteen converged rms values of rising and falling speeds to 0.05 %, both jumps to 3e-4; integrators "
    "agree.",
)
def _both_sweeps() -> Sequence[Measured]:
    """Sweep up and down through the jumps by shooting, and find where the branch turns back."""
    by_method = {method: [_sweep(method, side) for side in (0, 1)] for method in METHODS}
    off = max(
        abs(values[w] / _CONVERGED[w][side] - 1.0)
        for sweeps in by_method.values()
        for side, values in enumerate(sweeps)
        for w in _CONVERGED
    )
    apart = max(
        abs(first[w] / second[w] - 1.0)
        for first, second in zip(by_method["implicit"], by_method["explicit"], strict=True)
        for w in _CONVERGED
    )
    up, down = _fold(_JUMP_UP, 0.65, 0.9), _fold(_JUMP_DOWN, 0.9, 0.65)
    return (
        Measured("rms off the converged numbers, worst of 32", off, most=5e-4),
        Measured("two integrators apart, rms relative", apart, most=1e-5),
        Measured("jump up, off 0.8285", abs(up - _JUMP_UP), most=3e-4),
        Measured("jump down, off 0.7080", abs(down - _JUMP_DOWN), most=3e-4),
    )


def _sweep(method: str, side: int) -> dict[float, float]:
    """Return the rms at all frequencies, each settled from the motion at the one before."""
    state: FloatArray | None = None
    sizes: dict[float, float] = {}
    for frequency in sorted(_CONVERGED, reverse=side == 1):
        problem = periodic_problem(_oscillator(frequency, method), _SLOWEST / _TEETH)
        state = settled(problem, frequency / _TEETH, state)
        orbit = find_orbit(problem, frequency / _TEETH, state)
        sizes[frequency] = _rms(problem, orbit, frequency) if orbit.status.usable and orbit.stable else np.nan
        state = orbit.state
    return sizes


def _rms(problem: PeriodicProblem, orbit: Orbit, frequency: float) -> float:
    """Return the rms of the alternating part of d - e."""
    error = motion(problem, orbit).dynamic_transmission_error[0]
    phase = 2.0 * np.pi * np.arange(error.size) / error.size
    return float(np.std(error - _excitation(frequency) * np.cos(phase)))


def _fold(jump: float, start: float, end: float) -> float:
    """Return the frequency at which the branch first turns back, the excitation exact at `jump`."""
    problem = periodic_problem(_oscillator(jump), 0.6 / _TEETH)
    guess = settled(problem, start / _TEETH)
    branch = follow_branch(problem, start / _TEETH, end / _TEETH, 0.05, guess)
    return float(branch.folds[0]) * _TEETH if branch.status.usable and branch.folds.size == 2 else np.nan


def _excitation(frequency: float) -> float:
    """Return the amplitude of the error that makes the force Fa W^2."""
    return float(_AMPLITUDE * frequency / np.hypot(frequency, 2.0 * _ZETA))


def _oscillator(frequency: float, method: str = "implicit") -> System:
    """Return the system of unit mass and stiffness, damped against the ground."""
    amplitude = _excitation(frequency)
    gears = tuple(
        GearBody(f"gear {k}", f"shaft {k}", 0.5, _TEETH, 1.0, 0.1, inertia=Inertia(1.0, 1.0, 1.0))
        for k in (1, 2)
    )
    back = CoastFlank(2.0, 0.0, spring(-amplitude, 256, 1.0))
    scene = Scene(
        (Shaft("shaft 1", 1.0), Shaft("shaft 2", 1.0, (2.2, 0.0, 0.0))),
        gears,
        (GearMesh("mesh", "gear 1", "gear 2", spring(amplitude, 256, 1.0), damping=0.0, coast=back),),
        (ImposedRotation("drive", "shaft 1", TimeLaw.constant(frequency / _TEETH)),),
        duration=1.0,
        loads=(LoadTorque("load", "shaft 2", TimeLaw.constant(_MEAN)),),
        integration=Integration(method, tolerance=1e-6, largest_step=1.0),
    )
    system = assemble(scene)
    return replace(system, arrays=system.arrays.with_matrices(damping=np.array([[2.0 * _ZETA]])))


# A mesh whose stiffness changes by three as the teeth pass.


_RATIO = 3.0
_FREQUENCIES = (1.5, 2.0)
"""Of the mesh over that of the gear on the mean stiffness: stable, and in the widest unstable band."""


@STIFFNESSES.add(
    "stiffness_changing_threefold",
    "The stiffness goes from k to 3 k and back with every tooth, undamped: at twice the natural frequency "
    "motions grow without an error of the teeth.",
    "Floquet multipliers are those of Mathieu's equation, their product is one (Liouville); integrators "
    "agree, energy balances.",
)
def _threefold() -> Sequence[Measured]:
    """Compare the multipliers of the motion with Mathieu's equation, in and out of its unstable band."""
    figures: list[Measured] = []
    for frequency in _FREQUENCIES:
        exact = _mathieu(frequency)
        sizes = np.sort(np.abs(np.linalg.eigvals(exact)))[::-1]
        for method in METHODS:
            speed = frequency * NATURAL / TEETH
            scene = torsional(changing_spring(_RATIO), speed=speed, integration=Integration(method))
            orbit = find_orbit(periodic_problem(assemble(scene), speed), speed)
            name = f"{frequency:g}, {method}"
            matrix = orbit.monodromy if orbit.status.usable else np.full((2, 2), np.nan)
            figures += [
                Measured(
                    f"{name}: trace of the monodromy off Mathieu's",
                    abs(float(np.trace(matrix) - np.trace(exact))),
                    1e-4,
                ),
                Measured(f"{name}: determinant off one", abs(float(np.linalg.det(matrix)) - 1.0), most=1e-6),
            ]
        figures.append(Measured(f"{frequency:g}: largest multiplier by Mathieu", float(sizes[0])))
    scene = torsional(
        changing_spring(_RATIO), speed=_FREQUENCIES[0] * NATURAL / TEETH, damping=damping_of(0.05),
        duration=0.02, integration=Integration(tolerance=1e-10),
    )  # fmt: skip
    return (*figures, *common_figures(run_both(scene), scene))


def _mathieu(frequency: float) -> FloatArray:
    """Return the monodromy of x'' + (1 + swing cos(frequency t)) x = 0 by an integrator of order 8."""
    swing = (_RATIO - 1.0) / (_RATIO + 1.0)

    def rates(t: float, y: FloatArray) -> FloatArray:
        k = 1.0 + swing * np.cos(frequency * t)
        return np.array([y[2], y[3], -k * y[0], -k * y[1]])

    start = np.array([1.0, 0.0, 0.0, 1.0])
    end = solve_ivp(rates, (0.0, 2.0 * np.pi / frequency), start, "DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    return np.asarray(end.reshape(2, 2))


# Bearings that make a system stiff in the mathematical sense, or that hold nothing.


_SOFT, _HARD, _TORQUE, _RIPPLE_SUPPORTS = 1e5, 1e12, 1.0, 1e-8
_LENGTH, _SHAFT = 0.2, Inertia(2.0, 1e-3, 8e-3)
_MASS, _WALL, _CLEARANCE, _SPEED_SUPPORTS, _TOLERANCE_SUPPORTS, _BOUNCES = 2.0, 5e8, 20e-6, 0.05, 1e-9, 20


@STIFFNESSES.add(
    "bushings_1e5_and_1e12",
    "Stiffnesses seven decades apart in one matrix: natural motions of 0.03 s and of microseconds, and a "
    "shaft that all but pivots about one end.",
    "Each bushing carries half the load, gears move apart by F/2 (1/k1 + 1/k2); integrators agree, energy "
    "balances.",
)
def _unlike_bushings() -> Sequence[Measured]:
    """Hold shafts at one end by 1e5 and at the other by 1e12 N/m, free to tilt."""
    scene = _on_bushings()
    runs = run_both(scene)
    force = _TORQUE / BASE_RADIUS
    first = runs.implicit.bearing_force[:, :2, 0]
    across = np.hypot(first[:, 0], first[:, 1])
    system = assemble(scene)
    start = static_equilibrium(system)
    aside = float(start.displacement @ system.arrays.stiffness @ start.displacement) / force
    expected = 2.0 * force / 4.0 * (1.0 / _SOFT + 1.0 / _HARD)
    return (
        *common_figures(runs, scene),
        Measured("share of the load on a bushing, off 1/2", float(np.abs(across / force - 0.5).max()), 1e-6),
        Measured("gears moved apart over the closed form, off one", abs(aside / expected - 1.0), 1e-6),
        Measured("steps, implicit", float(runs.implicit.statistics.accepted)),
        Measured("steps, explicit", float(runs.explicit.statistics.accepted)),
    )


def _on_bushings() -> Scene:
    """Return the pair in the middle of shafts on unlike bushings."""
    scene = torsional(
        spring(_RIPPLE_SUPPORTS), torque=_TORQUE, duration=0.02, damping=damping_of(0.05),
        integration=Integration(tolerance=1e-11),
    )  # fmt: skip
    shafts = tuple(replace(shaft, length=_LENGTH, inertia=_SHAFT) for shaft in scene.shafts)
    gears = tuple(replace(gear, position=_LENGTH / 2.0) for gear in scene.gears)
    bushings = tuple(
        Bushing(f"{shaft.name} {end}", shaft.name, at, stiffness, stiffness)
        for shaft in shafts
        for end, at, stiffness in (("soft", 0.0, _SOFT), ("hard", _LENGTH, _HARD))
    )
    effects = {"lateral": "on", "tilt": "on", "axial": "off"}
    return replace(scene, shafts=shafts, gears=gears, bushings=bushings, effects=effects)


@STIFFNESSES.add(
    "unloaded_in_clearance",
    "Nothing presses the disc against its bearing: within the clearance it has no stiffness and no place to "
    "rest.",
    "The closed form of flights and half sines between the walls, to one tolerance per impact; so does the "
    "energy.",
)
def _unloaded_in_clearance() -> Sequence[Measured]:
    """Throw an unloaded disc to and fro in the clearance of its bearing."""
    natural = math.sqrt(_WALL / _MASS)
    duration = 0.5 * _BOUNCES * cycle(2.0 * _CLEARANCE, _SPEED_SUPPORTS, natural)
    grown = _TOLERANCE_SUPPORTS * 2.0 * _CLEARANCE * natural / _SPEED_SUPPORTS * _BOUNCES**2 / 2.0
    paths, energies = [], []
    for method in METHODS:
        system = assemble(_disc(duration, Integration(method, _TOLERANCE_SUPPORTS)))
        run, path = _thrown_between_supports(system)
        paths.append(path)
        exact = _CLEARANCE + bounce(run.time, 2.0 * _CLEARANCE, _SPEED_SUPPORTS, natural)
        energies.append((rms(path - exact), abs(float(np.diff(run.stored.sum(axis=1))[0] - run.work.sum()))))
    start = static_equilibrium(assemble(_disc(duration, Integration())))
    return (
        Measured("equilibrium of the unloaded disc found", float(start.status.usable), least=1.0),
        Measured(
            "two integrators apart, over a tolerance per impact and what flights make of it",
            rms(paths[0] - paths[1]) / (2.0 * grown), most=1.0,
        ),
        Measured("off the closed form, likewise", max(off for off, _ in energies) / grown, most=1.0),
        Measured(
            "energy lost over twenty impacts, over a tolerance per impact",
            max(lost for _, lost in energies) / (0.5 * _MASS * _SPEED_SUPPORTS**2)
            / (2.0 * _TOLERANCE_SUPPORTS * natural / _SPEED_SUPPORTS * _BOUNCES), most=1.0,
        ),
    )  # fmt: skip


def _disc(duration: float, integration: Integration) -> Scene:
    """Return a disc in one bearing with clearance, turned through a soft coupling by the driving gear."""
    outputs = Outputs(1e5)
    scene = torsional(spring(), speed=10.0 * RPM, duration=duration, outputs=outputs, integration=integration)
    return replace(
        scene,
        shafts=(*scene.shafts, Shaft("disc", _LENGTH, (0.0, 0.0, 0.4), Inertia(_MASS, 0.02, 0.01))),
        bushings=(Bushing("seat", "disc", _LENGTH / 2.0),),
        couplings=(Coupling("joint", "shaft 1", "disc", 100.0),),
        rolling_contacts=(RollingContact("seat", _WALL, 1.0, _CLEARANCE, damping=0.0),),
        effects={"lateral": "on", "bearing_clearance": "on"},
    )


def _thrown_between_supports(system: System) -> tuple[Trajectory, FloatArray]:
    """Let the disc leave the side of its bearing at the speed given; return the run and its place across."""
    start = static_equilibrium(system)
    across = system.freedoms.name.index("disc.x")
    displacement = start.displacement.copy()
    displacement[[n.startswith("disc.") and n[-1] in "xy" for n in system.freedoms.name]] = 0.0
    displacement[across] = _CLEARANCE
    velocity = np.zeros(displacement.size)
    velocity[across] = -_SPEED_SUPPORTS
    scene = system.scene
    run = integrate(system, replace(start, displacement=displacement), scene.integration, velocity=velocity)
    return run, run.q[:, across]
