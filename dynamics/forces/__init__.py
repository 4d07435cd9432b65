"""Forces between bodies and on them: gear mesh, torques by time and by speed, nonlinear bearings."""

import host.analysis  # noqa: F401 (says what to install)
from dynamics.forces.coast_flank import CoastFlank
from dynamics.forces.gear_mesh import GearMesh
from dynamics.forces.load_torque import LoadTorque
from dynamics.forces.mesh_table import MeshTable
from dynamics.forces.rolling_contact import RollingContact
from dynamics.forces.speed_torque import SpeedTorque
from dynamics.forces.spring_curve import SpringCurve
from dynamics.forces.stiffness_table import PeriodicCurve, stiffness_table
from dynamics.forces.straight_table import straight_table
from dynamics.loads.applied_force import AppliedForce
from dynamics.loads.unbalance import Unbalance

__all__ = [
    "AppliedForce",
    "CoastFlank",
    "GearMesh",
    "LoadTorque",
    "MeshTable",
    "PeriodicCurve",
    "RollingContact",
    "SpeedTorque",
    "SpringCurve",
    "Unbalance",
    "stiffness_table",
    "straight_table",
]
