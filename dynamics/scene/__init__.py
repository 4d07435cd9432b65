"""The scene of a simulation as data: shafts, gears, bearings, meshes, drives, loads, outputs."""

from dynamics.scene.pair_scene import pair_scene
from dynamics.scene.planetary_set import PlanetarySet, ring_phase
from dynamics.scene.scene import Scene
from dynamics.settings import Integration, Outputs

__all__ = [
    "Integration",
    "Outputs",
    "PlanetarySet",
    "Scene",
    "pair_scene",
    "ring_phase",
]
