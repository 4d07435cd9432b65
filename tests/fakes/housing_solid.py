"""A small housing from a STEP file under the scene of two equal gears, one bearing a shaft."""

import copy
import json
import math
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

from small_table import small_table

EXAMPLE = Path(__file__).parents[2] / "examples" / "palermo_scene.toml"
WRITE_BLOCK = """
import sys, gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
block = occ.addBox(-40, -40, 85, 160, 80, 30)
bores = [(3, occ.addCylinder(x, 0, 80, 0, 0, 40, 20)) for x in (0, 80)]
cut, _ = occ.cut([(3, block)], bores)
if sys.argv[2:] == ["small"]:
    occ.dilate(cut, 0, 0, 0, 0.25, 0.25, 0.25)
if sys.argv[2:] == ["two"]:
    occ.addBox(500, 0, 0, 10, 10, 10)
occ.synchronize()
gmsh.write(sys.argv[1])
gmsh.finalize()
"""
TILT = [[1e6 if i == k > 2 else 0.0 for k in range(5)] for i in range(5)]
STIFFNESS = {
    "teeth": [20, 20],
    "base_radius_mm": 40.0 * math.cos(math.radians(20.0)),
    "working_pressure_angle_deg": 20.0,
    "face_width_mm": 25.0,
    "stiffness_n_per_m": {"value": [4e8], "amplitude": [5e7]},
}
"""Of the mesh, in place of a table."""
SEAT = {"bore_diameter_mm": 40.0, "bore_length_mm": 30.0}


def write_block(file: Path, *options: str) -> Path:
    """Write the STEP file of a block with two bores; "small": at a quarter; "two": with another solid."""
    command = [sys.executable, "-c", WRITE_BLOCK, str(file), *options]
    subprocess.run(command, check=True, capture_output=True)
    return file


def housing(**fields: Any) -> dict[str, Any]:
    """Return the housing of the block, with other fields; those that are None are left out."""
    own: dict[str, Any] = {
        "name": "case",
        "step_file": "block.step",
        "material": "gray_cast_iron",
        "modes": 4,
        "element_size_mm": 25.0,
        "seats": [{"bearing": name, **SEAT} for name in ("input left", "output left")],
        "feet": [{"name": "base", "point_mm": [0.0, -40.0, 0.0], "normal": [0.0, -1.0, 0.0]}],
        "points": [{"name": "cover", "position_mm": [40.0, 40.0, 100.0]}],
    }
    return {name: value for name, value in (own | fields).items() if value is not None}


def write_housed_scene(folder: Path, **fields: Any) -> Path:
    write_block(folder / "block.step")
    (folder / "scene.json").write_text(json.dumps(housed_scene(folder, **fields)))
    return folder


def housed_scene(folder: Path, **fields: Any) -> dict[str, Any]:
    scene = copy.deepcopy(tomllib.loads(EXAMPLE.read_text(encoding="utf-8")))
    scene["bushings"] = [part for part in scene["bushings"] if part["name"].endswith("left")]
    for bushing in scene["bushings"]:
        bushing |= {"position_mm": 100.0, "stiffness_matrix": TILT}
    del scene["meshes"][0]["case_file"]
    scene["meshes"][0]["database_file"] = "mesh.nc"
    small_table().to_netcdf(folder / "mesh.nc")
    scene["run"]["duration_s"] = 0.01
    return scene | {"housings": [housing(**fields)]}
