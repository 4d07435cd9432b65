"""The choice between the explicit and the implicit method of integration.

The fastest motion of the system limits the explicit step, which must stay stable. Accuracy limits the step of
both methods: it follows the fastest natural motion that the meshes excite. The explicit method is chosen if
its step for accuracy is stable. A natural motion is a mode of the undamped system about the equilibrium.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.motion.force_balance import force_balance
from dynamics.scene import Integration
from dynamics.types import FloatArray, Json
from host.optional_modules import scipy

LIMIT = 2.0
"""Fastest rate, rad/s, times step for accuracy, s, above which stability shortens explicit steps."""
RADIANS = 1.0
"""Phase, rad, of the fastest motion that meshes excite in one explicit step at a tolerance of 1 nm.

Measured 0.4 to 1.6 on one pair, two stages and a planetary stage, 500 to 5000 rpm. The step grows with the
fifth root of the tolerance, within 15 % from 10 to 0.1 nm.
"""
REFERENCE_TOLERANCE = 1e-9
"""Tolerance, m, to which `RADIANS` belongs."""
TOLERANCE_EXPONENT = 0.2
"""Exponent of the tolerance in the step: the step grows with its fifth root."""
SHARE = 0.1
"""Share of the elastic energy of a natural motion that is in the meshes, above which they excite it."""
LIGHT = 0.01
"""Damping ratio below which a natural motion is lightly damped."""
LONGER = 1.4
"""Implicit over explicit step at the same tolerance; measured 1.05 to 1.65 on the gears of `RADIANS`."""
EVALUATIONS = {"explicit": 6.0, "implicit": 10.0}
"""Evaluations of the force laws per step, to which the CPU time is proportional."""
SLOWEST_RATE = 1e-300
"""Rate, rad/s, in place of 0 in a divisor: the stable step is then without bound."""


@dataclass(frozen=True)
class MethodChoice:
    """The method of a run, and the rates and steps that decided."""

    method: str
    requested: str
    """`method`, `requested`: ``"explicit"`` or ``"implicit"``; the requested one may also be ``"auto"``."""
    rate: float
    """Largest magnitude of an eigenvalue of the motion about the equilibrium at t = 0, rad/s."""
    step: float
    """Step for accuracy, s: the fixed step, or the one for the fastest natural motion that meshes excite."""
    slowest_decay: float
    """Least rate of decay, 1/s, of the lightly damped natural motions that meshes excite; infinite: there are
    none.
    """

    @property
    def other(self) -> str:
        """The method that was not chosen."""
        return "implicit" if self.method == "explicit" else "explicit"

    def settings(self, integration: Integration) -> Integration:
        """Return `integration` with the chosen method.

        If the choice was automatic, the largest explicit step is the stable one: while the system is at rest,
        the error estimate is 0 and would let the step grow beyond it.
        """
        largest = integration.largest_step
        if self.requested == "auto" and self.method == "explicit":
            stable = LIMIT / max(self.rate, SLOWEST_RATE)
            # the step control needs a largest step well above its smallest
            largest = min(largest, max(stable, 2.0 * integration.smallest_step))
        return replace(integration, method=self.method, largest_step=largest)

    def of(self, system: System) -> System:
        """Return `system` with the settings of the chosen method."""
        integration = self.settings(system.scene.integration)
        return replace(system, scene=replace(system.scene, integration=integration))

    def to_json(self, mean_step: float, seconds: float) -> Json:
        """Return the entries of a run's receipt on its method, as plain JSON.

        `mean_step`, s, is that of the run, `seconds` its CPU time. The cost of the other method is predicted
        from its step.
        """
        if self.method == "explicit":
            step = {"explicit": mean_step, "implicit": LONGER * mean_step}
        else:
            # the explicit step: as accurate as the implicit one, and stable
            shortened = min(mean_step / LONGER, LIMIT / max(self.rate, SLOWEST_RATE))
            step = {"explicit": shortened, "implicit": mean_step}
        cost = {name: EVALUATIONS[name] / step[name] for name in step}  # evaluations per second of motion
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
    """Choose the method for runs of `system` about the equilibrium at `displacement` (n,)."""
    arrays = system.arrays
    n = displacement.size
    at_rest = np.zeros(n)
    balance = force_balance(arrays, 0.0, displacement, at_rest, at_rest)
    response = np.linalg.solve(arrays.mass, np.hstack([balance.stiffness, balance.damping]))
    # d/dt (q, q') = A (q, q'): the upper half of A is (0, I), the lower -(M^-1 K, M^-1 C)
    first_order = np.vstack([np.eye(n, 2 * n, n), -response])
    rate = float(np.max(np.abs(np.linalg.eigvals(first_order)), initial=0.0))
    symmetric = 0.5 * (balance.stiffness + balance.stiffness.T)
    fastest, decay = _excited_motions(system, symmetric, balance.damping)
    accurate = np.inf
    if fastest > 0.0:
        phase = RADIANS * (integration.tolerance / REFERENCE_TOLERANCE) ** TOLERANCE_EXPONENT
        accurate = phase / fastest
    step = integration.fixed_step or min(float(accurate), integration.largest_step)
    chosen = "explicit" if rate * step <= LIMIT else "implicit"
    requested = integration.method
    return MethodChoice(
        method=chosen if requested == "auto" else requested,
        requested=requested,
        rate=rate,
        step=step,
        slowest_decay=decay,
    )


def _excited_motions(system: System, stiffness: FloatArray, damping: FloatArray) -> tuple[float, float]:
    """Return the rate of the fastest natural motion that meshes excite, rad/s, and the slowest decay, 1/s.

    The decay is that of the field `slowest_decay`. If meshes excite no motion, the rate is 0 and the decay
    infinite.
    """
    # shapes (n, n) have unit modal mass: the squared rate is twice the elastic energy
    squared_rate, shape = scipy.linalg.eigh(stiffness, system.arrays.mass)
    # stretch of the meshes by each mode, (meshes, n)
    stretch = system.arrays.direction[system.driving_rows] @ shape
    mesh_energy = system.flanks.mean_stiffness[: len(stretch)] @ stretch**2  # twice the energy
    excited = mesh_energy > SHARE * np.abs(squared_rate)
    rate = np.sqrt(np.maximum(squared_rate[excited], 0.0))
    excited_shape = shape[:, excited]  # (n, excited motions)
    decay = 0.5 * np.einsum("ia,ij,ja->a", excited_shape, damping, excited_shape)
    lightly_damped = decay < LIGHT * rate
    fastest = float(np.max(rate, initial=0.0))
    return fastest, float(np.min(decay[lightly_damped], initial=np.inf))
