"""Optional physics of the multibody model: one effect per file, a registry, a ledger."""

from dynamics.effects.effect import (
    FREEDOMS,
    BendingShaft,
    Effect,
    LoadedMesh,
    MeshAxes,
    MeshEffect,
    MeshOnRotor,
    RotorRotation,
    SupportedRotor,
    Verdict,
)
from dynamics.effects.registry import EFFECTS, LEFT_OUT, MESH_EFFECTS

__all__ = [
    "EFFECTS",
    "FREEDOMS",
    "LEFT_OUT",
    "MESH_EFFECTS",
    "BendingShaft",
    "Effect",
    "LoadedMesh",
    "MeshAxes",
    "MeshEffect",
    "MeshOnRotor",
    "RotorRotation",
    "SupportedRotor",
    "Verdict",
]
