"""Multibody dynamics of geared systems, excited by mesh-force tables.

Names are imported on first use, so that reading a result does not load what simulates.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dynamics.ablation import ablate
    from dynamics.accuracy import frontier
    from dynamics.bearings import Bushing
    from dynamics.forces import RollingContact
    from dynamics.joints import Coupling, FreeRotation, Housing, ImposedRotation
    from dynamics.linearize import forced_response, modal_analysis
    from dynamics.loads import LoadTorque, TimeLaw
    from dynamics.mechanism import with_planets
    from dynamics.meshes import CoastFlank, GearMesh, MeshTable
    from dynamics.orders import mesh_orders
    from dynamics.periodic import steady_states
    from dynamics.results import RunResult
    from dynamics.scene import Integration, Outputs, PlanetarySet, Scene, pair_scene
    from dynamics.shafts import GearBody, Inertia, Shaft, hollow_cylinder
    from dynamics.simulation import simulate, simulate_to_file

_HOME = {
    name: home
    for home, names in {
        "ablation": ("ablate",),
        "accuracy": ("frontier",),
        "bearings": ("Bushing",),
        "forces": ("RollingContact",),
        "joints": ("Coupling", "FreeRotation", "Housing", "ImposedRotation"),
        "linearize": ("forced_response", "modal_analysis"),
        "loads": ("LoadTorque", "TimeLaw"),
        "mechanism": ("with_planets",),
        "meshes": ("CoastFlank", "GearMesh", "MeshTable"),
        "orders": ("mesh_orders",),
        "periodic": ("steady_states",),
        "results": ("RunResult",),
        "scene": ("Integration", "Outputs", "PlanetarySet", "Scene", "pair_scene"),
        "shafts": ("GearBody", "Inertia", "Shaft", "hollow_cylinder"),
        "simulation": ("simulate", "simulate_to_file"),
    }.items()
    for name in names
}
"""The package that holds each public name."""

__all__ = [
    "Bushing",
    "CoastFlank",
    "Coupling",
    "FreeRotation",
    "GearBody",
    "GearMesh",
    "Housing",
    "ImposedRotation",
    "Inertia",
    "Integration",
    "LoadTorque",
    "MeshTable",
    "Outputs",
    "PlanetarySet",
    "RollingContact",
    "RunResult",
    "Scene",
    "Shaft",
    "TimeLaw",
    "ablate",
    "forced_response",
    "frontier",
    "hollow_cylinder",
    "mesh_orders",
    "modal_analysis",
    "pair_scene",
    "simulate",
    "simulate_to_file",
    "steady_states",
    "with_planets",
]


def __getattr__(name: str) -> object:
    """Import a public name from the package that holds it."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"dynamics.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
