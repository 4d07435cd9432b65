"""Additions of effects to a mechanism, by name: freedoms, laws, and terms that follow the motion."""

from __future__ import annotations

from dataclasses import dataclass

COAST_FLANKS = "coast_flanks"
BEARING_LAWS = "bearing_laws"
"""Laws of bearings that are not linear; without them their tangents at the load."""
ELEMENT_PASSING = "passing_elements"
"""Rolling elements one by one, at the angle of their cage."""
HOUSING_AMPLITUDES = "housing_amplitudes"
"""Modes of housings with mass; without them the housings have their static compliance."""
SPEED_DEPENDENCE = "speed_dependence"
"""Terms of the linear system that change with the speed."""
LOAD_ARM = "load_arm"
"""Axial distance of a mesh force from the axis about which the mesh is misaligned."""
MISALIGNMENT = "misalignment"
CENTER_DISTANCE_CHANGE = "center_distance_change"
TEETH_AS_MADE = "teeth_as_made"
"""Base pitches that differ; without them their mean."""


@dataclass(frozen=True)
class Additions:
    """Additions that the effects of a scene may make, and those that it requests."""

    possible: frozenset[str]
    """Names of `FREEDOMS` and of this module that an effect adds which is not switched off."""
    requested: frozenset[str]
    """Additions of the effects that are switched on."""
