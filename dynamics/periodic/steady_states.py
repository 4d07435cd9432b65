"""Periodic steady states over speed as a study: both sweeps, the branch between them, jumps, and its file.

The sweeps follow the motions at rising and at falling speeds, each from the motion before. Where they differ,
two motions exist at one speed, and an unstable branch joins them. A jump is the speed at which a sweep leaves
its motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bounds.brief import brief
from bounds.plottable import Plottable
from dynamics.assembly.assemble import System
from dynamics.errors import InputError
from dynamics.linearize.operating_speeds import checked_speeds, leading_law
from dynamics.motion.observation import observe, static_deflections
from dynamics.periodic.continuation import Branch, follow_branch
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap, periodic_problem
from dynamics.periodic.shooting import SETTLING, Instability, Orbit, find_orbit, settled
from dynamics.periodic.steady_cost import expected_iterations, motion_periods, period_seconds, steps_share
from dynamics.results.array_file import ArrayFile, stored
from dynamics.results.run_checks import checked_ledger
from dynamics.types import ComplexArray, FloatArray, IntArray, Json
from host import cpu_seconds
from host.optional_modules import scipy
from model_studies.record import under_key
from model_studies.workers import InProcess, Workers, pays, spent

SAMPLES_PER_PITCH = 64  # least samples of a pitch; doubled until there are as many as steps
FINE = 256  # samples per base pitch, for the share of the period that flanks touch
PER_MESH = (
    "mean_error",
    "rms_error",
    "peak_to_peak_error",
    "least_force",
    "largest_force",
    "parted",
    "coasting",
)
KINDS = (Instability.NONE, Instability.FOLD, Instability.PERIOD_DOUBLING, Instability.NEIMARK_SACKER)
UP, DOWN, BRANCH = 0, 1, 2  # numbers of the curves: rising speeds, falling speeds, the branch
CURVES = ("up", "down", "branch")
SAME = 0.02  # distance over the rms of the transmission error, below which motions are the same
MESH = ("point", "mesh")


@dataclass(frozen=True)
class _PeriodicMotion:
    """Series over one period on a uniform grid of T samples, its end left out; m meshes, b bearings."""

    time: FloatArray
    """Times, s. Shape (T,)."""
    position: FloatArray
    """Positions of the meshes, base pitches in [0, period of the table). Shape (m, T)."""
    dynamic_transmission_error: FloatArray
    static_transmission_error: FloatArray
    """`dynamic_transmission_error`, `static_transmission_error`: Transmission errors, m. The static one is
    that at the nominal force, with the misalignment and center distance of the bodies at rest. Shape (m, T)
    each.
    """
    mesh_force: FloatArray
    coast_force: FloatArray
    """`mesh_force`, `coast_force`: Transverse forces of the driving flanks, and of the coast flanks in use,
    N. (m, T), (c, T) arrays.
    """
    bearing_force: FloatArray
    """Force on the ground or the pin, in the bearing's own frame, N; with seats (b, 6, T), moments in N m.
    Shape (b, 3, T).
    """
    displacement: FloatArray
    velocity: FloatArray
    """`displacement`, `velocity`: Deviations from the kinematic motion, m and rad, and their rates. Shape
    (n, T) each.
    """
    order: FloatArray
    """Orders of the lines of `spectrum`: multiples of the frequency of the first mesh that turns. Shape
    (T // 2 + 1,).
    """

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
) -> _PeriodicMotion:
    """Return the series of `orbit`, a motion that `problem` has, at least so many samples per base pitch."""
    over_period = PeriodMap(problem, orbit.speed)
    path = over_period.path(orbit.state)
    once = over_period.times
    step_end = np.concatenate([once[:-1] + k * once[-1] for k in range(problem.repeat)] + [[orbit.duration]])
    pitches = problem.repeat * problem.period.counted
    finest = max((step_end.size - 1) / pitches, samples_per_pitch)
    samples = pitches * 2 ** int(np.ceil(np.log2(finest)))
    time = orbit.duration * np.arange(samples) / samples
    q = np.ascontiguousarray(scipy.interpolate.CubicHermiteSpline(step_end, path[0], path[1])(time))
    v = np.ascontiguousarray(scipy.interpolate.CubicHermiteSpline(step_end, path[1], path[2])(time))
    system, arrays = problem.system, over_period.arrays
    observed = observe(arrays, time, q, v)
    meshes, driving = len(system.scene.meshes), system.driving_rows
    coast = arrays.elements.first[meshes : meshes + len(system.flanks.coast)]
    static = np.empty((meshes, samples))
    for f, force in enumerate(system.flanks.nominal_force):
        static_deflections(system.flanks.static, f, observed.position[f], float(force), static[f])
    return _PeriodicMotion(
        time=time,
        position=observed.position[:meshes],
        dynamic_transmission_error=observed.coordinate[driving],
        static_transmission_error=static,
        mesh_force=observed.force[driving],
        coast_force=observed.force[coast],
        bearing_force=system.bearing_force(observed.force, q, v),
        displacement=np.ascontiguousarray(q.T),
        velocity=np.ascontiguousarray(v.T),
        order=np.arange(samples // 2 + 1) / pitches,
    )


def _figures_of(problem: PeriodicProblem, orbits: Sequence[Orbit], swept: int) -> dict[str, Any]:
    """Return the figures of all `orbits` by the names of `SteadyStates`; NaN where no motion was found.

    The first `swept` of them are those of sweeps; the steps of each fit its speed.
    """
    meshes, bearings = len(problem.system.scene.meshes), len(problem.system.supports.name)
    per_mesh = np.full((len(PER_MESH), len(orbits), meshes), np.nan)
    on_bearing = np.full((len(orbits), bearings), np.nan)
    for index, orbit in enumerate(orbits):
        if orbit.status.usable:
            problem_at = problem.at(orbit.speed) if index < swept else problem
            per_mesh[:, index], on_bearing[index] = _figures(problem_at, orbit)
    return {
        "speed": np.array([abs(orbit.speed) for orbit in orbits]),
        "status": np.array([int(orbit.status) for orbit in orbits], dtype=np.int64),
        "residual": np.array([orbit.residual for orbit in orbits]),
        "iterations": np.array([orbit.iterations for orbit in orbits], dtype=np.int64),
        "step_error": np.array([orbit.step_error for orbit in orbits]),
        "instability": np.array([KINDS.index(orbit.instability) for orbit in orbits], dtype=np.int64),
        "multiplier": np.array([orbit.multipliers for orbit in orbits]),
        **dict(zip(PER_MESH, per_mesh, strict=True)),
        "rms_bearing_force": on_bearing,
    }


def _figures(problem: PeriodicProblem, orbit: Orbit) -> tuple[FloatArray, FloatArray]:
    """Return the figures `PER_MESH` of every mesh (7, m), and the alternating force on every bearing (b,)."""
    series = motion(problem, orbit, FINE)
    error, force = series.dynamic_transmission_error, series.mesh_force
    coasting = np.zeros(force.shape[0])
    for row, mesh in enumerate(problem.system.flanks.coast):
        coasting[mesh] = np.mean(series.coast_force[row] > 0.0)
    figures = (
        np.mean(error, axis=1),
        np.std(error, axis=1),
        np.ptp(error, axis=1),
        np.min(force, axis=1),
        np.max(force, axis=1),
        series.parted,
        coasting,
    )
    bearing = np.sqrt(np.sum(np.var(series.bearing_force[:, :3], axis=-1), axis=1))
    return np.array(figures), np.asarray(bearing)


def sweep(
    problem: PeriodicProblem,
    speeds: Sequence[float] | FloatArray,
    periods: int = SETTLING,
    progress: Callable[[float], None] | None = None,
) -> tuple[Orbit, ...]:
    """Return the motion at each of `speeds` (rad/s) in turn, settled from the one before, with its own steps.

    The motion stays on its branch up to the fold and jumps there, as a slow run does: rising and falling
    speeds give the two sides of a hysteresis. If it does not settle on a motion of the requested period (a
    longer period, chaos), the status says so, and the sweep goes on from there. `progress` is called with the
    fraction of the steps done; what it raises ends the sweep. Raises `InputError`: a speed is zero or of the
    other sense.
    """
    state, orbits = problem.rest, []
    problems = [problem.at(float(speed)) for speed in speeds]
    steps = np.cumsum([problem_at.grid.level.size for problem_at in problems])
    for problem_at, speed, done in zip(problems, map(float, speeds), steps, strict=True):
        state = settled(problem_at, speed, state, periods)
        orbits.append(find_orbit(problem_at, speed, state))
        if orbits[-1].status.usable and orbits[-1].stable:
            state = orbits[-1].state
        if progress is not None:
            progress(float(done / steps[-1]))
    return tuple(orbits)


@brief
@dataclass(frozen=True)
class SteadyStates(ArrayFile, Plottable):
    """P periodic motions on three curves: at rising speeds, at falling ones, and along the branch.

    m meshes, b bearings, n freedoms; fields state unit, meaning and dimensions of arrays. Figures of motions
    that were not found are NaN; their status says why. The branch goes from the lowest to the highest speed.
    """

    SCHEMA = "lineofaction steady states"

    mesh: tuple[str, ...]
    bearing: tuple[str, ...]
    curve: IntArray = field(
        metadata=stored("1", "0 rising speeds, 1 falling speeds, 2 along the branch", "point")
    )
    speed: FloatArray = field(metadata=stored("rad s-1", "speed of the leading shaft", "point"))
    status: IntArray = field(
        metadata=stored("1", "how the search ended: 0 converged, see OrbitStatus", "point")
    )
    residual: FloatArray = field(metadata=stored("m", "largest change of the state over the period", "point"))
    """`residual`, `step_error`: See `Orbit`. Shape (P,) each."""
    iterations: IntArray = field(metadata=stored("1", "Newton iterations", "point"))
    step_error: FloatArray = field(
        metadata=stored("m", "estimate of what the steps' errors move the motion by", "point")
    )
    instability: IntArray = field(
        metadata=stored("1", "0 stable, 1 fold, 2 period doubling, 3 Neimark-Sacker", "point")
    )
    multiplier: ComplexArray = field(
        metadata=stored("1", "Floquet multipliers by falling size", "point", "state")
    )
    mean_error: FloatArray = field(metadata=stored("m", "mean dynamic transmission error", *MESH))
    rms_error: FloatArray = field(metadata=stored("m", "root mean square of its alternating part", *MESH))
    peak_to_peak_error: FloatArray = field(metadata=stored("m", "its peak-to-peak", *MESH))
    least_force: FloatArray = field(metadata=stored("N", "least mesh force of the driving flank", *MESH))
    largest_force: FloatArray = field(metadata=stored("N", "largest mesh force of the driving flank", *MESH))
    parted: FloatArray = field(
        metadata=stored("1", "share of the period that the driving flank is out of contact", *MESH)
    )
    coasting: FloatArray = field(
        metadata=stored("1", "share of the period that the coast flank is in contact", *MESH)
    )
    rms_bearing_force: FloatArray = field(
        metadata=stored("N", "root mean square of the alternating force", "point", "bearing")
    )
    """Root of the sum of squares of x, y and z. Shape (P, b)."""
    bifurcation_speed: FloatArray = field(
        metadata=stored("rad s-1", "speed of the leading shaft", "bifurcation")
    )
    bifurcation_kind: IntArray = field(
        metadata=stored("1", "1 fold, 2 period doubling, 3 Neimark-Sacker", "bifurcation")
    )
    jump_curve: IntArray = field(metadata=stored("1", "0 at rising speeds, 1 at falling ones", "jump"))
    jump_speed: FloatArray = field(
        metadata=stored("rad s-1", "last speed before and first after the jump", "jump", "side")
    )
    metadata: Json = field(default_factory=dict, metadata=under_key("facts"))
    """Plain JSON: `leading_shaft`, `branch` (status; "none" without), `repeat`, `period_pitches`, `freedoms`,
    `seconds` (CPU by stage), `effect_ledger`.
    """


def steady_states(
    system: System,
    speed: Sequence[float] | FloatArray,
    *,
    branch: bool = True,
    repeat: int = 1,
    periods: int = SETTLING,
    time: float = 0.0,
    progress: Callable[[str, float], None] | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SteadyStates:
    """Return the steady states of `system` at rising and falling speeds, and the branch between them.

    Raises `InputError`: a value is out of range, there is nothing to vibrate, or the meshes have no common
    period; `SolveError`: there is no static equilibrium, or a motion beyond the table (`STRAIGHT_ON`) is not
    accepted.

    Parameters
    ----------
    speed : (S,) sequence
        Speeds of the first drive that turns, rad/s, increasing, > 0; the scene decides the sense.
    branch : bool
        Whether to follow the branch from the lowest to the highest speed, through folds and unstable parts.
    repeat : int
        Period of the motions in common periods.
    periods : int
        Periods of settling at each speed of a sweep before Newton's method.
    time : float
        Time at which loads are evaluated, s.
    progress : callable, optional
        Called with the curve (`CURVES`) and the fraction of it done; an exception in it ends the study.
    workers : Workers
        Workers, which take a sweep each.
    """
    speeds = checked_speeds(np.asarray(speed, dtype=float), above_zero=True)
    if not speeds.size:
        raise InputError("speed", [], "at least one speed")
    sense = float(np.sign(system.scene.references[leading_law(system)].speed.extreme))

    def stage(name: str) -> Callable[[float], None]:
        return lambda fraction: None if progress is None else progress(name, fraction)

    began = spent(workers)
    problem = periodic_problem(system, sense * speeds[0], repeat, time)
    courses = [sense * speeds, sense * speeds[::-1]] if speeds.size > 1 else [sense * speeds]
    up, down = _sweeps(problem, courses, periods, stage, workers)
    seconds = {"sweeps": spent(workers) - began}
    began = cpu_seconds()
    followed = _branch_from(problem, courses[0], up[0], stage(CURVES[BRANCH])) if branch else None
    seconds["branch"] = cpu_seconds() - began
    began = cpu_seconds()
    curves = (up, down, followed.orbits if followed is not None else ())
    figures = _figures_of(problem, [orbit for orbits in curves for orbit in orbits], len(up) + len(down))
    seconds["figures"] = cpu_seconds() - began
    return _study(problem, curves, followed, figures, seconds)


def _sweeps(
    problem: PeriodicProblem,
    courses: Sequence[FloatArray],
    periods: int,
    stage: Callable[[str], Callable[[float], None]],
    workers: Workers,
) -> tuple[tuple[Orbit, ...], tuple[Orbit, ...]]:
    """Return the motions at rising speeds, and at falling ones if there are several."""
    swept: list[tuple[Orbit, ...]] = []
    reports = [stage(CURVES[curve]) for curve in (UP, DOWN)]
    others = len(courses) > 1 and not isinstance(workers, InProcess)
    if others and pays(workers, _sweep_seconds(problem, courses, periods)):
        for orbits in workers.run(_swept, (problem, periods), courses):
            reports[len(swept)](1.0)
            swept.append(orbits)
    else:
        swept = [
            sweep(problem, speeds, periods, report) for speeds, report in zip(courses, reports, strict=False)
        ]
    return swept[0], swept[1] if len(swept) > 1 else ()


def _branch_from(
    problem: PeriodicProblem, course: FloatArray, first: Orbit, report: Callable[[float], None]
) -> Branch | None:
    """Follow the branch of the first motion of a course to its end; None of a single speed."""
    if course.size < 2:
        return None
    guess = first.state if first.status.usable else None
    return follow_branch(problem, course[0], course[-1], guess=guess, progress=report)


def _swept(shared: tuple[PeriodicProblem, int], speeds: FloatArray) -> tuple[Orbit, ...]:
    """Return the motions at speeds in turn: one task."""
    problem, periods = shared
    return sweep(problem, speeds, periods)


def _sweep_seconds(problem: PeriodicProblem, courses: Sequence[FloatArray], periods: int) -> float:
    first = float(courses[0][0])
    motions = motion_periods(problem.rest.size // 2, periods, expected_iterations(problem, first, periods))
    seconds = period_seconds(problem, first) * steps_share(problem, courses[0])
    return seconds * motions * sum(map(len, courses))


def _study(
    problem: PeriodicProblem,
    curves: tuple[tuple[Orbit, ...], ...],
    branch: Branch | None,
    figures: dict[str, Any],
    seconds: Json,
) -> SteadyStates:
    bifurcations = branch.bifurcations if branch is not None else ()
    jumps = _jumps(figures, len(curves[UP])) if curves[DOWN] else []
    scene = problem.system.scene
    largest = np.asarray(np.max(np.nan_to_num(figures["largest_force"]), axis=0, initial=0.0))
    metadata: Json = {
        "leading_shaft": scene.references[leading_law(problem.system)].shaft,
        "branch": branch.status.name if branch is not None else "none",
        "repeat": problem.repeat,
        "period_pitches": {
            mesh.name: problem.repeat * abs(count)
            for mesh, count in zip(scene.meshes, problem.period.pitches, strict=True)
        },
        "freedoms": list(problem.system.freedoms.name),
        "steps_per_period": int(problem.grid.level.size) * problem.repeat,
        "seconds": seconds,
        "effect_ledger": checked_ledger(problem.system, largest),
        **problem.system.corrections,
    }
    return SteadyStates(
        **figures,
        mesh=tuple(mesh.name for mesh in scene.meshes),
        bearing=problem.system.supports.name,
        curve=np.repeat(np.arange(len(curves)), [len(orbits) for orbits in curves]),
        bifurcation_speed=np.array([abs(b.speed) for b in bifurcations]),
        bifurcation_kind=np.array([KINDS.index(b.kind) for b in bifurcations], dtype=np.int64),
        jump_curve=np.array([curve for curve, _ in jumps], dtype=np.int64),
        jump_speed=np.array([ends for _, ends in jumps], dtype=float).reshape(-1, 2),
        metadata=metadata,
    )


def _jumps(figures: dict[str, Any], speeds: int) -> list[tuple[int, tuple[float, float]]]:
    """Return the curves that jump, with the speeds before and after: next to speeds that have two motions.

    The first `speeds` figures are of rising speeds, as many after them of falling ones.
    """
    rising, falling = figures["rms_error"][:speeds], figures["rms_error"][speeds : 2 * speeds][::-1]
    jump = np.abs(rising - falling) > SAME * np.maximum(rising, falling)  # False where one was not found
    two = np.any(jump, axis=1)
    jumps = []
    for index in range(len(two) - 1):
        low, high = (float(value) for value in figures["speed"][index : index + 2])
        if two[index] and not two[index + 1]:
            jumps.append((UP, (low, high)))
        if two[index + 1] and not two[index]:
            jumps.append((DOWN, (high, low)))
    return jumps
