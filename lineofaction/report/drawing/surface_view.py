"""Pictures of a surface in the colors of a value, with edges, by parallel projection on pixels.

A facet is a triangle of the surface; a side is a large smooth part of the surface; a fold is an edge between
two sides; the outline is formed by the edges beside which nothing is seen. The depth of a point is its
coordinate towards the eye, in pixels: of two points at a pixel the one of greater depth is in front.
Axes of arrays: p points, t triangles, e edges. The edges of a list of neighbors lie between the triangles
`first` and `second`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray, IntArray
from dynamics.vibration import SurfaceShape
from lineofaction.gearbox.units import MM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, HeatMap, Line, Panel, number

DRAWN = 0.06
"""Length at which the largest motion is drawn, over the size of the surface."""
ACROSS = 360
"""Pixels along the longer side of the picture."""
FOLD = 40.0
"""Least angle, degrees, between the smoothed normals of two triangles at which their edge is a fold."""
SIDE = 0.03
"""Least area of a side whose edges are drawn, over the area of the surface."""
ALIKE = 80.0
"""Least angle, degrees, between the normals of neighbors that the smoothing leaves unchanged."""
PASSES = 3
"""Passes of the smoothing of normals."""
OUTLINE_MARGIN = 2
"""Largest distance, pixels, from an edge of the outline to a pixel where nothing is seen."""
MARGIN = 1
"""Empty pixels around the surface in a picture."""
ROUNDING = 1e-9
"""Tolerance of a point in a triangle, and twice the area, pixels squared, of one that is seen edge-on."""
SMALLEST = 1e-300
"""Length in place of 0 in a divisor."""
BEHIND = 3.0
"""Depth, pixels, by which a visible edge may lie behind the facet at its pixel: pixels are coarse."""
EYE = (1.0, 0.55, 0.65)
"""Direction to the eye; y points up in the picture."""
SIDES = {"From the front": EYE, "From behind and below": (-EYE[0], -EYE[1], -EYE[2])}
"""Two opposite directions to the eye, by the title: every facet that nothing hides faces one of them."""


def surface_panels(
    points: FloatArray, triangles: IntArray, offset: FloatArray, value: FloatArray, label: str, subtitle: str
) -> tuple[Panel, ...]:
    """Draw a displaced surface in the colors of a value, with its edges at rest, from two sides.

    Parameters
    ----------
    points, offset : (p, 3) arrays
        Points at rest, and their displacement as it is drawn, m.
    triangles : (t, 3) int array
    value : (t,) array
        Value of each triangle. If a value is negative, the range of colors is symmetric about 0.
    label : str
        Label of the colors, with the unit after the last comma.
    subtitle : str
        Addition to the titles of the panels; empty: none.
    """
    displaced = points + offset
    largest = float(np.max(np.abs(value), initial=0.0)) or 1.0  # all values 0: any range does
    minimum = -largest if np.any(value < 0.0) else 0.0
    panels = []
    folds = _folds(points, triangles)
    for side, eye in SIDES.items():
        view = _view_of(np.concatenate([points, displaced]), eye)
        image, _ = _rendered(view, displaced[triangles], value)
        _, depth_at_rest = _rendered(view, points[triangles], value)
        # positions of the pixels in mm; the shape of the view has the rows first
        x, y = (1e3 * view.step * np.arange(count, dtype=np.float64) for count in view.shape[::-1])
        outline = _outline(view, points, triangles, depth_at_rest)
        one_number = [len(points), 1]  # turns the two nodes of an edge into one number
        inner = folds[~np.isin(folds @ one_number, outline @ one_number)]  # not drawn twice
        visible_folds = _in_sight(view, points[inner], depth_at_rest)
        outline_folds = _in_sight(view, points[outline], depth_at_rest, np.inf)
        edges = 1e3 * view.step * np.concatenate([visible_folds, outline_folds])
        line = Line("edges at rest", edges[:, 0], edges[:, 1], palette.INK, width=0.6)
        across, up = (Axis("mm", limits=(0.0, float(along[-1]))) for along in (x, y))
        shade = HeatMap(x, y, image, label, largest, minimum)
        title = f"{side}: {subtitle}" if subtitle else side
        panels.append(Panel(across, up, (line,), title=title, shade=shade, equal=True))
    return tuple(panels)


def shape_figure(key: str, title: str, shape: SurfaceShape, unit: tuple[float, str] | None) -> Figure:
    """Draw the motion of a surface, a complex amplitude, from two sides.

    `unit` is the size of the unit of motion and its name. A mode has none: its size is arbitrary.
    """
    largest = max(float(np.linalg.norm(shape.motion, axis=1).max()), SMALLEST)
    drawn = DRAWN * float(np.ptp(shape.points, axis=0).max())
    # the instant at which the motion is largest: turned by this phase, it has the largest real part
    instant = shape.motion * np.exp(-0.5j * np.angle(np.sum(shape.motion**2)))
    offset = drawn / largest * instant.real
    unit_size, unit_name = unit or (largest, "part of the largest motion")
    size = f"{number(largest / unit_size, 3)} {unit_name}"
    scale = f"{size} drawn as {number(drawn / MM, 3)} mm"
    label = f"normal to the surface, {unit_name}"
    value = np.abs(shape.normal_motion) / unit_size
    return Figure(
        key=key,
        title=title,
        caption="Colors: peak amplitude normal to the surface. Drawn: the motion at the instant at which it "
        f"is largest{'' if unit else ', in arbitrary size'}. Lines: outline and large sides at rest.",
        alternative=f"{title}: {f'the largest motion is {size}' if unit else 'a shape without size'}.",
        content=surface_panels(shape.points, shape.facets, offset, value, label, scale if unit else ""),
    )


@dataclass(frozen=True)
class _View:
    """The projection of space on the pixels of a picture."""

    axes: FloatArray
    """Unit vectors in columns: to the right, up, to the eye. Shape (3, 3)."""
    low: FloatArray
    """Coordinates along the axes of the first pixel, m. Shape (3,)."""
    step: float
    """Size of a pixel, m."""
    shape: tuple[int, int]
    """Rows and columns of pixels."""

    def pixels(self, points: FloatArray) -> FloatArray:
        """Return the column, row and depth, in pixels, of points (..., 3)."""
        return np.asarray((points @ self.axes - self.low) / self.step)


def _view_of(points: FloatArray, eye: tuple[float, float, float] = EYE) -> _View:
    """Return the view of all points (p, 3) from the direction `eye`."""
    to_eye = np.array(eye) / np.linalg.norm(eye)
    right = np.cross([0.0, 1.0, 0.0], to_eye)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(to_eye, right), to_eye], axis=1)
    projected = points @ axes
    low = projected.min(axis=0)
    width, height = np.ptp(projected, axis=0)[:2]
    further = 2 * MARGIN + 1  # both margins, and the pixel of the last point
    step = float(max(width, height)) / (ACROSS - further)
    columns = int(np.ceil(width / step)) + further
    rows = int(np.ceil(height / step)) + further
    return _View(axes, low - MARGIN * step, step, (rows, columns))


def _rendered(view: _View, corners: FloatArray, value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return value and depth of the facet in front at each pixel, (rows, columns); NaN and -inf: no facet.

    Parameters
    ----------
    corners : (n, 3, 3) array
        Corners of the facets. Both faces of a facet are drawn: a thin wall may be meshed on one side alone.
    value : (n,) array
        Values of the facets.
    """
    flat = view.pixels(corners)
    span = np.ceil(np.ptp(flat[..., :2], axis=1).max(axis=1)).astype(int) + 1
    # facets are drawn together by size in pixels, rounded up to a power of two
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
    """Return the facet, the pixel and the depth for each pixel that a facet covers, (c,) each.

    `flat` (n, 3, 3) holds the corners of all facets in pixels, `facets` the numbers of those to cover, none
    of them larger than `side` pixels. Pixels are numbered row by row.
    """
    corner = flat[facets]
    first = np.floor(corner[..., :2].min(axis=1)).astype(int)
    offset = np.stack(np.meshgrid(np.arange(side + 1), np.arange(side + 1)), axis=-1).reshape(-1, 2)
    pixel = first[:, None] + offset
    origin = corner[:, 0]
    edge_1 = corner[:, 1] - origin
    edge_2 = corner[:, 2] - origin
    double_area = (edge_1[:, 0] * edge_2[:, 1] - edge_1[:, 1] * edge_2[:, 0])[:, None]
    # facets seen edge-on cover nothing
    double_area = np.where(np.abs(double_area) > ROUNDING, double_area, np.inf)
    x, y = np.moveaxis(pixel - origin[:, None, :2], 2, 0)  # (facets, pixels) each
    # barycentric coordinates: shares of the second and the third corner
    second = (x * edge_2[:, None, 1] - y * edge_2[:, None, 0]) / double_area
    third = (y * edge_1[:, None, 0] - x * edge_1[:, None, 1]) / double_area
    inside = (second >= -ROUNDING) & (third >= -ROUNDING) & (second + third <= 1.0 + ROUNDING)
    inside &= np.isfinite(double_area)
    inside &= np.all((pixel >= 0) & (pixel < view.shape[::-1]), axis=2)
    row, column = np.nonzero(inside)
    ahead = origin[row, 2] + second[row, column] * edge_1[row, 2] + third[row, column] * edge_2[row, 2]
    # facets that face away lie a pixel further back: where both meet, the one that faces the eye is seen
    ahead -= np.where(double_area[row, 0] < 0.0, 1.0, 0.0)
    number = pixel[row, column, 1] * view.shape[1] + pixel[row, column, 0]
    return facets[row], number, ahead


def _neighbors(triangles: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return the edges between two triangles (t, 3), as pairs of nodes (e, 2), and both triangles (e,)."""
    # three edges a triangle, (3 t, 2), the lower node first
    edges = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    index = inverse.ravel()
    order = np.argsort(index, kind="stable")
    pairs = np.flatnonzero(np.diff(index[order]) == 0)  # equal edges follow each other
    first, second = order[pairs], order[pairs + 1]
    return unique[index[first]], first // 3, second // 3


def _across(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return the normals of triangles, (t, 3), each as long as twice the area."""
    corner = points[triangles]
    return np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])


def _folds(points: FloatArray, triangles: IntArray) -> IntArray:
    """Return the edges between the large sides of a surface as pairs of nodes, (e, 2).

    Sides are the connected parts without a fold, after the normals of coarse triangles have been smoothed.
    """
    edges, first, second = _neighbors(triangles)
    across = _across(points, triangles)
    size = len(triangles)
    normal = _evened(across, first, second)
    sharp = np.sum(normal[first] * normal[second], axis=1) < np.cos(np.radians(FOLD))
    side = _connected(size, first[~sharp], second[~sharp])
    area = np.bincount(side, np.linalg.norm(across, axis=1))
    large = area > SIDE * area.sum()
    return np.asarray(edges[(side[first] != side[second]) & large[side[first]] & large[side[second]]])


def _connected(size: int, first: IntArray, second: IntArray) -> IntArray:
    """Return a number (n,) of the connected part of each of `size` nodes, by the ends of edges (e,).

    The number is that of the first node of the part: the lower number of an edge passes to the node that
    stands for the other end, and from there to all that it stands for.
    """
    least, number = np.arange(size), np.full(size, -1)
    while not np.array_equal(least, number):
        number = least.copy()
        lower = np.minimum(number[first], number[second])
        np.minimum.at(least, number[first], lower)
        np.minimum.at(least, number[second], lower)
        while not np.array_equal(least, least[least]):
            least = least[least]
    return number


def _outline(view: _View, points: FloatArray, triangles: IntArray, depth: FloatArray) -> IntArray:
    """Return the edges (e, 2) of the outline.

    One triangle of such an edge faces the eye, the other faces away, and nothing is seen near by.
    """
    edges, first, second = _neighbors(triangles)
    facing = _across(points, triangles) @ view.axes[:, 2] > 0.0
    turned = edges[facing[first] != facing[second]]
    column, row = np.rint(view.pixels(points[turned].mean(axis=1))[:, :2]).astype(int).T
    # by the padding, index 0 of a window is `OUTLINE_MARGIN` pixels before the pixel
    blank = np.pad(np.isinf(depth), OUTLINE_MARGIN, constant_values=True)
    around = np.arange(2 * OUTLINE_MARGIN + 1)
    near = blank[row[:, None, None] + around[:, None], column[:, None, None] + around]
    return np.asarray(turned[near.any(axis=(1, 2))])


def _evened(across: FloatArray, first: IntArray, second: IntArray) -> FloatArray:
    """Return unit normals (t, 3), smoothed among the neighbors `first` and `second`.

    This is a bilateral filter: neighbors count the more, the less their normals differ. The small angles of a
    curved side vanish, and the large ones between its sides stay. `across` holds the normals as long as twice
    the area.
    """
    area = np.maximum(np.linalg.norm(across, axis=1), SMALLEST)[:, None]
    normal = across / area
    limit = 1.0 - np.cos(np.radians(ALIKE))
    for _ in range(PASSES):
        deviation = 1.0 - np.sum(normal[first] * normal[second], axis=1)
        # Tukey's biweight: 1 for equal normals, 0 from the limit on
        weight = np.maximum(1.0 - (deviation / limit) ** 2, 0.0)[:, None] ** 2
        mean = area * normal
        np.add.at(mean, first, weight * area[second] * normal[second])
        np.add.at(mean, second, weight * area[first] * normal[first])
        normal = mean / np.maximum(np.linalg.norm(mean, axis=1), SMALLEST)[:, None]
    return np.asarray(normal)


def _in_sight(view: _View, ends: FloatArray, depth: FloatArray, behind: float = BEHIND) -> FloatArray:
    """Return the edges (e, 2, 3) that nothing hides, as points (n, 2), in pixels, of one line with breaks.

    An edge is visible if its middle lies at most `behind` pixels behind the facet in front, whose depth is
    `depth`.
    """
    flat = view.pixels(ends)
    middle = flat.mean(axis=1)
    column, row = np.rint(middle[:, :2]).astype(int).T
    visible = flat[middle[:, 2] >= depth[row, column] - behind, :, :2]
    gap = np.full((len(visible), 1, 2), np.nan)  # breaks the line
    return np.concatenate([visible, gap], axis=1).reshape(-1, 2)
