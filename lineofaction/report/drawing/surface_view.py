"""A surface seen from a far eye: the value of the facet in front at every pixel, and edges in sight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from bounds.types import FloatArray, IntArray
from dynamics.vibration import SurfaceShape
from lineofaction.gearbox.units import MM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, HeatMap, Line, Panel, number

DRAWN = 0.06
"""Largest motion as it is drawn, over the size of the surface."""
ACROSS = 360
"""Pixels along the longer side."""
FOLD = 40.0
"""Degrees between two triangles of the evened surface from which on their edge is drawn."""
SIDE = 0.03
"""Of the surface: the least part between edges, smaller ones have none."""
ALIKE, PASSES = 80.0, 3
"""Degrees between neighbors from which on none evens the other, and how often they do."""
OUTLINE_MARGIN = 2
"""Pixels from the outline to where nothing is seen, at most."""
BEHIND = 3.0
"""Pixels in depth by which an edge may lie behind what hides nothing: facets are flat, pixels coarse."""
EYE = (1.0, 0.55, 0.65)
"""Direction to the eye: seen from there y points up, as across a gearbox."""
SIDES = {"From the front": EYE, "From behind and below": (-EYE[0], -EYE[1], -EYE[2])}
"""Opposite eyes: each facet that nothing hides is seen from one of them."""


@dataclass(frozen=True)
class _View:
    """Axes of the picture in space, columns right, up, to the eye, and its pixels: corner, step, shape."""

    axes: FloatArray
    low: FloatArray
    step: float
    shape: tuple[int, int]

    def pixels(self, points: FloatArray) -> FloatArray:
        """Return points (..., 3) in pixels: column, row, depth."""
        return np.asarray((points @ self.axes - self.low) / self.step)


def _view_of(points: FloatArray, eye: tuple[float, float, float] = EYE) -> _View:
    """Return the view that holds all points, (p, 3)."""
    ahead = np.array(eye) / np.linalg.norm(eye)
    right = np.cross([0.0, 1.0, 0.0], ahead)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(ahead, right), ahead], axis=1)
    seen = points @ axes
    low, span = seen.min(axis=0), np.ptp(seen, axis=0)[:2]
    step = float(span.max()) / (ACROSS - 3)
    columns, rows = (int(np.ceil(side / step)) + 3 for side in span)
    return _View(axes, low - step, step, (rows, columns))


def _rendered(view: _View, corners: FloatArray, value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return value and depth of the facet in front at each pixel, (rows, columns); NaN and -inf at none.

    Parameters
    ----------
    corners : (n, 3, 3) array
        Of the facets, seen from either side: a thin wall may have but one of its two.
    value : (n,) array
    """
    flat = view.pixels(corners)
    span = np.ceil(np.ptp(flat[..., :2], axis=1).max(axis=1)).astype(int) + 1
    size = 2 ** np.ceil(np.log2(span)).astype(int)
    depth = np.full(view.shape[0] * view.shape[1], -np.inf)
    hits = [_covered(view, flat, np.flatnonzero(size == side), side) for side in np.unique(size)]
    for _, pixel, ahead in hits:
        np.maximum.at(depth, pixel, ahead)
    image = np.full(depth.size, np.nan)
    for facet, pixel, ahead in hits:
        front = ahead == depth[pixel]
        image[pixel[front]] = value[facet[front]]
    return image.reshape(view.shape), depth.reshape(view.shape)


def _covered(
    view: _View, flat: FloatArray, facets: IntArray, side: int
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return facets, pixels and depths of all pixels that facets of a size cover."""
    corner = flat[facets]
    first = np.floor(corner[..., :2].min(axis=1)).astype(int)
    offset = np.stack(np.meshgrid(np.arange(side + 1), np.arange(side + 1)), axis=-1).reshape(-1, 2)
    pixel = first[:, None] + offset
    a, edge, other = corner[:, 0], corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = (edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0])[:, None]
    area = np.where(np.abs(area) > 1e-9, area, np.inf)  # the others are seen edge on
    x, y = np.moveaxis(pixel - a[:, None, :2], 2, 0)
    second = (x * other[:, None, 1] - y * other[:, None, 0]) / area
    third = (y * edge[:, None, 0] - x * edge[:, None, 1]) / area
    inside = (second >= -1e-9) & (third >= -1e-9) & (second + third <= 1.0 + 1e-9) & np.isfinite(area)
    inside &= np.all((pixel >= 0) & (pixel < view.shape[::-1]), axis=2)
    row, column = np.nonzero(inside)
    ahead = a[row, 2] + second[row, column] * edge[row, 2] + third[row, column] * other[row, 2]
    ahead -= np.where(area[row, 0] < 0.0, 1.0, 0.0)  # behind those that face the eye
    number = pixel[row, column, 1] * view.shape[1] + pixel[row, column, 0]
    return facets[row], number, ahead


def _neighbors(triangles: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return edges between two triangles (t, 3) as pairs of nodes (e, 2), and these two (e,)."""
    edges = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    order = np.argsort(index.ravel(), kind="stable")
    pairs = np.flatnonzero(np.diff(index.ravel()[order]) == 0)
    return unique[index.ravel()[order[pairs]]], order[pairs] // 3, order[pairs + 1] // 3


def _across(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return normals (t, 3), as long as twice the area."""
    corner = points[triangles]
    return np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])


def _folds(points: FloatArray, triangles: IntArray) -> IntArray:
    """Return the edges between the large sides of a surface as pairs of nodes, (e, 2).

    Sides are what hangs together without a fold, once the folds of coarse triangles are evened out.
    """
    edges, one, two = _neighbors(triangles)
    across, size = _across(points, triangles), len(triangles)
    normal = _evened(across, one, two)
    sharp = np.sum(normal[one] * normal[two], axis=1) < np.cos(np.radians(FOLD))
    flat = coo_array((np.ones(np.count_nonzero(~sharp)), (one[~sharp], two[~sharp])), shape=(size, size))
    _, side = connected_components(flat, directed=False)
    area = np.bincount(side, np.linalg.norm(across, axis=1))
    large = area > SIDE * area.sum()
    return np.asarray(edges[(side[one] != side[two]) & large[side[one]] & large[side[two]]])


def _outline(view: _View, points: FloatArray, triangles: IntArray, depth: FloatArray) -> IntArray:
    """Return the edges (e, 2) about what is seen: one side to the eye, the other away, nothing beyond."""
    edges, one, two = _neighbors(triangles)
    facing = _across(points, triangles) @ view.axes[:, 2] > 0.0
    turned = edges[facing[one] != facing[two]]
    column, row = np.rint(view.pixels(points[turned].mean(axis=1))[:, :2]).astype(int).T
    blank = np.pad(np.isinf(depth), OUTLINE_MARGIN, constant_values=True)
    around = np.arange(2 * OUTLINE_MARGIN + 1)
    near = blank[row[:, None, None] + around[:, None], column[:, None, None] + around]
    return np.asarray(turned[near.any(axis=(1, 2))])


def _evened(across: FloatArray, one: IntArray, two: IntArray) -> FloatArray:
    """Return unit normals (t, 3) evened among neighbors `one` and `two` that face much the same way.

    A bilateral filter: the folds of a coarse surface level out, edges between its sides stay.
    `across`: normals as long as twice the area.
    """
    area = np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
    normal = across / area
    for _ in range(PASSES):
        deviation = 1.0 - np.sum(normal[one] * normal[two], axis=1)
        weight = np.maximum(1.0 - (deviation / (1.0 - np.cos(np.radians(ALIKE)))) ** 2, 0.0)[:, None] ** 2
        mean = area * normal
        np.add.at(mean, one, weight * area[two] * normal[two])
        np.add.at(mean, two, weight * area[one] * normal[one])
        normal = mean / np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
    return np.asarray(normal)


def surface_panels(
    points: FloatArray, triangles: IntArray, offset: FloatArray, value: FloatArray, label: str, subtitle: str
) -> tuple[Panel, ...]:
    """Draw a moved surface in the colors of a value, with the edges of where it was, from two sides.

    Parameters
    ----------
    points, offset : (p, 3) arrays
        m: at rest, and how far they are drawn off.
    triangles : (t, 3) int array
    value : (t,) array
        Where some is negative, colors are even about 0.
    label, subtitle : str
        Of the colors, with the unit after the last comma, and in the titles of the panels, if any.
    """
    displaced = points + offset
    largest = float(np.max(np.abs(value), initial=0.0)) or 1.0
    minimum = -largest if np.any(value < 0.0) else 0.0
    panels, folds = [], _folds(points, triangles)
    for side, eye in SIDES.items():
        view = _view_of(np.concatenate([points, displaced]), eye)
        image, _ = _rendered(view, displaced[triangles], value)
        _, depth = _rendered(view, points[triangles], value)
        x, y = (1e3 * view.step * np.arange(count, dtype=np.float64) for count in view.shape[::-1])
        about = _outline(view, points, triangles, depth)
        inner = folds[~np.isin(folds @ [len(points), 1], about @ [len(points), 1])]
        seen = _in_sight(view, points[inner], depth), _in_sight(view, points[about], depth, np.inf)
        edges = 1e3 * view.step * np.concatenate(seen)
        outline = Line("edges at rest", edges[:, 0], edges[:, 1], palette.INK, width=0.6)
        across, up = (Axis("mm", limits=(0.0, float(along[-1]))) for along in (x, y))
        shade = HeatMap(x, y, image, label, largest, minimum)
        titled = f"{side}{subtitle and f': {subtitle}'}"
        panels.append(Panel(across, up, (outline,), title=titled, shade=shade, equal=True))
    return tuple(panels)


def shape_figure(key: str, title: str, shape: SurfaceShape, unit: tuple[float, str] | None) -> Figure:
    """Draw a surface as it moves, from two sides; a unit is its size and name, that of a mode None."""
    fastest = max(float(np.linalg.norm(shape.motion, axis=1).max()), 1e-300)
    drawn = DRAWN * float(np.ptp(shape.points, axis=0).max())
    turned = shape.motion * np.exp(-0.5j * np.angle(np.sum(shape.motion**2)))  # as much as can be is real
    offset = drawn / fastest * turned.real
    one, name = unit or (fastest, "part of the largest motion")
    size, length = f"{number(fastest / one, 3)} {name}", f"{number(drawn / MM, 3)} mm"
    scale, largest = f"{size} drawn as {length}", f"the largest motion is {size}"
    label, value = f"normal to the surface, {name}", np.abs(shape.normal_motion) / one
    return Figure(
        key=key,
        title=title,
        caption="Colors: peak amplitude normal to the surface. Drawn: the motion at the instant at which it "
        f"is largest{'' if unit else ', in arbitrary size'}. Lines: outline and large sides at rest.",
        alternative=f"{title}: {largest if unit else 'a shape without size'}.",
        content=surface_panels(shape.points, shape.facets, offset, value, label, scale if unit else ""),
    )


def _in_sight(view: _View, ends: FloatArray, depth: FloatArray, behind: float = BEHIND) -> FloatArray:
    """Return edges (e, 2, 3) that nothing hides as points of a line with breaks, (n, 2) in pixels."""
    flat = view.pixels(ends)
    middle = flat.mean(axis=1)
    column, row = np.rint(middle[:, :2]).astype(int).T
    seen = flat[middle[:, 2] >= depth[row, column] - behind, :, :2]
    gap = np.full((len(seen), 1, 2), np.nan)
    return np.concatenate([seen, gap], axis=1).reshape(-1, 2)
