"""Forces between bodies and on them: gear mesh, torques by time and by speed."""

from dynamics.forces.coast_flank import CoastFlank
from dynamics.forces.gear_mesh import GearMesh
from dynamics.forces.load_torque import LoadTorque
from dynamics.forces.mesh_table import MeshTable
from dynamics.forces.speed_torque import SpeedTorque

__all__ = ["CoastFlank", "GearMesh", "LoadTorque", "MeshTable", "SpeedTorque"]
