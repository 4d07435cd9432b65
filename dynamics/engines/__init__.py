"""The mesh force for other engines: as an FMU, and as an element of Exudyn."""

from dynamics.engines.mesh_element import MeshElement, mesh_element

__all__ = ["MeshElement", "mesh_element"]
