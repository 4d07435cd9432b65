"""Error against time of every fidelity on one scene."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

import model_studies
from dynamics.accuracy.fidelities import FIDELITIES, Fidelity, TimeIntegration
from dynamics.accuracy.vibration import Blocks, Vibration, blocks_of
from dynamics.assembly.assemble import assemble
from dynamics.checks import chosen
from dynamics.errors import InputError, SolveError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.method_choice import EVALUATIONS
from dynamics.scene import Scene
from dynamics.types import FloatArray, Json
from model_studies import Outcome, Progress, against_finest, in_unit, knee_above, run_fidelities, silent
from model_studies.frontier import Errors

FIGURES = ("rms_error", "transmission_error_orders", "bearing_force_orders")
NAN = float("nan")
WARM_UP = 1e-4  # s: what a run before the measured ones lasts, so that everything is compiled
HALF, TABLE_REST = "table_half", 1.0 / 3.0
"""The fidelity of every second position node, and what of its error the whole table leaves: second order."""
LEAST_RATE = 1.5  # by which errors must fall from fidelity to fidelity to say what is left


@dataclass(frozen=True)
class FidelityResult(model_studies.FidelityResult):
    """Errors and time of a fidelity.

    Attributes
    ----------
    name, title : str
    cpu_seconds : float
        One thread, assembly included.
    family : str
    rms_error : float
        Of the rms of the transmission errors, relative: over all blocks and meshes, root of the sum of
        squares over that of the reference. NaN: not known.
    transmission_error_orders, bearing_force_orders : float
        Likewise of the amplitudes at the orders.
    """

    FIGURES = FIGURES

    family: str
    rms_error: float = NAN
    transmission_error_orders: float = NAN
    bearing_force_orders: float = NAN

    def to_json(self) -> Json:
        """Return plain JSON; errors that are not known are left out."""
        facts = {name: value for name, value in super().to_json().items() if name not in FIGURES}
        return {**facts, "errors": self.errors}


@dataclass(frozen=True)
class Frontier(model_studies.Frontier[FidelityResult]):
    """The accuracy study of one scene.

    Attributes
    ----------
    results, left_out, knee, chosen
        Of every accuracy study; the errors of the reference are those left by its steps, chosen is what the
        scene's own settings are nearest to, from above; None with a fixed step.
    orders, blocks : int
        Orders that were compared, and blocks of the run.
    transmission_error_rms : (blocks, meshes) array
        Of the reference, m.
    """

    orders: int
    blocks: int
    transmission_error_rms: FloatArray = field(metadata=in_unit("m", "block", "mesh"))


def frontier(
    scene: Scene,
    *,
    fidelities: Sequence[str] | None = None,
    progress: Progress = silent,
) -> Frontier:
    """Run every fidelity that says something about `scene`, and compare each to the finest.

    Parameters
    ----------
    scene : Scene
        Its duration and output grid are those of all fidelities.
    fidelities : sequence of str, optional
        Names of fidelities to run; default all.
    progress : callable, optional
        Called with "ladder" and the fraction done.

    Raises
    ------
    InputError
        No such fidelity, or a run too short to compare.
    SolveError
        Fewer than two fidelities came to their end.
    """
    system = assemble(scene)
    blocks, scene = blocks_of(system), system.resolved_scene
    names = chosen("fidelities", fidelities, [fidelity.name for fidelity in FIDELITIES])
    outcomes, left_out = run_fidelities(
        [fidelity for fidelity in FIDELITIES if fidelity.name in names],
        scene,
        lambda valid: _warm_up(scene, valid, blocks),
        lambda fidelity: fidelity.run(scene, blocks),
        (InputError, SolveError),
        progress,
    )
    results = _compared(outcomes)
    return Frontier(
        results,
        left_out,
        knee_of_results(results),
        _chosen_fidelity(scene, [outcome.fidelity for outcome in outcomes]),
        blocks.orders,
        len(blocks.bounds),
        outcomes[-1].result.rms,
    )


def _chosen_fidelity(scene: Scene, fidelities: Sequence[Fidelity]) -> str | None:
    """Return the fidelity of all effects and tables with the scene's tolerance, or the next finer one."""
    for fidelity in fidelities:
        tolerance = fidelity.tolerance if isinstance(fidelity, TimeIntegration) else None
        if tolerance is not None and tolerance <= scene.integration.tolerance * (1.0 + 1e-9):
            return fidelity.name
    return None


def _warm_up(scene: Scene, fidelities: Sequence[Fidelity], blocks: Blocks) -> None:
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


def _compared(outcomes: Sequence[Outcome[Fidelity, Vibration]]) -> tuple[FidelityResult, ...]:
    """Measure every fidelity against the last, and that one by how the errors fell towards it."""
    return tuple(
        FidelityResult(
            outcome.fidelity.name,
            outcome.fidelity.title,
            outcome.cpu_seconds,
            outcome.fidelity.family,
            **error,
        )
        for outcome, error in zip(outcomes, against_finest(outcomes, _errors, _remaining), strict=True)
    )


def _errors(vibration: Vibration, reference: Vibration) -> Errors:
    pairs = (
        (vibration.rms, reference.rms),
        (vibration.error_orders, reference.error_orders),
        (vibration.force_orders, reference.force_orders),
    )
    return {name: _apart(*pair) for name, pair in zip(FIGURES, pairs, strict=True)}


def _apart(values: FloatArray, reference: FloatArray) -> float:
    """Root of the sum of squared differences over that of the reference; NaN where there is nothing."""
    size = float(np.linalg.norm(reference))
    if values.shape != reference.shape or size == 0.0:
        return NAN
    return float(np.linalg.norm(values - reference)) / size


def _remaining(coarser: Sequence[tuple[Fidelity, Errors]], _finest: Fidelity) -> Errors:
    """Return what the errors of two fidelities leave behind the finer one, by the rate at which they fell."""
    if len(coarser) < 2:
        return dict.fromkeys(FIGURES, NAN)
    (_, far), (_, near) = coarser[-2:]
    return {name: _left_behind(far[name], near[name]) for name in FIGURES}


def _left_behind(far: float, near: float) -> float:
    """Return what a sequence of errors leaves behind its last step."""
    rate = far / near if near > 0.0 else NAN
    return near / (rate - 1.0) if rate > LEAST_RATE else near


def knee_of_results(results: Sequence[FidelityResult]) -> str | None:
    """Return the knee; differences below what steps and tables of the reference leave say nothing."""
    return knee_above(results, *(TABLE_REST * result.error for result in results if result.name == HALF))
