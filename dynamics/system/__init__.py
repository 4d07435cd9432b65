"""The scene and the arrays assembled from it."""

from dynamics.system.pair_scene import pair_scene
from dynamics.system.scene import Integration, Outputs, Scene

__all__ = ["Integration", "Outputs", "Scene", "pair_scene"]
