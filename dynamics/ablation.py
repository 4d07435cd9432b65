"""Ablation of a scene: toggle each of its effects by itself, run again, and compare the figures of the runs.

Terms: an effect is a part of the model that can be on or off, such as friction. The ledger of a scene says of
every part (mesh or bearing) which effects it has, which of them are on, and why. The influence of an effect
is the estimate, by linear theory, of what toggling it changes. The level is what the scene is computed for,
its `LevelQuantity`: the sound power of a housing, for example, or by default the forces on bearings; lines
are its squares by order. m counts meshes, b bearings with stored forces, K lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

import numpy as np

import model_studies
from bounds.brief import brief
from dynamics.assembly.assemble import System, assemble
from dynamics.checks import chosen
from dynamics.effects import EFFECTS
from dynamics.errors import InputError, SolveError
from dynamics.influence import Influence, decide_effects, estimate_influences
from dynamics.influence.level_change import BearingForces, LevelChange, Lines, level_change, loudest_lines
from dynamics.influence.linear_figures import COMPARED
from dynamics.orders import bearing_orders, order_track
from dynamics.results import RunResult
from dynamics.scene import Scene
from dynamics.settings.level_quantity import LevelQuantity
from dynamics.simulation import simulate
from dynamics.types import FloatArray
from host import cpu_seconds
from model_studies import Figures, LeftOut, Progress, in_unit, run_variants, silent
from model_studies.workers import InProcess, Workers

__all__ = ["Ablation", "EffectAblation", "RunFigures", "ablate"]


HIGHEST = COMPARED
"""Highest mesh order that is compared; the mean, order 0, is compared by itself."""
PITCHES = 16
"""Base pitches in a block of the order analysis, unless the run is too short for four such blocks."""
SETTLED = 0.5
"""Part of the run after which start-up transients are taken to have died out."""

WARM_UP = 0.01
"""Duration of the run before the timed one, over the duration of the scene."""
_FIGURE = 2e-6
"""CPU seconds of the figures of a run, per sample and per mesh or bearing; for predictions of cost only."""


def _no_lines() -> FloatArray:
    return np.empty(0)


@dataclass(frozen=True)
class RunFigures(Figures):
    """Figures of the settled part of a run.

    Attributes
    ----------
    mean, peak_to_peak : (m,) arrays
        Mean and peak-to-peak of the dynamic transmission error of every mesh, m.
    cpu_seconds : float
        CPU time of the run, s.
    """

    orders: FloatArray = field(metadata=in_unit("m", "curve", "order"))
    """Largest amplitudes along the run of mesh orders 1 to 5 of the transmission error, m. Shape (m, 5)."""
    bearing_orders: FloatArray = field(metadata=in_unit("n", "bearing", "order"))
    """Largest amplitudes along the run of mesh orders 1 to 5 of the bearing forces, N: the root of the sum
    of squares over the components. b = 0 if the run stores no forces. Shape (b, 5).
    """
    line_order: FloatArray = field(default_factory=_no_lines, metadata=in_unit("1", "line"))
    line_square: FloatArray = field(default_factory=_no_lines, metadata=in_unit("1", "line"))
    """`line_order`, `line_square`: Orders of the level, and its largest square along the run in each. K = 0
    if the run is too short for bearing orders. Shape (K,) each.
    """

    @property
    def lines(self) -> Lines:
        """Largest squares of the level by order."""
        return dict(zip(self.line_order.tolist(), self.line_square.tolist(), strict=True))


def _run_figures(result: RunResult, seconds: float, quantity: LevelQuantity) -> RunFigures:
    """Return the figures of a run that took `seconds` of CPU time.

    Raises `InputError`: the run is shorter than a few base pitches.
    """
    settled = slice(int(SETTLED * result.time.size), None)
    error = result.dynamic_transmission_error[:, settled]
    position = np.unwrap(result.position[0], period=1.0)  # position of the first mesh, base pitches
    travel = abs(float(np.sum(np.diff(position))))
    pitches = max(1, min(PITCHES, int(travel / 4.0)))  # at least four blocks: two of them in the settled half
    transmission = _largest(result, "dynamic_transmission_error", pitches)
    bearings = np.empty((0, HIGHEST))
    if result.bearing_force.size:
        components = _largest(result, "bearing_force", pitches)  # shape (b, components, 5)
        bearings = np.sqrt(np.sum(components**2, axis=1))
    line_order, line_square = _settled_lines(result, quantity)
    return RunFigures(
        mean=np.mean(error, axis=1),
        peak_to_peak=np.ptp(error, axis=1),
        cpu_seconds=seconds,
        orders=transmission,
        bearing_orders=bearings,
        line_order=line_order,
        line_square=line_square,
    )


def _settled_lines(result: RunResult, quantity: LevelQuantity) -> tuple[FloatArray, FloatArray]:
    """Return orders (K,) and largest squares (K,) of the level over the settled windows.

    Both are empty if the run has no bearing orders, or no settled window.
    """
    try:
        forces = bearing_orders(result)
    except InputError:
        return _no_lines(), _no_lines()
    settled = forces.time >= SETTLED * result.time[-1]
    if not settled.any():
        return _no_lines(), _no_lines()
    lines = loudest_lines(forces.order, quantity.squares(forces)[settled], known={})
    return np.array(list(lines)), np.array(list(lines.values()))


def _largest(result: RunResult, series: str, pitches: int) -> FloatArray:
    """Return the largest amplitudes (..., 5) of mesh orders 1 to 5 over the settled blocks of a series."""
    amplitude = order_track(result, series, pitches, HIGHEST).amplitude  # (..., blocks, orders 0 to 5)
    first = int(SETTLED * amplitude.shape[-2])
    return np.asarray(np.max(amplitude[..., first:, 1:], axis=-2))


@dataclass(frozen=True)
class EffectAblation(model_studies.EffectAblation[RunFigures, Influence]):
    """One effect toggled in all parts of a scene.

    Attributes
    ----------
    name, on, reason, with_effect, without_effect, estimate
        As in `model_studies.EffectAblation`. The effect is on if it is on in any part of the scene; the
        reason is that of the first such part. The estimate covers the settled part of the run, as the figures
        do.
    """

    level: LevelChange = field(default_factory=LevelChange)
    """Change of the level by the effect, as the ledger estimates it for the whole run."""

    @property
    def level_change(self) -> LevelChange:
        """Change of the level between the two runs, over their settled part."""
        level = self.level
        return level_change(self.with_effect.lines, self.without_effect.lines, level.quantity, level.unit)

    @property
    def order_change(self) -> FloatArray:
        """Change (m, 5) of the mesh orders of the transmission error by leaving the effect out, m."""
        return self.change("orders")

    @property
    def bearing_order_change(self) -> FloatArray:
        """Change (b, 5) of the mesh orders of the bearing forces by leaving the effect out, N."""
        return self.change("bearing_orders")


@brief
@dataclass(frozen=True)
class Ablation(model_studies.Ablation[RunFigures, EffectAblation]):
    """All effects of a scene, each toggled by itself.

    Attributes
    ----------
    nominal, effects, left_out
        Fields of `model_studies.Ablation`.
    """

    mesh: tuple[str, ...]
    bearing: tuple[str, ...]
    """`mesh`, `bearing`: Names of the meshes and bearings, in the order of the rows of the figures."""


def ablate(
    scene: Scene,
    only: Sequence[str] | None = None,
    progress: Progress = silent,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> Ablation:
    """Toggle each effect of a scene in all its parts and report the change.

    Raises `InputError`: no mesh, an unknown effect, or a run shorter than a few base pitches; `SolveError`:
    the scene itself has no equilibrium or stops early.

    Parameters
    ----------
    scene : Scene
        Its ``on_violation`` is ignored: no run is repeated. Its tolerance decides once which effects are on,
        for the scene itself; the runs with a toggled effect keep that choice.
    only : sequence of str, optional
        Effects to toggle; default all.
    progress : callable, optional
        Called with "ablation" and the fraction done.
    workers : Workers
        Executor of the runs: each task is one effect.

    Returns
    -------
    Ablation
        Figures of the second half of each run. They are those of the steady state if the speed is constant;
        in a run-up the amplitudes of orders are the largest ones along it.
    """
    names = chosen("only", only, [effect.name for effect in EFFECTS])
    scene.require_meshes()
    scene = decide_effects(scene).scene
    scene = assemble(scene).resolved(scene)  # all runs get the same times of output
    # The choice of effects is made: without tolerances no run makes it again.
    scene = replace(scene, on_violation="report", tolerance=None, level_tolerance=None)
    result, seconds = _timed(scene)
    quantity = scene.quantity or BearingForces()
    nominal = _run_figures(result, seconds, quantity)
    # Levels of the whole run, as its ledger states them; estimates of the settled part, as the figures.
    levels = {name: influence.level for name, influence in estimate_influences(scene).items()}
    estimates = estimate_influences(scene, settled=SETTLED)
    system = assemble(scene)
    states = {name: _EffectState.of(system, name) for name in names}
    effects, omitted = run_variants(
        stage="ablation",
        variants=states,
        compute=partial(_toggled_ablation, scene, nominal),
        failures=(InputError, SolveError),
        progress=progress,
        workers=workers,
        seconds=seconds * sum(state.possible for state in states.values()),
    )
    no_change = LevelChange(quantity.name, quantity.unit)
    entries = (
        replace(entry, estimate=estimates.get(name), level=levels.get(name, no_change))
        for name, entry in effects.items()
    )
    return Ablation(nominal, tuple(entries), omitted, result.mesh, result.bearing)


def runs_of_ablation(scene: Scene, only: Sequence[str] | None = None) -> tuple[list[float], float]:
    """Return the cost of an ablation: relative lengths of its runs, and CPU seconds of the figures of one.

    The first entry of the list is the scene itself, the others are one for every effect that the scene can
    have. An entry is a number of integration steps over the steps of the scene, warm-up included. A run with
    an effect switched off takes as many steps as the scene; one with an effect switched on takes more, in
    proportion to the degrees of freedom that the effect adds.
    """
    names = chosen("only", only, [effect.name for effect in EFFECTS])
    scene.require_meshes()
    system = assemble(scene)
    states = [_EffectState.of(system, name) for name in names]
    possible = [state for state in states if state.possible]
    freedoms = max(system.freedoms.column.size, 1)
    switched_off = [1.0 for state in possible if state.on]
    switched_on = [
        assemble(state.toggled(scene)).freedoms.column.size / freedoms for state in possible if not state.on
    ]
    steps = [(1.0 + WARM_UP) * ratio for ratio in (1.0, *switched_off, *switched_on)]
    parts = len(scene.meshes) + len(system.supports.name)
    samples = scene.duration * system.sampling.rate
    return steps, _FIGURE * parts * samples


class _EffectState(NamedTuple):
    """The state of one effect over all parts of a scene.

    The effect is `on` if it is on in any part, and `possible` if any part can have it.
    """

    name: str
    on: bool
    reason: str
    possible: bool

    @classmethod
    def of(cls, system: System, name: str) -> _EffectState:
        """Return the state that the ledger of a system holds; the reason is that of the first part with it.

        If no part can have the effect, the reason is that of the first part.
        """
        parts = system.ledger.of(name)
        capable = [part for part in parts if part.possible]
        on = any(part.on for part in capable)
        reasons = [part.reason for part in capable if part.on == on] or [part.reason for part in parts]
        reason = reasons[0] if reasons else "no part of the scene has it"
        return cls(name, on, reason, possible=bool(capable))

    def toggled(self, scene: Scene) -> Scene:
        """Return the scene with the effect toggled in all parts: off if it is on in any part, else on."""
        return replace(scene, effects={**scene.effects, self.name: "off" if self.on else "on"})


def _toggled_ablation(scene: Scene, nominal: RunFigures, state: _EffectState) -> EffectAblation:
    """Return the figures of a scene with and without one effect: `nominal`, and the figures of a second run.

    Raises `LeftOut`: no part of the scene can have the effect.
    """
    if not state.possible:
        raise LeftOut(state.reason)
    result, seconds = _timed(state.toggled(scene))
    toggled = _run_figures(result, seconds, scene.quantity or BearingForces())
    return EffectAblation(
        name=state.name,
        on=state.on,
        reason=state.reason,
        with_effect=nominal if state.on else toggled,
        without_effect=toggled if state.on else nominal,
        estimate=None,  # `ablate` fills it in
    )


def _timed(scene: Scene) -> tuple[RunResult, float]:
    """Run a scene; return the result and its CPU time in s.

    A short run comes first: it compiles or loads the laws of the scene, which the time then does not contain.
    """
    simulate(replace(scene, duration=WARM_UP * scene.duration))
    began = cpu_seconds()
    result = simulate(scene)
    return result, cpu_seconds() - began
