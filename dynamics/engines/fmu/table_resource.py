"""The mesh-force table as the FMU's resource: plain little-endian numbers."""

from __future__ import annotations

import hashlib

import numpy as np

from dynamics.forces.mesh_table import FIELDS, MeshTable

MAGIC = b"LOAMESH1"


def table_content(table: MeshTable) -> bytes:
    """Return five sizes (M, D, P, L, period) and the arrays: axes, positions, levels, nodes.

    Nodes (M, D, P, L, 4) hold deflection, its slope, stiffness, its slope.
    """
    axes = [table.misalignment, table.center_distance_change, table.position, table.level]
    flat = [np.atleast_1d(np.asarray(axis, dtype="<f8")) for axis in axes]
    sizes = np.array([*(axis.size for axis in flat), table.period], dtype="<u8")
    nodes = np.stack([np.asarray(getattr(table, name), dtype="<f8") for name in FIELDS], axis=-1)
    return b"".join([sizes.tobytes(), *(axis.tobytes() for axis in flat), nodes.tobytes()])


def identity_of(content: bytes) -> str:
    """Return 32 hexadecimal digits by which the unit knows its table."""
    return hashlib.sha256(content).hexdigest()[:32]


def table_file(content: bytes) -> bytes:
    """Return the file: magic, identity, content."""
    return MAGIC + identity_of(content).encode("ascii") + content
