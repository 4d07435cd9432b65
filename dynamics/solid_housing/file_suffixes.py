"""Files that hold the solid of a housing, by how their names end."""

STEP_SUFFIXES = (".step", ".stp")
MESH_SUFFIXES = (".msh", ".inp", ".bdf", ".nas", ".fem", ".vtu", ".vtk")
"""gmsh, Abaqus and CalculiX, Nastran, VTK."""
