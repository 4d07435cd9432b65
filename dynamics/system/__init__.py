"""The scene and the arrays assembled from it."""

from dynamics.system.scene import Integration, Outputs, Scene

__all__ = ["Integration", "Outputs", "Scene"]
