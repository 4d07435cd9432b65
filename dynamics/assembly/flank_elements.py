"""The force elements of the flanks: driving flanks of all meshes, coast flanks where backlash is on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.forces.law import Law
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.flank_gradients import approach
from dynamics.mechanism.flanks import Flanks
from dynamics.mechanism.line_of_action import LineOfAction, line_of_action
from dynamics.scene.scene import Scene


def flank_elements(
    scene: Scene,
    rotors: Bodies,
    senses: Sequence[int],
    lines: Sequence[LineOfAction],
    flanks: Flanks,
) -> tuple[Element, ...]:
    """Return one element per entry of ``flanks.law``, in its order.

    A driving flank's coordinate is the transmission error. A coast flank pushes along the line of action of
    the opposite sense, and its coordinate is the approach along that less the backlash: a smaller center
    distance closes both.
    """
    driving = [
        Element(Law.FLANK, index, index, approach(scene, rotors, index, line)[None, :], np.zeros(1))
        for index, line in enumerate(lines)
    ]
    coasting = []
    for entry, index in enumerate(flanks.coast, start=len(lines)):
        line, back = line_of_action(scene, index, -senses[index]), scene.meshes[index].coast
        gap = back.backlash if back is not None else 0.0
        gradient = approach(scene, rotors, index, line)[None, :]
        coasting.append(Element(Law.FLANK, entry, index, gradient, np.array([-gap])))
    return (*driving, *coasting)
