"""What is painted on flanks of the rolling pair: contact lines where they touch, colors of the pressure."""

import base64
import re
from typing import Any

import numpy as np
import pytest
from page_picture import CANVAS, stopped
from page_visit import Visit, opened, shown
from playwright.sync_api import Page, expect
from running_service import until

from lineofaction.gearbox.convert.outline import outline_json
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated

SIZE, ACROSS, UP = 300, 1.6, 4.5  # pixels; mm from the middle of a picture to its edges
TOP = 200.0  # MPa, end of the scale
STEEL = {"pinion": (0.60, 0.64, 0.69), "wheel": (0.79, 0.80, 0.80)}
PAINTED = """async ({ outline, name, position, pressure, size, top, view }) => {
  const { RollingPair, programsOf } = await import("/page/view_pair.js");
  const canvas = Object.assign(document.createElement("canvas"), { width: size, height: size });
  const gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true });
  const draw = gl.drawElementsInstanced.bind(gl);
  gl.drawElementsInstanced = (...all) => draw(...all.slice(0, -1), 1); // tooth 0
  const rows = (value) => Array.from({ length: 121 }, () => [value, value]);
  const tables = { pressure_mpa: rows(pressure), apart_um: rows(0) };
  const table = { first_place: -3, step: 0.05, face_position_mm: outline.pinion.face_mm, ...tables };
  const pair = Object.assign(new RollingPair(), { outline, position, top, curve: { passage: table } });
  gl.viewport(0, 0, size, size);
  pair.begin(gl, programsOf(gl));
  gl.bindTexture(gl.TEXTURE_2D, pair.texture);
  pair.gear(gl, name, ["FLANK"], { view: new Float32Array(view), back: [0, 0, 1], moving: false }, 1);
  const pixels = new Uint8Array(4 * size * size);
  gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let text = "";
  for (let k = 0; k < pixels.length; k += 8192) text += String.fromCharCode(...pixels.subarray(k, k + 8192));
  return btoa(text);
}"""


@pytest.fixture(scope="module")
def outline():
    """A helical pair as the service outlines it."""
    gear = {"teeth": 20, "face_width_mm": 8.0, "bore_diameter_mm": 10.0}
    gears = {"pinion": gear, "wheel": gear | {"teeth": 24}}
    pair = {"normal_module_mm": 1.0, "helix_angle_deg": 12.0, "center_distance_mm": 22.6, **gears}
    drawn: dict[str, Any] = outline_json(validated(Case, {"pair": pair, "load": {"torque_n_m": [1.0]}}))
    return drawn


@pytest.fixture(scope="module")
def page(drawing_browser, address):
    seen = opened(drawing_browser, address)
    yield seen.page
    seen.page.close()


def of_action(outline: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the pitch point and the directions along the line of action, to E, and across it."""
    start, pitch, end = (np.array(outline["path_of_contact"]["points_mm"][name]) for name in "ACE")
    along = (end - start) / np.linalg.norm(end - start)
    return pitch, along, np.array([-along[1], along[0]])


def painted(
    page: Page, outline: dict[str, Any], name: str, right: np.ndarray, position: float, pressure: float
) -> np.ndarray:
    """Return the colors (rows, columns, 4) of the flank of tooth 0: z upwards, a direction to the right."""
    pitch, along, across = of_action(outline)
    depth = across if right is along else along
    rows = [[*right / ACROSS, 0.0, -right @ pitch / ACROSS], [0.0, 0.0, 1.0 / UP, 0.0]]
    rows += [[*depth / 100.0, 0.0, -depth @ pitch / 100.0], [0.0, 0.0, 0.0, 1.0]]
    values = {"outline": outline, "name": name, "position": position, "pressure": pressure}
    view = np.array(rows).T.ravel().tolist()
    text = page.evaluate(PAINTED, values | {"size": SIZE, "top": TOP, "view": view})
    return np.frombuffer(base64.b64decode(text), np.uint8).reshape(SIZE, SIZE, 4).astype(float)


def middle_of_line(colors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return z and the place to the right of the middle of the red line in each row that has it, mm."""
    red = (colors[..., 0] > 150.0) & (colors[..., 1] < 80.0)
    rows = np.flatnonzero(red.sum(axis=1) > 0)
    at = (2.0 * np.arange(SIZE) + 1.0) / SIZE - 1.0
    return UP * at[rows], ACROSS * np.array([at[red[row]].mean() for row in rows])


@pytest.mark.law
@pytest.mark.parametrize("position", [0.2, -0.3])
@pytest.mark.parametrize("name", ["pinion", "wheel"])
def test_contact_lines_lie_in_the_plane_of_action_where_the_position_has_them(page, outline, name, position):
    _, along, across = of_action(outline)
    pitch_mm = outline["path_of_contact"]["base_pitch_mm"]
    pinion = outline["pinion"]
    slope = pinion["radius_mm"]["base"] * np.radians(pinion["twist_deg_per_mm"])
    z, beside = middle_of_line(painted(page, outline, name, across, position, 0.05 * TOP))
    assert z.min() < -3.5 and z.max() > 3.5, "over the whole face"
    np.testing.assert_allclose(beside, 0.0, atol=0.06)
    z, place = middle_of_line(painted(page, outline, name, along, position, 0.05 * TOP))
    assert abs(slope * z).max() > 0.5
    np.testing.assert_allclose(place, position * pitch_mm - slope * z, atol=0.1)


LEGEND = """() => {
  const node = document.createElement("span");
  node.className = "view-scale";
  document.body.append(node);
  const { backgroundImage } = getComputedStyle(node, "::before");
  node.remove();
  return backgroundImage;
}"""


def legend(page: Page, part: float) -> np.ndarray:
    """Return the color of the scale beside the picture at a part of its length."""
    stops = re.findall(r"rgb\((\d+), (\d+), (\d+)\)(?: (\d+)%)?", page.evaluate(LEGEND))
    at = [float(stop[3] or 100.0 * (k > 0)) / 100.0 for k, stop in enumerate(stops)]
    return np.array([np.interp(part, at, [float(stop[k]) / 255.0 for stop in stops]) for k in range(3)])


@pytest.mark.law
@pytest.mark.parametrize("name", STEEL)
def test_a_flank_has_the_color_of_the_scale_at_its_pressure(page, outline, name):
    """Seven parts of the scale over three of steel, both lit: each channel says how bright a place is."""
    for part in (0.1, 0.4, 0.7, 1.0):
        colors = painted(page, outline, name, of_action(outline)[2], 0.2, part * TOP)
        beside = colors[:, np.abs(ACROSS * (2.0 * np.arange(SIZE) / SIZE - 1.0)) > 0.4]  # the line
        seen = np.unique(beside[beside[..., 3] > 250.0][:, :3], axis=0) / 255.0
        seen = seen[np.ptp(seen / STEEL[name], axis=1) > 0.02]  # beyond the ends of contact it is steel
        assert len(seen) > 0
        scale = legend(page, part)
        lit = (seen - 0.35 * scale) / (0.35 * scale + 0.3 * np.array(STEEL[name]))
        assert np.ptp(lit, axis=1).max() < 0.08, (part, lit)


OPACITIES = """async ({ outline, positions, size }) => {
  const { RollingPair, programsOf } = await import("/page/view_pair.js");
  const { Camera } = await import("/page/view_camera.js");
  const { context } = await import("/page/view_gl.js");
  const canvas = Object.assign(document.createElement("canvas"), { width: size, height: size });
  const gl = canvas.getContext("webgl2", { ...context.getContextAttributes(), preserveDrawingBuffer: true });
  const [pair, camera] = [Object.assign(new RollingPair(), { outline }), new Camera()];
  pair.frame(camera);
  gl.viewport(0, 0, size, size);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  pair.begin(gl, programsOf(gl));
  const [count, pixels] = [Array(256).fill(0), new Uint8Array(4 * size * size)];
  for (const position of positions) {
    pair.position = position;
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    pair.draw(gl, { view: camera.matrix(1), back: camera.back, moving: true, picking: false });
    gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    for (let k = 3; k < pixels.length; k += 4) count[pixels[k]] += 1;
  }
  return count;
}"""
"""Draws the pair as it rolls; counts pixels by their opacity, in 255."""


@pytest.mark.law
def test_a_wheel_that_is_seen_through_covers_each_pixel_once(page, outline):
    """Neighboring teeth overlap; where both were painted, pixels flashed while the pair rolled."""
    positions = np.linspace(0.0, 5.0, 40).tolist()
    counts = np.array(page.evaluate(OPACITIES, {"outline": outline, "positions": positions, "size": 600}))
    far, near = 0.5, 0.2
    expected = 255.0 * np.array([0.0, far, near, 1.0 - (1.0 - far) * (1.0 - near), 1.0])
    counted = np.flatnonzero(counts)
    assert np.abs(counted[:, None] - expected).min(axis=1).max() <= 2.0, dict(
        zip(counted, counts[counted], strict=True)
    )
    assert (counts[[126, 127, 128, 129]].sum() > 0 or counts[[152, 153, 154]].sum() > 0) and counts[255] > 0


BENT = """async () => {
  const { RollingPair } = await import("/page/view_pair.js");
  const own = RollingPair.prototype.place;
  RollingPair.prototype.place = function (...all) { window.bent = this.bent; return own.apply(this, all); };
}"""


def test_the_switch_bends_as_many_times_as_it_says(drawing_browser, address, analyzed):
    seen: Visit = shown(drawing_browser, address, analyzed)
    seen.page.evaluate(BENT)
    stopped(seen.page)
    switch = seen.page.locator("#view label").filter(has_text="bent ×")
    times = float(switch.inner_text().rpartition("×")[2])
    switch.get_by_role("checkbox").check()
    until(lambda: seen.page.evaluate("window.bent"))
    assert seen.page.evaluate("window.bent") == times
    expect(seen.page.locator(CANVAS)).to_be_visible()
    seen.page.close()


SHARED = """async (curve) => (await import("/page/live_figures.js")).sharingFigure(curve).data.map(
  ({ name, x, y }) => [name, x, y])"""


@pytest.mark.law
def test_the_share_of_a_pair_goes_on_with_its_place_over_two_pitches(page):
    """A pair is a base pitch further with each number and with each pitch of the position."""

    def share(place):
        return np.clip((0.8 - np.abs(place)) / 0.6, 0.0, 1.0)

    position, pair = np.arange(0.0, 1.0, 0.125), np.array([-1, 0])
    curve = {"position": position.tolist(), "period": 1, "pair": pair.tolist()}
    drawn = page.evaluate(SHARED, curve | {"load_share": share(position[:, None] + pair).tolist()})
    assert {name for name, _, _ in drawn} == {"pair -2", "pair -1", "pair 0"}
    for name, x, y in drawn:
        expected = share(np.array(x) + float(name.split()[1]))
        np.testing.assert_allclose([value or 0.0 for value in y], expected, atol=1e-9)
        assert max(x) == 2.0
