"""A housing by a mesh of one tetrahedron, as the description of the service shows it."""

from __future__ import annotations

from base64 import b64encode
from typing import Any
from zlib import compress

_TETRAHEDRON = b"""*NODE
1, 0, 0, 0
2, 100, 0, 0
3, 0, 100, 0
4, 0, 0, 100
*ELEMENT, TYPE=C3D4
1, 1, 2, 3, 4
"""
MESHED_HOUSING: dict[str, Any] = {
    "name": "case",
    "mesh_file": {"name": "case.inp", "content": b64encode(compress(_TETRAHEDRON)).decode()},
    "mesh_unit": "mm",
    "material": "gray_cast_iron",
    "seats": [{"bearing": "input at 0", "bore_diameter_mm": 62.0, "bore_length_mm": 18.0}],
    "feet": [{"name": "base", "point_mm": [0.0, 0.0, 0.0], "normal": [0.0, -1.0, 0.0]}],
}
