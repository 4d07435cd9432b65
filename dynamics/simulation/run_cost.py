"""The cost of a run: steps measured at several times of it, and counted over its duration.

A probe starts a run at one of these times and takes a stretch of steps. A run may be integrated by ordinary
compiled loops or by code made for the structure of its system, which costs time to make.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.assembly.assemble import System, assemble
from dynamics.assembly.varied import starting_at, with_static_reference
from dynamics.errors import SolveError
from dynamics.integrators import static_equilibrium
from dynamics.integrators.march import March, advance_to, start_march
from dynamics.integrators.method_choice import choose_method
from dynamics.integrators.workspace import Count
from dynamics.motion.sampled_states import States, Widths
from dynamics.scene import Scene
from dynamics.simulation.error_by_source import WINDOW_SHARE
from dynamics.simulation.long_run_error import outlives_windows
from host import cpu_seconds

PARTS = (0.05, 0.5, 0.95)
"""Times at which a run is probed, over its duration."""
ENOUGH = 0.02
"""Least CPU seconds of the stretch whose steps are counted. Stretches double, so all stretches of a probe
take two to four times as much.
"""
MIN_STEPS = 32
"""Least number of steps of the stretch whose steps are counted."""
FIRST_STRETCH = 1.0 / 16.0
"""First stretch of a probe over the step of the chosen method."""
FINER = 10.0**0.2
"""Steps at a tenth of the tolerance, over the steps of the run: a method of order 5."""
FASTER, MAKING = 2.3, 2.0
"""CPU time of ordinary loops over that of code made for the structure (measured: 2.0 to 2.8), and CPU seconds
of making this code (1.1 to 4.6).
"""


class ProbedRun(NamedTuple):
    """Predicted cost of a run. The additional cost of flanks that part is not known in advance."""

    start: float
    """CPU seconds from the scene to the first step."""
    steps: float
    """CPU seconds of all steps by ordinary loops."""
    code_may_follow: bool
    """Whether code may be made for the structure of the system."""
    error_share: float
    """Steps of the runs that estimate errors, over the steps of the run."""

    def seconds(self, runs: int, *, with_errors: bool) -> float:
        """Return the CPU seconds of `runs` runs, with or without their error estimates."""
        steps = runs * self.steps * (1.0 + self.error_share if with_errors else 1.0)
        code = MAKING + steps / FASTER if self.code_may_follow else steps
        return runs * self.start + min(steps, code)


def probe_run(scene: Scene) -> ProbedRun:
    """Return the expected cost of a run of a scene, from probes of some tenths of a CPU second.

    Raises `InputError`: parts of the scene do not fit each other; `SolveError`: there is no static
    equilibrium, or no steps can be taken.
    """
    assemble(scene)  # loads modules and compiled code before the measurement
    began = cpu_seconds()
    system = assemble(scene)
    assembling = cpu_seconds() - began
    probes = [_probe(system, part * scene.duration) for part in PARTS]
    steps = scene.duration * float(np.mean([probe.seconds for probe in probes]))
    # windows are run again with half the positions of the tables, in as many steps; then windows, or all of
    # a lightly damped run, at a tenth of the tolerance
    share = WINDOW_SHARE + FINER * (1.0 if probes[0].lightly_damped else WINDOW_SHARE)
    start = assembling + min(probe.start for probe in probes)
    return ProbedRun(start, steps, probes[0].code_may_follow, share)


class _Probe(NamedTuple):
    """Cost of a run about one of its times."""

    start: float
    """CPU seconds from the assembled system to the first step."""
    seconds: float
    """CPU seconds per second of the run."""
    steps: float
    """Steps per second of the run."""
    code_may_follow: bool
    lightly_damped: bool


class _Discarded:
    """Store of samples that keeps none."""

    def __init__(self, widths: Widths) -> None:
        self._widths = widths

    def room(self, first: int, count: int) -> States:
        """Return rows to write samples to."""
        return self._widths.states(count)

    def keep(self, first: int, count: int) -> None:
        """Discard the samples."""

    def states(self, first: int, stop: int) -> States:
        """Raise `NotImplementedError`: no samples are kept."""
        raise NotImplementedError


def _probe(system: System, time: float) -> _Probe:
    """Integrate from the equilibrium at a time over stretches of doubled length, and measure the last one.

    It has `MIN_STEPS` steps and `ENOUGH` CPU seconds, or is as long as the run. The first stretch never
    counts, since it may load code.
    """
    from dynamics.integrators.code_choice import StructureCode  # noqa: PLC0415 (a result is read without it)

    began = cpu_seconds()
    no_revolutions = np.zeros(len(system.scene.references), dtype=np.int64)  # of trains without a drive
    later = starting_at(system, time, no_revolutions)
    rest = static_equilibrium(later)
    if not rest.status.usable:
        raise SolveError(f"no static equilibrium at {time:.6g} s: {rest.status.name.lower()}")
    choice = choose_method(later, rest.displacement, later.scene.integration)
    march = start_march(
        choice.of(with_static_reference(later, rest.displacement)), rest, later.scene.integration
    )
    code = StructureCode(march.control.implicit, march.structure, makes=False)
    start = cpu_seconds() - began
    stretch, sink, first = FIRST_STRETCH * choice.step, _Discarded(march.widths), True
    while True:
        stretch = min(stretch, system.scene.duration)
        since, before, began = float(march.work.time[0]), _steps(march), cpu_seconds()
        status = advance_to(march, code, since + stretch, sink)
        seconds = cpu_seconds() - began
        steps = _steps(march) - before
        passed = float(march.work.time[0]) - since
        if not status.usable:
            raise SolveError(f"no steps at {time:.6g} s: {status.name.lower()}")
        is_entire = stretch >= system.scene.duration  # the stretch is the entire short run
        if not first and (is_entire or (steps >= MIN_STEPS and seconds > ENOUGH)):
            light = outlives_windows(system, choice)
            return _Probe(start, seconds / passed, steps / passed, code.may_follow, light)
        stretch, first = 2.0 * stretch, False


def _steps(march: March) -> int:
    """Return the number of steps so far; a rejected step costs as much as an accepted one."""
    return int(march.work.counts[Count.ACCEPTED] + march.work.counts[Count.REJECTED])
