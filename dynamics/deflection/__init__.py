"""Static deflection of a geared system under load cases, and the alignment of its meshes by cause."""

from dynamics.deflection.bearing_loads import BearingLoad, equivalent_load, life_duration
from dynamics.deflection.deflect import CaseDeflection, Deflection, deflect
from dynamics.deflection.loaded_scene import ForceUnderCase, loaded_scene
from dynamics.deflection.mesh_alignment import CAUSES, MeshAlignment
from dynamics.settings.load_case import CaseForce, LoadCase

__all__ = [
    "CAUSES",
    "BearingLoad",
    "CaseDeflection",
    "CaseForce",
    "Deflection",
    "ForceUnderCase",
    "LoadCase",
    "MeshAlignment",
    "deflect",
    "equivalent_load",
    "life_duration",
    "loaded_scene",
]
