"""Pictures of bodies of revolution and surfaces: rays, the nearest surface of each ray, and its light."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bounds.types import BoolArray, FloatArray, IntArray
from lineofaction.gearbox.studies.bodies import HOUSING, Body, Hull, Ring

YAW, PITCH = 0.8, 0.35
"""Angles of the first view of a unit, rad, here and on the page."""
FIELD = 1.0 / math.tan(math.radians(15.0))
"""Cotangent of half the vertical field of view of the page's camera."""
LIGHT = (0.1, 0.6, 0.1)
"""Vector that is added to the direction of the eye; the sum is the direction of the light."""
SHADE = 0.34
"""Brightness of a surface without light."""
CONTOUR = 0.4
"""Brightness of an edge over the brightness of its surface."""
FINER = 2
"""Rays per pixel, across and down."""
SIDES = 48
"""Number of corners of the polygon about a circle by which the extent of a body is found."""
THROUGH = 0.3
"""Opacity of a surface, through which the rest is seen."""
BEHIND = 1e-6
"""Relative difference of distance by which a surface must be nearer than another to hide it."""


@dataclass(frozen=True)
class Camera:
    """An eye at a point (3,), m, its directions (3, 3) to the right, upwards and back, and its picture.

    A point whose directions from the eye have the ratios right / ahead and up / ahead lies at the pixel
    `scale` times these from `middle` (2,), counted from the upper left. `size`: width and height in pixels.
    """

    eye: FloatArray
    axes: FloatArray
    scale: float
    middle: FloatArray
    size: tuple[int, int]

    @classmethod
    def on(
        cls,
        bodies: Sequence[Body],
        size: tuple[int, int],
        margins: tuple[float, float],
        hulls: Sequence[Hull] = (),
    ) -> Camera:
        """Return the camera that sees all bodies and surfaces, as large as margins in pixels allow."""
        flat = math.cos(PITCH)
        back = np.array([math.sin(YAW) * flat, math.sin(PITCH), math.cos(YAW) * flat])
        right = np.array([math.cos(YAW), 0.0, -math.sin(YAW)])
        axes = np.array([right, np.cross(back, right), back])
        reached = [rims(body, ring) for body in bodies for ring in body.rings]
        points = np.vstack([*reached, *(hull.points for hull in hulls)])
        low, high = points.min(axis=0), points.max(axis=0)
        eye = 0.5 * (low + high) + 1.1 * FIELD * 0.5 * float(np.linalg.norm(high - low)) * back
        camera = cls(eye, axes, 1.0, np.zeros(2), size)
        pixels = camera.pixels(points)
        minimum, maximum = pixels.min(axis=0), pixels.max(axis=0)
        within = np.array(size) - 2.0 * np.array(margins)
        scale = float(np.min(within / np.maximum(maximum - minimum, 1e-12)))
        return cls(eye, axes, scale, 0.5 * np.array(size) - 0.5 * scale * (minimum + maximum), size)

    @property
    def light(self) -> FloatArray:
        """The direction of the light (3,), of length 1."""
        light = self.axes[2] + LIGHT
        return np.asarray(light / np.linalg.norm(light))

    def pixels(self, points: FloatArray) -> FloatArray:
        """Return the pixels of points (n, 3), across and down (n, 2)."""
        right, up, back = self.axes @ (points - self.eye).T
        return np.asarray(self.middle + self.scale * np.stack([right, -up], axis=1) / -back[:, None])

    def rays(self, rows: IntArray, columns: IntArray) -> FloatArray:
        """Return the directions (3, r, c) from the eye through the middles of pixels."""
        across = (columns + 0.5 - self.middle[0]) / self.scale
        up = (self.middle[1] - rows - 0.5) / self.scale
        right, above, back = self.axes[:, :, None, None]
        return np.asarray(right * across + above * up[:, None] - back)

    def finer(self) -> Camera:
        """Return the camera with `FINER` pixels for each."""
        width, height = self.size
        size = (FINER * width, FINER * height)
        return Camera(self.eye, self.axes, FINER * self.scale, FINER * self.middle, size)


def rims(body: Body, ring: Ring) -> FloatArray:
    """Return points (2 `SIDES`, 3) about both ends of a ring, whose hull holds it, m."""
    angle = np.arange(SIDES) * 2.0 * math.pi / SIDES
    ends = ((ring.low, ring.outer), (ring.high, ring.outer_high))
    about = np.stack([np.cos(angle), np.sin(angle)], axis=1) / math.cos(math.pi / SIDES)
    circles = [np.column_stack([radius * about + body.axis, np.full(SIDES, z)]) for z, radius in ends]
    return np.vstack(circles)


@dataclass(frozen=True)
class _Window:
    """A part of a picture: its rows and columns, and the rays (3, r, c) through it."""

    rows: slice
    columns: slice
    ray: FloatArray

    @classmethod
    def about(cls, camera: Camera, points: FloatArray) -> _Window:
        """Return the part that holds points."""
        pixels = camera.pixels(points)
        low = np.maximum(np.floor(pixels.min(axis=0)).astype(int), 0)
        high = np.minimum(np.ceil(pixels.max(axis=0)).astype(int) + 1, camera.size)
        (left, top), (right, bottom) = low.tolist(), high.tolist()
        ray = camera.rays(np.arange(top, bottom), np.arange(left, right))
        return cls(slice(top, bottom), slice(left, right), ray)


@dataclass(frozen=True)
class _Surface:
    """Intersection of the rays of a window with a surface: lengths, infinite if none, and light there."""

    distance: FloatArray
    light: FloatArray


def _surfaces(ring: Ring, eye: FloatArray, ray: FloatArray, light: FloatArray) -> Iterator[_Surface]:
    """Yield the walls and the ends of a ring that the eye sees; the eye counts from the ring's axis."""
    slope = (ring.outer_high - ring.outer) / (ring.high - ring.low)
    yield _Cone(ring.low, ring.high, ring.outer, slope).met(eye, ray, light, outward=True)
    if ring.inner > 0.0:
        yield _Cone(ring.low, ring.high, ring.inner, 0.0).met(eye, ray, light, outward=False)
    for z, way, outer in ((ring.low, -1.0, ring.outer), (ring.high, 1.0, ring.outer_high)):
        if way * (eye[2] - z) > 0.0:
            with np.errstate(divide="ignore", invalid="ignore"):
                distance = (z - eye[2]) / ray[2]
                radius = np.hypot(eye[0] + distance * ray[0], eye[1] + distance * ray[1])
            on = (distance > 0.0) & (radius <= outer) & (radius >= ring.inner)
            lit = max(way * light[2], 0.0)
            yield _Surface(np.where(on, distance, np.inf), np.full(on.shape, lit))


@dataclass(frozen=True)
class _Cone:
    """A wall about z between two ends: its radius at the lower end, and the growth of the radius per z."""

    low: float
    high: float
    radius: float
    slope: float

    def met(self, eye: FloatArray, ray: FloatArray, light: FloatArray, *, outward: bool) -> _Surface:
        """Return the first intersection of rays with the wall, from outside or from within."""
        at_eye = self.radius + self.slope * (eye[2] - self.low)
        a = ray[0] ** 2 + ray[1] ** 2 - (self.slope * ray[2]) ** 2
        half_b = ray[0] * eye[0] + ray[1] * eye[1] - self.slope * ray[2] * at_eye
        c = eye[0] ** 2 + eye[1] ** 2 - at_eye**2
        best, lit = np.full(a.shape, np.inf), np.zeros(a.shape)
        side = -1.0 if outward else 1.0
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt(half_b**2 - a * c)
            for way in (side,) if self.slope == 0.0 else (side, -side):
                distance = (way * root - half_b) / a
                z = eye[2] + distance * ray[2]
                on = (z >= self.low) & (z <= self.high) & (distance > 0.0) & (distance < best)
                normal = self._normals(eye[:, None] + distance[on] * ray[:, on])
                normal *= -side
                faces = np.sum(normal * ray[:, on], axis=0) < 0.0
                on[on] = faces  # of these rays only those that meet the visible side
                best[on] = distance[on]
                lit[on] = np.maximum(light @ normal[:, faces], 0.0)
        return _Surface(best, lit)

    def _normals(self, points: FloatArray) -> FloatArray:
        """Return the unit normals (3, n) at points (3, n), away from the axis."""
        across = points[:2] / np.maximum(np.hypot(*points[:2]), np.finfo(float).tiny)
        along = np.full((1, points.shape[1]), -self.slope)
        return np.asarray(np.vstack([across, along]) / math.hypot(1.0, self.slope))


@dataclass
class _Picture:
    """The nearest surface of each ray: distance, number of the surface (0: none), color (h, w, 3)."""

    camera: Camera
    distance: FloatArray
    surface: IntArray
    color: FloatArray
    count: int = 0

    @classmethod
    def blank(cls, camera: Camera) -> _Picture:
        width, height = camera.size
        shape = (height, width)
        return cls(camera, np.full(shape, np.inf), np.zeros(shape, dtype=np.int64), np.ones((*shape, 3)))

    def add(self, body: Body, ring: Ring, color: Sequence[float]) -> None:
        window = _Window.about(self.camera, rims(body, ring))
        pixels = (window.rows, window.columns)
        for met in _surfaces(ring, self.camera.eye - [*body.axis, 0.0], window.ray, self.camera.light):
            before = met.distance < self.distance[pixels] * (1.0 - BEHIND)
            self.distance[pixels][before] = met.distance[before]
            self.count += 1
            self.surface[pixels][before] = self.count
            lit = SHADE + (1.0 - SHADE) * met.light[before]
            self.color[pixels][before] = np.outer(lit, color)

    def cover(self, hull: Hull, color: Sequence[float]) -> None:
        """Draw the visible outside of a surface over everything behind it."""
        nearest = np.full(self.distance.shape, np.inf)
        lit = np.zeros(self.distance.shape)
        for corners in hull.points[hull.facets]:
            across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            height = float(across @ (self.camera.eye - corners[0]))
            if height <= 0.0:  # the eye is behind the facet
                continue
            window = _Window.about(self.camera, corners)
            pixels = (window.rows, window.columns)
            with np.errstate(divide="ignore", invalid="ignore"):
                distance = -height / np.tensordot(across, window.ray, 1)
            met = _within(corners - self.camera.eye, window.ray) & (distance < nearest[pixels])
            nearest[pixels][met] = distance[met]
            lit[pixels][met] = max(float(self.camera.light @ across) / float(np.linalg.norm(across)), 0.0)
        front = nearest < self.distance
        over = np.outer(SHADE + (1.0 - SHADE) * lit[front], color)
        self.color[front] += THROUGH * (over - self.color[front])

    def contours(self) -> BoolArray:
        """Return the pixels at which a surface ends."""
        edge = np.zeros(self.surface.shape, dtype=bool)
        for axis in (0, 1):
            changes = np.diff(self.surface, axis=axis) != 0
            low = (slice(None),) * axis + (slice(None, -1),)
            high = (slice(None),) * axis + (slice(1, None),)
            edge[low] |= changes
            edge[high] |= changes
        return edge


def _within(corners: FloatArray, ray: FloatArray) -> BoolArray:
    """Whether rays (3, r, c) from the origin pass a triangle (3, 3), counter-clockwise as they see it."""
    sides = (np.cross(corners[k], corners[(k + 1) % 3]) for k in range(3))
    return np.asarray(np.all([np.tensordot(side, ray, 1) <= 0.0 for side in sides], axis=0))


@dataclass(frozen=True)
class Rendered:
    """A picture: its color (height, width, 3), 0 to 1, and the body (height, width) by index; -1: none."""

    color: FloatArray
    body: IntArray


def rendered(
    bodies: Sequence[Body],
    camera: Camera,
    colors: Mapping[str, Sequence[float]],
    hulls: Sequence[Hull] = (),
) -> Rendered:
    """Return the picture of bodies on white, seen through surfaces; colors by kind of body."""
    picture = _Picture.blank(camera.finer())
    owner = [-1]  # body by the number of the surface
    for index, body in enumerate(bodies):
        for ring in body.rings:
            picture.add(body, ring, colors[body.kind])
        owner += [index] * (picture.count + 1 - len(owner))
    picture.color[picture.contours() & (picture.surface > 0)] *= CONTOUR
    for hull in hulls:
        picture.cover(hull, colors[HOUSING])
    width, height = camera.size
    color = picture.color.reshape(height, FINER, width, FINER, 3).mean(axis=(1, 3))
    return Rendered(color, np.array(owner)[picture.surface[::FINER, ::FINER]])
