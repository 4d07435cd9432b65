"""The error of a run by source: the errors of transmission errors and bearing forces in its receipt.

A window is a stretch of the run that is integrated again, with finer steps or with fewer positions of the
tables. Its difference from the run is the error by that source.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.assembly.varied import starting_at, with_decimated_tables
from dynamics.integrators import StaticSolution, integrate
from dynamics.integrators.advance import POSITION_LIMIT
from dynamics.integrators.march import sample_count
from dynamics.kernels.by_address import by_address
from dynamics.motion.observation import observe
from dynamics.motion.sampled_states import States
from dynamics.results.order_fit import order_amplitudes, orders_seen, unwrapped
from dynamics.scene import Integration
from dynamics.simulation.documents import ERROR_CHECK_FACTOR, finer, requested_error, with_longest_step
from dynamics.types import FloatArray, IntArray, Json, StaticStatus
from host import cpu_seconds

WINDOWS = 3  # windows of a run, if it is long enough
WINDOW_SHARE = 0.045
"""Most samples in all windows, over the samples of a run: integrating them anew takes some 12 % of the run.
"""
MIN_SAMPLES, MAX_SAMPLES = 24, 512
"""Least and most samples of a window. An error of the steps is stationary once the vibration that it makes
has decayed. On a gear pair (damping ratio 0.01 and 0.15) and a planetary stage, longer windows stated no
better errors.
"""
ORDERS = 5  # mesh orders whose errors are stated
CAP = 0.63
"""Longest steps of a finer run over those of the run where no tolerance sets them: 0.1^(1/5)."""

StatesOf = Callable[[int, int], States]
TIME_STEP_REST = 1.0 / (1.0 - ERROR_CHECK_FACTOR**0.75)
"""Error over the difference to a run at a tenth of the tolerance: it falls as the tolerance^(3/4)."""
TABLE_REST = 1.0 / 3.0
"""Error over the difference to half the positions: second order, as kinks at handovers allow."""


@dataclass(frozen=True)
class _Window:
    """A stretch of a run from a sample on; T samples, m meshes, b bearings."""

    first: int
    stop: int
    """`first`, `stop`: First sample of the window, and the sample after its last."""
    time: FloatArray
    """Times from the start of the window, s. Shape (T,)."""
    system: System
    """System whose clock starts with the window."""
    states: States
    """States of the run in the window."""
    start: FloatArray
    """Displacements and rates of all freedoms at the first sample. Shape (2, n)."""
    position: FloatArray
    """Positions of the meshes, unwrapped base pitches. Shape (m, T)."""
    error: FloatArray
    """Transmission errors, m. Shape (m, T)."""
    force: FloatArray
    """Bearing forces in their own frames, N. Shape (b, c, T)."""

    def repeated(self, system: System, integration: Integration) -> _Difference | None:
        """Integrate it as `system`, from the run's state at its start; None if that ends early."""
        q, v = self.start
        start = StaticSolution(StaticStatus.CONVERGED, q, np.empty(0), 0.0, 0)
        run = integrate(system, start, integration, velocity=v)
        if not run.status.usable or run.samples != self.time.size:
            return None
        _, error, force = observed_signals(self.system, self.time, run.states)
        error_change, pushed = error - self.error, force - self.force
        orders = min((orders_seen(position, ORDERS) for position in self.position), default=0)
        if np.ptp(self.position[0]) < 1.0:
            orders = 0
        by_error = [
            order_amplitudes(position, series, orders)
            for position, series in zip(self.position, error_change, strict=True)
        ]
        by_force = np.linalg.norm(order_amplitudes(self.position[0], pushed, orders), axis=1)
        rms = float(np.sqrt(np.mean(error_change**2)))
        return _Difference(rms, np.max(by_error, axis=0), np.max(by_force, axis=0, initial=0.0))

    def finer(self, integration: Integration) -> Integration:
        """Return the settings of its run for the error of the steps, shorter too where teeth limit them."""
        shorter, turned = finer(integration), float(np.max(np.ptp(self.position, axis=1)))
        if integration.fixed_step is not None or turned == 0.0:
            return shorter
        return with_longest_step(shorter, CAP * POSITION_LIMIT * float(self.time[-1]) / turned)

    def on_laws_of(self, other: System) -> System:
        """Return the window's system with the force laws of `other`, the run's system with other laws."""
        window_laws, laws = self.system.arrays.elements.laws, other.arrays.elements.laws
        laws = laws._replace(applied_force=window_laws.applied_force)  # whose clock starts here
        arrays = self.system.arrays._replace(elements=other.arrays.elements._replace(laws=laws))
        return replace(self.system, arrays=by_address(arrays))


@dataclass(frozen=True)
class _Difference:
    """The difference of another run of a window."""

    rms: float
    """Root mean square of the difference of the transmission errors, m."""
    error_orders: FloatArray
    force_orders: FloatArray
    """`error_orders`, `force_orders`: Largest amplitude among the meshes (m) and among the bearings (N) at
    each order of the first mesh. Shape (ORDERS or fewer,) each.
    """


def window_starts(system: System) -> IntArray:
    """Return the first samples (W,) of the windows of a run, which are to be whole."""
    full = system.scene.outputs.receipt == "full"
    return np.array([first for first, _ in _spans(system)] if full else [], dtype=np.int64)


def window_seconds(system: System) -> float:
    """Return the duration of a window of a run, s; 0 where the run is too short for any."""
    first, stop = next(iter(_spans(system)), (0, 0))
    return (stop - first) / system.sampling.rate


def _spans(system: System) -> list[tuple[int, int]]:
    """Return windows at the ends of equal parts of the run; none where it is too short or has no mesh."""
    samples = sample_count(system)
    count = WINDOWS if WINDOW_SHARE * samples >= WINDOWS * MIN_SAMPLES else 1
    size = min(int(WINDOW_SHARE * samples / count), MAX_SAMPLES)
    if size < MIN_SAMPLES or not system.scene.meshes:
        return []
    ends = [round((k + 1) * samples / count) for k in range(count)]
    return [(end - size, end) for end in ends]


def _windows(system: System, states_of: StatesOf, modal_states: FloatArray) -> list[_Window]:
    """Return the windows of a run; `modal_states` (W, 2, b) are the modal freedoms at their starts."""
    return [
        _window(system, states_of, *span, amplitudes)
        for span, amplitudes in zip(_spans(system), modal_states, strict=False)
    ]


def _window(system: System, states_of: StatesOf, first: int, stop: int, amplitudes: FloatArray) -> _Window:
    rate, bodies = system.sampling.rate, system.arrays.sparse.modal.first
    states, time = states_of(first, stop), np.arange(stop - first) / rate
    later = starting_at(system, first / rate, states.quanta[0])
    outputs = replace(system.scene.outputs, energy_audit=False)
    scene = replace(system.scene, duration=float(time[-1]), outputs=outputs)
    later = replace(later, scene=scene, sampling=system.sampling.points())
    counted = states._replace(quanta=states.quanta - states.quanta[0])
    position, error, force = observed_signals(later, time, counted)
    start = np.concatenate([[states.q[0, :bodies], states.v[0, :bodies]], amplitudes], axis=1)
    return _Window(first, stop, time, later, counted, start, position, error, force)


def observed_signals(
    system: System, time: FloatArray, states: States
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return positions (m, T), base pitches, transmission errors (m, T), m, bearing forces (b, 3, T), N."""
    observed = observe(system.arrays, time, states.q, states.v, states.quanta, states.carried)
    force = system.bearing_force(observed.force, states.q, states.v)
    meshes = len(system.scene.meshes)  # frames that turn have positions too, behind those of the meshes
    return unwrapped(observed.position[:meshes]), observed.coordinate[system.driving_rows], force[:, :3]


def error_by_source(
    system: System, states_of: StatesOf, modal_states: FloatArray, steps: Json | None = None
) -> Json:
    """Return the estimates of a run, measured in windows of it; the requested error where it is too short.

    Sources: time steps, unless `steps` states their error from all of the run, and table interpolation
    between positions. `modal_states` (W, 2, b) are the modal freedoms at the samples `window_starts`.
    """
    integration = system.scene.integration
    began = cpu_seconds()
    looked = _windows(system, states_of, modal_states)
    if not looked:
        return {"time_step": steps} if steps else requested_error(integration)
    measured = steps or _step_error(looked, integration)
    coarse = with_decimated_tables(system)
    tables = [window.repeated(window.on_laws_of(coarse), integration) for window in looked]
    seconds = cpu_seconds() - began
    return {
        **({"time_step": measured} if measured else requested_error(integration)),
        "table_interpolation": _estimate(tables, TABLE_REST, "runs of windows on every second position"),
        "windows": [[window.first, window.stop - 1] for window in looked],
        "cpu_seconds": seconds,
    }


def _step_error(windows: Sequence[_Window], integration: Integration) -> Json:
    """Return the error of the time steps by windows; empty if one of them failed."""
    steps = [window.repeated(window.system, window.finer(integration)) for window in windows]
    return _estimate(steps, TIME_STEP_REST, "runs of windows at a tenth of the tolerance")


def _estimate(differences: Sequence[_Difference | None], rest: float, source: str) -> Json:
    """Put the windows together: rms over all, the worst amplitudes; empty if one of them failed."""
    known = [difference for difference in differences if difference is not None]
    if len(known) < len(differences):
        return {}
    orders = min(difference.error_orders.size for difference in known)
    return {
        "rms": rest * float(np.sqrt(np.mean([difference.rms**2 for difference in known]))),
        "unit": "m",
        "source": source,
        "transmission_error_orders": [
            rest * max(float(difference.error_orders[k]) for difference in known) for k in range(orders)
        ],
        "bearing_force_orders": [
            rest * max(float(difference.force_orders[k]) for difference in known) for k in range(orders)
        ],
        "bearing_force_unit": "N",
    }
