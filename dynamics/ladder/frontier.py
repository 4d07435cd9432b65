"""Error against time of every rung of the ladder, on one scene."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.checks import one_of
from dynamics.errors import InputError, SolveError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.ladder.knee import knee_of
from dynamics.ladder.registry import RUNGS
from dynamics.ladder.rung import Rung
from dynamics.ladder.time_integration import TimeIntegration
from dynamics.ladder.vibration import Blocks, Vibration, blocks_of
from dynamics.scene import Scene
from dynamics.types import FloatArray, Json

FIGURES = ("rms_error", "transmission_error_orders", "bearing_force_orders")
WARM_UP = 1e-4  # s: what a run before the measured ones lasts, so that everything is compiled
HALF, TABLE_REST = "table_half", 1.0 / 3.0
"""The rung of every second position node, and what of its error the whole table leaves: second order."""
LEAST_RATE = 1.5  # by which errors must fall from rung to rung to say what is left


@dataclass(frozen=True)
class RungResult:
    """What a rung gave and took.

    Attributes
    ----------
    name, title, family : str
    rms_error : float
        Of the rms of the transmission errors, relative: over all blocks and meshes, root of the sum of
        squares over that of the reference. NaN: not known.
    transmission_error_orders, bearing_force_orders : float
        Likewise of the amplitudes at the orders.
    cpu_seconds : float
        One thread, assembly included.
    """

    name: str
    title: str
    family: str
    rms_error: float
    transmission_error_orders: float
    bearing_force_orders: float
    cpu_seconds: float

    @property
    def error(self) -> float:
        """The worst of those that are known."""
        known = [value for value in self.errors if np.isfinite(value)]
        return max(known, default=float("nan"))

    @property
    def errors(self) -> tuple[float, float, float]:
        """In the order of FIGURES."""
        return self.rms_error, self.transmission_error_orders, self.bearing_force_orders

    def to_json(self) -> Json:
        """Return plain JSON; errors that are not known are left out."""
        known = {name: value for name, value in zip(FIGURES, self.errors, strict=True) if np.isfinite(value)}
        facts = {"name": self.name, "title": self.title, "family": self.family}
        return {**facts, "errors": known, "cpu_seconds": self.cpu_seconds}


@dataclass(frozen=True)
class Frontier:
    """The ladder on one scene.

    Attributes
    ----------
    results : tuple of RungResult
        In the order of the ladder; the last one is the reference, its errors are those left by its steps.
    left_out : dict
        Name of a rung to the reason why it says nothing here.
    orders, blocks : int
        Orders that were compared, and blocks of the run.
    reference : Vibration
        Of the finest rung.
    knee : str or None
        The rung after which time buys least, by the worst of the errors.
    chosen : str or None
        The rung that the scene's own settings are nearest to, from above; None with a fixed step.
    """

    results: tuple[RungResult, ...]
    left_out: dict[str, str]
    orders: int
    blocks: int
    reference: Vibration
    knee: str | None
    chosen: str | None

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "rungs": [result.to_json() for result in self.results],
            "left_out": self.left_out,
            "reference": self.results[-1].name,
            "knee": self.knee,
            "chosen": self.chosen,
            "orders": self.orders,
            "blocks": self.blocks,
            "transmission_error_rms_m": self.reference.rms.tolist(),
        }


def frontier(
    scene: Scene,
    *,
    rungs: Sequence[str] | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Frontier:
    """Run every rung that says something about `scene`, and compare each to the finest.

    Parameters
    ----------
    scene : Scene
        Its duration and output grid are those of all rungs.
    rungs : sequence of str, optional
        Names of rungs to run; default all.
    progress : callable, optional
        Called with "ladder" and the fraction done.

    Raises
    ------
    InputError
        No such rung, or a run too short to compare.
    SolveError
        Fewer than two rungs came to their end.
    """
    system = assemble(scene)
    blocks, scene = blocks_of(system), system.resolved_scene
    asked = _selected(rungs)
    left_out = {rung.name: reason for rung in asked if (reason := rung.refusal(scene)) is not None}
    asked = [rung for rung in asked if rung.name not in left_out]
    _warm_up(scene, asked, blocks)
    found: list[tuple[Rung, Vibration, float]] = []
    for count, rung in enumerate(asked):
        if progress is not None:
            progress("ladder", count / len(asked))
        try:
            found.append((rung, *_timed(rung, scene, blocks)))
        except (InputError, SolveError) as error:
            left_out[rung.name] = str(error)
        except MemoryError:
            left_out[rung.name] = "out of memory"
    if progress is not None:
        progress("ladder", 1.0)
    if len(found) < 2:
        raise SolveError(f"an error needs two rungs to compare; left out: {left_out}")
    results = _compared(found)
    return Frontier(
        results,
        left_out,
        blocks.orders,
        len(blocks.bounds),
        found[-1][1],
        knee_of_rungs(results),
        chosen_rung(scene, [rung for rung, _, _ in found]),
    )


def chosen_rung(scene: Scene, rungs: Sequence[Rung]) -> str | None:
    """Return the rung of all effects and tables with the scene's tolerance, or the next finer one."""
    for rung in rungs:
        tolerance = rung.tolerance if isinstance(rung, TimeIntegration) else None
        if tolerance is not None and tolerance <= scene.integration.tolerance * (1.0 + 1e-9):
            return rung.name
    return None


def _selected(names: Sequence[str] | None) -> list[Rung]:
    """Rungs of these names in the order of the ladder."""
    for name in names or ():
        one_of("rungs", name, [rung.name for rung in RUNGS])
    return [rung for rung in RUNGS if names is None or rung.name in names]


def _warm_up(scene: Scene, rungs: Sequence[Rung], blocks: Blocks) -> None:
    """Compile what the rungs run."""
    short = replace(scene, duration=min(WARM_UP, scene.duration))
    system = assemble(TimeIntegration("warm_up", "", "steps").as_asked(short))
    start = static_equilibrium(system)
    if start.status.usable:
        integrate(system, start, system.scene.integration)
    for rung in rungs:
        if not isinstance(rung, TimeIntegration):
            with suppress(InputError, SolveError):
                rung.run(scene, replace(blocks, bounds=blocks.bounds[:1]))


def _timed(rung: Rung, scene: Scene, blocks: Blocks) -> tuple[Vibration, float]:
    """Run a rung and take its CPU time."""
    began = clock.process_time()
    found = rung.run(scene, blocks)
    return found, clock.process_time() - began


def _compared(found: Sequence[tuple[Rung, Vibration, float]]) -> tuple[RungResult, ...]:
    """Measure every rung against the last, and that one by how the errors fell towards it."""
    reference = found[-1][1]
    errors = [_errors(vibration, reference) for _, vibration, _ in found]
    steps = [i for i, (rung, _, _) in enumerate(found[:-1]) if rung.family == found[-1][0].family]
    errors[-1] = _left(errors[steps[-2]], errors[steps[-1]]) if len(steps) > 1 else (float("nan"),) * 3
    return tuple(
        RungResult(rung.name, rung.title, rung.family, *error, seconds)
        for (rung, _, seconds), error in zip(found, errors, strict=True)
    )


def _errors(found: Vibration, reference: Vibration) -> tuple[float, float, float]:
    """Relative errors in the order of FIGURES."""
    pairs = (
        (found.rms, reference.rms),
        (found.error_orders, reference.error_orders),
        (found.force_orders, reference.force_orders),
    )
    rms, errors, forces = (_apart(one, other) for one, other in pairs)
    return rms, errors, forces


def _apart(one: FloatArray, other: FloatArray) -> float:
    """Root of the sum of squared differences over that of the reference; NaN where there is nothing."""
    size = float(np.linalg.norm(other))
    if one.shape != other.shape or size == 0.0:
        return float("nan")
    return float(np.linalg.norm(one - other)) / size


def _left(coarse: Sequence[float], fine: Sequence[float]) -> tuple[float, float, float]:
    """Return what a sequence of errors leaves behind its last step, by the rate at which they fell."""
    left = []
    for far, near in zip(coarse, fine, strict=True):
        rate = far / near if near > 0.0 else float("nan")
        left.append(near / (rate - 1.0) if rate > LEAST_RATE else near)
    return left[0], left[1], left[2]


def knee_of_rungs(results: Sequence[RungResult]) -> str | None:
    """Return the knee; differences below what steps and tables of the reference leave say nothing."""
    own = [results[-1].error, *(TABLE_REST * r.error for r in results if r.name == HALF)]
    floor = max((error for error in own if np.isfinite(error)), default=0.0)
    known = [result for result in results if np.isfinite(result.error)]
    return knee_of({result.name: (result.cpu_seconds, max(result.error, floor)) for result in known})
