"""What effects may add to a mechanism, by name: freedoms, laws, what follows the motion."""

from __future__ import annotations

from dataclasses import dataclass

COAST_FLANKS = "coast_flanks"
BEARING_LAWS = "bearing_laws"
"""Laws of bearings that are not linear; without them their tangents at the load."""
ELEMENT_PASSING = "passing_elements"
"""Rolling elements one by one, at the angle of their cage."""
HOUSING_AMPLITUDES = "housing_amplitudes"
"""Modes of housings with mass; without them their static compliance."""
SPEED_DEPENDENCE = "speed_dependence"
"""Terms of the linear system that change with the speed."""
LOAD_ARM = "load_arm"
"""Of a mesh force about the axis of a misalignment."""
MISALIGNMENT = "misalignment"
CENTER_DISTANCE_CHANGE = "center_distance_change"
TEETH_AS_MADE = "teeth_as_made"
"""Base pitches that differ; without them their mean."""


@dataclass(frozen=True)
class Additions:
    """What the effects of a scene may add."""

    possible: frozenset[str]
    """Names of `FREEDOMS` and of this module that an effect adds which is not switched off."""
    requested: frozenset[str]
    """Those of effects that are switched on."""
