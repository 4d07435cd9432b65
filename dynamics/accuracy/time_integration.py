"""Fidelities of time integration: fewer effects, coarser tables, longer steps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.accuracy.vibration import Blocks, Vibration, vibration_of
from dynamics.assembly.assemble import System, assemble
from dynamics.assembly.decimated_tables import with_decimated_tables
from dynamics.effects import EFFECTS
from dynamics.errors import SolveError
from dynamics.integrators import Trajectory, integrate, static_equilibrium
from dynamics.mechanism.additions import COAST_FLANKS
from dynamics.motion.observation import observe
from dynamics.scene import Outputs, Scene
from dynamics.types import FloatArray

BY_TORSION = (COAST_FLANKS,)
IN_PLANE = (COAST_FLANKS, "x", "y")


@dataclass(frozen=True)
class TimeIntegration:
    """A run of the scene with changes.

    Attributes
    ----------
    name, title, family : str
    tolerance : float or None
        m; None: the scene's own.
    every : int
        Position nodes of the tables that are kept: every one, every second ...
    additions : tuple of str or None
        What effects may add; those that add something else, or nothing, are off. None: all.
    """

    name: str
    title: str
    family: str
    tolerance: float | None = None
    every: int = 1
    additions: tuple[str, ...] | None = None

    def refusal(self, scene: Scene) -> str | None:
        """Say that fewer effects change nothing, or that a fixed step knows no tolerance."""
        if self.tolerance is not None and scene.integration.fixed_step is not None:
            return "the scene has a fixed step"
        if self.additions is None:
            return None
        here, there = _decided(scene), _decided(self.as_run(scene))
        return "the scene has no more effects than these" if here == there else None

    def as_run(self, scene: Scene) -> Scene:
        """Return the scene as this fidelity runs it."""
        integration, effects = scene.integration, dict(scene.effects)
        if self.tolerance is not None:
            integration = replace(integration, tolerance=self.tolerance)
        if self.additions is not None:
            kept = [effect for effect in EFFECTS if effect.adds and {*effect.adds} <= {*self.additions}]
            effects |= {effect.name: "off" for effect in EFFECTS if effect not in kept}
        outputs = Outputs(scene.outputs.sample_rate, energy_audit=False, receipt="minimal", anti_alias=False)
        return replace(scene, integration=integration, effects=effects, outputs=outputs)

    def run(self, scene: Scene, blocks: Blocks) -> Vibration:
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
        return vibration_of(blocks, *_series(system, trajectory))


def _decided(scene: Scene) -> set[tuple[str, str]]:
    """Return the effects that are on, and where."""
    return {(entry.effect, entry.part) for entry in assemble(scene).ledger.entries if entry.on}


def _series(system: System, trajectory: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Transmission errors (m, T) and bearing forces in their own frames (b, 3, T)."""
    observed = observe(system.arrays, trajectory.time, trajectory.q, trajectory.v, trajectory.moved)
    force = system.bearing_force(observed.force, trajectory.q, trajectory.v)[:, :3]
    elastic = np.any(system.bearing_stiffness) or system.housed or system.bearings
    if system.freedoms.column.size and not elastic:
        force = np.full_like(force, np.nan)  # bearings hold nothing here: no freedom moves them
    return observed.coordinate[system.driving_rows], force
