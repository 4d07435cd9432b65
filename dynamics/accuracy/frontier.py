"""Error against time of every fidelity on one scene."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from dynamics.accuracy.fidelity import Fidelity
from dynamics.accuracy.knee import knee_of
from dynamics.accuracy.registry import FIDELITIES
from dynamics.accuracy.time_integration import TimeIntegration
from dynamics.accuracy.vibration import Blocks, Vibration, blocks_of
from dynamics.assembly.assemble import assemble
from dynamics.checks import one_of
from dynamics.errors import InputError, SolveError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.scene import Scene
from dynamics.types import FloatArray, Json

FIGURES = ("rms_error", "transmission_error_orders", "bearing_force_orders")
WARM_UP = 1e-4  # s: what a run before the measured ones lasts, so that everything is compiled
HALF, TABLE_REST = "table_half", 1.0 / 3.0
"""The fidelity of every second position node, and what of its error the whole table leaves: second order."""
LEAST_RATE = 1.5  # by which errors must fall from fidelity to fidelity to say what is left


@dataclass(frozen=True)
class FidelityResult:
    """Errors and time of a fidelity.

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
    """The accuracy study of one scene.

    Attributes
    ----------
    results : tuple of FidelityResult
        In the order of `FIDELITIES`; the last one is the reference, its errors are those left by its steps.
    left_out : dict
        Name of a fidelity to the reason why it says nothing here.
    orders, blocks : int
        Orders that were compared, and blocks of the run.
    reference : Vibration
        Of the finest fidelity.
    knee : str or None
        The fidelity after which time buys least, by the worst of the errors.
    chosen : str or None
        The fidelity that the scene's own settings are nearest to, from above; None with a fixed step.
    """

    results: tuple[FidelityResult, ...]
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
    fidelities: Sequence[str] | None = None,
    progress: Callable[[str, float], None] | None = None,
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
    requested = _selected(fidelities)
    refusals = {fidelity.name: fidelity.refusal(scene) for fidelity in requested}
    left_out = {name: reason for name, reason in refusals.items() if reason is not None}
    requested = [fidelity for fidelity in requested if fidelity.name not in left_out]
    _warm_up(scene, requested, blocks)
    found: list[tuple[Fidelity, Vibration, float]] = []
    for count, fidelity in enumerate(requested):
        if progress is not None:
            progress("ladder", count / len(requested))
        try:
            found.append((fidelity, *_timed(fidelity, scene, blocks)))
        except (InputError, SolveError) as error:
            left_out[fidelity.name] = str(error)
        except MemoryError:
            left_out[fidelity.name] = "out of memory"
    if progress is not None:
        progress("ladder", 1.0)
    if len(found) < 2:
        raise SolveError(f"an error needs two fidelities to compare; left out: {left_out}")
    results = _compared(found)
    return Frontier(
        results,
        left_out,
        blocks.orders,
        len(blocks.bounds),
        found[-1][1],
        knee_of_results(results),
        chosen_fidelity(scene, [fidelity for fidelity, _, _ in found]),
    )


def chosen_fidelity(scene: Scene, fidelities: Sequence[Fidelity]) -> str | None:
    """Return the fidelity of all effects and tables with the scene's tolerance, or the next finer one."""
    for fidelity in fidelities:
        tolerance = fidelity.tolerance if isinstance(fidelity, TimeIntegration) else None
        if tolerance is not None and tolerance <= scene.integration.tolerance * (1.0 + 1e-9):
            return fidelity.name
    return None


def _selected(names: Sequence[str] | None) -> list[Fidelity]:
    """Fidelities of these names in the order of `FIDELITIES`."""
    for name in names or ():
        one_of("fidelities", name, [fidelity.name for fidelity in FIDELITIES])
    return [fidelity for fidelity in FIDELITIES if names is None or fidelity.name in names]


def _warm_up(scene: Scene, fidelities: Sequence[Fidelity], blocks: Blocks) -> None:
    """Compile what the fidelities run."""
    short = replace(scene, duration=min(WARM_UP, scene.duration))
    system = assemble(TimeIntegration("warm_up", "", "steps").as_run(short))
    start = static_equilibrium(system)
    if start.status.usable:
        integrate(system, start, system.scene.integration)
    for fidelity in fidelities:
        if not isinstance(fidelity, TimeIntegration):
            with suppress(InputError, SolveError):
                fidelity.run(scene, replace(blocks, bounds=blocks.bounds[:1]))


def _timed(fidelity: Fidelity, scene: Scene, blocks: Blocks) -> tuple[Vibration, float]:
    """Run a fidelity and take its CPU time."""
    began = clock.process_time()
    found = fidelity.run(scene, blocks)
    return found, clock.process_time() - began


def _compared(found: Sequence[tuple[Fidelity, Vibration, float]]) -> tuple[FidelityResult, ...]:
    """Measure every fidelity against the last, and that one by how the errors fell towards it."""
    reference = found[-1][1]
    errors = [_errors(vibration, reference) for _, vibration, _ in found]
    steps = [i for i, (fidelity, _, _) in enumerate(found[:-1]) if fidelity.family == found[-1][0].family]
    errors[-1] = _left(errors[steps[-2]], errors[steps[-1]]) if len(steps) > 1 else (float("nan"),) * 3
    return tuple(
        FidelityResult(fidelity.name, fidelity.title, fidelity.family, *error, seconds)
        for (fidelity, _, seconds), error in zip(found, errors, strict=True)
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


def knee_of_results(results: Sequence[FidelityResult]) -> str | None:
    """Return the knee; differences below what steps and tables of the reference leave say nothing."""
    own = [results[-1].error, *(TABLE_REST * r.error for r in results if r.name == HALF)]
    floor = max((error for error in own if np.isfinite(error)), default=0.0)
    known = [result for result in results if np.isfinite(result.error)]
    return knee_of({result.name: (result.cpu_seconds, max(result.error, floor)) for result in known})
