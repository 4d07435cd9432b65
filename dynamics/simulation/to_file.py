"""A run from its scene to a result file: states stream to disk, checkpoints let a later process go on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from bounds import warn_of
from dynamics.assembly.assemble import System
from dynamics.assembly.varied import with_static_reference
from dynamics.errors import ResultError, SolveError
from dynamics.influence import Decision, decide_effects
from dynamics.influence.neglected_check import NeglectedChecks
from dynamics.integrators import Cancel, Progress, StaticSolution, Trajectory, integrate, static_equilibrium
from dynamics.integrators import march as marching
from dynamics.integrators.checkpoints import fingerprint, restore
from dynamics.integrators.march import Ending, March, march_on, start_march
from dynamics.integrators.method_choice import MethodChoice, choose_method
from dynamics.integrators.start_value import StartValue, Trail
from dynamics.integrators.state_sink import MemorySink, StateSpool, blocks
from dynamics.integrators.workspace import Count
from dynamics.motion.sampled_states import Widths
from dynamics.plausibility import scene_findings
from dynamics.results import RunResult
from dynamics.results.checks import ending
from dynamics.results.run_checks import RunChecks
from dynamics.results.run_result import SAMPLED, RunFile, attributes
from dynamics.scene import Integration, Scene
from dynamics.simulation.documents import (
    Description,
    RunContext,
    described,
    documents,
    effect_ledger,
    requested_error,
    series_of,
    with_tolerance,
)
from dynamics.simulation.error_by_source import error_by_source, window_starts
from dynamics.simulation.light_loads import with_tolerance_to_scale
from dynamics.simulation.long_run_error import RunPair, blind_windows, finer_run
from dynamics.simulation.violations import FIRST, EarlierRun, StatesOf, needed_effects, taken_over
from dynamics.types import Json, RunStatus
from model_studies.stage_clock import StageClock, TimeTaken

CHECKPOINT_EVERY = 5.0  # s of wall time

EffectChoice = Callable[[Scene], Decision]
"""Decides the effects of a scene: `decide_effects`, or a decision that a study took before."""


@dataclass(frozen=True)
class _MadeRun:
    """A run as made: its status, effect ledger and CPU time (s), its saved states, its records."""

    status: RunStatus
    ledger: Json
    seconds: float
    trail: Trail
    widths: Widths


@dataclass(frozen=True)
class _Session:
    """Calls of a run for its progress and for whether to stop, and the wall time between checkpoints, s."""

    progress: Progress | None
    cancel: Cancel | None
    checkpoint_every: float


class _Leg:
    """One integration with its states on disk, resumed from its checkpoint."""

    def __init__(
        self,
        stack: ExitStack,
        path: Path,
        system: System,
        start: StaticSolution,
        integration: Integration,
        resume: bool,
        earlier: _MadeRun | None = None,
    ) -> None:
        self.march: March = start_march(system, start, integration, modal_samples=window_starts(system))
        work, control, duration = self.march.work, self.march.control, system.scene.duration
        self._mark = fingerprint(
            system.arrays, control, self.march.sampler, work.step_sizes, start.displacement, duration
        )
        self.spool = stack.enter_context(StateSpool(path, self.march.widths))
        self._taken = TimeTaken()
        self._status: RunStatus | None = None
        self.since = 0.0
        checkpoint = self.spool.checkpoint() if resume else None
        start_value = earlier and taken_over(earlier.ledger, earlier.trail, self.spool.states, system)
        if checkpoint is not None:
            self._resume(path, *checkpoint)
        elif earlier and start_value:
            self._go_on_for(earlier.widths, start_value)
        else:
            self.spool.begin()

    def _resume(self, path: Path, arrays: dict[str, Any], values: dict[str, Any]) -> None:
        if str(values.get("mark")) != self._mark:
            raise ResultError(f"{path}: of another scene or version. Start a new run.")
        restore(self.march.state, arrays, path)
        self.spool.resume(int(values["samples"]))
        self._taken = TimeTaken(float(values["cpu_seconds"]), float(values["wall_seconds"]))
        self.since = float(values["since"])
        status = RunStatus(int(values["status"]))
        self._status = None if status is RunStatus.CANCELLED else status

    def _go_on_for(self, widths: Widths, start_value: StartValue) -> None:
        """Start from an earlier run, whose samples the spool holds; save at once, as its own are gone."""
        start_value.start(self.march)
        samples = start_value.at.samples
        self.spool.rewrite(widths, samples, lambda states: start_value.widened(states, self.march))
        self.spool.resume(samples)
        self.since = start_value.at.time
        self._save(RunStatus.CANCELLED)

    def go(self, session: _Session, trail: Trail | None = None) -> Ending:
        """March on to the end, with checkpoints; one that had ended stays as it is."""
        before, began, saved = self._taken, TimeTaken.now(), monotonic()
        remember = None if trail is None else trail.watch(self.march)

        def after_block() -> None:
            nonlocal saved
            if remember is not None:
                remember()
            self._taken = before.plus(TimeTaken.now().since(began))
            if monotonic() - saved >= session.checkpoint_every:
                self._save(RunStatus.CANCELLED)
                saved = monotonic()

        if self._status is None:
            status = march_on(self.march, self.spool, session.progress, session.cancel, after_block)
            self._taken = before.plus(TimeTaken.now().since(began))
            self._save(status)
            self._status = status
        return marching.ending(self.march, self.spool, self._status, self._taken)

    def _save(self, status: RunStatus) -> None:
        samples = int(self.march.work.counts[Count.OUTPUT])
        values = {"mark": self._mark, "samples": samples, "since": self.since, **asdict(self._taken)}
        self.spool.save(self.march.state, **values, status=int(status))


def simulate(scene: Scene, progress: Progress | None = None, cancel: Cancel | None = None) -> RunResult:
    """Run `scene` from static equilibrium at t = 0 over its duration.

    All series are kept in memory; for longer runs use `simulate_to_file`.

    Parameters
    ----------
    scene : Scene
    progress : callable, optional
        Called with the fraction done (0..1) and the stage; an exception in it ends the run.
    cancel : callable, optional
        Polled for whether to stop; e.g. ``threading.Event().is_set``.

    Returns
    -------
    RunResult
        Complete: its status is `RunStatus.COMPLETED`.

    Raises
    ------
    InputError
        If the scene's parts do not fit each other.
    SolveError
        If there is no equilibrium to start from, the run stopped early or was cancelled, or it violates an
        assumption and the scene's ``on_violation`` is "fail", or "repeat" and no effect corrects it;
        ``partial`` is the result up to then.

    Warns
    -----
    PlausibilityWarning
        Once for each implausible value of the scene; all are in `RunResult.warnings`.
    """
    warn_of(scene_findings(scene))
    return run_scene(scene, progress, cancel)


def run_scene(
    scene: Scene,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    describe: Description = described,
    decide: EffectChoice | None = None,
) -> RunResult:
    """Run `scene` as `simulate` does; implausible values are in the result alone, if `describe`d."""
    decision, before = (decide or decide_effects)(scene), FIRST
    run = _run(decision, before, None, progress, cancel, describe)
    while needed := _needed_effects(scene, run.result.effect_ledger, run.result):
        before = before.then(needed, sum(run.result.receipt["seconds"].values()))
        run = _run(before.of(decision), before, run, progress, cancel, describe)
    if progress is not None:
        progress(1.0, "done")
    return run.result


def _needed_effects(
    scene: Scene, ledger: Json, partial: RunResult | None = None, file: Path | None = None
) -> dict[str, str]:
    """Return the effects with which a run is to be repeated; raises where the run cannot stand."""
    if not ledger:  # a run without a ledger: all its assumptions hold
        return {}
    needed = needed_effects(ledger) if scene.on_violation == "repeat" else {}
    wrong = "" if needed else ending(ledger["checks"], scene.on_violation)
    if wrong and file is not None:
        _remove_interrupted(file)
        wrong = f"{wrong}. It is in {file}"
    if wrong:
        raise SolveError(f"violated assumptions of the run: {wrong}", partial)
    return needed


@dataclass(frozen=True)
class _Run:
    """A finished run: its result, and the state from which another run goes on."""

    result: RunResult
    trail: Trail
    trajectory: Trajectory


@dataclass(frozen=True)
class _Start:
    """A system at rest in equilibrium, the method that a run takes, and the clock of the run."""

    system: System
    rest: StaticSolution
    choice: MethodChoice
    trail: Trail
    clock: StageClock

    @classmethod
    def of(cls, decision: Decision) -> _Start:
        """Assemble a scene and find its equilibrium.

        Raises `SolveError`: there is none; ``partial`` shows where the search for it ended.
        """
        clock = StageClock()
        with clock.stage("assembly_and_equilibrium"):
            system = with_tolerance_to_scale(decision.system())
            rest = static_equilibrium(system)
        if not rest.status.usable:
            message = (
                f"no static equilibrium at t = 0: {rest.status.name.lower()}, {rest.residual:.3g} N left"
            )
            raise SolveError(message, _result(system, _no_trajectory(system, rest), clock, None, decision))
        choice = choose_method(system, rest.displacement, system.scene.integration)
        made = choice.of(with_static_reference(system, rest.displacement))
        return cls(made, rest, choice, Trail(system), clock)


def _run(
    decision: Decision,
    before: EarlierRun,
    earlier: _Run | None,
    progress: Progress | None,
    cancel: Cancel | None,
    describe: Description,
) -> _Run:
    """Run a scene once; `before` is the account of the run `earlier` that it repeats."""
    start = _Start.of(decision)
    system = start.system
    if earlier is not None:
        states_of = earlier.trajectory.states.rows
        start_value = taken_over(earlier.result.effect_ledger, earlier.trail, states_of, system)
        before = before if start_value is None else replace(before, since=start_value.at.time)
        start.trail.taken = start_value
    trajectory = integrate(
        system,
        start.rest,
        system.scene.integration,
        progress,
        cancel=cancel,
        trail=start.trail,
        modal_samples=window_starts(system),
    )
    start.clock.book("integration", trajectory.taken)

    def finer(integration: Integration) -> tuple[Ending, StatesOf]:
        run = integrate(system, start.rest, integration, _of_errors(progress), cancel=cancel)
        return run, run.states.rows

    errors = _Errors(start, trajectory.states.rows, finer)
    result = _result(system, trajectory, start.clock, errors, decision, before, start.choice, describe)
    if not result.status.usable:
        reached = f"at {trajectory.end:.6g} s of {decision.scene.duration:g} s"
        raise SolveError(f"run ended early, {result.status.name.lower()} {reached}", result)
    return _Run(result, start.trail, trajectory)


def _of_errors(progress: Progress | None) -> Progress | None:
    """Return the progress report of a run that measures errors, under a stage with that name."""
    return progress and (lambda done, _stage: progress(done, "error of the steps"))


@dataclass(frozen=True)
class _Errors:
    """Measurement of the errors of a run: by its samples, and by a finer run to its end."""

    start: _Start
    states_of: StatesOf
    finer: Callable[[Integration], tuple[Ending, StatesOf]]

    def measure(self, end: Ending, run: RunContext) -> tuple[Json, RunStatus]:
        """Return the errors by source, and how the run ended once they are measured.

        The error of the steps is measured over the whole run where windows cannot see it, unless missing
        effects mean that the run is repeated anyway. A cancelled measurement cancels the run.
        """
        system, integration = self.start.system, self.start.system.scene.integration
        if not end.status.usable:
            return requested_error(integration), end.status
        reason = blind_windows(system, self.start.choice, self.states_of, end)
        if not reason or _is_repeated(run):
            return with_tolerance(
                error_by_source(system, self.states_of, end.modal_states), integration
            ), end.status
        other, finer_states = self.finer(finer_run(integration, end))
        if other.status.usable and other.samples == end.samples:
            pair = RunPair(system, self.states_of, finer_states, end.samples)
            steps = pair.error(reason) | {"seconds": other.taken.cpu_seconds}
            error = error_by_source(system, self.states_of, end.modal_states, steps)
            return with_tolerance(error, integration), end.status
        error = error_by_source(system, self.states_of, end.modal_states)
        steps = error["time_step"] | {"not_covered": reason}
        ends = integration.estimate_error or other.status is RunStatus.CANCELLED
        return error | {"time_step": steps}, other.status if ends else end.status


def _is_repeated(run: RunContext) -> bool:
    return run.scene.on_violation == "repeat" and bool(needed_effects(effect_ledger(run)))


def _result(
    system: System,
    trajectory: Trajectory,
    clock: StageClock,
    errors: _Errors | None,
    decision: Decision,
    before: EarlierRun = FIRST,
    choice: MethodChoice | None = None,
    describe: Description = described,
) -> RunResult:
    checks = RunChecks(system, [NeglectedChecks(decision)])
    with clock.stage("outputs"):
        parts = _checked_series(system, trajectory.states.rows, trajectory.samples, checks)
        series = _joined(parts, trajectory.samples)
    run = RunContext.of(system, trajectory, checks, clock, decision, before)
    error: Json = {}
    if errors is not None:
        with clock.stage("error_estimate"):
            error, status = errors.measure(trajectory, run)
        run, trajectory = run.with_errors(error), replace(trajectory, status=status)
    about = documents(run, trajectory, clock, error, before, choice)
    return RunResult(**series, **describe(run, about))


def _checked_series(
    system: System, states_of: StatesOf, samples: int, checks: RunChecks
) -> Iterator[dict[str, Any]]:
    """Yield the series of a run block by block; `checks` see them."""
    for first, stop in blocks(samples):
        states = states_of(first, stop)
        series, raw = series_of(system, np.arange(first, stop) / system.sampling.rate, states)
        checks.see(raw, states)
        yield series


def _joined(parts: Iterator[dict[str, Any]], samples: int) -> dict[str, Any]:
    """Write blocks of series into those of the whole run; the memory of a block is used again."""
    joined, first = next(parts), 0
    if joined["time"].size == samples:
        return joined
    part = joined
    joined = part | {name: np.empty((*part[name].shape[:-1], samples), part[name].dtype) for name in SAMPLED}
    while part:
        stop = first + part["time"].size
        for name in SAMPLED:
            joined[name][..., first:stop] = part[name]
        part, first = next(parts, {}), stop
    return joined


def _no_trajectory(system: System, start: StaticSolution) -> Trajectory:
    """Return the trajectory of a run that never started: the end of the search for equilibrium."""
    march = marching.start_march(system, start, system.scene.integration)
    sink = MemorySink(1, march.widths)
    marching.sample_rest(march, sink)
    return Trajectory(
        **vars(marching.ending(march, sink, RunStatus.NO_EQUILIBRIUM, TimeTaken())),
        time=np.zeros(1),
        states=sink.states(0, 1),
    )


def interrupted_run(path: str | Path) -> Path:
    """Return the folder that holds an unfinished run to `path`, whether it exists or not."""
    return Path(path).with_name(f"{Path(path).name}.partial")


def simulate_to_file(
    scene: Scene,
    path: str | Path,
    *,
    resume: bool = False,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    checkpoint_every: float = CHECKPOINT_EVERY,
    decide: EffectChoice | None = None,
) -> RunStatus:
    """Run `scene` as `simulate` does, with memory independent of its duration.

    During the run, states and checkpoints are in the folder `interrupted_run(path)`. The result is written to
    `path` at the end, or when the run is cancelled; except for times in the receipt it is that of `simulate`
    to the last bit. A cancelled or killed run keeps the folder, and `resume` continues from its checkpoint.

    Parameters
    ----------
    scene : Scene
    path : str or Path
        netCDF file, see `RunResult.from_netcdf`.
    resume : bool
        Continue from the checkpoint if there is one. Otherwise the remains of another run are removed.
    progress, cancel : callable, optional
        As in `simulate`.
    checkpoint_every : float
        s of wall time between checkpoints.
    decide : callable, optional
        Decides the effects of the scene in place of its own tolerance.

    Returns
    -------
    RunStatus
        Status of the run, also in the file.

    Raises
    ------
    InputError
        If the scene's parts do not fit each other, or another process runs to the same file.
    SolveError
        If there is no equilibrium to start from, or the run violates an assumption and the scene's
        ``on_violation`` is "fail", or "repeat" and no effect corrects it; the file is then complete.
    ResultError
        If the checkpoint is damaged, or that of another scene.
    """
    path = Path(path)
    session = _Session(progress, cancel, checkpoint_every)
    before = EarlierRun.read(interrupted_run(path)) if resume else FIRST
    warn_of(scene_findings(scene))
    decision = (decide or decide_effects)(scene)
    run = _run_to_file(before.of(decision), path, before, session, resume=resume)
    while run.status.usable and (needed := _needed_effects(scene, run.ledger, file=path)):
        before = before.then(needed, run.seconds)
        before.write(interrupted_run(path))
        run = _run_to_file(before.of(decision), path, before, session, run)
    if run.status is not RunStatus.CANCELLED:
        _remove_interrupted(path)
    if progress is not None:
        progress(1.0, "done" if run.status.usable else run.status.name.lower())
    return run.status


def _run_to_file(
    decision: Decision,
    path: Path,
    before: EarlierRun,
    session: _Session,
    earlier: _MadeRun | None = None,
    *,
    resume: bool = False,
) -> _MadeRun:
    """Run once; `before` is the account of the run `earlier` that it repeats."""
    start = _Start.of(decision)
    system, rest, clock = start.system, start.rest, start.clock
    folder = interrupted_run(path)
    folder.mkdir(exist_ok=True)
    with ExitStack() as stack:
        leg = _Leg(stack, folder / "run", system, rest, system.scene.integration, resume, earlier)
        before = replace(before, since=leg.since)
        end = leg.go(session, start.trail)
        clock.book("integration", end.taken)

        def finer(integration: Integration) -> tuple[Ending, StatesOf]:
            check = _Leg(stack, folder / "check", system, rest, integration, resume)
            measuring = replace(session, progress=_of_errors(session.progress))
            return check.go(measuring), check.spool.states

        errors = _Errors(start, leg.spool.states, finer)
        status, ledger = _write(path, leg, end, errors, decision, before)
    return _MadeRun(status, ledger, sum(clock.seconds.values()), start.trail, leg.march.widths)


def _write(
    path: Path, leg: _Leg, end: Ending, errors: _Errors, decision: Decision, before: EarlierRun
) -> tuple[RunStatus, Json]:
    """Make the series from the states, block by block, into the file; return status and effect ledger."""
    system, start = leg.march.system, errors.start
    checks = RunChecks(system, [NeglectedChecks(decision)])
    with RunFile(path) as file:
        with start.clock.stage("outputs"):
            for series in _checked_series(system, leg.spool.states, end.samples, checks):
                file.append(series)
        run = RunContext.of(system, end, checks, start.clock, decision, before)
        with start.clock.stage("error_estimate"):
            error, status = errors.measure(end, run)
        run = run.with_errors(error)
        made = documents(run, replace(end, status=status), start.clock, error, before, start.choice)
        about = described(run, made)
        file.publish(attributes(about))
    return status, dict(about["effect_ledger"])


def _remove_interrupted(path: Path) -> None:
    folder = interrupted_run(path)
    for file in folder.iterdir():
        file.unlink()
    folder.rmdir()
