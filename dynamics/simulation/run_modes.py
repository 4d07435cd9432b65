"""The modes that a run keeps: natural modes at rest, and whirl modes over its speeds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.errors import SolveError
from dynamics.linearize import natural_modes
from dynamics.linearize.campbell import whirl_branches
from dynamics.linearize.energy_shares import freedom_parts
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.linearize.speeds import leading_law, mesh_frequencies
from dynamics.mechanism.additions import SPEED_DEPENDENCE
from dynamics.types import FloatArray, Json

WHIRL_SPEEDS = 33
LEAST_SHARE = 0.05  # of a part in the kinetic energy of a mode


def modes_of_run(system: System) -> Json:
    """Return the `modes` of `RunResult`; nothing where there is no equilibrium."""
    try:
        linear = linearize(system)
    except SolveError:
        return {}
    modes = natural_modes(linear)
    most = np.argmax(modes.kinetic_energy, axis=1) if modes.frequency.size else []
    turning = any(part.speed.extreme != 0.0 for part in system.scene.references)
    rotating = turning and linear.freedom and system.ledger.adds(SPEED_DEPENDENCE)
    return {
        "frequency": [float(value) for value in modes.frequency],
        "damping_ratio": [float(value) for value in modes.damping_ratio],
        "freedom": [modes.freedom[index] for index in most],
        "moves": [_moves(modes.freedom, shares) for shares in modes.kinetic_energy],
        **({"over_speed": _over_speed(system, linear)} if rotating else {}),
    }


def _over_speed(system: System, linear: LinearSystem) -> Json:
    """Return the whirl modes up to the largest speeds of the run, those that oscillate at all of them."""
    law = leading_law(system)
    extreme = system.scene.references[law].speed.extreme
    speed = np.linspace(0.0, abs(extreme), WHIRL_SPEEDS)
    branches = whirl_branches(system, linear, speed)
    whole = np.all(np.isfinite(branches.frequency), axis=0)
    most = np.argmax(branches.kinetic_energy[-1], axis=1)
    return {
        "shaft": system.scene.references[law].shaft,
        "speed": speed.tolist(),
        "mesh_frequency": mesh_frequencies(system, speed).tolist(),
        "frequency": branches.frequency[:, whole].T.tolist(),
        "damping_ratio": branches.damping_ratio[:, whole].T.tolist(),
        "whirl": branches.whirl[:, whole].T.tolist(),
        "freedom": [linear.freedom[index] for index in most[whole]],
        "moves": [_moves(linear.freedom, shares) for shares in branches.kinetic_energy[-1][whole]],
    }


def _moves(freedom: Sequence[str], shares: FloatArray) -> Json:
    """Return what moves in a mode, "shaft, how", with its share of the kinetic energy; the largest first."""
    summed: dict[str, float] = {}
    for (shaft, how), share in zip(freedom_parts(freedom), shares, strict=True):
        name = f"{shaft}, {how}"
        summed[name] = summed.get(name, 0.0) + float(share)
    most = sorted(summed.items(), key=lambda part: -part[1])
    return {name: share for name, share in most if share >= LEAST_SHARE}
