"""Pictures of surfaces: what is in front, edges in sight."""

import numpy as np
import pytest
from hulls import sphere
from lattice_meshes import box

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Figure
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.surface_view import _folds, _rendered, _view_of, surface_panels

SIDES = (0.3, 0.2, 0.1)


def block() -> tuple[np.ndarray, np.ndarray]:
    mesh = box(SIDES, (3, 2, 1))
    nodes, triangles = np.unique(mesh.surface[:, :3], return_inverse=True)
    return mesh.points[nodes], triangles.reshape(-1, 3)


def test_a_block_shows_the_three_sides_that_face_the_eye_in_their_projected_areas():
    points, triangles = block()
    corner = points[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    side = np.argmax(np.abs(normal), axis=1) + np.where(normal.sum(axis=1) > 0.0, 0, 3)
    eye = (1.0, 0.55, 0.65)
    view = _view_of(points, eye)
    image, depth = _rendered(view, corner, side.astype(float))
    ahead = np.array(eye) / np.linalg.norm(eye)
    x, y, z = SIDES
    for axis, area in enumerate((y * z, x * z, x * y)):
        seen = np.count_nonzero(image == axis) * view.step**2
        assert seen == pytest.approx(area * ahead[axis], rel=0.02)
    assert not np.any(image > 2.5)  # no side turned away
    assert np.array_equal(np.isnan(image), np.isinf(depth))


def test_all_six_sides_of_a_block_are_seen_in_two_pictures():
    points, triangles = block()
    corner = points[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    side = np.argmax(np.abs(normal), axis=1) + np.where(normal.sum(axis=1) > 0.0, 0, 3)
    pictures = surface_panels(points, triangles, np.zeros_like(points), side.astype(float), "side", "at rest")
    seen = np.concatenate([np.unique(picture.shade.z) for picture in pictures])
    assert set(seen[np.isfinite(seen)]) == set(range(6))


def test_folds_are_the_edges_of_the_block():
    points, triangles = block()
    ends = points[_folds(points, triangles)]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(4.0 * sum(SIDES))


def test_values_of_either_sign_have_colors_even_about_zero():
    points, triangles = block()
    size = np.linspace(-0.5, 2.0, len(triangles))
    front, behind = surface_panels(points, triangles, np.zeros_like(points), size, "I, W/m²", "at rest")
    assert (
        (front.shade.minimum, front.shade.largest)
        == (-2.0, 2.0)
        == (behind.shade.minimum, behind.shade.largest)
    )
    assert front.shade.colors == palette.SIGNED
    (positive, _) = surface_panels(points, triangles, np.zeros_like(points), size + 0.5, "v, m/s", "at rest")
    assert positive.shade.minimum == 0.0 and positive.shade.colors == palette.CIVIDIS
    (heat, *_) = plotly_figure(Figure("k", "t", "c", "a", (front,)))["data"]
    assert [color for _, color in heat["colorscale"]] == list(palette.SIGNED)


def test_a_panel_shows_the_moved_surface_and_the_nine_edges_in_sight_at_rest():
    points, triangles = block()
    size = np.linspace(0.0, 2.0, len(triangles))
    still = surface_panels(points, triangles, np.zeros_like(points), size, "v, mm/s", "at rest")[0]
    away = surface_panels(points, triangles, np.full_like(points, 0.05), size, "v, mm/s", "moved")[0]
    assert still.equal
    assert still.shade.largest == 2.0
    assert np.nanmax(still.shade.z) <= 2.0
    assert np.isnan(still.shade.z).any()
    (line,) = still.lines
    view = _view_of(points)
    ends = points[_folds(points, triangles)] @ view.axes[:, :2]
    whole = 1e3 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    drawn = np.nansum(np.hypot(np.diff(line.x), np.diff(line.y)))
    assert drawn == pytest.approx(0.75 * whole, rel=0.02)  # three of twelve, one of each length, are behind
    assert away.shade.z.shape[0] * (away.shade.y[1] - away.shade.y[0]) > still.shade.y[-1]


def test_a_wall_that_has_one_of_its_two_sides_is_seen_from_both():
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    covered = []
    for corners in (points, points[::-1]):
        image, _ = _rendered(_view_of(points, (0.0, 0.2, 1.0)), corners[None], np.ones(1))
        covered.append(np.isfinite(image))
    assert np.array_equal(*covered)
    assert covered[0].mean() > 0.4


@pytest.mark.law
def test_blocks_of_rough_triangles_have_the_edges_of_the_block_and_no_fold_within_a_side():
    mesh = box(SIDES, (6, 4, 2))
    nodes, triangles = np.unique(mesh.surface[:, :3], return_inverse=True)
    points, triangles = mesh.points[nodes], triangles.reshape(-1, 3)
    on_edge = np.sum((points == points.min(axis=0)) | (points == points.max(axis=0)), axis=1) >= 2
    true = []
    for seed in range(20):  # triangles of one side are up to 40 degrees apart
        rough = points + 0.010 * np.random.default_rng(seed).uniform(-1.0, 1.0, points.shape)
        folds = _folds(rough, triangles)
        length = np.linalg.norm(points[folds[:, 1]] - points[folds[:, 0]], axis=1).sum()
        true.append(np.all(on_edge[folds]) and length == pytest.approx(4.0 * sum(SIDES), rel=0.1))
    assert sum(true) >= 15


@pytest.mark.law
def test_a_sphere_has_its_outline_and_no_edge():
    hull, radius = sphere(12, 0.3), 0.3
    points, triangles = hull.nodes, hull.triangles
    assert len(_folds(points, triangles)) == 0
    (panel, _) = surface_panels(points, triangles, np.zeros_like(points), np.ones(len(triangles)), "v, m", "")
    (line,) = panel.lines
    drawn = np.nansum(np.hypot(np.diff(line.x), np.diff(line.y)))
    assert drawn == pytest.approx(2e3 * np.pi * radius, rel=0.15)
