"""Toggle each effect of a scene and run again."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.ablation.figures import SETTLED, RunFigures, run_figures
from dynamics.assembly.assemble import assemble
from dynamics.checks import one_of
from dynamics.effects import EFFECTS
from dynamics.errors import InputError, SolveError
from dynamics.influence import Influence, decide_effects, estimate_influences
from dynamics.integrators import Progress
from dynamics.results import RunResult
from dynamics.scene import Scene
from dynamics.simulation import simulate
from dynamics.types import FloatArray, Json

WARM_UP = 0.01
"""Part of the duration that a scene runs for before it is timed."""


@dataclass(frozen=True)
class EffectAblation:
    """One effect toggled in all parts of a scene.

    Attributes
    ----------
    name : str
    on : bool
        Whether the scene has it on anywhere.
    reason : str
        Of the first part that has it, from the ledger.
    influence : float
        Largest static displacement that the ledger states, m.
    estimate : Influence or None
        What leaving it out is estimated to change in that part of the run; None: nothing is known.
    with_effect, without_effect : RunFigures
        One of them is the scene itself.
    """

    name: str
    on: bool
    reason: str
    influence: float
    estimate: Influence | None
    with_effect: RunFigures
    without_effect: RunFigures

    @property
    def mean_change(self) -> FloatArray:
        """Change (m,) of the mean transmission error by leaving the effect out, m."""
        return self.without_effect.mean - self.with_effect.mean

    @property
    def peak_to_peak_change(self) -> FloatArray:
        """Change (m,) of its peak-to-peak value, m."""
        return self.without_effect.peak_to_peak - self.with_effect.peak_to_peak

    @property
    def order_change(self) -> FloatArray:
        """Change (m, 5) of its mesh orders, m."""
        return self.without_effect.orders - self.with_effect.orders

    @property
    def bearing_order_change(self) -> FloatArray:
        """Change (b, 5) of the mesh orders of bearing forces, N."""
        return self.without_effect.bearing_orders - self.with_effect.bearing_orders

    @property
    def cost_ratio(self) -> float:
        """CPU time of the run with the effect over that without."""
        return self.with_effect.seconds / self.without_effect.seconds

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "name": self.name,
            "on": self.on,
            "reason": self.reason,
            "worth_m": self.influence,
            "estimate": None if self.estimate is None else self.estimate.to_json(),
            "with": self.with_effect.to_json(),
            "without": self.without_effect.to_json(),
            "mean_change_m": self.mean_change.tolist(),
            "peak_to_peak_change_m": self.peak_to_peak_change.tolist(),
            "order_change_m": self.order_change.tolist(),
            "bearing_order_change_n": self.bearing_order_change.tolist(),
            "cost_ratio": self.cost_ratio,
        }


@dataclass(frozen=True)
class Ablation:
    """All effects of a scene, each toggled by itself.

    Attributes
    ----------
    mesh, bearing : tuple of str
        What the rows of the figures are.
    nominal : RunFigures
        Of the scene.
    effects : tuple of EffectAblation
    left_out : dict of str to str
        Effects that were not toggled, and why.
    """

    mesh: tuple[str, ...]
    bearing: tuple[str, ...]
    nominal: RunFigures
    effects: tuple[EffectAblation, ...]
    left_out: dict[str, str]

    def to_json(self) -> Json:
        """Return plain JSON in SI units."""
        return {
            "mesh": list(self.mesh),
            "bearing": list(self.bearing),
            "nominal": self.nominal.to_json(),
            "effects": [entry.to_json() for entry in self.effects],
            "left_out": self.left_out,
        }


def ablate(scene: Scene, only: Sequence[str] | None = None, progress: Progress | None = None) -> Ablation:
    """Toggle each effect of a scene in all its parts and report the change.

    Parameters
    ----------
    scene : Scene
        Its ``on_violation`` plays no part: runs are taken as they are. Its tolerance decides once, for the
        scene itself.
    only : sequence of str, optional
        Effects to toggle; default all.
    progress : callable, optional
        Called with the fraction done and what is being done.

    Returns
    -------
    Ablation
        Figures of the second half of each run: of a run at constant speed the steady state, of a run-up the
        largest order amplitudes along it.

    Raises
    ------
    InputError
        An unknown effect, or a run shorter than a few base pitches.
    SolveError
        The scene itself has no equilibrium or stops early.
    """
    known = [effect.name for effect in EFFECTS]
    for name in only or ():
        one_of("only", name, known)
    requested = known if only is None else [name for name in known if name in only]
    scene = assemble(decide_effects(scene).scene).resolved_scene  # one output grid for all runs
    scene = replace(scene, on_violation="report", tolerance=None)
    result, seconds = _timed(scene)
    influences = estimate_influences(scene, SETTLED)
    nominal, found, left_out = run_figures(result, seconds), [], {}
    for count, name in enumerate(requested):
        if progress is not None:
            progress(count / len(requested), name)
        parts = [one for one in result.effect_ledger["entries"] if one["effect"] == name]
        able = [one for one in parts if one["possible"]]
        if not able:
            left_out[name] = parts[0]["reason"] if parts else "no part of the scene has it"
            continue
        try:
            found.append(_switched(scene, name, able, nominal, influences.get(name)))
        except (InputError, SolveError) as error:
            left_out[name] = str(error)
    return Ablation(result.mesh, result.bearing, nominal, tuple(found), left_out)


def _switched(
    scene: Scene, name: str, parts: Sequence[Json], nominal: RunFigures, estimate: Influence | None
) -> EffectAblation:
    """Run with one effect toggled; what is on anywhere goes off everywhere."""
    on = any(part["on"] for part in parts)
    choice = "off" if on else "on"
    other = run_figures(*_timed(replace(scene, effects={**scene.effects, name: choice})))
    first = next((part for part in parts if part["on"] == on), parts[0])
    influence = float(np.max([part["worth"] for part in parts]))
    both = (nominal, other) if on else (other, nominal)
    return EffectAblation(name, on, first["reason"], influence, estimate, *both)


def _timed(scene: Scene) -> tuple[RunResult, float]:
    """Run a scene; the CPU time is that of a second run, the first loads what is compiled for its laws."""
    simulate(replace(scene, duration=WARM_UP * scene.duration))
    began = time.process_time()
    result = simulate(scene)
    return result, time.process_time() - began
