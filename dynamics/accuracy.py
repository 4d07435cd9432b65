"""The cost of accuracy on a scene: models and settings from quasi-static to the finest steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Protocol

import numpy as np

import model_studies
from bounds.brief import brief
from dynamics.assembly.assemble import System, assemble
from dynamics.assembly.varied import with_decimated_tables
from dynamics.checks import chosen
from dynamics.effects import EFFECTS
from dynamics.errors import InputError, SolveError
from dynamics.integrators import Trajectory, integrate, static_equilibrium
from dynamics.integrators.method_choice import EVALUATIONS
from dynamics.linearize import HarmonicResponse, harmonic_response
from dynamics.mechanism.additions import COAST_FLANKS, TEETH_AS_MADE
from dynamics.motion.observation import observe, observe_laws, static_deflections
from dynamics.results.order_fit import order_amplitudes, orders_seen, unwrapped
from dynamics.scene import Outputs, Scene
from dynamics.types import FloatArray, IntArray
from model_studies import Progress, against_finest, in_unit, knee_above, run_fidelities, silent
from model_studies.frontier import Errors

MAX_BLOCKS, ORDERS = 6, 5  # most blocks of a run that are compared, and mesh orders compared in each
MIN_SAMPLES = 32  # least samples of a block
MIN_PITCHES = 2.0  # least base pitches of the first mesh in a block
BY_TORSION = (COAST_FLANKS, TEETH_AS_MADE)
IN_PLANE = (*BY_TORSION, "x", "y")
ORDER_MATCH = 1e-6  # relative difference of orders, below which they are the same
NM = 1e-9  # nanometer, m
FIGURES = ("rms_error", "transmission_error_orders", "bearing_force_orders")
NAN = float("nan")
WARM_UP = 1e-4  # duration of a run before the measured ones, s: it compiles their routines
HALF, TABLE_REST = "table_half", 1.0 / 3.0
"""Name of the fidelity of every second position node, and share of its error that the whole table has: second
order.
"""
MIN_RATE = 1.5  # least fall of errors from fidelity to fidelity that allows an extrapolation
STEPS = 0.2
"""Power of the tolerance with which the steps of a run fall: errors of the fifth order."""


@dataclass(frozen=True)
class _Vibration:
    """Vibration in B blocks of a run: m meshes, b bearings, n orders of a mesh (first mesh for bearings)."""

    rms: FloatArray
    """Root mean square of the transmission error about its mean, m. Shape (B, m)."""
    error_orders: FloatArray
    """Amplitudes of the transmission errors, m. Shape (B, m, n)."""
    force_orders: FloatArray
    """Amplitudes of the bearing forces in their own frames, N: the norm over three directions. NaN where a
    model has none. Shape (B, b, n).
    """


@dataclass(frozen=True)
class BlockGrid:
    """The output grid that a run is compared on."""

    time: FloatArray
    """Output grid, s. Shape (T,)."""
    position: FloatArray
    """Position of the meshes in the kinematic motion, unwrapped base pitches. Shape (m, T)."""
    bounds: IntArray
    """First sample of each block, and the one behind its last. Shape (B, 2)."""
    orders: int

    @classmethod
    def of(cls, system: System) -> BlockGrid:
        """Cut the run of `system` into blocks of equal time.

        Raises `InputError`: the run turns its first mesh by less than `MIN_PITCHES`, or has too few samples
        a period.
        """
        rate, scene = system.sampling.rate, system.scene
        samples = math.floor(scene.duration * rate * (1.0 + 1e-12)) + 1
        time = np.arange(samples) / rate
        rest = np.zeros((samples, system.arrays.mass.shape[0]))
        position = unwrapped(observe(system.arrays, time, rest, rest).position[: len(scene.meshes)])
        ends = np.linspace(0, samples, MAX_BLOCKS + 1).astype(np.int64)
        bounds = np.stack([ends[:-1], ends[1:]], axis=1)
        turned = [abs(position[0, stop - 1] - position[0, first]) for first, stop in bounds]
        long = np.diff(bounds, axis=1)[:, 0] >= MIN_SAMPLES
        bounds = bounds[(np.array(turned) >= MIN_PITCHES) & long]
        if bounds.size == 0:
            bounds = np.array([[0, samples]])
            if samples < MIN_SAMPLES or abs(position[0, -1] - position[0, 0]) < MIN_PITCHES:
                bound = f"long enough for {MIN_PITCHES:g} base pitches and {MIN_SAMPLES} samples"
                raise InputError("duration", scene.duration, bound, "Lengthen the run or raise its speed.")
        orders = min(orders_seen(line[bounds[0, 0] :], ORDERS) for line in position)
        if orders < 1:
            bound = "at least four samples a base pitch"
            raise InputError("outputs.sample_rate", rate, bound, "Raise it.")
        return cls(time, position, bounds, orders)

    @property
    def middle(self) -> FloatArray:
        """Time in the middle of each block, s."""
        return np.asarray(self.time[self.bounds.mean(axis=1).astype(int)])


def _vibration_of(blocks: BlockGrid, error: FloatArray, force: FloatArray) -> _Vibration:
    """Return the vibration in transmission errors (m, T), m, and bearing forces (b, 3, T), N."""
    rms, by_error, by_force = [], [], []
    for first, stop in blocks.bounds:
        part = slice(int(first), int(stop))
        position, series = blocks.position[:, part], error[:, part]
        rms.append(series.std(axis=1))
        by_error.append(
            [order_amplitudes(at, line, blocks.orders) for at, line in zip(position, series, strict=True)]
        )
        by_force.append(
            np.linalg.norm(order_amplitudes(position[0], force[..., part], blocks.orders), axis=1)
        )
    return _Vibration(np.array(rms), np.array(by_error), np.array(by_force))


class _Fidelity(model_studies.Fidelity[Scene], Protocol):
    """A way to the vibration of a scene; its family is "model", "table" or "steps"."""

    def run(self, scene: Scene, blocks: BlockGrid) -> _Vibration:
        """Compute the vibration.

        Raises `SolveError`: it ended early; `InputError`: the scene has what this model cannot hold.
        """


@dataclass(frozen=True)
class TimeIntegration:
    """A run of the scene with changes."""

    name: str
    title: str
    family: str
    tolerance: float | None = None
    """Tolerance of the time steps, m; None: the tolerance of the scene."""
    every: int = 1
    """Position nodes of the tables that are kept: every one, every second ..."""
    additions: tuple[str, ...] | None = None
    """Additions to the model that effects may make. An effect that makes another one, or none, is off. None:
    all.
    """

    def refusal(self, scene: Scene) -> str | None:
        """Say that fewer effects change nothing, or that a fixed step knows no tolerance."""
        if self.tolerance is not None and scene.integration.fixed_step is not None:
            return "the scene has a fixed step"
        if self.additions is None:
            return None
        decision, own_decision = _decision(scene), _decision(self.as_run(scene))
        return "the scene has no more effects than these" if decision == own_decision else None

    def as_run(self, scene: Scene) -> Scene:
        """Return the scene as this fidelity runs it."""
        integration, effects = scene.integration, dict(scene.effects)
        if self.tolerance is not None:
            integration = replace(integration, tolerance=self.tolerance)
        if self.additions is not None:
            added = [effect for effect in EFFECTS if effect.adds and {*effect.adds} <= {*self.additions}]
            effects |= {effect.name: "off" for effect in EFFECTS if effect not in added}
        outputs = Outputs(scene.outputs.sample_rate, energy_audit=False, receipt="minimal", anti_alias=False)
        return replace(scene, integration=integration, effects=effects, outputs=outputs)

    def run(self, scene: Scene, blocks: BlockGrid) -> _Vibration:
        """Integrate."""
        system = assemble(self.as_run(scene))
        if self.every > 1:
            system = with_decimated_tables(system, self.every)
        start = static_equilibrium(system)
        if not start.status.usable:
            raise SolveError(f"no static equilibrium at t = 0: {start.status.name.lower()}")
        trajectory = integrate(system, start, system.scene.integration)
        if not trajectory.status.usable:
            raise SolveError(f"run ended early, {trajectory.status.name.lower()} at {trajectory.end:.6g} s")
        return _vibration_of(blocks, *_series(system, trajectory))


def _decision(scene: Scene) -> set[tuple[str, str]]:
    return {(entry.effect, entry.part) for entry in assemble(scene).ledger.entries if entry.on}


def _series(system: System, trajectory: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Transmission errors (m, T) and bearing forces in their own frames (b, 3, T)."""
    states = trajectory.states
    observed = observe(system.arrays, trajectory.time, states.q, states.v, states.quanta, states.carried)
    force = system.bearing_force(observed.force, states.q, states.v)[:, :3]
    elastic = np.any(system.bearing_stiffness) or system.housed or system.bearings
    if system.freedoms.column.size and not elastic:
        force = np.full_like(force, np.nan)  # bearings hold nothing here: no freedom moves them
    return observed.coordinate[system.driving_rows], force


@dataclass(frozen=True)
class _QuasiStatic:
    """Static transmission error under the forces that balance loads and imposed accelerations.

    Mesh and bearing forces do not vibrate: their orders are 0.
    """

    name: str = "quasi_static"
    title: str = "quasi-static"
    family: str = "model"

    def refusal(self, scene: Scene) -> str | None:
        """Say nothing: it is valid for every scene."""
        return None

    def run(self, scene: Scene, blocks: BlockGrid) -> _Vibration:
        """Read the tables at the positions and forces of every block."""
        system = assemble(scene)
        error = np.zeros_like(blocks.position)
        for (first, stop), middle in zip(blocks.bounds, blocks.middle, strict=True):
            rest = static_equilibrium(system, float(middle))
            if not rest.status.usable:
                raise SolveError(f"no static equilibrium at {middle:.6g} s")
            for f, force in enumerate(rest.mesh_force):
                position = np.ascontiguousarray(blocks.position[f, first:stop])
                deflection = np.empty_like(position)
                static_deflections(system.flanks.static, f, position, float(force), deflection)
                error[f, first:stop] = deflection
        return _vibration_of(blocks, error, np.zeros((len(system.supports.name), 3, blocks.time.size)))


@dataclass(frozen=True)
class _LinearResponse:
    """Harmonic response to the static transmission errors, with mean stiffnesses."""

    name: str = "harmonic_response"
    title: str = "harmonic response"
    family: str = "model"

    def refusal(self, scene: Scene) -> str | None:
        """Say nothing: what it cannot hold shows when it runs."""
        return None

    def run(self, scene: Scene, blocks: BlockGrid) -> _Vibration:
        """Respond at the speed in the middle of every block."""
        system = assemble(scene)
        speeds = np.abs(observe_laws(system.arrays, blocks.middle)[2])
        law = int(np.flatnonzero(np.max(speeds, axis=1) > 0.0)[0])
        parts = [
            _of_one_speed(
                harmonic_response(system, np.array([speed]), 4 * blocks.orders, float(time)), system, blocks
            )
            for speed, time in zip(speeds[law], blocks.middle, strict=True)
        ]
        names = _Vibration.__dataclass_fields__
        return _Vibration(*(np.array([getattr(part, name) for part in parts]) for name in names))


def _of_one_speed(response: HarmonicResponse, system: System, blocks: BlockGrid) -> _Vibration:
    """Return the vibration of each mesh at its orders, and of bearings at the orders of the first mesh."""
    pace = np.abs(blocks.position[:, -1] - blocks.position[:, 0])
    ratio = pace / pace[0]
    size = np.abs(response.dynamic_transmission_error[:, 0])
    errors = [_at(response.order, size[f], ratio[f], blocks.orders) for f in range(len(size))]
    pushed = np.linalg.norm(np.abs(response.bearing_force[:, :3, 0]), axis=1)
    forces = [_at(response.order, line, 1.0, blocks.orders) for line in pushed]
    empty = np.zeros((0, blocks.orders))
    return _Vibration(
        np.sqrt(0.5 * np.sum(size**2, axis=1)), np.array(errors), np.array(forces) if forces else empty
    )


def _at(order: FloatArray, amplitude: FloatArray, ratio: float, orders: int) -> FloatArray:
    """Amplitudes at the multiples 1 to `orders` of `ratio`; 0 where nothing is excited."""
    multiples = ratio * np.arange(1, orders + 1)
    match = np.abs(order[None, :] - multiples[:, None]) <= ORDER_MATCH * multiples[:, None]
    return np.asarray(np.sum(np.where(match, amplitude[None, :], 0.0), axis=1))


FIDELITIES: tuple[_Fidelity, ...] = (
    _QuasiStatic(),
    _LinearResponse(),
    TimeIntegration("torsion", "torsion only", "model", additions=BY_TORSION),
    TimeIntegration("in_plane", "torsion and lateral motion", "model", additions=IN_PLANE),
    TimeIntegration("table_quarter", "every fourth position node", "table", every=4),
    TimeIntegration("table_half", "every second position node", "table", every=2),
    TimeIntegration("100_nm", "tolerance 100 nm", "steps", tolerance=100 * NM),
    TimeIntegration("10_nm", "tolerance 10 nm", "steps", tolerance=10 * NM),
    TimeIntegration("1_nm", "tolerance 1 nm", "steps", tolerance=NM),
    TimeIntegration("0.1_nm", "tolerance 0.1 nm", "steps", tolerance=0.1 * NM),
    TimeIntegration("0.01_nm", "tolerance 0.01 nm", "steps", tolerance=0.01 * NM),
)


@dataclass(frozen=True)
class FidelityResult(model_studies.FidelityResult):
    """Errors and time of a fidelity.

    Attributes
    ----------
    name, title : str
    cpu_seconds : float
        One thread, assembly included.
    """

    FIGURES = FIGURES

    family: str
    rms_error: float = NAN
    """Relative error of the rms of the transmission errors: over all blocks and meshes, root of the sum of
    squared errors over that of the squares of the reference. NaN: not known.
    """
    transmission_error_orders: float = NAN
    bearing_force_orders: float = NAN
    """`transmission_error_orders`, `bearing_force_orders`: Relative errors of the amplitudes at the orders,
    formed as `rms_error` is.
    """


@brief
@dataclass(frozen=True)
class Frontier(model_studies.Frontier[FidelityResult]):
    """The accuracy study of one scene.

    Attributes
    ----------
    results, left_out, knee, chosen
        Of every accuracy study; the errors of the reference are those left by its steps, chosen is what the
        scene's own settings are nearest to, from above; None with a fixed step.
    """

    orders: int
    blocks: int
    """`orders`, `blocks`: Orders that were compared, and blocks of the run."""
    transmission_error_rms: FloatArray = field(metadata=in_unit("m", "block", "mesh"))
    """Root mean square of the transmission errors in the reference, m. Shape (blocks, meshes)."""


def frontier(
    scene: Scene,
    *,
    fidelities: Sequence[str] | None = None,
    progress: Progress = silent,
) -> Frontier:
    """Run every fidelity that says something about `scene`, and compare each to the finest.

    Raises `InputError`: no mesh, no such fidelity, or a run too short to compare; `SolveError`: fewer than
    two fidelities came to their end.

    Parameters
    ----------
    scene : Scene
        Its duration and output grid are those of all fidelities.
    fidelities : sequence of str, optional
        Names of fidelities to run; default all.
    progress : callable, optional
        Called with "ladder" and the fraction done.
    """
    scene.require_meshes()
    system = assemble(scene)
    blocks, scene = BlockGrid.of(system), system.resolved(scene)
    names = chosen("fidelities", fidelities, [fidelity.name for fidelity in FIDELITIES])
    outcomes, omitted = run_fidelities(
        [fidelity for fidelity in FIDELITIES if fidelity.name in names],
        scene,
        partial(_warm_up, scene, blocks),
        partial(_run, scene, blocks),
        (InputError, SolveError),
        progress,
    )
    results = tuple(  # every fidelity against the last, and that one by how the errors fell towards it
        FidelityResult(
            outcome.fidelity.name,
            outcome.fidelity.title,
            outcome.cpu_seconds,
            outcome.fidelity.family,
            **error,
        )
        for outcome, error in zip(outcomes, against_finest(outcomes, _errors, _remaining), strict=True)
    )
    return Frontier(
        results,
        omitted,
        knee_of_results(results),
        _chosen_fidelity(scene, [outcome.fidelity for outcome in outcomes]),
        blocks.orders,
        len(blocks.bounds),
        outcomes[-1].result.rms,
    )


def runs_of_frontier(scene: Scene, names: Sequence[str]) -> tuple[list[float], float]:
    """Return the steps of the run of each valid fidelity, over the steps of the scene as it is, and 0.

    Raises `InputError`: no mesh, or a run too short to compare.
    """
    scene.require_meshes()
    BlockGrid.of(assemble(scene))  # refuses runs too short to compare
    runs = (run for run in FIDELITIES if isinstance(run, TimeIntegration) and run.name in names)
    tolerance = scene.integration.tolerance
    valid = (run.tolerance or tolerance for run in runs if run.refusal(scene) is None)
    return [(tolerance / run) ** STEPS for run in valid], 0.0


def _chosen_fidelity(scene: Scene, fidelities: Sequence[_Fidelity]) -> str | None:
    """Return the fidelity of all effects and tables with the scene's tolerance, or the next finer one."""
    for fidelity in fidelities:
        tolerance = fidelity.tolerance if isinstance(fidelity, TimeIntegration) else None
        if tolerance is not None and tolerance <= scene.integration.tolerance * (1.0 + 1e-9):
            return fidelity.name
    return None


def _run(scene: Scene, blocks: BlockGrid, fidelity: _Fidelity) -> _Vibration:
    return fidelity.run(scene, blocks)


def _warm_up(scene: Scene, blocks: BlockGrid, fidelities: Sequence[_Fidelity]) -> None:
    """Compile what the fidelities run."""
    short = replace(scene, duration=min(WARM_UP, scene.duration))
    system = assemble(TimeIntegration("warm_up", "", "steps").as_run(short))
    start = static_equilibrium(system)
    for method in EVALUATIONS if start.status.usable else ():
        integrate(system, start, replace(system.scene.integration, method=method))
    for fidelity in fidelities:
        if not isinstance(fidelity, TimeIntegration):
            with suppress(InputError, SolveError):
                fidelity.run(scene, replace(blocks, bounds=blocks.bounds[:1]))


def _errors(vibration: _Vibration, reference: _Vibration) -> Errors:
    pairs = zip(vars(vibration).values(), vars(reference).values(), strict=True)
    return {name: _relative_difference(*pair) for name, pair in zip(FIGURES, pairs, strict=True)}


def _relative_difference(values: FloatArray, reference: FloatArray) -> float:
    """Root of the sum of squared differences over that of the reference; NaN where there is nothing."""
    size = float(np.linalg.norm(reference))
    if values.shape != reference.shape or size == 0.0:
        return NAN
    return float(np.linalg.norm(values - reference)) / size


def _remaining(coarser: Sequence[tuple[_Fidelity, Errors]], _finest: _Fidelity) -> Errors:
    """Estimate the errors of the finer of two fidelities by the rate at which the errors fell."""
    if len(coarser) < 2:
        return dict.fromkeys(FIGURES, NAN)
    (_, far), (_, near) = coarser[-2:]
    rate = {name: far[name] / near[name] if near[name] > 0.0 else NAN for name in FIGURES}
    return {
        name: near[name] / (rate[name] - 1.0) if rate[name] > MIN_RATE else near[name] for name in FIGURES
    }


def knee_of_results(results: Sequence[FidelityResult]) -> str | None:
    """Return the knee; differences below the errors of the reference by steps and tables do not count."""
    return knee_above(results, *(TABLE_REST * result.error for result in results if result.name == HALF))
