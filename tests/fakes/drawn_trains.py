"""Trains of gears drawn at random, and where their teeth touch: involutes are turned until they meet."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import minimize_scalar

from dynamics import GearBody, GearMesh, ImposedRotation, Inertia, Scene, Shaft, TimeLaw
from dynamics.meshes.stiffness_table import straight_table

PER_TOOTH = 1e-3  # base radius per tooth, m
PITCH = 2.0 * math.pi * PER_TOOTH
INERTIA = Inertia(1.0, 1e-3, 1e-3)


def involute(angle):
    return math.tan(angle) - angle


@dataclass
class Train:
    """Gears on shafts by name, and who drives whom; grows gear by gear."""

    gears: dict[str, GearBody] = field(default_factory=dict)
    places: dict[str, tuple[float, float]] = field(default_factory=dict)
    links: list[tuple[str, str]] = field(default_factory=list)
    angles: dict[str, tuple[float, ...]] = field(default_factory=dict)
    frame: str | None = None
    speed: float = 10.0
    offsets: dict[str, float] = field(default_factory=dict)

    def add(self, name, teeth, *, share=None, shaft=None, helix=0.0, internal=False, position=0.05):
        thickness = None if share is None else share * PITCH
        self.gears[name] = GearBody(
            name, shaft or name, position, teeth, PER_TOOTH * teeth, 0.02, helix, INERTIA, internal, thickness
        )

    def mesh(self, driver, driven, pressure_angle, direction):
        """Let two gears mesh; the shaft that has no place gets it in a direction from the other one."""
        self.links.append((driver, driven))
        first, second = (self.gears[name] for name in (driver, driven))
        sign = -1.0 if first.internal or second.internal else 1.0
        apart = abs(first.base_radius + sign * second.base_radius) / math.cos(pressure_angle)
        self.places.setdefault(first.shaft, (0.0, 0.0))
        x, y = self.places[first.shaft]
        there = (x + apart * math.cos(direction), y + apart * math.sin(direction))
        self.places.setdefault(second.shaft, there)

    def scene(self):
        """Return the scene, driven at its first shaft; in a frame the carrier stands."""
        origins = dict(self.places)
        drives = [ImposedRotation("motor", next(iter(self.places)), TimeLaw.constant(self.speed))]
        if self.frame:
            origins[self.frame] = (0.0, 0.0)
            drives.append(ImposedRotation("hold", self.frame, TimeLaw.constant(0.0)))
        shafts = tuple(
            Shaft(name, 0.2, (*at, 0.0), INERTIA, self.frame, self.angles.get(name))
            for name, at in origins.items()
        )
        table = straight_table(1e8)
        meshes = tuple(
            GearMesh(f"{a}-{b}", a, b, table, position_offset=self.offsets.get(f"{a}-{b}"))
            for a, b in self.links
        )
        return Scene(shafts, tuple(self.gears.values()), meshes, tuple(drives), 0.1)


# The count by hand: gears are turned, one after the other, until their flanks touch.


@dataclass(frozen=True)
class PlacedGear:
    """A gear with its tooth center at an angle (rad) at mid-face; `z` is that of the section looked at."""

    body: GearBody
    center: tuple[float, float]
    angle: float

    def half_angle(self, radius):
        pressure = math.acos(min(1.0, self.body.base_radius / radius))
        widening = -involute(pressure) if not self.body.internal else involute(pressure)
        return self.body.base_tooth_thickness / (2.0 * self.body.base_radius) + widening

    def tooth(self, z):
        """Return the angle of the tooth center at a section."""
        turn = math.tan(self.body.base_helix_angle) / self.body.base_radius
        return self.angle + (z - self.body.position) * turn

    def flank(self, side, radius, z):
        return self.tooth(z) + side * self.half_angle(radius)


def off_pitches(value):
    return value - np.round(value)


def nearest_to(value, target, step):
    return target + step * off_pitches((value - target) / step)


def pitch_point(first, second):
    """Return the operating pitch point: it divides the line of centers as the base radii do."""
    (a, b), (c, d) = first.center, second.center
    if first.body.internal or second.body.internal:
        share = first.body.base_radius / (first.body.base_radius - second.body.base_radius)
    else:
        share = first.body.base_radius / (first.body.base_radius + second.body.base_radius)
    return a + share * (c - a), b + share * (d - b)


def polar(point, center):
    x, y = point[0] - center[0], point[1] - center[1]
    return math.hypot(x, y), math.atan2(y, x)


def touching(fixed, body, center, fixed_side, side, z):
    """Return a gear turned about its center until its flank touches one of the gear that stands fixed.

    The gap between flanks, as an angle of the gear that turns, is least where they touch.
    """
    loose = PlacedGear(body, center, 0.0)
    radius, direction = polar(pitch_point(fixed, loose), fixed.center)
    flank = fixed.flank(fixed_side, radius, z)
    angle = nearest_to(flank, direction, 2.0 * math.pi / fixed.body.teeth) - flank
    pitch = 2.0 * math.pi / body.teeth

    def raw(at):
        turned = fixed.flank(fixed_side, at, z) + angle
        point = (fixed.center[0] + at * math.cos(turned), fixed.center[1] + at * math.sin(turned))
        distance, seen = polar(point, center)
        return math.inf if distance <= body.base_radius else side * (seen - loose.flank(side, distance, z))

    first = off_pitches(raw(radius) / pitch) * pitch

    def gap(at):
        value = raw(at)
        return math.pi if math.isinf(value) else nearest_to(value, first, pitch)

    reach = (max(fixed.body.base_radius, 0.9 * radius), 1.1 * radius)
    best = minimize_scalar(gap, bounds=reach, method="bounded", options={"xatol": 1e-12})
    return replace(loose, angle=side * gap(best.x))


def position(driver, driven, side, sense, z):
    """Return by how many pitches the driver is beyond where its flank passes the pitch point."""
    radius, direction = polar(pitch_point(driver, driven), driver.center)
    return sense * (driver.flank(side, radius, z) - direction) * driver.body.teeth / (2.0 * math.pi)
