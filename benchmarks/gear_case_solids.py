"""Five gear cases of different shape as solids: a box, an angle, a flat reducer, a pot, two fused drums."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from dynamics.housings import (
    GRAY_CAST_IRON,
    Bore,
    Foot,
    MeshedHousing,
    Plane,
    ReducedHousing,
    SeatBore,
    mesh_step,
    reduced_housing,
)

_SOLID = """
import sys, gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
def fused(parts):
    return parts if len(parts) < 2 else occ.fuse(parts[:1], parts[1:])[0]
def shell(scale):
    return fused([(3, (occ.addBox if len(part) == 6 else occ.addCylinder)(*part)) for part in scale])
case, _ = occ.cut(shell({outer}), shell({inner}))
bosses = [(3, occ.addCylinder(x, y, z, 0, 24, 0, 42)) for x, y, z in {bores}]
feet = [(3, occ.addBox(*part)) for part in {feet}]
case, _ = occ.fuse(case, bosses + feet)
occ.cut(case, [(3, occ.addCylinder(x, y - 8, z, 0, 40, 0, 31)) for x, y, z in {bores}])
occ.synchronize()
gmsh.write(sys.argv[1])
"""


@dataclass(frozen=True)
class GearCase:
    """A hollow case in mm: boxes (x, y, z, lengths) and cylinders (x, y, z, axis, radius) outside and inside.

    Bores are along y, stated by the ends of their bosses at the smallest y; feet are boxes down to z = -15.
    """

    outer: tuple[tuple[float, ...], ...]
    inner: tuple[tuple[float, ...], ...]
    bores: tuple[tuple[float, float, float], ...]
    feet: tuple[tuple[float, ...], ...]
    element: float

    def reduced(self, modes: int) -> ReducedHousing:
        """Return the case on its feet with its first modes."""
        parts = {name: getattr(self, name) for name in ("outer", "inner", "bores", "feet")}
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "case.step"
            command = [sys.executable, "-c", _SOLID.format(**parts), str(file)]
            subprocess.run(command, check=True, capture_output=True)
            mesh = mesh_step(file, 1e-3 * self.element)
        seats = tuple(
            SeatBore(str(k), Bore((1e-3 * x, 1e-3 * (y + 12.0), 1e-3 * z), (0.0, 1.0, 0.0), 0.062, 0.024))
            for k, (x, y, z) in enumerate(self.bores)
        )
        feet = (Foot("base", Plane((0.0, 0.0, -0.015), (0.0, 0.0, -1.0))),)
        return reduced_housing(MeshedHousing(mesh, GRAY_CAST_IRON, seats, feet, modes=modes))


def _pads(xs: tuple[float, float], ys: tuple[float, float]) -> tuple[tuple[float, ...], ...]:
    return tuple((x, y, -15.0, 40.0, 30.0, 20.0) for x in xs for y in ys)


CASES = {
    "box": GearCase(
        ((0, 0, 0, 230, 224, 150),),
        ((8, 8, 8, 214, 208, 134),),
        tuple((x, y, 75) for x in (75, 155) for y in (-8, 208)),
        _pads((0, 190), (0, 194)),
        17.0,
    ),
    "angle": GearCase(
        ((0, 0, 0, 300, 160, 110), (0, 0, 0, 130, 160, 260)),
        ((7, 7, 7, 286, 146, 96), (7, 7, 7, 116, 146, 246)),
        tuple((x, y, z) for x, z in ((65, 180), (65, 60), (220, 55)) for y in (-8, 144)),
        _pads((0, 260), (0, 130)),
        16.0,
    ),
    "flat reducer": GearCase(
        ((0, 0, 0, 380, 110, 190),),
        ((6, 6, 6, 368, 98, 178),),
        tuple((x, y, 95) for x in (80, 180, 300) for y in (-8, 94)),
        _pads((0, 340), (0, 80)),
        14.0,
    ),
    "pot": GearCase(
        ((130, 0, 130, 0, 200, 0, 125),),
        ((130, 9, 130, 0, 182, 0, 116),),
        tuple((130, y, 130) for y in (-8, 184)),
        ((60, 20, -15, 30, 160, 60), (170, 20, -15, 30, 160, 60)),
        18.0,
    ),
    "two drums": GearCase(
        ((100, 0, 110, 0, 150, 0, 95), (240, 0, 130, 0, 150, 0, 120)),
        ((100, 7, 110, 0, 136, 0, 88), (240, 7, 130, 0, 136, 0, 113)),
        tuple((x, y, z) for x, z in ((100, 110), (240, 130)) for y in (-8, 134)),
        ((60, 10, -15, 40, 130, 60), (260, 10, -15, 40, 130, 60)),
        16.0,
    ),
}
"""Gear cases by name; their walls are 6 to 9 mm thick."""
