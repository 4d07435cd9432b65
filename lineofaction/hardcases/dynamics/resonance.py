"""Resonance with loss of contact: two motions at one speed, and jumps between them.

The oscillator has unit mass and stiffness: x'' + 2 z x' + f(x) = Fm + Fa W^2 cos W t, with f = x - 1 above 1,
x + 1 below -1, else 0. It is a driven gear with backlash 2, x - 1 = d - e, e the error of its teeth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System, assemble
from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.periodic import (
    Orbit,
    PeriodicProblem,
    find_orbit,
    follow_branch,
    motion,
    periodic_problem,
    settled,
)
from dynamics.scene import Integration, Scene
from dynamics.shafts import GearBody, Inertia, Shaft
from dynamics.types import FloatArray
from lineofaction.hardcases.dynamics.laws import METHODS
from lineofaction.hardcases.dynamics.oscillators import spring
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("dynamics")

_ZETA = 0.05  # z
_MEAN = 0.1  # Fm
_AMPLITUDE = 0.05  # Fa
_TEETH = 20  # the gear turns at W / teeth

_SLOWEST = 0.5
"""Lowest frequency W."""

_CONVERGED = {
    0.5: (0.011759, 0.011759),
    0.7: (0.033653, 0.033653),
    0.75: (0.044803, 0.224724),
    0.8: (0.061357, 0.202258),
    0.85: (0.181301, 0.181301),
    1.0: (0.133083, 0.133083),
    1.2: (0.094212, 0.094212),
    1.6: (0.057716, 0.057716),
}
"""Rms of the alternating part by frequency, at rising and at falling frequencies, converged independently."""

_JUMP_UP, _JUMP_DOWN = 0.8285, 0.7080
"""Frequencies of the jumps, converged in the same way."""


@SCENES.add(
    "jumps_of_resonance",
    "Between two jumps three motions exist at one speed, the middle one unstable; at the folds Newton's "
    "matrix is singular.",
    "Sixteen converged rms values of rising and falling speeds to 0.05 %, both jumps to 3e-4; integrators "
    "agree.",
)
def _both_sweeps() -> Sequence[Measured]:
    """Sweep up and down through the jumps by shooting, and find where the branch turns back."""
    by_method = {method: [_sweep(method, falling=falling) for falling in (False, True)] for method in METHODS}
    off = max(
        abs(values[w] / _CONVERGED[w][side] - 1.0)
        for sweeps in by_method.values()
        for side, values in enumerate(sweeps)
        for w in _CONVERGED
    )
    difference = max(
        abs(first[w] / second[w] - 1.0)
        for first, second in zip(by_method["implicit"], by_method["explicit"], strict=True)
        for w in _CONVERGED
    )
    up, down = _fold(_JUMP_UP, 0.65, 0.9), _fold(_JUMP_DOWN, 0.9, 0.65)
    return (
        Measured("rms off the converged numbers, worst of 32", off, maximum=5e-4),
        Measured("two integrators apart, rms relative", difference, maximum=1e-5),
        Measured("jump up, off 0.8285", abs(up - _JUMP_UP), maximum=3e-4),
        Measured("jump down, off 0.7080", abs(down - _JUMP_DOWN), maximum=3e-4),
    )


def _sweep(method: str, *, falling: bool) -> dict[float, float]:
    """Return the rms at all frequencies, each settled from the motion at the one before."""
    state: FloatArray | None = None
    sizes: dict[float, float] = {}
    for frequency in sorted(_CONVERGED, reverse=falling):
        problem = periodic_problem(_oscillator(frequency, method), _SLOWEST / _TEETH)
        state = settled(problem, frequency / _TEETH, state)
        orbit = find_orbit(problem, frequency / _TEETH, state)
        sizes[frequency] = _rms(problem, orbit, frequency) if orbit.status.usable and orbit.stable else np.nan
        state = orbit.state
    return sizes


def _rms(problem: PeriodicProblem, orbit: Orbit, frequency: float) -> float:
    """Return the rms of the alternating part of d - e."""
    error = motion(problem, orbit).dynamic_transmission_error[0]
    phase = 2.0 * np.pi * np.arange(error.size) / error.size
    return float(np.std(error - _excitation(frequency) * np.cos(phase)))


def _fold(jump: float, start: float, end: float) -> float:
    """Return the frequency of the first fold of the branch from `start` to `end`.

    The amplitude of the error is that of frequency `jump`, so the force is exact there.
    """
    problem = periodic_problem(_oscillator(jump), 0.6 / _TEETH)  # 0.6: below both ends of the branch
    guess = settled(problem, start / _TEETH)
    branch = follow_branch(problem, start / _TEETH, end / _TEETH, 0.05, guess)
    return float(branch.folds[0]) * _TEETH if branch.status.usable and branch.folds.size == 2 else np.nan


def _excitation(frequency: float) -> float:
    """Return the amplitude A of e whose force by inertia and damping, A W sqrt(W^2 + 4 z^2), is Fa W^2."""
    return float(_AMPLITUDE * frequency / np.hypot(frequency, 2.0 * _ZETA))


def _oscillator(frequency: float, method: str = "implicit") -> System:
    """Return the system of unit mass and stiffness, damped against the ground."""
    amplitude = _excitation(frequency)
    gears = tuple(
        GearBody(f"gear {k}", f"shaft {k}", 0.5, _TEETH, 1.0, 0.1, inertia=Inertia(1.0, 1.0, 1.0))
        for k in (1, 2)
    )
    back = CoastFlank(2.0, 0.0, spring(-amplitude, 256, 1.0))  # backlash from x = -1 to 1
    scene = Scene(
        (Shaft("shaft 1", 1.0), Shaft("shaft 2", 1.0, (2.2, 0.0, 0.0))),
        gears,
        (GearMesh("mesh", "gear 1", "gear 2", spring(amplitude, 256, 1.0), damping=0.0, coast=back),),
        (ImposedRotation("drive", "shaft 1", TimeLaw.constant(frequency / _TEETH)),),
        duration=1.0,
        loads=(LoadTorque("load", "shaft 2", TimeLaw.constant(_MEAN)),),
        integration=Integration(method, tolerance=1e-6, largest_step=1.0),
    )
    system = assemble(scene)
    return replace(system, arrays=system.arrays.with_matrices(damping=np.array([[2.0 * _ZETA]])))
