"""The scene and the arrays assembled from it."""

from dynamics.system.pair_scene import pair_scene
from dynamics.system.planet_copies import with_planets
from dynamics.system.planetary_set import PlanetaryParts, PlanetarySet, ring_phase
from dynamics.system.scene import Integration, Outputs, Scene

__all__ = [
    "Integration",
    "Outputs",
    "PlanetaryParts",
    "PlanetarySet",
    "Scene",
    "pair_scene",
    "ring_phase",
    "with_planets",
]
