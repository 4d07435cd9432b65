"""A whole run in memory: from equilibrium, block by block with progress, to a trajectory with its status."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.integrators.march import NO_SAMPLES, Cancel, Ending, Progress, ending, march_on, start_march
from dynamics.integrators.start_value import Trail
from dynamics.integrators.state_sink import MemorySink
from dynamics.integrators.static import StaticSolution
from dynamics.motion.sampled_states import States
from dynamics.scene import Integration
from dynamics.types import FloatArray, IntArray
from model_studies.stage_clock import TimeTaken


@dataclass(frozen=True)
class Trajectory(Ending):
    """A run as computed: how it ended, and its states on the output grid."""

    time: FloatArray
    """Output grid as far as the run came, s. Shape (T,)."""
    states: States
    """The samples."""

    @property
    def q(self) -> FloatArray:
        """Deviations from the kinematic motion at the instants of `time`, without a filter, (T, n)."""
        return self.states.q

    @property
    def v(self) -> FloatArray:
        """Rates of the freedoms, (T, n)."""
        return self.states.v


def integrate(
    system: System,
    start: StaticSolution,
    integration: Integration,
    progress: Progress | None = None,
    velocity: FloatArray | None = None,
    cancel: Cancel | None = None,
    trail: Trail | None = None,
    modal_samples: IntArray = NO_SAMPLES,
) -> Trajectory:
    """Run `system` over its scene's duration, from rest in `start` or from the `velocity` (n,) there.

    At rest means without any deviation from the kinematic motion: the shafts turn with the drive. `cancel` is
    polled about fifty times or more. `trail` saves states of the run after its blocks. If another run has
    left a start value in it (`trail.taken`), this run continues from there. Samples `modal_samples` (W,) keep
    all freedoms.
    """
    began = TimeTaken.now()
    march = start_march(system, start, integration, velocity, modal_samples)
    sink = MemorySink(march.samples, march.widths)
    if trail is not None and trail.taken is not None:
        trail.taken.into(march, sink)  # the march starts where the other run is left
    status = march_on(march, sink, progress, cancel, None if trail is None else trail.watch(march))
    end = ending(march, sink, status, TimeTaken.now().since(began))
    time = np.arange(end.samples) / system.sampling.rate
    # `vars(end)`: a trajectory has all fields of an ending
    return Trajectory(**vars(end), time=time, states=sink.states(0, end.samples))
