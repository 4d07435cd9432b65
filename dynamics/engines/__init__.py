"""The mesh force for other engines: as an element by itself, and as an FMU."""

from dynamics.engines.mesh_element import MeshElement, mesh_element

__all__ = ["MeshElement", "mesh_element"]
