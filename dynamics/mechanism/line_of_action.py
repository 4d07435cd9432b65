"""The line of action of a mesh, and gradients of a flank's deflection and operating point in its bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds import Quantity, Text, above
from dynamics.errors import InputError
from dynamics.identity_cache import cached_by
from dynamics.scene.scene import Scene
from dynamics.shafts import GearBody
from dynamics.types import FloatArray

UNIT_Z = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class LineOfAction:
    """The line along which the driver pushes the driven gear."""

    point: FloatArray
    """Operating pitch point in the middle of the common face, fixed frame, m. Shape (3,)."""
    force: FloatArray
    """Force on the driven gear per unit transverse mesh force: a unit vector in the transverse plane, plus
    the axial part of a helical mesh. Shape (3,).
    """
    working_pressure_angle: float
    """Working pressure angle, rad."""

    def gradient(self, center: FloatArray) -> FloatArray:
        """Return the (6,) wrench of `force` about `center`: the derivative of the approach along the line.

        Displacements and small rotations of a body at `center` move its point at the pitch point by
        u + r x point arm, and this is its projection on `force`.
        """
        return np.concatenate([self.force, cross(self.point - center, self.force)])


def cross(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return `first` x `second`, (3,) each, to the bits of NumPy's in a sixth of its time."""
    (a, b, c), (x, y, z) = first, second
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def _pairs(scene: Scene) -> tuple[object, ...]:
    gears = (name for mesh in scene.meshes for name in (mesh.driver, mesh.driven))
    return (scene.shafts, scene.gears, *gears)


@cached_by(_pairs)
def lines_of_action(scene: Scene, senses: tuple[int, ...]) -> tuple[LineOfAction, ...]:
    """Return `line_of_action` of every mesh, by the sense of each."""
    return tuple(line_of_action(scene, index, sense) for index, sense in enumerate(senses))


def line_of_action(scene: Scene, index: int, sense: int) -> LineOfAction:
    """Return the line of action of mesh `index` whose driver pushes in the `sense` (+1 or -1) about +z.

    With e from the driver's center to the pitch point and alpha the working pressure angle, the driver
    rotating in +z pushes along n = sin(alpha) e + cos(alpha) (z x e); a ring gear that drives pushes inwards,
    along n = -sin(alpha) e + cos(alpha) (z x e). The other `sense` is the coast flank. A right-hand driver
    (beta_b > 0) pushed on by F feels the axial force sense F tan(beta_b). Raises `InputError`: the gears
    cannot mesh: hand, faces or center distance do not fit.
    """
    mesh = scene.meshes[index]
    driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
    field = f"meshes[{index}].driven"
    _check_fit(field, driver, driven)
    first, second = _center(scene, driver), _center(scene, driven)
    offset = (second - first) * np.array([1.0, 1.0, 0.0])
    distance = float(np.hypot(offset[0], offset[1]))
    bases = _acting_base_radii(driver, driven)
    if distance <= bases:
        combined = "difference" if driver.internal or driven.internal else "sum"
        bound = Text.of("at a center distance ", above(bases, "m", f"the base radii's {combined},"))
        raise InputError(field, Quantity(distance, "m"), bound)
    angle = math.acos(bases / distance)
    e = (
        offset / distance * (-1.0 if driven.internal else 1.0)
    )  # a pinion meets its ring away from the ring's center
    across = np.array([-e[1], e[0], 0.0])
    inwards = -1.0 if driver.internal else 1.0
    force = inwards * math.sin(angle) * e + sense * math.cos(angle) * across
    force[2] = -sense * math.tan(driver.base_helix_angle)
    point = first + e * driver.base_radius / math.cos(angle)
    low, high = common_face(scene, index)
    if high <= low:
        position = Quantity(driven.position, "m")
        raise InputError(field, position, "at an axial position where the faces overlap")
    point[2] = (low + high) / 2.0
    return LineOfAction(point, force, angle)


def _center(scene: Scene, gear: GearBody) -> FloatArray:
    x, y, z = scene.shaft(gear.shaft).origin
    return np.array([x, y, z + gear.position])


def _acting_base_radii(driver: GearBody, driven: GearBody) -> float:
    """Center distance times the cosine of the working pressure angle, m: sum, or difference in a ring."""
    if driver.internal:
        return driver.base_radius - driven.base_radius
    if driven.internal:
        return driven.base_radius - driver.base_radius
    return driver.base_radius + driven.base_radius


def _check_fit(field: str, driver: GearBody, driven: GearBody) -> None:
    """Opposite hand; the same hand and a smaller pinion in a ring gear."""
    ring = driver if driver.internal else driven
    pinion = driven if driver.internal else driver
    if ring.internal and pinion.internal:
        raise InputError(field, driven.name, "an external gear where the driver is a ring gear")
    if ring.internal and pinion.teeth >= ring.teeth:
        raise InputError(field, driven.teeth, f"such that the ring gear has more teeth than {pinion.teeth}")
    hand, name = (1.0, "the same hand") if ring.internal else (-1.0, "the other hand")
    if abs(driver.base_helix_angle - hand * driven.base_helix_angle) > 1e-9:
        expected = Quantity(hand * driver.base_helix_angle, "rad")
        bound = Text.of("of base helix angle ", expected, f", {name}")
        raise InputError(field, Quantity(driven.base_helix_angle, "rad"), bound)


def common_face(scene: Scene, index: int) -> tuple[float, float]:
    """Return the ends along z of the length over which both gears' faces overlap, m."""
    ends = []
    for name in (scene.meshes[index].driver, scene.meshes[index].driven):
        gear = scene.gear(name)
        middle = scene.shaft(gear.shaft).origin[2] + gear.position
        ends.append((middle - gear.face_width / 2.0, middle + gear.face_width / 2.0))
    return max(end[0] for end in ends), min(end[1] for end in ends)
