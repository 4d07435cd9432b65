"""To which frequency the shafts of a modal analysis are resolved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System, assemble
from dynamics.checks import positive
from dynamics.linearize.speeds import mesh_frequencies
from dynamics.types import FloatArray


def resolved_to(system: System, speed: FloatArray, orders: int, highest: float | None) -> float:
    """Return the frequency to resolve, Hz: `highest`, else the highest of the orders at the highest speed.

    Raises
    ------
    InputError
        If `highest` is not positive.
    """
    if highest is not None:
        return positive("highest_frequency", highest)
    if system.scene.highest_frequency is not None:
        return system.scene.highest_frequency
    if speed.size and speed[-1] > 0.0:
        top = float(np.max(mesh_frequencies(system, speed[-1:]), initial=0.0))
    else:
        top = system.sampling.mesh_frequency
    return orders * top


def with_shafts_to(system: System, highest: float) -> System:
    """Return `system`, its shafts that bend and twist resolved to `highest`, Hz; 0: as they are."""
    elastic = [rotor.elastic.highest for rotor in system.rotors if rotor.elastic is not None]
    if highest == 0.0 or all(frequency == highest for frequency in elastic):
        return system
    return assemble(replace(system.scene, highest_frequency=highest))
