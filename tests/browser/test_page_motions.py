"""What the three-dimensional picture draws is what it says: bent teeth, bent shafts, motions at a phase."""

import base64
import re
from typing import Any

import numpy as np
import pytest
from page_picture import CANVAS, different, has_room, picture, stopped, vertices
from page_visit import PATIENCE, opened, opened_scene, shown, tab
from playwright.sync_api import Page, expect

from lineofaction.gearbox.convert.outline import outline_json
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated

APART = 4.0  # um, of the flanks
SINE = 2e-5  # rad, of the sines and cosines of shaders
PAIR = """async ({ outline, passage }) => {
  const { RollingPair } = await import("/page/view_pair.js");
  const pair = Object.assign(new RollingPair(), { outline, through: false, curve: { passage } });
  return pair;
}"""
UNIT = """async ({ scene, outline, motion }) => {
  const { Gearbox } = await import("/page/view_unit.js");
  const unit = new Gearbox(scene, [{ mesh: scene.meshes[0], outline }], () => {});
  return Object.assign(unit, { given: motion });
}"""
LENGTH, DISTANCE, STATIONS = 80.0, 22.6, 33
CLOSE = 3e-4  # mm: shaders end the last interval at 0.9999 of it
SCENE: dict[str, Any] = {
    "shafts": [
        {"name": "input", "origin_mm": [0.0, 0.0, 0.0], "length_mm": LENGTH, "diameter_mm": 12.0},
        {"name": "output", "origin_mm": [0.0, -DISTANCE, 0.0], "length_mm": LENGTH, "diameter_mm": 14.0},
    ],
    "gears": [
        {"name": "pinion", "shaft": "input", "position_mm": 30.0},
        {"name": "wheel", "shaft": "output", "position_mm": 30.0},
    ],
    "bushings": [{"name": "left", "shaft": "input", "position_mm": 5.0}],
    "meshes": [{"name": "mesh", "driver": "pinion", "driven": "wheel"}],
}
AT_REST = "subject.move(null)"


@pytest.fixture(scope="module")
def outline():
    """A helical pair as the service outlines it."""
    gear = {"teeth": 20, "face_width_mm": 8.0, "bore_diameter_mm": 10.0}
    pair = {
        "normal_module_mm": 1.0,
        "helix_angle_deg": 12.0,
        "center_distance_mm": DISTANCE,
        "pinion": gear,
        "wheel": gear | {"teeth": 24},
    }
    drawn: dict[str, Any] = outline_json(validated(Case, {"pair": pair, "load": {"torque_n_m": [1.0]}}))
    return drawn


@pytest.fixture(scope="module")
def visit(drawing_browser, address):
    seen = opened(drawing_browser, address)
    yield seen
    seen.page.close()


def rotation(before: np.ndarray, after: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Return the angles by which points (..., 3) are rotated about a center in the transverse plane."""
    a, b = ((points[..., :2] - center) @ [1.0, 1.0j] for points in (before, after))
    return np.angle(b / a)


@pytest.mark.law
def test_teeth_are_bent_by_as_many_times_as_the_switch_says(visit, outline):
    row = [APART, APART]
    places = 121
    passage = {
        "first_place": -3.0,
        "step": 0.05,
        "face_position_mm": outline["pinion"]["face_mm"],
        "pressure_mpa": [[100.0, 100.0]] * places,
        "apart_um": [row] * places,
    }
    steps = [f"subject.bent = {times}" for times in (0, 200, 400, 0)]
    straight, bent, twice, again = vertices(visit.page, PAIR, steps, outline=outline, passage=passage)
    assert all(np.array_equal(a, b) for a, b in zip(straight, again, strict=True))
    drawn = {"pinion": (0, 3), "wheel": (2, 1)}  # calls: what does not carry, the flanks that do
    apart = 0.0
    for name, (steel, flank) in drawn.items():
        gear, center = outline[name], np.array(outline[name]["centre_mm"])
        base = gear["radius_mm"]["base"]
        for call in (steel, flank):
            once = rotation(straight[call], bent[call], center)
            np.testing.assert_allclose(rotation(straight[call], twice[call], center), 2.0 * once, atol=SINE)
        body = np.linalg.norm(straight[steel][:, :2] - center, axis=1) < gear["radius_mm"]["root"] - 0.01
        whole = rotation(straight[steel], bent[steel], center)[body]
        expected = 0.0 if name == "pinion" else 200.0 * 1e-3 * APART / base
        np.testing.assert_allclose(np.abs(whole), expected, atol=SINE)
        tooth = straight[flank].reshape(gear["teeth"], -1, 3)[0]
        middle = np.abs(tooth[:, 2]) < 1e-4
        radius = np.linalg.norm(tooth[middle, :2] - center, axis=1)
        turned = rotation(tooth, bent[flank].reshape(gear["teeth"], -1, 3)[0], center)[middle] - whole[0]
        order = np.argsort(radius)
        pitch = np.linalg.norm(np.array(outline["path_of_contact"]["points_mm"]["C"]) - center)
        apart += abs(np.interp(pitch, radius[order], turned[order])) * base
    np.testing.assert_allclose(apart, 200.0 * 1e-3 * APART, rtol=2e-3)


def motion_of(rng: np.random.Generator, *, oscillates: bool, surface: bool = False) -> dict[str, Any]:
    """Return a motion of both shafts that is none beyond the middle of the input shaft."""
    scale = np.array([1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5])
    still = np.zeros((STATIONS, 6))
    shafts = []
    for shaft in SCENE["shafts"]:
        real, imaginary = (scale * rng.normal(size=(STATIONS, 6)) for _ in range(2))
        if shaft["name"] == "input":
            real[STATIONS // 2 :] = imaginary[STATIONS // 2 :] = 0.0
        shafts.append(
            {
                "name": shaft["name"],
                "position_mm": [0.0, LENGTH],
                "real": real.tolist(),
                "imaginary": (imaginary if oscillates else still).tolist(),
            }
        )
    return {"oscillates": oscillates, "shafts": shafts, "surface": hull_of(rng) if surface else None}


def hull_of(rng: np.random.Generator) -> dict[str, Any]:
    """Return a tetrahedron whose first node stands."""
    place = 30.0 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    moves = [1e-3 * rng.normal(size=(4, 3)) for _ in range(2)]
    for part in moves:
        part[0] = 0.0
    facets = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    arrays = {"place_mm": place, "normal": place / 30.0, "real": moves[0], "imaginary": moves[1]}
    packed = {name: packed_as("<f4", values) for name, values in arrays.items()}
    return packed | {"level_db": None, "facets": packed_as("<u4", facets)}


def packed_as(kind: str, values: np.ndarray) -> str:
    return base64.b64encode(values.astype(kind).tobytes()).decode()


def unpacked(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), "<f4").reshape(-1, 3)


def moved(shaft: dict[str, Any], points: np.ndarray, phase: float, disc: float | None = None) -> np.ndarray:
    """Return what a section, or the disc at a place of a shaft, moves by at its points (n, 3); mm."""
    origin = np.array(next(own["origin_mm"] for own in SCENE["shafts"] if own["name"] == shaft["name"]))
    arm = points - origin
    along = arm[:, 2].copy() if disc is None else np.full(len(points), disc)
    rows = np.array(shaft["real"]) + 1j * np.array(shaft["imaginary"])
    at = np.linspace(*shaft["position_mm"], STATIONS)
    now = np.stack([np.interp(along, at, (np.exp(1j * phase) * row).real) for row in rows.T], axis=-1)
    arm[:, 2] -= along
    return now[:, :3] + np.cross(now[:, 3:], arm)


@pytest.mark.law
@pytest.mark.parametrize("oscillates", [False, True], ids=["deflection", "mode"])
def test_shafts_gears_and_housing_move_as_the_result_says(visit, outline, oscillates):
    motion = motion_of(np.random.default_rng(5), oscillates=oscillates, surface=oscillates)
    half = "subject.motion.phase = Math.PI"
    steps = [
        AT_REST,
        "subject.move(subject.given)",
        "subject.motion.part = 2",
        "subject.motion.part = 0",
        "subject.motion.part = 1; subject.advance(0.4)",
        half,
        "subject.motion.phase = 0; for (let k = 0; k < 50; k += 1) subject.advance(2 / 50)",
    ]
    drawn = vertices(visit.page, UNIT, steps, scene=SCENE, outline=outline, motion=motion)
    rest, once, twice, none, later, opposite, whole = (np.vstack(calls[:7]) for calls in drawn)
    calls, (first, second) = drawn[0], motion["shafts"]
    places = {"pinion": (first, 30.0), "wheel": (second, 30.0)}

    def expected(phase):
        shafts = [moved(first, calls[0], phase), moved(second, calls[1], phase)]
        gears = [moved(*places[name][:1], calls[k], phase, 30.0) for name, k in GEAR_CALLS]
        return np.vstack([*shafts, np.zeros_like(calls[2]), *gears])

    at_once = expected(0.0)
    factor = np.sum((once - rest) * at_once) / np.sum(at_once**2)
    np.testing.assert_allclose(once - rest, factor * at_once, atol=CLOSE)
    np.testing.assert_allclose(twice - rest, 2.0 * (once - rest), atol=2.0 * CLOSE)
    assert np.array_equal(none, rest)
    input_shaft = calls[0]
    stands = input_shaft[:, 2] >= LENGTH / 2.0
    assert np.array_equal(drawn[1][0][stands], input_shaft[stands]), "beyond the node nothing moves"
    assert np.unique(np.round(input_shaft[:, 2], 3)).size == STATIONS, "a shaft bends between its ends"
    if not oscillates:
        return
    np.testing.assert_allclose(later - rest, factor * expected(0.4 * np.pi), atol=CLOSE)
    np.testing.assert_allclose(opposite - rest, rest - once, atol=CLOSE)
    np.testing.assert_allclose(whole, once, atol=CLOSE)
    surface = motion["surface"]
    place, real, imaginary = (unpacked(surface[name]) for name in ("place_mm", "real", "imaginary"))
    facets = np.frombuffer(base64.b64decode(surface["facets"]), "<u4")
    turned = ((real + 1j * imaginary) * np.exp(0.4j * np.pi)).real
    np.testing.assert_allclose(drawn[4][7], (place + factor * turned)[facets], atol=CLOSE)
    assert np.array_equal(drawn[4][7][facets == 0], np.zeros((3, 3))), "a node that does not move stays"


GEAR_CALLS = (("pinion", 3), ("pinion", 4), ("wheel", 5), ("wheel", 6))


def test_a_hollow_shaft_is_seen_through_and_its_bushing_is_as_thick_as_its_wall(visit, outline):
    section = {"length_mm": LENGTH, "outer_diameter_mm": 12.0, "bore_diameter_mm": 8.0}
    solid, output = SCENE["shafts"]
    hollow = {name: value for name, value in solid.items() if name != "diameter_mm"} | {"sections": [section]}
    scene = SCENE | {"shafts": [hollow, output]}
    for drawn, wall in ((SCENE, 6.0), (scene, 2.0)):
        (calls,) = vertices(visit.page, UNIT, [AT_REST], scene=drawn, outline=outline, motion=None)
        shaft, bushing = (np.hypot(calls[k][:, 0], calls[k][:, 1]) for k in (0, 2))
        assert [shaft.min(), shaft.max()] == pytest.approx([6.0 - wall, 6.0], abs=1e-4)
        assert [bushing.min(), bushing.max()] == pytest.approx([6.0, 6.0 + 0.7 * wall], abs=1e-4)


@pytest.mark.law
def test_a_wheel_stands_at_its_own_place_in_mesh(visit, outline):
    shift = 7.0
    pinion, wheel = SCENE["gears"]
    slid = SCENE | {"gears": [pinion, wheel | {"position_mm": wheel["position_mm"] + shift}]}
    steps = [AT_REST, "if (!subject.follow(subject.given)) throw new Error()"]
    before, after = vertices(visit.page, UNIT, steps, scene=SCENE, outline=outline, motion=slid)
    twist = np.radians(outline["wheel"]["twist_deg_per_mm"])
    for name, call in GEAR_CALLS:
        moved = shift if name == "wheel" else 0.0
        center = np.array([0.0, -DISTANCE if name == "wheel" else 0.0])
        np.testing.assert_allclose(after[call][:, 2] - before[call][:, 2], moved, atol=1e-4)
        turned = rotation(before[call], after[call], center)
        np.testing.assert_allclose(turned, twist * moved, atol=1e-4)


@pytest.mark.law
def test_the_largest_motion_is_drawn_with_a_share_of_the_unit(visit, outline):
    drawn = []
    for size in (1.0, 1e-3):
        motion = motion_of(np.random.default_rng(7), oscillates=False)
        for shaft in motion["shafts"]:
            shaft["real"] = (size * np.array(shaft["real"])).tolist()
        steps = [AT_REST, "subject.move(subject.given)"]
        rest, moved_unit = vertices(visit.page, UNIT, steps, scene=SCENE, outline=outline, motion=motion)
        drawn.append(max(np.linalg.norm(b - a, axis=1).max() for a, b in zip(rest, moved_unit, strict=True)))
    extent = 0.5 * np.hypot(LENGTH, DISTANCE) + 0.5 * outline["wheel"]["radius_mm"]["tip"]
    assert 0.04 * extent < drawn[0] <= 0.08 * extent
    assert drawn[1] == pytest.approx(drawn[0], rel=1e-3)


@pytest.mark.law
def test_the_switch_bends_the_teeth_of_the_pair_and_straightens_them(drawing_browser, address, analyzed):
    seen = shown(drawing_browser, address, analyzed)
    page = seen.page
    expect(page.locator(f"{CANVAS}[data-pressed]:not([data-pressed='0'])")).to_have_count(1)
    stopped(page)
    straight, switch = picture(page), page.get_by_label("bent × 200", exact=True)
    switch.check()
    assert different(straight, picture(page)) > 0.002
    switch.uncheck()
    assert different(straight, picture(page)) < 0.0005
    assert seen.complaints == []
    page.close()


def computed_motions(page: Page, process: str) -> list[str]:
    """Compute a study of the scene that is open; returns the motions that are offered then."""
    page.get_by_label("Compute", exact=True).select_option(process)
    before = page.locator("#scene-body [data-figure]").count()
    page.get_by_role("button", name="Compute the scene").press("Enter")
    if before:
        page.locator("#view select:visible").wait_for(state="hidden")
    page.locator("#view select:visible, #scene-body [role=alert]").first.wait_for(timeout=PATIENCE)
    assert page.locator("#scene-body [role=alert]").all_text_contents() == []
    return page.get_by_label("Motion", exact=True).locator("option").all_inner_texts()


@pytest.mark.law
def test_a_unit_in_its_housing_moves_in_a_mode_and_stands_deflected(
    drawing_browser, address, analyzed, tmp_path
):
    seen = shown(drawing_browser, address, analyzed)
    page = seen.page
    tab(page, "Sound")
    opened_scene(page, tmp_path)
    page.locator("#scene-body").get_by_label("number", exact=True).fill("2")
    stopped(page)
    motion, amplitude = page.get_by_label("Motion", exact=True), page.get_by_label("Amplitude", exact=True)
    size = page.locator("#view output")
    walls = next(name for name in computed_motions(page, "modes") if "housing on housing" in name)
    with page.expect_response(re.compile("motion.number")) as answered:
        motion.select_option(walls)
    status = page.locator("#view [role=status]")
    expect(status).to_have_text(walls)
    moving = answered.value.json()["motion"]
    of_shafts = max(np.linalg.norm(row[:3]) for shaft in moving["shafts"] for row in shaft["real"])
    of_walls = np.linalg.norm(unpacked(moving["surface"]["real"]), axis=1)
    assert of_walls.max() > 10.0 * of_shafts, "what is seen to move is the housing"
    assert of_walls.min() < 1e-3 * of_walls.max(), "its feet stand"
    has_room(page)
    amplitude.fill("3")
    mode = picture(page)
    amplitude.fill("0")
    assert different(mode, picture(page)) > 0.003
    expect(size).to_have_text("")
    _, under_load = computed_motions(page, "deflect")
    with page.expect_response(re.compile("motion.number=0")) as answered:
        motion.select_option(under_load)
    expect(status).to_have_text(f"{under_load}. The housing is drawn at rest.")
    shafts = answered.value.json()["motion"]["shafts"]
    largest = max(np.linalg.norm(row[:3]) for shaft in shafts for row in shaft["real"])
    amplitude.fill("1")
    expect(size).to_have_text(re.compile(r"^× [1-9]"))
    has_room(page)
    bent = picture(page)
    times = float(size.inner_text().removeprefix("× "))
    extent = 0.5 * np.linalg.norm([100.0, 80.0]) + 100.0
    assert 0.01 * extent < times * largest < 0.1 * extent
    amplitude.fill("2")
    assert float(size.inner_text().removeprefix("× ")) == pytest.approx(2.0 * times, rel=0.05)
    assert different(bent, picture(page)) > 0.002
    amplitude.fill("0")
    straight = picture(page)
    assert different(bent, straight) > 0.002
    assert seen.complaints == []
    page.close()
