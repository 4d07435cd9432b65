"""The choice between the two methods: by the fastest motion times the step that accuracy wants."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from dynamics.assembly.assemble import System
from dynamics.motion.force_balance import force_balance
from dynamics.scene import Integration
from dynamics.types import FloatArray, Json

LIMIT = 2.0
"""Fastest rate times step, above which the explicit method takes shorter steps than accuracy wants."""
RADIANS = 1.0
"""Of the fastest motion that meshes excite, per explicit step at a tolerance of 1 nm.

Measured 0.4 to 1.6 on one pair, two stages and a planetary stage, 500 to 5000 rpm; the fifth root of the
tolerance holds within 15 % from 10 to 0.1 nm."""
SHARE = 0.1
"""Of a natural motion's energy in meshes, from which they excite it."""
LIGHT = 0.01
"""Damping ratio below which a natural motion is damped lightly."""
LONGER = 1.4
"""Implicit over explicit step at one tolerance; measured 1.05 to 1.65 there."""
EVALUATIONS = {"explicit": 6.0, "implicit": 10.0}
"""Of the force laws per step, which cost stands in proportion to."""


@dataclass(frozen=True)
class MethodChoice:
    """The method of a run, and what speaks for it."""

    method: str
    requested: str
    """`method`, `requested`: ``"explicit"`` or ``"implicit"``; the latter may be ``"auto"``."""
    rate: float
    """Largest magnitude of an eigenvalue of the motion about the equilibrium at t = 0, rad/s."""
    step: float
    """That accuracy wants, s: the fixed one, or by the fastest natural motion that meshes excite."""
    slowest_decay: float
    """Least rate of decay of natural motions that meshes excite and that are damped lightly, 1/s; infinite:
    there are none.
    """

    @property
    def other(self) -> str:
        """The method that was not taken."""
        return "implicit" if self.method == "explicit" else "explicit"

    def settings(self, integration: Integration) -> Integration:
        """Return `integration` by the method chosen.

        Explicit steps that are not stated stay stable: a motion at rest has no error that would tell.
        """
        largest, stable = integration.largest_step, LIMIT / max(self.rate, 1e-300)
        if self.requested == "auto" and self.method == "explicit":
            largest = min(largest, max(stable, 2.0 * integration.smallest_step))
        return replace(integration, method=self.method, largest_step=largest)

    def of(self, system: System) -> System:
        """Return `system` with these settings."""
        integration = self.settings(system.scene.integration)
        return replace(system, scene=replace(system.scene, integration=integration))

    def to_json(self, mean_step: float, seconds: float) -> Json:
        """Return what the receipt of a run of such steps (s) that took `seconds` says."""
        if self.method == "explicit":
            step = {"explicit": mean_step, "implicit": LONGER * mean_step}
        else:
            shortened = min(mean_step / LONGER, LIMIT / max(self.rate, 1e-300))
            step = {"explicit": shortened, "implicit": mean_step}
        cost = {name: EVALUATIONS[name] / step[name] for name in step}
        return {
            "used": self.method,
            "requested": self.requested,
            "fastest_rate": self.rate,
            "rate_unit": "rad/s",
            "step": self.step,
            "step_unit": "s",
            "rate_times_step": self.rate * self.step,
            "explicit_up_to": LIMIT,
            "other": self.other,
            "other_seconds_predicted": seconds * cost[self.other] / cost[self.method],
        }


def choose_method(system: System, displacement: FloatArray, integration: Integration) -> MethodChoice:
    """Choose for runs of `system` about the equilibrium at `displacement` (n,)."""
    arrays, n = system.arrays, displacement.size
    at_rest = np.zeros(n)
    balance = force_balance(arrays, 0.0, displacement, at_rest, at_rest)
    response = np.linalg.solve(arrays.mass, np.hstack([balance.stiffness, balance.damping]))
    first_order = np.vstack([np.eye(n, 2 * n, n), -response])
    rate = float(np.max(np.abs(np.linalg.eigvals(first_order)), initial=0.0))
    fastest, decay = _excited_motions(
        system, 0.5 * (balance.stiffness + balance.stiffness.T), balance.damping
    )
    wanted = RADIANS * (integration.tolerance / 1e-9) ** 0.2 / fastest if fastest > 0.0 else np.inf
    step = integration.fixed_step or min(float(wanted), integration.largest_step)
    chosen = "explicit" if rate * step <= LIMIT else "implicit"
    requested = integration.method
    return MethodChoice(chosen if requested == "auto" else requested, requested, rate, step, decay)


def _excited_motions(system: System, stiffness: FloatArray, damping: FloatArray) -> tuple[float, float]:
    """Return the rate of the fastest natural motion with energy in the meshes, rad/s, and `slowest_decay`.

    0 and infinite without one.
    """
    square, shape = scipy.linalg.eigh(stiffness, system.arrays.mass)
    stretch = system.arrays.direction[system.driving_rows] @ shape
    energy = system.flanks.mean_stiffness[: len(stretch)] @ stretch**2
    excited = energy > SHARE * np.abs(square)
    rate = np.sqrt(np.maximum(square[excited], 0.0))
    decay = 0.5 * np.einsum("ia,ij,ja->a", shape[:, excited], damping, shape[:, excited])
    return float(np.max(rate, initial=0.0)), float(np.min(decay[decay < LIGHT * rate], initial=np.inf))
