"""The cost of a run: steps measured at several times of it, and counted over its duration."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.assembly.assemble import System, assemble
from dynamics.assembly.varied import starting_at, with_static_reference
from dynamics.errors import SolveError
from dynamics.integrators import static_equilibrium
from dynamics.integrators.code_choice import StructureCode
from dynamics.integrators.march import March, advance_to, start_march
from dynamics.integrators.method_choice import choose_method
from dynamics.integrators.workspace import Count
from dynamics.motion.sampled_states import States, Widths
from dynamics.scene import Scene
from dynamics.simulation.error_by_source import SHARE
from dynamics.simulation.long_run_error import outlives_windows
from host import cpu_seconds

PARTS = (0.05, 0.5, 0.95)
"""Times at which a run is probed, over its duration."""
ENOUGH = 0.02
"""CPU s of the stretch of a probe that counts; all of them take twice that, and up to twice that again."""
MIN_STEPS = 32
"""Least steps of a stretch that counts, however long a step takes."""
FINER = 10.0**0.2
"""Steps at a tenth of the tolerance, over the steps of the run; with half the positions there are as many."""
FASTER, MAKING = 2.3, 2.0
"""Ordinary loops over code of a structure's own, measured 2.0 to 2.8; CPU s of making it, 1.1 to 4.6."""


class ProbedRun(NamedTuple):
    """CPU seconds of the start and the steps of a run, and whether code of its own may follow.

    `error_share`: steps of its error estimates over its own. The additional cost of flanks that part is not
    known in advance.
    """

    start: float
    steps: float
    code_may_follow: bool
    error_share: float

    def seconds(self, runs: int, *, with_errors: bool) -> float:
        """Return the CPU seconds of `runs` runs, with or without their error estimates."""
        steps = runs * self.steps * (1.0 + self.error_share if with_errors else 1.0)
        code = MAKING + steps / FASTER if self.code_may_follow else steps
        return runs * self.start + min(steps, code)


def probe_run(scene: Scene) -> ProbedRun:
    """Return the expected cost of a run of a scene; some tenths of a CPU second of it are run.

    Raises `InputError`: its parts do not fit each other; `SolveError`: nothing holds it at rest, or no steps
    can be taken.
    """
    assemble(scene)  # loads modules and compiled code before the measurement
    began = cpu_seconds()
    system = assemble(scene)
    assembling = cpu_seconds() - began
    probes = [_probe(system, part * scene.duration) for part in PARTS]
    steps = scene.duration * float(np.mean([probe.seconds for probe in probes]))
    share = SHARE + FINER * (1.0 if probes[0].lightly_damped else SHARE)
    start = assembling + min(probe.start for probe in probes)
    return ProbedRun(start, steps, probes[0].code_may_follow, share)


class _Probe(NamedTuple):
    """CPU seconds of starting; CPU seconds and steps per second of a run about some time of it."""

    start: float
    seconds: float
    steps: float
    code_may_follow: bool
    lightly_damped: bool


class _Discarded:
    """Takes samples, and keeps none."""

    def __init__(self, widths: Widths) -> None:
        self._widths = widths

    def room(self, first: int, count: int) -> States:
        """Return rows that nobody reads."""
        return self._widths.states(count)

    def keep(self, first: int, count: int) -> None:
        """Do nothing."""

    def states(self, first: int, stop: int) -> States:
        """Refuse: nothing is kept."""
        raise NotImplementedError


def _probe(system: System, time: float) -> _Probe:
    """March on from the equilibrium at a time by stretches that grow, until one of them tells."""
    began = cpu_seconds()
    later = starting_at(system, time, np.zeros(len(system.scene.references), dtype=np.int64))
    rest = static_equilibrium(later)
    if not rest.status.usable:
        raise SolveError(f"no static equilibrium at {time:.6g} s: {rest.status.name.lower()}")
    choice = choose_method(later, rest.displacement, later.scene.integration)
    march = start_march(
        choice.of(with_static_reference(later, rest.displacement)), rest, later.scene.integration
    )
    code = StructureCode(march.control.implicit, march.structure, makes=False)
    start = cpu_seconds() - began
    stretch, sink, first = choice.step / 16.0, _Discarded(march.widths), True
    while True:
        stretch = min(stretch, system.scene.duration)
        began, before, since = cpu_seconds(), _steps(march), float(march.work.time[0])
        status = advance_to(march, code, since + stretch, sink)
        seconds, steps, passed = (
            cpu_seconds() - began,
            _steps(march) - before,
            float(march.work.time[0]) - since,
        )
        if not status.usable:
            raise SolveError(f"no steps at {time:.6g} s: {status.name.lower()}")
        is_entire = stretch >= system.scene.duration  # the stretch is the entire short run
        if not first and (is_entire or (steps >= MIN_STEPS and seconds > ENOUGH)):
            light = outlives_windows(system, choice)
            return _Probe(start, seconds / passed, steps / passed, code.may_follow, light)
        stretch, first = 2.0 * stretch, False


def _steps(march: March) -> int:
    return int(march.work.counts[Count.ACCEPTED] + march.work.counts[Count.REJECTED])
