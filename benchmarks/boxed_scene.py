"""The scene of the paper's pair in a cast box, whose STEP file is written here."""

from __future__ import annotations

import copy
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from lineofaction.gearbox.schemas.file_content import FileContentInput

_BOX = """
import sys, gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
outer, inner = occ.addBox(-75, -75, -12, 230, 150, 224), occ.addBox(-67, -67, -4, 214, 134, 208)
box, _ = occ.cut([(3, outer)], [(3, inner)])
bosses = [(3, occ.addCylinder(x, 0, z, 0, 0, 24, 42)) for x in (0, 80) for z in (-12, 188)]
box, _ = occ.fuse(box, bosses)
pads = [(3, occ.addBox(x, -90, z, 30, 15, 30)) for x in (-75, 125) for z in (-12, 182)]
box, _ = occ.fuse(box, pads)
occ.cut(box, [(3, occ.addCylinder(x, 0, -20, 0, 0, 240, 31)) for x in (0, 80)])
occ.synchronize()
gmsh.write(sys.argv[1])
"""


def boxed_scene(inputs: dict[str, Any]) -> dict[str, Any]:
    """Return inputs of the pair's scene with its bearings in the box, 40 modes."""
    boxed = copy.deepcopy(inputs)
    seats = [
        {"bearing": part["name"], "bore_diameter_mm": 62.0, "bore_length_mm": 24.0}
        for part in boxed["scene"]["bushings"]
    ]
    feet = [{"name": "base", "point_mm": [0.0, -90.0, 0.0], "normal": [0.0, -1.0, 0.0]}]
    points = [{"name": "cover", "position_mm": [40.0, 75.0, 100.0]}]
    own = {"name": "case", "material": "gray_cast_iron", "modes": 40, "element_size_mm": 18.0}
    solid = {"step_file": _step_file(), "seats": seats, "feet": feet, "points": points}
    boxed["scene"]["housings"] = [own | solid]
    return boxed


def _step_file() -> dict[str, Any]:
    """Return the content of the STEP file as it goes over HTTP."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "case.step"
        subprocess.run([sys.executable, "-c", _BOX, str(file)], check=True, capture_output=True)
        return FileContentInput.of(file).model_dump()
