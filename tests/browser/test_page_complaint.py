"""The complaint in the bar: fields of the design in the units of who hears it, and the order that it is."""

import math
import re
import tomllib
from pathlib import Path
from typing import Any

import httpx2
import pytest
from page_visit import (
    CASE,
    GEAR,
    control,
    found_inaccessible,
    moved,
    opened,
    other_browser,
    refused,
    shown,
    tab,
)
from playwright.sync_api import Page, Route, expect
from running_service import until

from lineofaction.gearbox.convert.complaint import complaint_of_case
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.reading import validated

PAIR = CASE["pair"] | {"center_distance_mm": 22.0, "wheel": GEAR | {"teeth": 24}}
FIELDS = ("frequency_hz", "speed_rpm", "torque_n_m")
RESTED = 600  # milliseconds after which an edit is a step to undo, and in the address
HEARD = """async (content) => (await import("/page/complaint.js")).heardIn(content)"""
AXES = """async (content) => {
  const { axesOf, heardIn } = await import("/page/complaint.js");
  return axesOf(heardIn(content));
}"""
AT_40 = {"road_speed_km_h": 40.0, "tire_radius_mm": 310.0, "final_ratio": 3.2}
LINES = """node => (node.layout?.shapes ?? []).map(({ xref, x0, x1, y0, y1, label }) => (
  [label.text, xref, x0, x1, y0, y1]))"""
BARS = "node => node.data.at(-1).y.length"
OF_A_RUN = """async ([mark, figure]) => {
  const { mark: put, marked } = await import("/page/plots.js");
  put(mark);
  const { shapes } = marked(figure).layout;
  return (shapes ?? []).map(({ xref, yref, x0, y0 }) => [xref, yref, xref === "x" ? x0 : y0]);
}"""
UNIT = Path(__file__).parents[2] / "examples" / "two_stage_gearbox.rexs"


@pytest.fixture
def visit(browser, address):
    seen = opened(browser, address)
    yield seen
    seen.page.close()


def bar(page: Page) -> dict[str, str]:
    return {name: page.locator(f"#bar-{name}").input_value() for name in FIELDS}


def fields(page: Page) -> dict[str, str]:
    return {name: page.locator(f"#f-complaint-{name}").input_value() for name in FIELDS}


def typed(page: Page, **texts: str) -> None:
    for name, text in texts.items():
        page.locator(f"#bar-{name}").fill(text)


def said(page: Page, text: str) -> None:
    expect(page.locator("#complaint output")).to_have_text(text)


@pytest.mark.law
@pytest.mark.parametrize(
    "complaint",
    [
        {"frequency_hz": 1412.0, "speed_rpm": 2100.0},
        {"frequency_hz": 1453.0, "speed_rpm": 2100.0},
        {"frequency_hz": 1412.0, "speed_rpm": 1765.0, "shaft": "wheel"},
        {"frequency_hz": 880.0, "torque_n_m": 0.7, **AT_40},
        {"frequency_hz": 735.0, "final_shaft": "pinion", "torque_n_m": 0.7, **AT_40},
        {"order": 72.0, "shaft": "wheel"},
        {"order": 40.0, **AT_40},
    ],
)
def test_the_order_is_that_of_the_service(scripts, complaint):
    case = CASE | {"pair": PAIR, "complaint": complaint}
    known = complaint_of_case(validated(Case, case))
    heard = scripts.evaluate(HEARD, case)
    assert heard["order"] == pytest.approx(known.order * known.per_pitch)
    assert heard["harmonic"] == known.within[0].harmonic
    assert heard["torque"] == known.torques["pair"]


@pytest.mark.law
def test_axes_have_the_complaint_as_it_is_stated(scripts):
    stated = {"frequency_hz": 1412.0, "speed_rpm": 1765.0, "shaft": "wheel", "torque_n_m": 0.7}
    orders = dict.fromkeys(("harmonic of the mesh", "order of the mesh", "mesh order"), 2.0)
    others = {
        "frequency, Hz": 1412.0,
        "speed of the driving gear, rpm": 1765.0 * 24 / 20,
        "torque on the driving gear, N m": 0.7,
    }
    axes = scripts.evaluate(AXES, CASE | {"pair": PAIR, "complaint": stated})
    assert axes == pytest.approx(orders | others, rel=1e-12)
    assert scripts.evaluate(AXES, CASE) == {}


@pytest.mark.parametrize(
    "stated", [{"frequency_hz": 1486.0}, {"frequency_hz": 1453.0, "tolerance_percent": 3.0}]
)
def test_what_is_no_harmonic_to_the_service_is_none_in_the_bar(scripts, stated):
    case = CASE | {"pair": PAIR, "complaint": stated | {"speed_rpm": 2100.0}}
    with pytest.raises(BadInput, match="of what passes"):
        complaint_of_case(validated(Case, case))
    assert scripts.evaluate(HEARD, case)["harmonic"] is None


@pytest.mark.law
def test_bar_form_undo_address_and_file_have_one_complaint(visit, browser):
    page = visit.page
    page.get_by_label("Unit of the complaint's frequency").select_option("kHz")
    typed(page, frequency_hz="1,4", speed_rpm="1812", torque_n_m="80")
    assert fields(page) == {"frequency_hz": "1400", "speed_rpm": "1812", "torque_n_m": "80"}
    said(page, "order 46.36 of the pinion, harmonic 2 (−0.77 %)")
    page.wait_for_timeout(RESTED)
    control(page, "#f-complaint-frequency_hz").fill("1500")
    assert bar(page) == {"frequency_hz": "1.5", "speed_rpm": "1812", "torque_n_m": "80"}
    said(page, "order 49.67 of the pinion, no harmonic within 5 %")
    page.wait_for_timeout(RESTED)
    page.locator("#undo").press("Enter")
    expect(page.locator("#bar-frequency_hz")).to_have_value("1.4")
    page.get_by_label("Unit of the complaint's frequency").select_option("Hz")
    assert bar(page)["frequency_hz"] == fields(page)["frequency_hz"] == "1400"
    with page.expect_download() as saved:
        page.locator("#export-toml").press("Enter")
    kept = tomllib.loads(saved.value.path().read_text("utf-8"))["complaint"]
    assert kept == {"frequency_hz": 1400, "speed_rpm": 1812, "torque_n_m": 80}
    until(lambda: "case=" in page.url)
    page.wait_for_timeout(RESTED)
    with other_browser(browser, page.url) as sent:
        assert bar(sent) == bar(page)
    page.get_by_role("button", name="Another variant").press("Enter")
    expect(page.get_by_role("button", name="Variant B")).to_have_attribute("aria-pressed", "true")
    typed(page, torque_n_m="120")
    page.wait_for_timeout(RESTED)
    page.get_by_role("button", name="Variant A").press("Enter")
    expect(page.locator("#bar-torque_n_m")).to_have_value("80")
    assert visit.complaints == []


@pytest.mark.law
def test_a_road_speed_is_in_the_bar_once_the_tire_is_known_and_reads_as_rpm(visit):
    page = visit.page
    typed(page, frequency_hz="1400", speed_rpm="1812")
    expect(page.locator("#bar-road_speed_km_h")).to_be_hidden()
    for name, text in {"tire_radius_mm": "310", "final_ratio": "4"}.items():
        control(page, f"#f-complaint-{name}").fill(text)
    expect(page.locator("#bar-speed_rpm")).to_be_hidden()
    typed(page, road_speed_km_h="40")
    assert fields(page)["speed_rpm"] == "", "either of them"
    rpm = 40 / 3.6 / (2 * 3.141592653589793 * 0.31) * 60 * 4 * 67 / 23
    page.get_by_label("Unit of the complaint's road speed").select_option("rpm")
    assert float(page.locator("#bar-road_speed_km_h").input_value()) == pytest.approx(rpm, rel=1e-5)
    typed(page, road_speed_km_h=str(2 * rpm))
    assert float(page.locator("#f-complaint-road_speed_km_h").input_value()) == pytest.approx(80.0)


def test_what_is_refused_is_marked_in_the_bar(visit):
    page = visit.page
    typed(page, frequency_hz="1.4", speed_rpm="1812")
    field = page.locator("#bar-frequency_hz")
    expect(field).to_have_attribute("aria-invalid", "true")
    told = page.locator(f"#{field.get_attribute('aria-describedby')}")
    expect(told).to_contain_text("In kHz? Then write 1400")
    typed(page, frequency_hz="1400")
    expect(field).to_have_attribute("aria-invalid", "false")


@pytest.mark.parametrize("width", [1400, 400])
def test_the_complaint_is_typed_by_keyboard_at_any_width(browser, address, width):
    visit = opened(browser, address, width=width)
    page = visit.page
    page.locator("#dock-fold").focus()
    stops = []
    for text in ("", "1400", "", "1812", "80"):  # the button, the frequency and its unit, speed, torque
        page.keyboard.press("Tab")
        stops.append(page.evaluate("document.activeElement.id"))
        page.keyboard.type(text)
    assert [stop for stop in stops if stop] == [f"bar-{name}" for name in FIELDS]
    said(page, "order 46.36 of the pinion, harmonic 2 (−0.77 %)")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    edges = page.locator("#complaint > :not([hidden])").evaluate_all(
        "all => all.map((node) => node.getBoundingClientRect().right)"
    )
    assert max(edges) <= width
    assert found_inaccessible(page, ".bar") == {}
    page.get_by_role("button", name="Complaint", exact=True).press("Enter")
    assert page.evaluate("document.activeElement.id") == "f-complaint-frequency_hz"
    assert visit.complaints == []
    page.close()


@pytest.mark.law
@pytest.mark.parametrize("width", [1440, 1920])
def test_the_bar_is_one_line_with_a_complaint_and_three_variants(browser, address, width):
    visit = opened(browser, address, width=width)
    page = visit.page
    for _ in range(2):
        page.get_by_role("button", name="Another variant").press("Enter")
    typed(page, frequency_hz="1400", speed_rpm="1812", torque_n_m="80")
    boxes = page.locator(".bar > :not(.unseen, .hidden-file), #complaint > :not([hidden])").evaluate_all(
        "all => all.map((node) => node.getBoundingClientRect())"
    )
    bar_box = page.locator(".bar").bounding_box()
    assert bar_box is not None and bar_box["height"] < 48.0
    assert all(box["right"] <= width for box in boxes)
    words = page.locator("#complaint output")
    assert words.evaluate("node => node.scrollWidth <= node.clientWidth"), "nothing of the words is cut"
    visit.page.close()


@pytest.mark.law
def test_the_order_is_marked_in_the_plots_of_the_pair_as_it_is_typed(browser, address, analyzed):
    visit = shown(browser, address, analyzed)
    page = visit.page
    live, spectrum = (
        control(page, f"[data-figure={key}] .plot") for key in ("live_harmonics", "ste_spectrum")
    )
    typed(page, frequency_hz="990", speed_rpm="1500")  # 20 teeth: 500 Hz of the mesh
    for plot in (live, spectrum):
        until(lambda plot=plot: plot.evaluate(LINES) == [["complaint", "x", 1.98, 1.98, 0, 1]])
    typed(page, frequency_hz="1500")
    for plot in (live, spectrum):
        until(lambda plot=plot: plot.evaluate(LINES) == [["complaint", "x", 3, 3, 0, 1]])
    for times, harmonics in ((12, 12), (25, 8), (3, 8)):  # a curve has twenty
        typed(page, frequency_hz=str(500 * times))
        marks = [["complaint", "x", times, times, 0, 1]] if times <= harmonics else []
        until(lambda marks=marks: live.evaluate(LINES) == marks)
        until(lambda harmonics=harmonics: live.evaluate(BARS) == harmonics)
        rows = page.locator("#live-ripple details th[scope=row]", has_text=re.compile(r"^harmonic \d+$"))
        expect(rows).to_have_count(harmonics)
    said_of_sound = page.locator("#live-sound output")
    expect(said_of_sound).to_have_text("The complaint, at 1500 rpm, passes after 0.60 s.")
    control(page, "#sound-from").fill("1600")
    expect(said_of_sound).to_be_empty()
    tab(page, "Ripple")
    assert page.locator("[data-figure=live_ste] .plot").evaluate(LINES) == [], "positions have no order"
    typed(page, speed_rpm="")
    control(page, "[data-figure=live_harmonics] .plot")
    until(lambda: live.evaluate(LINES) == [])
    assert visit.complaints == []
    page.close()


@pytest.mark.law
def test_a_complaint_of_a_design_without_a_result_is_typed_after_one_with(browser, address, analyzed):
    """The parts of the page that belong to the result are gone, and nothing looks for them."""
    visit = opened(browser, f"{address}/#database={analyzed}")
    page = visit.page
    expect(page.locator("#sound-from")).to_have_count(1)
    control(page, "#example").select_option("empty")
    expect(page.locator("#sound-from")).to_have_count(0)
    page.locator("#bar-frequency_hz").fill("933")
    page.locator("#bar-speed_rpm").fill("2800")
    control(page, "#f-pair-pinion-teeth").fill("20")
    page.wait_for_timeout(RESTED)
    assert visit.complaints == []
    page.close()


def test_an_order_map_is_marked_on_both_axes_and_what_came_with_marks_keeps_them(visit):
    axes = {"mesh order": 2.0, "speed of the driving gear, rpm": 1500.0}
    speed, order = ({"title": {"text": text}} for text in reversed(axes))
    run = {
        "data": [{"x": [0, 3000], "y": [0, 8], "z": [[0, 1], [1, 0]]}],
        "layout": {"xaxis": speed, "yaxis": order},
    }
    marked = visit.page.evaluate(OF_A_RUN, [axes, run])
    assert sorted(marked) == [["x", "y domain", 1500], ["x domain", "y", 2]]
    beyond = run | {"layout": {"xaxis": speed | {"range": [0, 1000]}, "yaxis": order | {"range": [0, 8]}}}
    assert visit.page.evaluate(OF_A_RUN, [axes, beyond]) == [["x domain", "y", 2]]
    own = run | {"layout": run["layout"] | {"annotations": [{"text": "complaint, 1400 Hz"}]}}
    assert visit.page.evaluate(OF_A_RUN, [axes, own]) == []


ROWS = """() => [...document.querySelectorAll("#live-figures > div")].map((row) => [...row.children]
  .map((part) => part.textContent).join(": ")).filter((text) => text.startsWith("complaint"))"""
LEVEL = re.compile(r"(−?[\d.]+)(?: dB)? ± ([\d.]+)")
CHANGE = re.compile(r"([+−][\d.]+) ± ([\d.]+)")
STATED = """async (heard) => {
  const { besideFigures, heardFigures } = await import("/page/live_numbers.js");
  const plain = (cell) => (cell.text ?? cell).replace("\\u00a0", " ");
  const said = (remarks) => remarks.filter(Boolean).map((part) => part.text ?? part).join("; ");
  const words = ([name, value, remarks]) => [name, value, said(remarks)];
  const more = { torque_n_m: 80, flanks: { k_h_beta: null }, error_by_source_um: {} };
  const curves = heard.curves.map((own) => ({ ...own, curve: { ...more, ...own.curve } }));
  heard = { ...heard, curves };
  const rows = besideFigures(curves, heard).rows.slice(0, 2);
  return [heardFigures(heard).map(words), rows.map((row) => row.map(plain))];
}"""
BESIDE = """() => [...document.querySelectorAll("#compared tbody tr")].slice(0, 2).map((row) => (
  [...row.children].map((cell) => cell.textContent.replace("\\u00a0", " "))))"""


def in_rest(page: Page, count: int) -> list[str]:
    """Return the levels of the complaint once they have their bands."""
    rows: list[str] = []

    def stated():
        rows[:] = page.evaluate(ROWS)
        return len(rows) == count and not any("…" in row for row in rows)

    until(stated)
    return rows


@pytest.mark.law
def test_levels_have_the_band_of_their_error_and_changes_that_of_both(visit):
    def curve(amplitude, error):
        return {"harmonics_um": [9.0, amplitude], "harmonics_error_um": [9.0, error]}

    def stated(*curves):
        named = [{"name": name, "curve": each} for name, each in zip("AB", curves, strict=True)]
        heard = {"harmonic": 2, "torque": 80.0, "curves": named}
        figures: list[list[list[str]]] = visit.page.evaluate(STATED, heard)
        return figures

    # 20 lg 0.2 = -13.98, -20 lg 0.9 = 0.915, 20 lg 0.1 = -20
    name = "complaint, harmonic 2 at 80 N m"
    assert stated(curve(0.2, 0.02), curve(0.1, 0.01)) == [
        [[name, "−20.00 dB", "± 0.92 re 1 µm; change −6.0 ± 1.3 dB from A"]],
        [
            [f"{name}, dB re 1 µm", "−13.98 ± 0.92", "−20.00 ± 0.92"],
            ["the same, dB from A", "", "−6.0 ± 1.3"],
        ],
    ]
    alone, beside = stated(curve(0.2, 0.02), curve(0.05, 0.1))  # 20 lg((0.05 + 0.1) / (0.2 - 0.02))
    assert alone[0][1:] == ["below −20.0 dB", "its error; change below −1.6 dB from A"]
    assert [cells[2] for cells in beside] == ["below −20.0 (its error)", "below −1.6"]


@pytest.mark.law
def test_the_dock_has_the_level_of_the_complaint_of_both_variants_at_its_torque(browser, address, analyzed):
    visit = shown(browser, address, analyzed)
    page = visit.page
    typed(page, frequency_hz="1000", speed_rpm="1500", torque_n_m="0.7")  # 20 teeth: harmonic 2
    (row,) = in_rest(page, 1)
    expect(page.locator(".design-note")).to_have_count(0)  # no curve depends on what is heard
    answer = httpx2.post(f"{address}/v1/databases/{analyzed}/ste", json={"torque_n_m": [0.7]}, timeout=60.0)
    (curve,) = answer.json()["curves"]
    amplitude, error = (curve[name][1] for name in ("harmonics_um", "harmonics_error_um"))
    level = number(LEVEL, row, 1)
    assert level == pytest.approx(20.0 * math.log10(amplitude), abs=0.06)
    assert number(LEVEL, row, 2) == pytest.approx(-20.0 * math.log10(1.0 - error / amplitude), rel=0.06)
    assert " from " not in row, "nothing was moved"
    page.get_by_role("button", name="Another variant").press("Enter")
    expect(page.get_by_role("button", name="Variant B")).to_have_attribute("aria-pressed", "true")
    moved(page, "#live-torque_n_m", "End")
    sent: list[dict[str, Any]] = []
    page.on("request", lambda request: sent.append(request.post_data_json) if "/ste" in request.url else None)
    moved(page, "#live-pinion-tip_relief_um", "End")
    levels, changes = beside_at_rest(page)
    assert_at_rest(sent)
    assert levels[0] == "complaint, harmonic 2 at 0.7 N m, dB re 1 µm"
    assert changes[:2] == ["the same, dB from A", ""]
    assert number(LEVEL, levels[1], 1) == level, "A stands"
    assert number(CHANGE, changes[2], 1) == pytest.approx(number(LEVEL, levels[2], 1) - level, abs=0.16)
    moved(page, "#live-torque_n_m", "Home")
    assert beside_at_rest(page) == [levels, changes], "the torque is the complaint's"
    typed(page, torque_n_m="500")
    until(lambda: page.evaluate(BESIDE)[0] == ["complaint, harmonic 2 at 500 N m", "none", "none"])
    typed(page, frequency_hz="1100")
    until(lambda: "complaint" not in str(page.evaluate(BESIDE)))
    assert found_inaccessible(page, "#dock") == {}
    assert visit.complaints == []
    page.close()


def beside_at_rest(page: Page) -> list[list[str]]:
    """Return the rows of the complaint of both variants once they have their bands."""
    rows: list[list[str]] = []

    def stated():
        rows[:] = page.evaluate(BESIDE)
        return "complaint" in str(rows) and "…" not in str(rows)

    until(stated)
    return rows


def assert_at_rest(sent: list[dict[str, Any]]) -> None:
    """The level of the complaint is requested after the answer at rest: no slider waits for it."""
    own = ["-complaint" in body["caller"] for body in sent]
    assert any(own)
    *moving, rested = [bool(body.get("preview")) for body in sent[: own.index(True)] if body.get("passage")]
    assert moving and all(moving) and not rested


def number(pattern: re.Pattern[str], text: str, group: int) -> float:
    found = pattern.search(text)
    assert found is not None, text
    return float(found[group].replace("−", "-"))


MESHES = (
    """async ([scene, complaint]) => (await import("/page/unit_heard.js")).meshesHeard(scene, complaint)"""
)


@pytest.mark.law
def test_meshes_of_a_unit_are_heard_by_the_teeth_on_the_way(visit):
    def mesh(name, driver, driven, teeth):
        pair = {gear: {"teeth": count} for gear, count in zip(("pinion", "wheel"), teeth, strict=True)}
        return {"name": name, "driver": driver, "driven": driven, "case": {"pair": pair}}

    shafts = {"a": "input", "b": "middle", "c": "middle", "d": "output", "e": "alone", "f": "alone too"}
    scene = {
        "gears": [{"name": name, "shaft": shaft} for name, shaft in shafts.items()],
        "meshes": [
            mesh("in", "a", "b", (20, 60)),
            mesh("out", "c", "d", (18, 54)),
            mesh("no", "e", "f", (9, 9)),
        ],
    }
    heard = visit.page.evaluate(MESHES, [scene, {"frequency_hz": 560.0, "speed_rpm": 2800.0}])
    assert [each["name"] for each in heard] == ["in", "out"], "what no mesh drives has no speed"
    first, second = heard
    assert first["frequency"] == pytest.approx(2800 / 60 * 20)
    assert second["frequency"] == pytest.approx(2800 / 60 * 20 / 60 * 18)
    assert (first["harmonic"], second["harmonic"]) == (None, 2)
    assert second["off"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.law
def test_a_complaint_that_is_typed_while_a_unit_opens_is_kept(visit):
    """What was typed before belongs to the design that is left."""
    page, waiting = visit.page, list[Route]()

    def hold(route):
        waiting.append(route)

    page.locator("#bar-torque_n_m").fill("77")
    page.locator("#import-file").set_input_files(UNIT)
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value("20")
    assert bar(page) == dict.fromkeys(FIELDS, "")
    page.route("**/v1/units/open", hold)
    page.locator("#import-file").set_input_files(UNIT)
    until(lambda: page.wait_for_timeout(20) or waiting)
    page.locator("#bar-frequency_hz").fill("933")
    page.locator("#bar-speed_rpm").fill("2800")
    waiting[0].continue_()
    page.unroute("**/v1/units/open")
    expect(page.locator("#unit-heard")).to_contain_text("cylindrical_stage 21 at 933.3 Hz: harmonic 1")
    assert bar(page) == {"frequency_hz": "933", "speed_rpm": "2800", "torque_n_m": ""}
    expect(page.locator("#f-complaint-frequency_hz")).to_have_value("933")
    page.locator("#bar-frequency_hz").fill("1300")
    expect(page.locator("#unit-heard")).to_contain_text("at 933.3 Hz: no harmonic near")


@pytest.mark.law
def test_what_another_mesh_of_a_unit_makes_is_not_submitted_with_the_open_pair(visit):
    """The plan, Analyze and studies of the pair are as without it; the bar and the address keep it."""
    page = visit.page
    page.locator("#import-file").set_input_files(UNIT)
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value("20")
    page.locator("#unit button", has_text="cylindrical_stage 21").press("Enter")
    for frequency, submitted in (("1300", False), ("933", True)):  # 20 teeth at 2800 rpm: 933 Hz
        typed(page, frequency_hz=frequency, speed_rpm="2800")
        expect(page.locator("#unit-heard")).to_contain_text(re.compile(rf"^At {frequency}\b"))
        for _ in range(2):
            expect(page.locator("#plan")).to_contain_text("of one processor")
            expect(page.locator("#form-errors")).to_be_hidden()
            for process, name in (("analyze", "Analyze"), ("optimize", "Search better flanks")):
                with refused(page, process) as sent:
                    page.get_by_role("button", name=name).first.press("Enter")
                    until(lambda sent=sent: page.wait_for_timeout(20) or sent)
                assert ("complaint" in sent[0]["case"]) == submitted
            until(lambda frequency=frequency: bar(page)["frequency_hz"] == frequency)
            page.reload()
            page.wait_for_selector("html[data-ready=yes]")
