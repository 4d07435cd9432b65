"""Rotors that no bearing holds in a direction, but a coupling to a rotor that a bearing holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynamics.bearings.seat import SEAT
from dynamics.joints import Coupling
from dynamics.mechanism.coupling_rows import full_matrix
from dynamics.mechanism.rotor import Rotor
from dynamics.scene.scene import Scene

RADIAL, AXIAL, TILT = (0, 1), (2,), (3, 4)  # indices of strains: x and y, z, tilt_x and tilt_y


def with_couplings(scene: Scene, rotors: Sequence[Rotor]) -> tuple[Rotor, ...]:
    """Return the rotors with the supports by couplings where no bearing holds them.

    A coupling's matrix holds a shaft in a direction if bearings (or further couplings) hold the shaft behind
    it there. Shafts that nothing holds stay where they are, as shafts without bearings do.
    """
    stiff = [coupling for coupling in scene.couplings if coupling.stiffness is not None]
    sides = [(c, a, b) for c in stiff for a, b in ((c.first, c.second), (c.second, c.first))]
    supported = list(rotors)
    while True:  # a rotor that gets a support may lend it on: start again until no coupling adds one
        for side in sides:
            coupling, floating, behind = side
            index, support = scene.shaft_index(floating), supported[scene.shaft_index(behind)]
            kinds = _lent(supported[index], support, coupling)
            if kinds:
                supported[index] = _holding(scene, supported[index], coupling, kinds)
                sides.remove(side)
                break
        else:
            return tuple(supported)


def _lent(rotor: Rotor, behind: Rotor, coupling: Coupling) -> tuple[int, ...]:
    """Return the directions in which the rotor lacks bearings and the coupling has stiffness to offer."""
    matrix = full_matrix(coupling.stiffness, 0.0)
    kinds: tuple[int, ...] = ()
    # a rotor that could tilt needs a second radial support, away from its first
    if behind.radial_stiffness > 0.0 and (rotor.radial_stiffness == 0.0 or rotor.tilt_stiffness == 0.0):
        kinds += RADIAL
    if behind.axial_stiffness > 0.0 and rotor.axial_stiffness == 0.0:
        kinds += AXIAL
    if behind.tilt_stiffness > 0.0 and rotor.tilt_stiffness == 0.0:
        kinds += TILT
    return tuple(kind for kind in kinds if matrix[kind, kind] > 0.0)


def _holding(scene: Scene, rotor: Rotor, coupling: Coupling, kinds: tuple[int, ...]) -> Rotor:
    """Return the rotor with a further support: the coupling's stiffness in the directions `kinds`."""
    matrix, support = full_matrix(coupling.stiffness, 0.0)[:SEAT, :SEAT], np.zeros((SEAT, SEAT))
    block = np.ix_(kinds, kinds)
    support[block] = matrix[block]
    lever = float(scene.shaft(coupling.first).origin[2] + coupling.position - rotor.center[2])
    return replace(rotor, typical_stiffness=(*rotor.typical_stiffness, (support, lever)))
