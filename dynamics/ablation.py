"""Toggle each effect of a scene and run again."""

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
"""Mesh orders that are compared."""
PITCHES = 16
SETTLED = 0.5
"""Part of the run after which start-up transients are taken to have died out."""

WARM_UP = 0.01
"""Part of the duration that a scene runs for before it is timed."""
_FIGURE = 2e-6
"""CPU seconds of the figures of a run by sample, and by mesh or bearing."""


def _no_lines() -> FloatArray:
    return np.empty(0)


@dataclass(frozen=True)
class RunFigures(Figures):
    """Figures of the settled part of a run.

    Attributes
    ----------
    mean, peak_to_peak : (m,) arrays
        Of the dynamic transmission error of every mesh, m.
    cpu_seconds : float
        Of the run.
    """

    orders: FloatArray = field(metadata=in_unit("m", "curve", "order"))
    """Largest amplitude along the run of the mesh orders 1 to 5 of the transmission error, m. Shape (m, 5).
    """
    bearing_orders: FloatArray = field(metadata=in_unit("n", "bearing", "order"))
    """Of the bearing forces, root of the sum of squares of their components, N; b = 0 if not stored. Shape
    (b, 5).
    """
    line_order: FloatArray = field(default_factory=_no_lines, metadata=in_unit("1", "line"))
    line_square: FloatArray = field(default_factory=_no_lines, metadata=in_unit("1", "line"))
    """`line_order`, `line_square`: Orders of the bearing forces and the largest squares along the run of what
    the scene is computed for; K = 0 of a run too short to tell them. Shape (K,) each.
    """

    @property
    def lines(self) -> Lines:
        """The largest squares by order."""
        return dict(zip(self.line_order.tolist(), self.line_square.tolist(), strict=True))


def _run_figures(result: RunResult, seconds: float, quantity: LevelQuantity) -> RunFigures:
    """Return the figures of a run of so many CPU seconds; one shorter than a few base pitches is refused."""
    settled = slice(int(SETTLED * result.time.size), None)
    error = result.dynamic_transmission_error[:, settled]
    travel = float(np.abs(np.sum(np.diff(np.unwrap(result.position[0], period=1.0)))))  # of the first mesh
    pitches = max(1, min(PITCHES, int(travel / 4.0)))
    transmission = _largest(result, "dynamic_transmission_error", pitches)
    bearings = np.empty((0, HIGHEST))
    if result.bearing_force.size:
        bearings = np.sqrt(np.sum(_largest(result, "bearing_force", pitches) ** 2, axis=1))
    figures = np.mean(error, axis=1), np.ptp(error, axis=1), seconds
    return RunFigures(*figures, transmission, bearings, *_lines_of(result, quantity))


def _lines_of(result: RunResult, quantity: LevelQuantity) -> tuple[FloatArray, FloatArray]:
    """Return orders (K,) and largest squares (K,) over the settled windows; none of a run without any."""
    try:
        forces = bearing_orders(result)
    except InputError:
        return _no_lines(), _no_lines()
    settled = forces.time >= SETTLED * result.time[-1]
    lines = loudest_lines(forces.order, quantity.squares(forces)[settled], {}) if settled.any() else {}
    return np.array(list(lines)), np.array(list(lines.values()))


def _largest(result: RunResult, series: str, pitches: int) -> FloatArray:
    """Largest amplitudes (..., 5) of the orders 1 to 5 over the settled blocks."""
    amplitude = order_track(result, series, pitches, HIGHEST).amplitude
    first = int(SETTLED * amplitude.shape[-2])
    return np.asarray(np.max(amplitude[..., first:, 1:], axis=-2))


@dataclass(frozen=True)
class EffectAblation(model_studies.EffectAblation[RunFigures, Influence]):
    """One effect toggled in all parts of a scene.

    Attributes
    ----------
    name, on, reason, with_effect, without_effect, estimate
        Of every ablation; on if any part has it on, the reason is that of the first such part. The estimate
        is of the part of the run that is compared.
    """

    level: LevelChange = field(default_factory=LevelChange)
    """What the ledger of the run states, of all of it."""

    @property
    def level_change(self) -> LevelChange:
        """Change of the level that is measured, of the part of the run that is compared."""
        level = self.level
        return level_change(self.with_effect.lines, self.without_effect.lines, level.quantity, level.unit)

    @property
    def order_change(self) -> FloatArray:
        """Change (m, 5) of the mesh orders by leaving the effect out, m."""
        return self.change("orders")

    @property
    def bearing_order_change(self) -> FloatArray:
        """Change (b, 5) of the mesh orders of bearing forces, N."""
        return self.change("bearing_orders")


@brief
@dataclass(frozen=True)
class Ablation(model_studies.Ablation[RunFigures, EffectAblation]):
    """All effects of a scene, each toggled by itself.

    Attributes
    ----------
    nominal, effects, left_out
        Of every ablation.
    """

    mesh: tuple[str, ...]
    bearing: tuple[str, ...]
    """`mesh`, `bearing`: What the rows of the figures are."""


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
        Its ``on_violation`` is ignored: no run is repeated. Its tolerance decides once, for the scene itself.
    only : sequence of str, optional
        Effects to toggle; default all.
    progress : callable, optional
        Called with "ablation" and the fraction done.
    workers : Workers
        They run an effect each.

    Returns
    -------
    Ablation
        Figures of the second half of each run: of a run at constant speed the steady state, of a run-up the
        largest order amplitudes along it.
    """
    names = chosen("only", only, [effect.name for effect in EFFECTS])
    scene.require_meshes()
    scene = decide_effects(scene).scene
    scene = assemble(scene).resolved(scene)  # one output grid for all runs
    scene = replace(scene, on_violation="report", tolerance=None, level_tolerance=None)
    result, seconds = _timed(scene)
    quantity = scene.quantity or BearingForces()
    nominal = _run_figures(result, seconds, quantity)
    ledger = {name: influence.level for name, influence in estimate_influences(scene).items()}
    estimates = estimate_influences(scene, SETTLED)
    system = assemble(scene)
    states = {name: _EffectState.of(system, name) for name in names}
    effects, left_out = run_variants(
        "ablation",
        states,
        partial(_toggled, scene, nominal),
        (InputError, SolveError),
        progress,
        workers,
        seconds * sum(state.possible for state in states.values()),
    )
    silence = LevelChange(quantity.name, quantity.unit)
    entries = (
        replace(entry, estimate=estimates.get(name), level=ledger.get(name, silence))
        for name, entry in effects.items()
    )
    return Ablation(nominal, tuple(entries), left_out, result.mesh, result.bearing)


def runs_of_ablation(scene: Scene, only: Sequence[str] | None = None) -> tuple[list[float], float]:
    """Return the steps of all runs over those of the scene's own, and the CPU seconds of the figures of each.

    Of the scene and of every effect that it can have; one that is off brings its freedoms, in proportion.
    """
    names = chosen("only", only, [effect.name for effect in EFFECTS])
    scene.require_meshes()
    system = assemble(scene)
    states = [state for state in (_EffectState.of(system, name) for name in names) if state.possible]
    scenes = [state.toggled(scene) for state in states if not state.on]
    freedoms = max(system.freedoms.column.size, 1)
    more = [assemble(other).freedoms.column.size / freedoms for other in scenes]
    less = sum(state.on for state in states)
    parts = len(scene.meshes) + len(system.supports.name)
    figures = _FIGURE * parts * scene.duration * system.sampling.rate
    return [(1.0 + WARM_UP) * times for times in (1.0, *less * [1.0], *more)], figures


class _EffectState(NamedTuple):
    """One effect over all parts of a scene: on if any part has it on."""

    name: str
    on: bool
    reason: str
    possible: bool

    @classmethod
    def of(cls, system: System, name: str) -> _EffectState:
        """Return what the ledger of a scene decided; the reason is that of the first such part."""
        parts = system.ledger.of(name)
        able = [part for part in parts if part.possible]
        on = any(part.on for part in able)
        reasons = [part.reason for part in able if part.on == on] or [part.reason for part in parts]
        return cls(name, on, next(iter(reasons), "no part of the scene has it"), possible=bool(able))

    def toggled(self, scene: Scene) -> Scene:
        """Return the scene with the effect toggled: what is on anywhere goes off everywhere."""
        return replace(scene, effects={**scene.effects, self.name: "off" if self.on else "on"})


def _toggled(scene: Scene, nominal: RunFigures, state: _EffectState) -> EffectAblation:
    """Run with one effect toggled."""
    if not state.possible:
        raise LeftOut(state.reason)
    other = _run_figures(*_timed(state.toggled(scene)), scene.quantity or BearingForces())
    runs = (nominal, other) if state.on else (other, nominal)
    return EffectAblation(state.name, state.on, state.reason, *runs, None)


def _timed(scene: Scene) -> tuple[RunResult, float]:
    """Run a scene; the CPU time is that of a second run, the first loads what is compiled for its laws."""
    simulate(replace(scene, duration=WARM_UP * scene.duration))
    began = cpu_seconds()
    result = simulate(scene)
    return result, cpu_seconds() - began
