"""The map of a state over one common period, and its derivatives, for shooting and Floquet theory.

The common period is the shortest time after which all meshes, loads and frames are in phase again. States are
displacements and rates of n freedoms, both scaled to meters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bounds import above, below
from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import System
from dynamics.assembly.varied import with_static_reference
from dynamics.checks import integer
from dynamics.errors import InputError, SolveError
from dynamics.forces.laws import Law
from dynamics.integrators import static_equilibrium
from dynamics.integrators.advance import prepare_steps
from dynamics.integrators.explicit_step import accelerate, explicit_step
from dynamics.integrators.implicit_step import implicit_step
from dynamics.integrators.workspace import Workspace
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.cubics import Cubics
from dynamics.linearize import Modes, natural_modes
from dynamics.linearize.common_period import CommonPeriod, common_period
from dynamics.linearize.linear_system import about_running, require_freedoms
from dynamics.linearize.load_harmonics import load_cycles
from dynamics.mechanism.additions import ELEMENT_PASSING
from dynamics.meshes.packed_tables import BUCKETS_PER_KNOT
from dynamics.types import BoolArray, FloatArray, IntArray

HALVINGS = 8
"""A step in which a flank lifts off or lands is halved down to 1/256 around it, so that its kink costs no
digits and the end of the march depends smoothly on its start."""

SAME = 1e-11  # over the period: nearer knots count as one, nearer step sizes as equal
MAX_STEPS = 1_000_000  # most steps of a period
MAX_GAIN = 100.0  # largest gain of a resonance that counts
STEPS_PER_CYCLE = 24  # least steps per cycle of the highest natural frequency
STEPS_PER_PITCH = 64  # per pitch of the mesh with the most, or per cycle of a load's highest order
NEWTON_SHARE = 1e-12  # last update in an implicit stage, over the largest force
DIFFERENCE = 1e-6  # step of differences for derivatives, over the size of the state


@compiled
def _march(
    system: SystemArrays,
    work: Workspace,
    implicit: bool,
    force_tolerance: float,
    time: FloatArray,
    level: IntArray,
    touching: BoolArray,
    keep: bool,
    path: FloatArray,
) -> bool:
    """Step from the state in `work` over `time` (N + 1,) by `level` (N,); leave the end in `work`.

    Step `level` halved j times is `step_sizes[(HALVINGS + 1) level + j]`. `touching` (R,) is scratch.
    With `keep`, q, q' and q'' at all times go into `path` (3, N + 1, n). Returns whether all stages were
    solved and the end is finite.
    """
    for i in range(work.q.size):
        work.q_new[i], work.v_new[i] = work.q[i], work.v[i]
    accelerate(system, work, time[0], 0)
    for i in range(work.q.size):
        work.a[i] = work.stage_a[0, i]
    for r in range(touching.size):
        touching[r] = work.local.elastic[r] > 0.0
    for step in range(level.size):
        if keep:
            _keep(work, step, path)
        if not _full_step(
            system, work, implicit, force_tolerance, time[step], level[step] * (HALVINGS + 1), touching
        ):
            return False
    if keep:
        _keep(work, level.size, path)
    total = 0.0
    for i in range(work.q.size):
        total += abs(work.q[i]) + abs(work.v[i])
    return math.isfinite(total)


@inner
def _full_step(
    system: SystemArrays,
    work: Workspace,
    implicit: bool,
    force_tolerance: float,
    start: float,
    level: int,
    touching: BoolArray,
) -> bool:
    """Advance by the step `level` in one, or in halves of halves around a change of contact."""
    parts, done, halved = 2**HALVINGS, 0, 0
    while done < parts:
        work.time[0] = start + work.step_sizes[level] * (done / parts)
        solved = True
        if implicit:
            solved = implicit_step(system, work, level + halved, force_tolerance, False)
        else:
            explicit_step(system, work, level + halved, False)
        changed = not solved
        for r in range(touching.size):
            changed = changed or (work.local.elastic[r] > 0.0) != touching[r]
        if changed and halved < HALVINGS:
            halved += 1
            continue
        if not solved:
            return False
        for i in range(work.q.size):
            work.q[i], work.v[i], work.a[i] = work.q_new[i], work.v_new[i], work.a_new[i]
        for r in range(touching.size):
            touching[r] = work.local.elastic[r] > 0.0
        done += 2 ** (HALVINGS - halved)
        while halved > 0 and done % 2 ** (HALVINGS - halved + 1) == 0:
            halved -= 1
    return True


@inner
def _keep(work: Workspace, step: int, path: FloatArray) -> None:
    for i in range(work.q.size):
        path[0, step, i], path[1, step, i], path[2, step, i] = work.q[i], work.v[i], work.a[i]


@dataclass(frozen=True)
class PeriodGrid:
    """N steps of U different sizes, in common periods; the same at all speeds."""

    phase: FloatArray
    """Ends of the steps, from 0 to 1. Shape (N + 1,)."""
    size: FloatArray
    """Different sizes of the steps, in common periods; the last is 0. Shape (U,)."""
    level: IntArray
    """Index in `size` of each step. Shape (N,)."""

    @classmethod
    def of(cls, system: System, period: CommonPeriod, largest: float) -> PeriodGrid:
        """Return steps of at most `largest` common periods, an equal number of them between any two knots.

        Tables have a kink in their second derivative at each knot (a jump of stiffness is a narrow interval
        between two of them): steps that end there keep the method's order. Raises `InputError`: that takes
        more than a million steps.
        """
        knots = _knots(system, period)
        counts = np.maximum(np.ceil(np.diff(knots) / largest * (1.0 - 1e-9)), 1.0)
        if np.sum(counts) > MAX_STEPS:
            bound = f"such that a period takes at most {MAX_STEPS} steps"
            suggestion = "Look at one stage or fewer different teeth, or at higher speeds."
            raise InputError("period", f"{period.revolutions} revolutions", bound, suggestion)
        inner = [
            np.linspace(start, end, int(count), endpoint=False)
            for start, end, count in zip(knots[:-1], knots[1:], counts, strict=True)
        ]
        phase = np.append(np.concatenate(inner), 1.0)
        key, level = np.unique(np.rint(np.diff(phase) / SAME), return_inverse=True)
        size = np.array([np.mean(np.diff(phase)[level == k]) for k in range(key.size)])
        return cls(phase, np.append(size, 0.0), np.asarray(level, dtype=np.int64))

    @property
    def halved(self) -> PeriodGrid:
        """The grid with every step halved."""
        middle = 0.5 * (self.phase[1:] + self.phase[:-1])
        phase = np.sort(np.concatenate([self.phase, middle]))
        return PeriodGrid(phase, 0.5 * self.size, np.repeat(self.level, 2))


def _knots(system: System, period: CommonPeriod) -> FloatArray:
    """Phases at which any flank passes a knot of its table, with 0 and 1."""
    elements, reference = system.arrays.elements, system.arrays.reference
    table = elements.laws.flank.table
    phases = [np.array([0.0, 1.0])]
    for law, entry, mesh in zip(elements.law, elements.entry, elements.mesh, strict=True):
        pitches = period.pitches[mesh] if law == Law.FLANK else 0
        if pitches == 0:
            continue
        first, span = table.offset[entry, 0], table.period[entry]
        last = first + table.offset[entry, 2] // BUCKETS_PER_KNOT
        knot = table.knot[first:last] + table.shift[entry] - reference.offset[mesh]
        cycles = abs(pitches) // round(span)
        passed = (knot[:, None] + span * np.arange(cycles)) / pitches
        phases.append(np.ravel(passed) % 1.0)
    phase = np.sort(np.concatenate(phases))
    distinct = np.diff(phase, prepend=-1.0) > SAME
    phase = phase[distinct]
    phase[-1] = 1.0
    return phase


def _check_speed(system: System, period: CommonPeriod, speed: float) -> None:
    """Refuse a speed of 0 or of the other sense, in which other flanks carry."""
    extreme = system.scene.drives[period.law].speed.extreme
    if not np.isfinite(speed) or speed * extreme <= 0.0:
        bound = (above if extreme > 0.0 else below)(0.0, note=", the sense in which the scene turns")
        raise InputError("speed", speed, bound, "Reverse the scene's drive for the other flanks.")


def _at_constant_speed(system: System, period: CommonPeriod, speed: float, time: float) -> SystemArrays:
    """Return the arrays with the drives at `speed` (rad/s, of the leading law) for ever.

    Loads by time keep the values that they have at `time`.
    """
    _check_speed(system, period, speed)
    speeds = _constant(speed * period.proportion)
    zeros = np.zeros(period.proportion.size)
    torque = np.array([float(load.torque(time)) for load in system.scene.loads])
    arrays = system.arrays
    laws = arrays.elements.laws
    laws = laws._replace(applied_force=laws.applied_force.frozen_at(time))
    changed = arrays._replace(
        reference=arrays.reference._replace(speed=speeds, full_turns=zeros, fraction=zeros),
        load=arrays.load._replace(torque=_constant(torque)),
        elements=arrays.elements._replace(laws=laws),
    )
    return by_address(changed)


def _constant(values: FloatArray) -> Cubics:
    """Lay out laws that never change."""
    coefficient = np.zeros((values.size, 4))
    coefficient[:, 0] = values
    return Cubics(np.arange(values.size + 1), np.zeros(values.size), coefficient)


def _largest_force(system: System, mesh_force: FloatArray) -> float:
    """Return the largest force of meshes and loads at the largest speed, N."""
    laws, extreme = system.arrays.elements.laws, [part.speed.extreme for part in system.scene.references]
    speed = float(np.max(np.abs(system.kinematics.float_ratio @ np.array(extreme))))
    turning = laws.applied_force.size, laws.unbalance.amount * speed**2
    forces = (mesh_force, system.flanks.nominal_force, *turning)
    return max(float(np.max(np.abs(force), initial=0.0)) for force in forces)


def _stiffest(system: System) -> float:
    """Return the stiffness of the stiffest mesh; without meshes, of the stiffest freedom, N/m."""
    arrays, meshes = system.arrays, system.flanks.mean_stiffness
    if meshes.size:
        return float(np.max(meshes))
    return float(np.max(np.diag(arrays.stiffness) / arrays.scale**2)) or 1.0


def _resonant_gain(system: System, modes: Modes) -> float:
    """Return the motion by loads at a resonance over that at rest, in a system without meshes; else 1."""
    ratios = modes.damping_ratio[modes.frequency > 0.0]
    if system.scene.meshes or not ratios.size:
        return 1.0
    return min(MAX_GAIN, 0.5 / max(float(np.min(ratios)), 0.5 / MAX_GAIN))


@dataclass(frozen=True)
class PeriodicProblem:
    """A system prepared for periodic steady states; states y are (2n,) in meters.

    y = (q scale, q' rate_scale): displacements, and rates as the displacements that they become.
    """

    system: System
    period: CommonPeriod
    grid: PeriodGrid
    """Steps of one period, the same at all speeds, so that the map depends smoothly on speed."""
    rate: float
    minimum: float
    """`rate`, `minimum`: Least number of steps in a period: per second, and in all."""
    repeat: int
    """Common periods after which the motion is to repeat; 2 finds motions after period doubling."""
    time: float
    """Time at which loads are taken, s."""
    rest: FloatArray
    """Static equilibrium, m. Shape (2n,)."""
    size: float
    """Size of a state, for tolerances and differences: the largest static displacement, m."""
    force_tolerance: float
    """Force tolerance of the implicit stages, N."""

    @cached_property
    def scale(self) -> FloatArray:
        """Meters per unit of q and q', (2n,)."""
        return np.concatenate([self.system.arrays.scale, self.system.arrays.rate_scale])

    def at(self, speed: float) -> PeriodicProblem:
        """Return the problem with the steps that a speed takes by itself, fewer than a lower one.

        Raises `InputError`: the speed is zero or of the other sense.
        """
        _check_speed(self.system, self.period, speed)
        largest = 1.0 / max(self.rate * self.period.duration(speed), self.minimum)
        return replace(self, grid=PeriodGrid.of(self.system, self.period, largest))


def periodic_problem(
    system: System, slowest: float, repeat: int = 1, time: float = 0.0, steps_per_cycle: int = STEPS_PER_CYCLE
) -> PeriodicProblem:
    """Prepare `system` for speeds from `slowest` (rad/s) up.

    Raises `InputError`: there is nothing to vibrate, or the meshes have no common period; `SolveError`: there
    is no static equilibrium.
    """
    integer("repeat", repeat, 1, 1000)
    integer("steps_per_cycle", steps_per_cycle, 4, 100_000)
    require_freedoms(system)
    if system.ledger.adds(ELEMENT_PASSING):
        name = system.ledger.effect_adding(ELEMENT_PASSING)
        bound = "off: cages turn at no ratio of integers to the meshes, so nothing repeats"
        raise InputError(f"effects.{name}", "on", bound, "Average the passing, or simulate a run.")
    period, start = common_period(system), static_equilibrium(about_running(system), time)
    if not start.status.usable:
        raise SolveError(f"no static equilibrium: {start.status.name.lower()}, {start.residual:.3g} N left")
    _check_speed(system, period, slowest)
    system = with_static_reference(system, start.displacement, time)
    modes = natural_modes(system, time)
    rate = steps_per_cycle * _highest(system, modes.frequency)
    pitches = max((abs(count) for count in period.pitches), default=0)
    minimum = float(STEPS_PER_PITCH * max(pitches, load_cycles(system, period)))
    rest = start.displacement * system.arrays.scale
    force, stiff = _largest_force(system, start.mesh_force), _stiffest(system)
    size = max(float(np.max(np.abs(rest))), _resonant_gain(system, modes) * force / stiff)
    if size <= 0.0:
        raise InputError(
            "loads", 0.0, "present, or a nominal force given", "They set the size of the motion."
        )
    return PeriodicProblem(
        system=system,
        period=period,
        grid=PeriodGrid.of(system, period, 1.0 / max(rate * period.duration(slowest), minimum)),
        rate=rate,
        minimum=minimum,
        repeat=repeat,
        time=time,
        rest=np.concatenate([rest, np.zeros(rest.size)]),
        size=size,
        force_tolerance=NEWTON_SHARE * max(force, stiff * size),
    )


def _highest(system: System, frequency: FloatArray) -> float:
    """Return the highest natural frequency that steps resolve, Hz.

    Flexible shafts and housings have coordinates far above what is of interest; the implicit method lets them
    follow as springs do. In housings the vibration by meshes is of interest.
    """
    interest = [rotor.elastic.highest for rotor in system.rotors if rotor.elastic is not None]
    interest += [system.sampling.mode_frequency for _ in system.rotors.housings]
    if not interest or system.scene.integration.method == "explicit":
        return float(frequency[-1])
    return float(np.max(frequency[frequency <= max(interest)], initial=0.0))


@dataclass(frozen=True)
class PeriodMap:
    """y -> state `repeat` common periods later at one speed; not to be shared between threads.

    `speed`: of the leading law, rad/s.
    """

    problem: PeriodicProblem
    speed: float

    @cached_property
    def arrays(self) -> SystemArrays:
        """The system at this speed."""
        problem = self.problem
        return _at_constant_speed(problem.system, problem.period, self.speed, problem.time)

    @cached_property
    def duration(self) -> float:
        """Duration of `repeat` common periods, s."""
        return self.problem.repeat * self.problem.period.duration(self.speed)

    @cached_property
    def times(self) -> FloatArray:
        """Ends of the steps of one common period, s."""
        return self.problem.grid.phase * self.problem.period.duration(self.speed)

    @cached_property
    def _work(self) -> Workspace:
        sizes = self.problem.grid.size[:-1] * self.problem.period.duration(self.speed)
        step_sizes = np.outer(sizes, 0.5 ** np.arange(HALVINGS + 1)).ravel()
        n = self.arrays.mass.shape[0]
        work = by_address(Workspace.of(self.arrays, step_sizes, np.zeros(n), float(step_sizes[0])))
        implicit = self.problem.system.scene.integration.method != "explicit"
        prepare_steps(self.arrays, work, implicit, False)
        return work

    def __call__(self, y: FloatArray) -> FloatArray:
        """Return the state `repeat` common periods after `y`, (2n,); NaN where the march failed."""
        for _ in range(self.problem.repeat):
            y = self._one_period(y, np.empty((3, 0, 0)))
        return y

    def path(self, y: FloatArray) -> FloatArray:
        """Return q, q' and q'' at the ends of the steps of all periods, (3, repeat N + 1, n), SI."""
        n, parts = y.size // 2, []
        for _ in range(self.problem.repeat):
            part = np.empty((3, self.times.size, n))
            y = self._one_period(y, part)
            parts.append(part[:, :-1])
        return np.concatenate([*parts, part[:, -1:]], axis=1)

    def monodromy(self, y: FloatArray) -> FloatArray:
        """Return the derivative of the map at `y`, (2n, 2n), by central differences."""
        step = DIFFERENCE * self.problem.size
        columns = [(self(y + step * unit) - self(y - step * unit)) / (2.0 * step) for unit in np.eye(y.size)]
        return np.stack(columns, axis=1)

    def by_speed(self, y: FloatArray) -> FloatArray:
        """Return the derivative of the map in the speed, (2n,) in m s/rad, by central differences."""
        step = DIFFERENCE * self.speed
        up, down = (replace(self, speed=self.speed + sign * step)(y) for sign in (1.0, -1.0))
        return np.asarray((up - down) / (2.0 * step))

    def step_error(self, y: FloatArray) -> FloatArray:
        """Return the change of the end of the march with half the step size, (2n,) m."""
        finer = replace(self.problem, grid=self.problem.grid.halved)
        return PeriodMap(finer, self.speed)(y) - self(y)

    def begun(self, y: FloatArray, steps: int) -> None:
        """March from `y` over the first `steps` steps of a period alone: a probe of their cost."""
        self._one_period(y, np.empty((3, 0, 0)), steps)

    def _one_period(self, y: FloatArray, path: FloatArray, steps: int | None = None) -> FloatArray:
        """March from `y` over one common period; fill `path` (3, N + 1, n) if it has room."""
        work, n, problem = self._work, y.size // 2, self.problem
        state = y / problem.scale
        work.q[:], work.v[:] = state[:n], state[n:]
        work.force[:] = 0.0
        solved = _march(
            self.arrays,
            work,
            problem.system.scene.integration.method != "explicit",
            problem.force_tolerance,
            self.times,
            problem.grid.level[:steps],
            np.empty(work.force.size, dtype=np.bool_),
            path.size > 0,
            path,
        )
        if not solved:
            return np.full(y.size, np.nan)
        return np.concatenate([work.q, work.v]) * problem.scale
