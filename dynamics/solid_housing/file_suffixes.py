"""Files that hold the solid of a housing, by how their names end."""

STEP_SUFFIXES = (".step", ".stp")
MESH_FORMATS = {
    ".msh": "gmsh",
    ".inp": "Abaqus",
    ".bdf": "Nastran",
    ".nas": "Nastran",
    ".fem": "Nastran",
    ".vtu": "VTU",
    ".vtk": "VTK",
}
"""By suffix. CalculiX reads and writes those of Abaqus."""
MESH_SUFFIXES = tuple(MESH_FORMATS)
