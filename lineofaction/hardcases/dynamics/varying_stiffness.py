"""A mesh whose stiffness changes by three as the teeth pass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.integrate import solve_ivp

from dynamics.assembly.assemble import assemble
from dynamics.periodic import find_orbit, periodic_problem
from dynamics.scene import Integration
from dynamics.types import FloatArray
from lineofaction.hardcases.dynamics.laws import METHODS, common_figures, run_both
from lineofaction.hardcases.dynamics.oscillators import NATURAL, TEETH, changing_spring, damping_of, torsional
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("dynamics")

_RATIO = 3.0

_FREQUENCIES = (1.5, 2.0)
"""Mesh frequency over the natural frequency of the gear on the mean stiffness: a stable value, and one in the
widest unstable band."""


@SCENES.add(
    "stiffness_changing_threefold",
    "The stiffness goes from k to 3 k and back with every tooth, undamped: at twice the natural frequency "
    "motions grow without an error of the teeth.",
    "Floquet multipliers are those of Mathieu's equation, their product is one (Liouville); integrators "
    "agree, energy balances.",
)
def _threefold() -> Sequence[Measured]:
    """Compare the multipliers of the motion with Mathieu's equation, in and out of its unstable band."""
    figures: list[Measured] = []
    for frequency in _FREQUENCIES:
        exact = _mathieu(frequency)
        sizes = np.sort(np.abs(np.linalg.eigvals(exact)))[::-1]
        for method in METHODS:
            speed = frequency * NATURAL / TEETH
            scene = torsional(changing_spring(_RATIO), speed=speed, integration=Integration(method))
            orbit = find_orbit(periodic_problem(assemble(scene), speed), speed)
            name = f"{frequency:g}, {method}"
            matrix = orbit.monodromy if orbit.status.usable else np.full((2, 2), np.nan)
            figures += [
                Measured(
                    f"{name}: trace of the monodromy off Mathieu's",
                    abs(float(np.trace(matrix) - np.trace(exact))),
                    maximum=1e-4,
                ),
                Measured(
                    f"{name}: determinant off one", abs(float(np.linalg.det(matrix)) - 1.0), maximum=1e-6
                ),
            ]
        figures.append(Measured(f"{frequency:g}: largest multiplier by Mathieu", sizes[0]))
    scene = torsional(
        changing_spring(_RATIO), speed=_FREQUENCIES[0] * NATURAL / TEETH, damping=damping_of(0.05),
        duration=0.02, integration=Integration(tolerance=1e-10),
    )  # fmt: skip
    return (*figures, *common_figures(run_both(scene), scene))


def _mathieu(frequency: float) -> FloatArray:
    """Return the monodromy of x'' + (1 + swing cos(frequency t)) x = 0 by an integrator of order 8."""
    swing = (_RATIO - 1.0) / (_RATIO + 1.0)

    def rates(t: float, y: FloatArray) -> FloatArray:  # y: two solutions side by side, then their rates
        k = 1.0 + swing * np.cos(frequency * t)
        return np.array([y[2], y[3], -k * y[0], -k * y[1]])

    start = np.array([1.0, 0.0, 0.0, 1.0])
    end = solve_ivp(rates, (0.0, 2.0 * np.pi / frequency), start, "DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    return np.asarray(end.reshape(2, 2))
