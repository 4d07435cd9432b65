"""STE databases: storage, C1 interpolation, force extraction. Light: xarray is imported for files only."""

from fe_contact.ste.curve import Curve
from fe_contact.ste.database import SteDatabase
from fe_contact.ste.force_table import ForceTable
from fe_contact.ste.mesh_force import MeshForce, Validity
from fe_contact.ste.metadata import SCHEMA_VERSION, Metadata, PairGeometry
from fe_contact.ste.tooth_loads import ToothLoads

__all__ = [
    "SCHEMA_VERSION",
    "Curve",
    "ForceTable",
    "MeshForce",
    "Metadata",
    "PairGeometry",
    "SteDatabase",
    "ToothLoads",
    "Validity",
]
