"""A run in progress: its workspace, and the loop that integrates it block by block into a sink.

A *march* is a run in progress: it can stop after each block and continue, also in another process. A *sink*
takes the output samples. The *inner grid* has several points of time for each output sample; an anti-alias
filter acts from it to the output. Named tuples go to compiled functions by address.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import System
from dynamics.forces.elements import FLANK, SPATIAL_FLANK, Elements, potential
from dynamics.integrators.advance import Control, prepare_samples, prepare_steps
from dynamics.integrators.method_choice import choose_method
from dynamics.integrators.sampler import (
    Sampler,
    SampleRing,
    carried_signals,
    continue_past_the_end,
    sample_step,
)
from dynamics.integrators.state_sink import BLOCK, StateSink
from dynamics.integrators.static import StaticSolution
from dynamics.integrators.tableaus import EXPLICIT_EMBEDDED_ORDER, IMPLICIT_EMBEDDED_ORDER
from dynamics.integrators.workspace import Count, Power, Workspace, geometric_steps
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.kernels.local_state import LocalState
from dynamics.motion.motion import SPEED
from dynamics.motion.observation import local_state, observe_laws
from dynamics.motion.sampled_states import Widths
from dynamics.scene import Integration
from dynamics.structure_code.known_parts import Known
from dynamics.types import FloatArray, IntArray, Json, RunStatus
from model_studies.stage_clock import TimeTaken

if TYPE_CHECKING:
    from dynamics.integrators.code_choice import StructureCode

Progress = Callable[[float, str], None]
Cancel = Callable[[], bool]
CHUNKS = 50  # usual number of blocks of a run, between which progress is reported
BLOCK_WORK = 25_000
"""Least samples times freedoms of a block without a listener for progress or cancelling: 5 to 50 ms in which
the interpreter's lock is free."""
FIRST_STEP = 1e-6  # size of the first step without a fixed one, s
ROUNDING = 1e-12  # a last sample that rounding puts this part of the duration behind the end counts
NO_SAMPLES = np.zeros(0, dtype=np.int64)
STEP_SHARE = 0.07
"""Error allowed per step over the tolerance of the run.

Measured on the run-up of a spur pair: with this share the rms error of the run is 0.2 of the tolerance at a
damping ratio of 0.05, and 0.8 at 0.01, where the errors of steps ring five times longer."""
NEWTON_SHARE = 0.01
"""Error of Newton's method over the error allowed per step.

The remainders of Newton's method have one sign and add up. With a fixed step, whose error may lie far below
any tolerance, the iteration therefore goes on to rounding."""


@dataclass(frozen=True)
class _SampleFigures:
    """Figures over the inner grid of a run: m meshes, c coast flanks, b supports, N."""

    mesh_peak: FloatArray
    mesh_rms: FloatArray
    """`mesh_peak`, `mesh_rms`: Largest magnitude and rms of the driving flanks' forces. Shape (m,) each."""
    coast_peak: FloatArray
    coast_rms: FloatArray
    """`coast_peak`, `coast_rms`: Largest magnitude and rms of the coast flanks' forces; zero where there is
    none. Shape (m,) each.
    """
    bearing_peak: FloatArray
    bearing_rms: FloatArray
    """`bearing_peak`, `bearing_rms`: Largest magnitude and rms of forces (and moments, N m) in the frame of
    each support. Shape (b, 3 or 6) each.
    """
    removed: FloatArray
    folded: FloatArray
    """`removed`, `folded`: Rms of the part of the mesh force that the filter removes, and of its content near
    half the inner rate, which bounds the part that may fold into the output. Shape (m,) each.
    """

    def to_json(self, system: System) -> Json:
        """Return peaks and rms by part, and the sampling error of the mesh forces."""
        meshes = [mesh.name for mesh in system.scene.meshes]
        coast = [meshes[mesh] for mesh in system.flanks.coast]
        stored = system.supports.name if system.scene.outputs.bearing_forces else ()
        return {
            "mesh_force": _by_part(meshes, self.mesh_peak, self.mesh_rms),
            "coast_force": {
                name: part
                for name, part in _by_part(meshes, self.coast_peak, self.coast_rms).items()
                if name in coast
            },
            "bearing_force": _by_part(stored, self.bearing_peak[:, :3], self.bearing_rms[:, :3]),
        }

    def error(self, system: System) -> Json:
        """Return the sampling error of the mesh forces, N rms."""
        names = (mesh.name for mesh in system.scene.meshes)
        return {
            "unit": "N",
            "source": "removed: above the pass band, not in the output; folded: bound on content above the "
            "inner grid, which the output may hold at a wrong frequency",
            "mesh_force": {
                name: {"removed": float(removed), "folded": float(folded)}
                for name, removed, folded in zip(names, self.removed, self.folded, strict=True)
            },
        }


def _sample_figures(system: System, ring: SampleRing, points: int, samples: int) -> _SampleFigures:
    """Return the figures that a ring holds after `points` of the inner grid and `samples` of the output."""
    rows, stored = ring.local.force.size, system.scene.outputs.bearing_forces
    supports = system.bearing_stiffness.shape[:2] if stored else (0, 3)
    largest, rms = ring.peaks.largest.copy(), np.sqrt(ring.peaks.square / max(points, 1))
    driving = system.driving_rows
    coast = np.zeros((2, driving.size))
    for element, mesh in enumerate(system.flanks.coast, start=driving.size):
        row = system.arrays.elements.first[element]
        coast[:, mesh] = largest[row], rms[row]
    removed, folded = (np.sqrt(part[driving] / max(samples, 1)) for part in (ring.removed, ring.folded))
    return _SampleFigures(
        largest[driving],
        rms[driving],
        coast[0],
        coast[1],
        largest[rows:].reshape(supports),
        rms[rows:].reshape(supports),
        removed,
        folded,
    )


def _by_part(names: list[str] | tuple[str, ...], peak: FloatArray, rms: FloatArray) -> Json:
    return {
        name: {"peak": np.asarray(p).tolist(), "rms": np.asarray(r).tolist()}
        for name, p, r in zip(names, peak, rms, strict=False)
    }


def stored_energy(
    system: SystemArrays, time: float, q: FloatArray, v: FloatArray, quanta: IntArray
) -> FloatArray:
    """Return kinetic, bushing and mesh energy, J, (3,).

    Bodies move with the laws' speeds W_k times their kinematic vectors r_k, and their rate in `v` on top:
    T = v M v/2 + sum_k W_k r_k M v + sum_kl W_k W_l r_k M r_l/2.
    """
    speed = observe_laws(system, np.array([time]))[SPEED, :, 0]
    kinetic = (
        0.5 * v @ system.mass @ v - speed @ system.inertial @ v + 0.5 * speed @ system.total_inertia @ speed
    )
    mesh, bearing = _in_elements(
        by_address(system.elements), by_address(local_state(system, time, q, v, quanta))
    )
    linear = 0.5 * q @ system.stiffness @ q - system.constant @ q
    return np.array([kinetic, linear + bearing, mesh])


def _audited_energy(system: System, control: Control, time: float, work: Workspace) -> FloatArray:
    if not control.audit:
        return np.zeros(3)
    return stored_energy(system.arrays, time, work.q, work.v, work.quanta)


@compiled
def _in_elements(elements: Elements, local: LocalState) -> tuple[float, float]:
    """Return the energies that flanks and that bearings store, J."""
    mesh, bearing = 0.0, 0.0
    for e in range(elements.law.size):
        if elements.law[e] == FLANK or elements.law[e] == SPATIAL_FLANK:
            mesh += potential(elements, local, e)[0]
        else:
            bearing += potential(elements, local, e)[0]
    return mesh, bearing


class _Passed(NamedTuple):
    """Arguments that compiled loops get by address."""

    arrays: SystemArrays
    work: Workspace
    control: Control
    sampler: Sampler
    ring: SampleRing


@dataclass(frozen=True)
class March:
    """The state from which a run continues."""

    system: System
    work: Workspace
    """The state, changed in place."""
    ring: SampleRing
    """Points that the anti-alias filter sees, changed in place."""
    control: Control
    sampler: Sampler
    compiled: _Passed
    initial: FloatArray
    """Kinetic, bushing and mesh energy at the start, J; 0 without an audit. Shape (3,)."""
    samples: int
    """Number of output samples of the whole run."""

    @property
    def state(self) -> tuple[Workspace, SampleRing]:
        """Arrays that change during the run."""
        return self.work, self.ring

    @property
    def structure(self) -> dict[Any, Known]:
        """Arguments that `advance` gets by address, and the part of each that belongs to the run's structure.

        Runs of one structure share compiled code.
        """
        known = {"work": Known.DIMENSIONS, "ring": Known.DIMENSIONS}
        fixed = {argument: known.get(name, Known.ALL) for name, argument in self.compiled._asdict().items()}
        return {**fixed, by_address(self.widths.states(0)): Known.WIDTHS}

    @property
    def widths(self) -> Widths:
        """Sizes of the sampled states."""
        channels, rows = self.sampler.filtered, self.ring.local.force.size
        carried = carried_signals(self.system.arrays, self.sampler)
        return Widths(self.sampler.freedoms, carried, self.work.quanta.size, channels, rows)


@dataclass(frozen=True)
class Ending:
    """The end of a run, and its steps."""

    status: RunStatus
    samples: int
    """Number of output samples that the run reached."""
    end: float
    """Time of the last step's end, s; the energies refer to it."""
    stored: FloatArray
    """Kinetic, bushing and mesh energy at the start and at the end, J; 0 without an audit. Shape (2, 3)."""
    work: FloatArray
    """Works over the run, J, in the order of `Power`. Shape (7,)."""
    fallen: float
    """Largest fall of a dissipated energy below its highest value before, J."""
    count: IntArray
    """Statistics, in the order of `Count`."""
    step_range: FloatArray
    """Smallest and largest accepted step, s. Shape (2,)."""
    taken: TimeTaken
    """Time of the stepping. In the first run of a process it includes reading or making the compiled code."""
    figures: _SampleFigures
    """Peaks and rms over the run, and the rms of the part that the anti-alias filter removes."""
    modal_states: FloatArray
    """q and v of the b modal freedoms at the W `modal_samples` of the start. Shape (W, 2, b)."""


def sample_count(system: System) -> int:
    """Return the number of output samples of a complete run."""
    return int(np.floor(system.scene.duration * system.sampling.rate * (1.0 + ROUNDING))) + 1


def start_march(
    system: System,
    start: StaticSolution,
    integration: Integration,
    velocity: FloatArray | None = None,
    modal_samples: IntArray = NO_SAMPLES,
) -> March:
    """Return a march at t = 0 from the equilibrium `start`, at rest or with the `velocity` (n,).

    At the output samples `modal_samples` (W,) the states of the modal freedoms are kept too.
    """
    if integration.method == "auto":
        integration = choose_method(system, start.displacement, integration).settings(integration)
    if integration.fixed_step is None:
        step_sizes = geometric_steps(integration.largest_step, integration.smallest_step)
    else:
        step_sizes = np.array([integration.fixed_step, 0.0])
    work = Workspace.of(system.arrays, step_sizes, start.displacement, integration.fixed_step or FIRST_STEP)
    if velocity is not None:
        work.v[:] = velocity
    control = _control(system, integration)
    initial = _audited_energy(system, control, 0.0, work)
    sampler = Sampler.of(system, modal_samples)
    ring = SampleRing.of(system.arrays, sampler)
    run = by_address(system.arrays), by_address(work)
    passed = _Passed(*run, by_address(control), by_address(sampler), by_address(ring))
    march = March(system, work, ring, control, sampler, passed, initial, sample_count(system))
    prepare_steps(*run, control.implicit, control.audit)
    prepare_samples(*run, passed.sampler, passed.ring, by_address(march.widths.states(0)))
    return march


def sample_rest(march: March, sink: StateSink) -> None:
    """Sample the start of a march without integrating: the only sample of a run of no duration."""
    passed = march.compiled
    room = by_address(sink.room(0, 1))
    sample_step(passed.arrays, passed.work, passed.sampler, passed.ring, 1.0, 0.0, room)


def march_on(
    march: March,
    sink: StateSink,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    after_block: Callable[[], None] | None = None,
) -> RunStatus:
    """Integrate to the end of the run, block by block; after each block `cancel` says whether to stop."""
    from dynamics.integrators.code_choice import StructureCode  # noqa: PLC0415 (a result is read without it)

    duration, rate = march.system.scene.duration, march.system.sampling.rate
    # least work of a block, samples times freedoms
    work = BLOCK_WORK if progress is None and cancel is None else 0
    minimum, longest = work / (max(march.work.q.size, 1) * rate), BLOCK / rate
    block = min(max(duration / CHUNKS, minimum), longest)
    code = StructureCode(march.control.implicit, march.structure)
    while True:
        stop = min(float(march.work.time[0]) + block, duration)
        status = advance_to(march, code, stop, sink)
        if progress is not None:
            # 1e-300: a run may have no duration
            progress(min(float(march.work.time[0]) / max(duration, 1e-300), 1.0), "time integration")
        if not status.usable or march.work.time[0] >= duration:
            return status
        if cancel is not None and cancel():
            return RunStatus.CANCELLED
        if after_block is not None:
            after_block()


def advance_to(march: March, code: StructureCode, stop: float, sink: StateSink) -> RunStatus:
    """Integrate until the time passes `stop`, by at most the largest step; samples go into `sink`."""
    rate, counts = march.system.sampling.rate, march.work.counts
    first = int(counts[Count.OUTPUT])
    # floor + 1 samples lie before the end of the longest step; one more for rounding
    last = int(np.floor((stop + float(march.work.step_sizes[0])) * rate)) + 2
    room = sink.room(first, max(min(last, march.samples) - first, 1 if first == 0 else 0))
    counts[Count.FIRST_ROW] = first
    status = RunStatus(code.advance(march.compiled, stop, by_address(room)))
    sink.keep(first, int(counts[Count.OUTPUT]) - first)
    return status


def ending(march: March, sink: StateSink, status: RunStatus, taken: TimeTaken) -> Ending:
    """Return the ending of a march with `status`; the samples that the filter still holds go into `sink`.

    For their filtering the motion is continued beyond its last point by its own past, rotated by 180 degrees
    about that point. Afterwards the march is as before the call and can continue.
    """
    work, ring, passed = march.work, march.ring, march.compiled
    end, before, points = float(work.time[0]), *(int(work.counts[at]) for at in (Count.OUTPUT, Count.POINT))
    samples = min((points - 1) // march.sampler.factor + 1, march.samples)
    room = sink.room(before, samples - before)
    copies = [(part, part.copy()) for part in (work.counts, ring.point, ring.removed, ring.folded)]
    work.counts[Count.FIRST_ROW] = before
    buffers = passed.work, passed.sampler, passed.ring
    continue_past_the_end(*buffers, march.sampler.taps.size // 2, by_address(room))
    sink.keep(before, samples - before)
    figures = _sample_figures(march.system, ring, points, samples)
    for part, values in copies:
        part[...] = values
    final = _audited_energy(march.system, march.control, end, work)
    done = work.work.copy()
    done[Power.POSITION] += final[2] - march.initial[2]  # 2: energy of the meshes
    return Ending(
        status=status,
        samples=samples,
        end=end,
        stored=np.array([march.initial, final]),
        work=done,
        fallen=float(np.max(work.fallen)),
        count=work.counts,
        step_range=_step_range(work),
        taken=taken,
        figures=figures,
        modal_states=ring.modal_states,
    )


def _control(system: System, integration: Integration) -> Control:
    implicit, adaptive = integration.method == "implicit", integration.fixed_step is None
    tolerance = STEP_SHARE * integration.tolerance
    stiffness = float(np.max(system.flanks.mean_stiffness, initial=1.0))
    return Control(
        implicit,
        adaptive,
        system.scene.outputs.energy_audit,
        IMPLICIT_EMBEDDED_ORDER if implicit else EXPLICIT_EMBEDDED_ORDER,
        tolerance,
        NEWTON_SHARE * tolerance * stiffness if adaptive else 0.0,
        integration.step_limit,
    )


def _step_range(work: Workspace) -> FloatArray:
    """Return the smallest and largest accepted step, s; zeros if no step was accepted."""
    if work.counts[Count.ACCEPTED] == 0:
        return np.zeros(2)
    return np.array(
        [
            work.step_sizes[work.counts[Count.LARGEST_LEVEL]],
            work.step_sizes[work.counts[Count.SMALLEST_LEVEL]],
        ]
    )
