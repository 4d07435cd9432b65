"""A scene of one's own on the page: written for the pair, edited, opened from a file, computed, refused."""

import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from faulty_units import LEFT_OUT, TWO_STAGE
from housing_solid import STIFFNESS, housed_scene, write_block
from page_picture import CANVAS, different, picture, stopped
from page_visit import PATIENCE, Visit, found_inaccessible, opened, other_browser, refused, shown, tab
from playwright.sync_api import Page, expect
from running_service import until

from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas.toml import toml_text

UNIT = Path(__file__).parents[2] / "examples" / "two_stage_gearbox.rexs"
EXAMPLE = Path(__file__).parents[2] / "examples" / "planetary_scene.toml"


@pytest.fixture(scope="module")
def visit(browser, address, analyzed):
    seen = shown(browser, address, analyzed)
    tab(seen.page, "Sound")
    tab(seen.page, "TOML")
    yield seen
    seen.page.close()


def test_the_scene_of_the_pair_is_edited_and_computed_over_speed(visit, analyzed):
    page = visit.page
    page.get_by_role("button", name="Write the scene of the pair").press("Enter")
    text = page.get_by_label("Scene, TOML")
    expect(text).to_have_value(re.compile("database_hash"))
    scene = tomllib.loads(text.input_value())
    assert scene["meshes"][0]["database_hash"] == analyzed
    text.fill(
        text.input_value().replace("radial_stiffness_n_per_m = 100000000.0", "radial_stiffness_n_per_m = 5e7")
    )
    page.get_by_label("Compute", exact=True).select_option("response")
    page.locator("#scene-body").get_by_label("Speeds from, rpm").fill("500")
    page.locator("#scene-body").get_by_label("number", exact=True).fill("5")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    plot = page.locator("#scene-body [data-figure=response] .plot")
    expect(plot).to_have_attribute("data-drawn", "yes")
    speeds = page.locator("#scene-body .js-plotly-plot").first.evaluate("node => node.data[0].x.length")
    assert speeds == 5


def test_a_run_and_every_study_of_a_scene_are_offered(visit):
    offered = visit.page.get_by_label("Compute", exact=True).locator("option")
    names = offered.evaluate_all("options => options.map((option) => option.value)")
    assert names == ["simulate", *(name for name, study in STUDIES.items() if "scene" in study.takes.subject)]


def test_the_last_run_is_heard_at_a_microphone(visit, tmp_path):
    page = visit.page
    step, file = write_block(tmp_path / "block.step"), tmp_path / "scene.toml"
    scene = housed_scene(tmp_path)
    scene["run"]["duration_s"] = 0.2
    scene["drives"][0] |= {"time_s": [0.0], "speed_rpm": [6000.0]}
    scene["meshes"][0] |= {"database_file": None, "stiffness": STIFFNESS}
    file.write_text(toml_text(scene), encoding="utf-8")
    page.locator("#scene-file").set_input_files([file, step])
    expect(page.get_by_text("With block.step.")).to_be_visible()
    process, compute = (
        page.get_by_label("Compute", exact=True),
        page.get_by_role("button", name="Compute the scene"),
    )
    process.select_option("simulate")
    compute.press("Enter")
    expect(page.locator("#scene-body [data-figure=order_map] .plot")).to_have_attribute("data-drawn", "yes")
    map_of_orders = page.locator("#scene-body [data-figure=order_map]")
    hear = map_of_orders.get_by_role("button", name="Hear orders of: Order map")
    hear.press("Enter")
    hear.press("ArrowRight")
    expect(map_of_orders.locator("output")).to_contain_text("Order 1.00 at")
    expect(map_of_orders.locator("output")).to_contain_text("2000 Hz")  # 20 teeth at 6000 rpm
    map_of_orders.locator(".plot").hover()
    expect(map_of_orders.locator("output")).not_to_contain_text("Order 1.00 at")
    hear.press("Enter")
    expect(map_of_orders.locator("output")).to_be_empty()
    process.select_option("listen")
    page.get_by_label("Microphone x, y, z, mm").fill("40, 60, 400")
    compute.press("Enter")
    level = page.locator("#scene-body [data-figure=heard_level]")
    refused = page.locator("#scene-body [role=alert]")
    level.or_(refused).first.wait_for(timeout=PATIENCE)
    assert refused.all_text_contents() == []
    expect(level.locator(".plot")).to_have_attribute("data-drawn", "yes")
    expect(page.locator("#scene-body .headline")).to_contain_text("dB(A)")
    level.get_by_role("button", name="Listen to: Level of the sound pressure").press("Enter")
    player = level.locator("audio")
    until(lambda: player.evaluate("one => one.readyState") > 0)
    assert player.evaluate("one => one.duration") == pytest.approx(0.2, abs=1e-3)


def test_many_runs_at_constant_speeds_are_drawn_over_speed(visit, analyzed):
    page = visit.page
    page.get_by_role("button", name="Write the scene of the pair").press("Enter")
    text = page.get_by_label("Scene, TOML")
    expect(text).to_have_value(re.compile("database_hash"))
    text.fill(text.input_value().replace("duration_s = 1.0", "duration_s = 0.1"))
    page.get_by_label("Compute", exact=True).select_option("study")
    page.locator("#scene-body").get_by_label("number", exact=True).fill("3")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    for name in ("study_curves", "study_distribution", "study_tornado"):
        expect(page.locator(f"#scene-body [data-figure={name}] .plot")).to_have_attribute("data-drawn", "yes")
    assert visit.complaints == []


def test_a_scene_that_cannot_be_used_is_refused_by_field(visit):
    page = visit.page
    refused = page.locator("#scene-body [role=alert]")
    page.get_by_label("Scene, TOML").fill("[run]\nduration_s = 1.0\nend_s = 3.0\n")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    expect(refused).to_contain_text("run.end_s must be")


def test_a_scene_file_is_opened_and_what_it_names_by_file_is_refused(visit):
    page = visit.page
    page.locator("#scene-file").set_input_files(EXAMPLE)
    expect(page.get_by_label("Scene, TOML")).to_have_value(EXAMPLE.read_text(encoding="utf-8"))
    page.get_by_role("button", name="Compute the scene").press("Enter")
    expect(page.locator("#scene-body [role=alert]")).to_contain_text("meshes[0]")
    assert visit.complaints == []


def test_a_scene_is_opened_where_cases_are(visit):
    page = visit.page
    page.locator("#import-file").set_input_files(EXAMPLE)
    expect(page.get_by_label("Scene, TOML")).to_have_value(EXAMPLE.read_text(encoding="utf-8"))
    expect(page.locator("#scene-tables")).to_be_visible()
    expect(page.get_by_text("This case cannot be computed")).to_have_count(0)
    tab(page, "TOML")


def test_files_chosen_with_a_scene_go_with_it(visit):
    page = visit.page
    scene, case = (EXAMPLE.with_name(f"{name}.toml") for name in ("palermo_scene", "palermo_spur_20_20"))
    page.locator("#scene-file").set_input_files([case, scene])
    expect(page.get_by_label("Scene, TOML")).to_have_value(scene.read_text(encoding="utf-8"))
    expect(page.get_by_text("With palermo_spur_20_20.toml.")).to_be_visible()
    page.get_by_label("Compute", exact=True).select_option("simulate")
    with refused(page, "simulate") as sent:
        page.get_by_role("button", name="Compute the scene").press("Enter")
        expect(page.locator("#scene-body [role=alert]")).to_contain_text("Not now")
    (mesh,) = sent[0]["scene"]["meshes"]
    assert mesh["case"]["pair"]["pinion"]["teeth"] == 20
    assert mesh.get("case_file") is None


def test_a_reload_and_a_second_browser_show_the_edited_scene_with_its_files(browser, address, tmp_path):
    step, file = write_block(tmp_path / "block.step"), tmp_path / "scene.toml"
    scene = housed_scene(tmp_path)
    scene["meshes"][0] |= {"database_file": None, "stiffness": STIFFNESS}
    file.write_text("# as typed\n" + toml_text(scene), encoding="utf-8")
    with other_browser(browser, f"{address}/#tab=sound") as page:
        page.locator("#scene-file").set_input_files([file, step])
        expect(page).to_have_url(re.compile("toml="))
        text, files = page.locator("#scene-text"), page.locator("#scene-body")
        written = text.input_value()
        assert "# as typed" in written
        page.reload()
        expect(files).to_contain_text("With block.step.")
        expect(text).to_have_value(written)
        length, known = page.locator("#scene-shafts-0-length_mm"), page.url
        length.fill("231.5")
        length.press("Tab")
        expect(text).to_have_value(re.compile("length_mm = 231.5"))
        expect(page).not_to_have_url(known)
        with other_browser(browser, page.url) as second:
            expect(second.locator("#scene-shafts-0-length_mm")).to_have_value("231.5")
            expect(second.locator("#scene-body")).to_contain_text("With block.step.")
            assert second.locator("#scene-text").input_value() == text.input_value()


def test_the_card_of_a_gear_unit_begins_with_what_is_left_out(visit):
    page = visit.page
    _, edit, _ = LEFT_OUT["hand of a wheel"]
    file = {"name": "hand.rexs", "mimeType": "application/xml", "buffer": edit(TWO_STAGE).encode()}
    page.locator("#import-file").set_input_files(file)
    first = page.locator("#unit > :first-child")
    expect(first).to_contain_text('Left out of the scene: cylindrical_stage 22 "second stage" (line 326)')
    expect(page.locator("#unit > [role=alert]")).to_have_count(6)
    assert visit.complaints == []


def test_the_matrix_of_a_unit_is_a_file_beside_its_scene(visit):
    """The text has no line that nobody reads, and the scene that is computed has the matrix."""
    page = visit.page
    file: Any = {"name": "two_stage.rexs", "mimeType": "text/xml", "buffer": TWO_STAGE.encode()}
    page.locator("#import-file").set_input_files(file)
    page.get_by_role("button", name="Open scene", exact=True).press("Enter")
    expect(page.get_by_text("With housing_stiffness.csv.")).to_be_visible()
    text = page.get_by_label("Scene, TOML").input_value()
    assert 'stiffness_file = "housing_stiffness.csv"' in text
    assert max(map(len, text.splitlines())) < 300
    refused = {"status": 422, "json": {"title": "Not now", "status": 422}}  # others wait for the worker
    page.route("**/execution", lambda route: route.fulfill(**refused))
    tab(page, "TOML")
    with page.expect_request("**/v1/drafts/scene-text") as sent:
        page.get_by_label("Scene, TOML").press("End")
        page.keyboard.type(" ")
        page.get_by_role("button", name="Compute the scene").press("Enter")
    expect(page.locator("#scene-body [role=alert]")).to_contain_text("Not now")
    page.unroute("**/execution")
    assert [part["name"] for part in sent.value.post_data_json["files"]] == ["housing_stiffness.csv"]
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save scene").last.press("Enter")
    assert saved.value.suggested_filename == "scene.toml"


def test_a_gear_unit_is_deflected_under_the_load_cases_of_its_file(visit):
    page = visit.page
    page.locator("#import-file").set_input_files(UNIT)
    page.get_by_role("button", name="Open scene", exact=True).press("Enter")
    text, cases = page.get_by_label("Scene, TOML"), page.get_by_text("A deflection takes the load cases")
    expect(text).to_have_value(re.compile(r'\[\[bushings\]\]\nname = "concept_bearing 31"'))
    expect(cases).to_contain_text("of two_stage_gearbox.rexs: load case 1, load case 2, load case 3.")
    page.get_by_label("Compute", exact=True).select_option("deflect")
    compute = page.get_by_role("button", name="Compute the scene")
    with refused(page, "deflect") as sent:
        compute.press("Enter")
        expect(page.locator("#scene-body [role=alert]")).to_contain_text("Not now")
        page.get_by_role("button", name="Leave them out").press("Enter")
        expect(cases).to_have_count(0)
        with page.expect_response("**/processes/deflect/execution"):
            compute.press("Enter")
    assert [case["torque_n_m"] for case in sent[0]["load_cases"]] == [50.0, 80.0, 30.0]
    assert len(sent[0]["scene"]["bushings"]) == 6
    assert "load_cases" not in sent[1]


def test_flanks_of_a_unit_are_searched_by_what_is_heard(visit):
    """Of the mesh whose pair is typed, under the load cases of the file, over the speeds of the card."""
    page = visit.page
    page.locator("#import-file").set_input_files(UNIT)
    page.get_by_role("button", name="Open scene", exact=True).press("Enter")
    expect(page.get_by_text("A deflection takes the load cases")).to_be_visible()
    page.get_by_label("Compute", exact=True).select_option("optimize")
    page.locator("#scene-body").get_by_label("Speeds from, rpm").fill("400")
    with refused(page, "optimize") as sent:
        with page.expect_response("**/processes/optimize/execution"):
            page.get_by_role("button", name="Compute the scene").press("Enter")
        expect(page.locator("#scene-body [role=alert]")).to_contain_text("Not now")
    first = next(mesh for mesh in sent[0]["scene"]["meshes"] if mesh.get("case"))
    heard = sent[0]["heard"]
    assert heard["mesh"] == first["name"] and heard["speed_rpm"][0] == 400
    assert [case["torque_n_m"] for case in heard["load_cases"]] == [50.0, 80.0, 30.0]


def test_a_deflection_shows_its_tables_of_bearings(visit):
    page = visit.page
    page.locator("#scene-file").set_input_files(EXAMPLE.with_name("jeffcott_scene.toml"))
    page.get_by_label("Compute", exact=True).select_option("deflect")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    table = page.locator("#scene-body table", has_text="Bearings under the load cases")
    expect(table).to_be_visible()
    expect(table.locator("tbody tr")).to_have_count(2)
    expect(page.locator("#scene-body .lead")).to_have_text(re.compile(r"Nothing meshes\.$"))
    assert visit.complaints == []


SHOWN = "#view [role=status]"
HELD = "The unit of the scene, which has no mesh with a pair to draw."
BARE = """[run]
duration_s = 1.0

[[shafts]]
name = "bar"
diameter_mm = 20.0
length_mm = 300.0
"""


def errors(seen: Visit) -> list[str]:
    """Return all that is logged as an error, refused requests too."""
    return [line for line in seen.console if line.startswith("error")]


def shows_scene(page: Page, words: str) -> np.ndarray:
    expect(page.locator(SHOWN)).to_have_text(words)
    return picture(page)


@pytest.mark.law
def test_the_picture_follows_the_scene_that_is_edited(drawing_browser, address, analyzed):
    seen = shown(drawing_browser, address, analyzed)
    page, words = seen.page, "The unit of the scene: click a mesh to open its pair."
    stopped(page)
    pair = picture(page)
    tab(page, "Sound")
    page.get_by_role("button", name="Write the scene of the pair").press("Enter")
    whole = shows_scene(page, words)
    assert different(pair, whole) > 0.05
    page.locator(CANVAS).press("ArrowUp")
    turned = picture(page)
    length, text = page.locator("#scene-shafts-1-length_mm"), page.get_by_label("Scene, TOML")
    length.fill("290")
    length.press("Tab")
    expect(text).to_have_value(re.compile("length_mm = 290.0"))
    longer = picture(page)
    assert different(turned, longer) > 0.01
    length.fill("-3")
    length.press("Tab")
    expect(length).to_have_attribute("aria-invalid", "true")
    assert different(longer, picture(page)) < 0.002, "the last good picture stays"
    length.fill("200")
    length.press("Tab")
    expect(length).to_have_attribute("aria-invalid", "false")
    until(lambda: different(turned, picture(page)) < 0.002)  # seen from where it was seen
    tab(page, "TOML")
    with page.expect_response("**/v1/drafts/scene-text"):
        text.fill(text.input_value().replace("length_mm = 200.0", "length_mm = 260.0"))
    until(lambda: different(turned, picture(page)) > 0.01)
    expect(text).to_be_focused()
    page.get_by_role("button", name="See the pair", exact=True).press("Enter")
    assert different(pair, picture(page)) < 0.002
    expect(page).not_to_have_url(re.compile("see="))
    page.get_by_role("button", name="Show in the picture").press("Enter")
    expect(page).to_have_url(re.compile("see=scene"))
    shows_scene(page, words)
    assert found_inaccessible(page, "#view") == {}
    page.reload()
    stopped(page)
    assert different(pair, shows_scene(page, words)) > 0.05
    assert errors(seen) == []
    page.close()


@pytest.mark.law
def test_a_scene_without_meshes_is_drawn_as_it_is_typed(drawing_browser, address):
    """From nothing: a shaft, another one, then none, which is a fault, then a file with shafts alone."""
    seen = opened(drawing_browser, f"{address}/#tab=sound")
    page = seen.page
    stopped(page)
    tab(page, "TOML")
    text, canvas = page.get_by_label("Scene, TOML"), page.locator(CANVAS)
    text.fill(BARE)
    bar = shows_scene(page, HELD)
    expect(canvas).to_have_attribute("aria-label", re.compile("^Gear unit with 1 shaft and 0 meshes, in"))
    other = BARE.partition("\n\n")[2].replace("bar", "other")
    text.fill(f"{BARE}{other}origin_mm = [0.0, 90.0, 0.0]\n")
    expect(canvas).to_have_attribute("aria-label", re.compile("^Gear unit with 2 shafts and 0 meshes, in"))
    both = picture(page)
    assert different(bar, both) > 0.01
    text.fill("[run]\nduration_s = 1.0\n")
    expect(page.locator("#scene-body")).to_contain_text("The scene has faults")
    assert different(both, picture(page)) < 0.002
    text.fill(EXAMPLE.with_name("jeffcott_scene.toml").read_text(encoding="utf-8"))
    expect(canvas).to_have_attribute("aria-label", re.compile("^Gear unit with 1 shaft and 0 meshes, in"))
    assert errors(seen) == []
    page.close()


@pytest.mark.law
def test_a_pair_that_cannot_be_made_is_said_under_the_last_picture(drawing_browser, address):
    seen = opened(drawing_browser, f"{address}/#tab=sound")
    page = seen.page
    stopped(page)
    scene, case = (EXAMPLE.with_name(f"{name}.toml") for name in ("palermo_scene", "palermo_spur_20_20"))
    page.locator("#scene-file").set_input_files([case, scene])
    shows_scene(page, "The unit of the scene: click a mesh to open its pair.")
    page.locator(SHOWN).evaluate("(node) => { node.style.opacity = '0'; }")
    whole = picture(page)
    far = case.read_text(encoding="utf-8").replace("center_distance_mm = 80.0", "center_distance_mm = 800.0")
    texts = {case.name: far, scene.name: scene.read_text(encoding="utf-8")}
    files: Any = [
        {"name": name, "mimeType": "text/plain", "buffer": text.encode()} for name, text in texts.items()
    ]
    page.locator("#scene-file").set_input_files(files)
    expect(page.locator(SHOWN)).to_contain_text("the contact ratio is")
    assert different(whole, picture(page)) < 0.002
    assert errors(seen) == []
    page.close()


@pytest.mark.law
def test_a_planet_stage_shows_its_first_planet_where_the_wheel_drives_too(drawing_browser, address):
    seen = opened(drawing_browser, f"{address}/#tab=sound")
    names = (
        "wind_turbine_scene",
        *(f"wind_turbine_{pair}" for pair in ("planet_sun", "planet_ring", "high_speed")),
    )
    seen.page.locator("#scene-file").set_input_files([EXAMPLE.with_name(f"{name}.toml") for name in names])
    expect(seen.page.locator(SHOWN)).to_have_text(
        "The unit of the scene: click a mesh to open its pair. Of planets the first is drawn."
    )
    assert errors(seen) == []
    seen.page.close()


@pytest.mark.law
def test_a_browser_without_webgl_follows_the_scene_by_still_pictures(browser, address):
    seen = opened(browser, f"{address}/#tab=sound")
    page, canvas = seen.page, seen.page.locator(CANVAS)
    tab(page, "TOML")
    text = page.get_by_label("Scene, TOML")
    for words, content in (
        ("1 shaft", BARE),
        ("2 shafts", BARE + BARE.partition("\n\n")[2].replace("bar", "end")),
    ):
        text.fill(content)
        expect(canvas).to_have_attribute("aria-label", f"Gear unit with {words} and 0 meshes")
        expect(canvas).to_have_attribute("data-drawn", "yes")
    expect(page.locator("#mesh-drawing")).to_be_hidden()
    page.get_by_role("button", name="See the pair", exact=True).press("Enter")
    expect(page.locator("#mesh-drawing path").first).to_be_visible()
    assert errors(seen) == []
    page.close()
