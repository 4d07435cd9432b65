"""The picture of a gear unit: sizes and what hides what, and where it stands in reports."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import loa
from hulls import sphere
from repository import EXAMPLES
from sounding_housings import rigid_housing

from bounds.types import Json
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.schemas.reading import read_model
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.bodies import BEARING, HOUSING, PINION, SHAFT, WHEEL, Body, Hull, Ring
from lineofaction.gearbox.studies.unit_bodies import bodies_of
from lineofaction.report.document import page_json, page_of, read_inputs, write_page
from lineofaction.report.drawing.bodies import LIGHT, SHADE, THROUGH, Camera, rendered
from lineofaction.report.drawing.image import still
from lineofaction.report.drawing.page import Page
from lineofaction.report.unit_picture import COLORS, HOUSED, UNHOUSED, is_picture, unit_png, with_picture

ROTOR, PLANETARY = EXAMPLES / "jeffcott_scene.toml", EXAMPLES / "lin_parker_planetary_scene.toml"
SIZE = (240, 180)


def body(kind: str, low: float, high: float, outer: float, inner: float = 0.0, x: float = 0.0) -> Body:
    return Body(kind, f"{kind} {low:g}", (x, 0.0), (Ring(low, high, inner, outer, outer),))


def bodies(file: Path) -> list[Json]:
    scene = read_model(SceneInput, file)
    return bodies_of(TabledScene(scene, {}, dynamic_scene(scene, {})))


def unit(file: Path) -> list[Body]:
    return [*map(Body.of, bodies(file))]


def along_z(distance: float) -> Camera:
    """Return a camera on the axis that looks against z; at the plane z = 0 a mm is 100 pixels."""
    return Camera(np.array([0.0, 0.0, distance]), np.eye(3), 100e3 * distance, 0.5 * np.array(SIZE), SIZE)


def test_a_disc_covers_the_area_of_its_circle_in_perspective():
    camera, radius = along_z(1.0), 0.7e-3
    seen = rendered([body(SHAFT, -0.05, 0.0, radius)], camera, COLORS)
    assert np.count_nonzero(seen.body == 0) == pytest.approx(np.pi * 70.0**2, rel=2e-3)


def test_a_cylinder_from_the_side_is_as_wide_as_its_tangent_cone():
    """An eye at distance d sees a radius r by half-width r / sqrt(d^2 - r^2) over its distance."""
    distance, radius = 0.01, 3e-3
    axes = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    camera = Camera(np.array([distance, 0.0, 0.0]), axes, 200.0, 0.5 * np.array(SIZE), SIZE)
    seen = rendered([body(SHAFT, -0.1, 0.1, radius)], camera, COLORS)
    rows = np.count_nonzero(seen.body[:, SIZE[0] // 2] == 0)
    assert rows == pytest.approx(2.0 * 200.0 * radius / np.sqrt(distance**2 - radius**2), abs=1.0)


def test_a_cone_is_as_wide_as_its_radius_where_it_is_cut():
    distance = 100.0
    axes = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    camera = Camera(np.array([distance, 0.0, 0.0]), axes, 60.0 * distance, 0.5 * np.array(SIZE), SIZE)
    cone = Body(SHAFT, "cone", (0.0, 0.0), (Ring(-1.0, 1.0, 0.0, 1.0, 0.4),))
    seen = rendered([cone], camera, COLORS).body == 0
    width = np.count_nonzero(seen, axis=0)
    z = -(np.arange(SIZE[0]) + 0.5 - 0.5 * SIZE[0]) / 60.0
    inside = np.abs(z) < 0.95
    assert width[inside] == pytest.approx(2.0 * 60.0 * (0.7 - 0.3 * z[inside]), abs=2.5)
    assert not np.any(width[np.abs(z) > 1.05])


@pytest.mark.parametrize("nearest_first", [False, True])
def test_what_is_behind_is_hidden(nearest_first):
    parts = [body(PINION, -0.03, -0.02, 0.4e-3), body(WHEEL, -0.01, 0.0, 0.5e-3)]
    hidden = 0
    if nearest_first:
        parts.reverse()
        hidden = 1
    seen = rendered(parts, along_z(1.0), COLORS).body
    assert not np.any(seen == hidden)
    assert np.any(seen == 1 - hidden)


def test_through_a_bore_one_sees_what_is_behind():
    parts = [body(PINION, -0.03, -0.02, 0.3e-3), body(WHEEL, -0.01, 0.0, 0.8e-3, inner=0.5e-3)]
    seen = rendered(parts, along_z(1.0), COLORS).body
    assert seen[SIZE[1] // 2, SIZE[0] // 2] == 0
    assert np.count_nonzero(seen == 0) == pytest.approx(np.pi * (30.0 / 1.02) ** 2, rel=0.01)


def plate(z: float, *, away: bool = False) -> Hull:
    """Return a square of 0.6 mm across the axis, which faces +z or away."""
    points = np.array([[x, y, z] for x, y in ((-3e-4, -3e-4), (3e-4, -3e-4), (3e-4, 3e-4), (-3e-4, 3e-4))])
    facets = np.array([[0, 1, 2], [0, 2, 3]])
    return Hull("plate", points, facets[:, ::-1] if away else facets)


@pytest.mark.law
def test_the_rest_is_seen_through_a_surface_that_is_before_it():
    disc, camera = [body(SHAFT, -0.02, 0.0, 0.7e-3)], along_z(1.0)
    bare = rendered(disc, camera, COLORS).color
    through = rendered(disc, camera, COLORS, [plate(0.01)]).color
    light = 1.0 + LIGHT[2]
    lit = SHADE + (1.0 - SHADE) * light / np.hypot(np.hypot(LIGHT[0], LIGHT[1]), light)
    changed = np.any(through != bare, axis=-1)
    inside = changed & np.roll(changed, 2, axis=(0, 1)) & np.roll(changed, -2, axis=(0, 1))
    expected = bare[inside] + THROUGH * (lit * np.array(COLORS[HOUSING]) - bare[inside])
    np.testing.assert_allclose(through[inside], expected, atol=1e-12)
    change = (through - bare)[..., 0]
    assert change.sum() / change[inside][0] == pytest.approx((60.0 / 0.99) ** 2, rel=0.02)


@pytest.mark.parametrize("hull", [plate(-0.01), plate(0.01, away=True)], ids=["behind", "turned away"])
def test_a_surface_that_is_hidden_or_turned_away_is_not_seen(hull):
    disc, camera = [body(SHAFT, -0.005, 0.0, 0.7e-3)], along_z(1.0)
    assert np.array_equal(rendered(disc, camera, COLORS).color, rendered(disc, camera, COLORS, [hull]).color)


def test_the_housing_of_a_scene_is_in_its_picture_and_stays_small():
    scene, radius = read_model(SceneInput, ROTOR), 0.3
    hull = sphere(24, radius)
    housing = rigid_housing(10.0, 1e8, 0.01, hull)
    parts = bodies_of(TabledScene(scene, {}, dynamic_scene(scene, {}), housings={"case": housing}))
    (written,) = (part for part in parts if part["kind"] == HOUSING)
    drawn = Hull.of(written)
    assert len(hull.triangles) > 2_000 >= len(drawn.facets) > 500
    assert len(repr(written)) < 40_000
    reach = np.linalg.norm(hull.nodes[0])
    np.testing.assert_allclose(np.linalg.norm(drawn.points, axis=1), reach, rtol=1e-6)
    corners = np.moveaxis(drawn.points[drawn.facets], 1, 0)
    enclosed = np.sum(np.cross(corners[0], corners[1]) * corners[2]) / 6.0
    assert enclosed == pytest.approx(4.0 / 3.0 * np.pi * radius**3, rel=0.05), "closed, and faces outwards"
    captions = []
    for unit_parts in (parts, bodies(ROTOR)):
        (section, *_) = with_picture(Page("Title", "", (), ()), unit_parts).sections
        (figure,) = section.figures
        captions.append((figure.caption, figure.picture()))
    (housed, first), (unhoused, second) = captions
    assert housed.endswith(HOUSED) and unhoused.endswith(UNHOUSED)
    assert first != second and len(still(first)) < 60_000


def test_its_camera_shows_all_of_a_unit_and_fills_the_picture():
    parts = unit(PLANETARY)
    seen = rendered(parts, Camera.on(parts, SIZE, (20.0, 10.0)), COLORS).body >= 0
    rows, columns = (np.flatnonzero(np.any(seen, axis=axis)) for axis in (1, 0))
    assert rows[0] in (9, 10, 11)
    assert rows[-1] in (168, 169, 170)
    assert columns[0] >= 19
    assert columns[-1] <= 220


def test_the_bodies_of_a_scene_have_its_sizes():
    by_name = {part.name: part for part in unit(PLANETARY)}
    gears = {name: part for name, part in by_name.items() if part.kind in (PINION, WHEEL)}
    (ring,) = gears["ring gear"].rings
    (sun,) = gears["sun gear"].rings
    planets = [part for name, part in gears.items() if name.startswith("planet")]
    assert len(planets) == 3
    assert gears["ring gear"].kind == WHEEL
    for planet in planets:
        assert np.hypot(*planet.axis) == pytest.approx(97.0045064449e-3)
        reach = planet.rings[0].outer
        assert ring.inner < np.hypot(*planet.axis) + reach < ring.outer, (
            "its teeth are between those of the ring"
        )
        assert sun.outer + reach > np.hypot(*planet.axis)


def test_a_picture_is_small_and_the_same_for_the_same_unit():
    first, again = (unit_png(tuple(unit(PLANETARY))) for _ in range(2))
    assert first == again
    assert len(first) < 150_000
    assert len(still(first)) < 60_000


def pictures(text: str) -> list[str]:
    return re.findall(r'<img class="picture" alt="([^"]*)"', text)


@pytest.mark.parametrize("verb", ["modes", "response", "steady", "deflect"])
def test_the_report_of_a_study_of_a_scene_has_one_picture_of_its_unit(verb, tmp_path):
    page, file = tmp_path / "page.html", tmp_path / "result.nc"
    done = loa(verb, ROTOR, "-o", file)
    assert done.exit_code == 0, done.output
    read = page_of(read_inputs([file]))
    assert [*map(is_picture, read.sections)].count(True) == 1
    assert read.sections[0].title == "Unit"
    write_page(read, page, still_only=True)
    (alternative,) = pictures(page.read_text("utf-8"))
    assert alternative.startswith("The gear unit. 1 shaft and 2 bearings. Shafts: ")
    assert all(figure["plot"]["data"] for one in page_json(read)["sections"] for figure in one["figures"])


def test_results_of_one_scene_bound_together_share_its_picture(tmp_path):
    for verb in ("modes", "deflect"):
        assert loa(verb, ROTOR, "-o", tmp_path / f"{verb}.nc").exit_code == 0
    assert loa("simulate", ROTOR, "-o", tmp_path / "run.nc").exit_code == 0
    for page, files in {"all.html": ["modes.nc", "deflect.nc", "run.nc"], "run.html": ["run.nc"]}.items():
        done = loa("report", *(tmp_path / name for name in files), "-o", tmp_path / page, "--still")
        assert done.exit_code == 0, done.output
        assert len(pictures((tmp_path / page).read_text("utf-8"))) == 1
        assert (tmp_path / page).stat().st_size < 600_000


def test_a_page_with_plots_has_a_picture_that_is_none(tmp_path):
    page = with_picture(Page("Title", "", (), ()), bodies(ROTOR))
    write_page(page, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text("utf-8")
    assert len(pictures(text)) == 1
    assert 'class="plot"' not in text


def test_a_result_without_bodies_has_no_picture():
    page = Page("Title", "", (), ())
    assert with_picture(page, None) == with_picture(page, []) == page


def test_bearings_are_rings_about_their_shafts():
    shaft = next(part for part in unit(ROTOR) if part.kind == SHAFT).rings[0]
    for bearing in (part.rings[0] for part in unit(ROTOR) if part.kind == BEARING):
        assert bearing.inner == pytest.approx(shaft.outer)
        assert bearing.outer == pytest.approx(1.7 * shaft.outer)


def test_the_outside_of_a_bearing_is_that_of_its_catalog_line(tmp_path):
    text = ROTOR.read_text("utf-8")
    line = "{ bore_mm = 25.0, outside_diameter_mm = 62.0, static_rating_n = 11600.0 }"
    bearing = f'name = "ball"\nshaft = "rotor"\nposition_mm = 100.0\ncatalog = {line}\n'
    (tmp_path / "scene.toml").write_text(f"{text}\n[[rolling_bearings]]\n{bearing}", encoding="utf-8")
    (ball,) = (part for part in unit(tmp_path / "scene.toml") if part.name == "ball")
    assert ball.rings[0].outer == pytest.approx(31e-3)
