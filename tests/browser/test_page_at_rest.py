"""What the page computes while no slider moves: peak-to-peak over torque, the band of pairs as made."""

import re
from typing import Any

import pytest
from page_visit import moved, tab
from playwright.sync_api import expect
from running_service import until

ROWS = """async (key) => {
  const { TorqueCurve } = await import("/page/torque_curve.js");
  const curve = new TorqueCurve(2, "test", () => {});
  document.querySelector("#sliders").append(curve.node);
  const flanks = { misalignment_um: 0, pinion: { tip_relief_um: 4, tip_relief_length_mm: 0.4 }, wheel: {} };
  const now = { torque_n_m: 1, peak_to_peak_um: 0.1, period: 1 };
  const look = { name: "now", color: "#0072B2", width: 2 };
  await curve.follow([{ asked: { key, flanks }, curve: now, ...look }], () => false);
  return curve.of({ key, flanks }).rows;
}"""
SINGLE = """async ([key, torque]) => {
  const { post } = await import("/page/api.js");
  const pinion = { tip_relief_um: 4, tip_relief_length_mm: 0.4 };
  return (await post(`/v1/databases/${key}/ste`, { torque_n_m: [torque], pinion })).curves[0];
}"""


@pytest.fixture
def asked(visit):
    """Return the live questions of the page from now on."""
    found: list[dict[str, Any]] = []
    visit.page.on(
        "request", lambda request: request.url.endswith("/ste") and found.append(request.post_data_json)
    )
    return found


@pytest.mark.law
def test_the_curve_over_torque_has_what_each_torque_has_by_itself(visit, analyzed):
    tab(visit.page, "Flanks, live")
    rows = visit.page.evaluate(ROWS, analyzed)
    torques = [row["torque"] for row in rows]
    assert torques == sorted(torques) and len(torques) == 16 and torques[-1] == 2.0
    for row in rows[::5]:
        single = visit.page.evaluate(SINGLE, [analyzed, row["torque"]])
        assert row["ripple"] == pytest.approx(single["peak_to_peak_um"], rel=1e-6, abs=0.0)
        bias = single["error_by_source_um"]["finite_width"]["peak_to_peak"]
        own = (single["peak_to_peak_error_um"] ** 2 - bias**2) ** 0.5
        assert row["error"] == pytest.approx(own, rel=0.01, abs=0.0)  # an estimate


@pytest.mark.law
def test_the_torque_of_the_slider_stands_under_its_thumb(visit):
    page = visit.page
    tab(page, "Flanks, live")
    page.wait_for_selector(".torque-curve[data-drawn]")
    slider, mark = page.locator("#live-torque_n_m"), page.locator(".torque-curve .mark").last
    for key, part in (("Home", 0.01), ("End", 1.0)):
        moved(page, "#live-torque_n_m", key)
        track = slider.bounding_box()
        assert track is not None
        there = track["x"] + 8.0 + part * (track["width"] - 16.0)

        def off(there=there):
            box = mark.bounding_box()
            return 1e3 if box is None else abs(box["x"] + 0.5 * box["width"] - there)

        until(lambda: off() < 2.0)


@pytest.mark.law
def test_a_slider_that_moves_asks_for_one_torque(visit, asked):
    page = visit.page
    tab(page, "Flanks, live")
    page.wait_for_selector(".torque-curve[data-drawn]")
    asked.clear()
    for _ in range(5):
        page.locator("#live-pinion-tip_relief_um").press("ArrowRight")
    expect(page.locator(".torque-curve")).to_have_class(re.compile("passed"))
    expect(page.locator(".torque-curve")).not_to_have_class(re.compile("passed"))
    quick = [question for question in asked if question.get("preview")]
    many = [question for question in asked if len(question["torque_n_m"]) > 1]
    assert quick and all(len(question["torque_n_m"]) == 1 for question in quick)
    assert [len(question["torque_n_m"]) for question in many] == [8, 8]
    assert asked.index(many[0]) > asked.index(quick[-1])
    expect(page.locator(".torque-curve .band")).to_have_count(2)  # as analyzed and now, with their errors
    asked.clear()
    moved(page, "#live-torque_n_m", "End")
    page.wait_for_timeout(500)
    assert [len(question["torque_n_m"]) for question in asked] == [1] * len(asked), "it is known already"
    assert visit.complaints == []


def test_what_nobody_sees_is_not_computed(visit, asked):
    page = visit.page
    tab(page, "Loads")
    page.wait_for_timeout(500)
    asked.clear()
    page.evaluate("() => document.querySelector('#live-torque_n_m').dispatchEvent(new Event('input'))")
    page.wait_for_timeout(1500)
    assert any(not question["preview"] for question in asked)
    assert all(len(question["torque_n_m"]) == 1 for question in asked)
    tab(page, "Flanks, live")
    page.wait_for_selector(".torque-curve[data-drawn]")


BANDS = """node => (node.data ?? []).filter((trace) => trace.fill).map(({ fillcolor, x, y }) => {
  const half = x.length / 2;
  const low = y.slice(half).reverse();
  return { fillcolor, width: Math.max(...low.map((value, k) => y[k] - value)), x: x.slice(0, half) };
})"""


@pytest.mark.law
def test_the_band_of_a_class_is_drawn_and_goes_away_with_its_switch(visit, asked):
    page = visit.page
    page.wait_for_selector("[data-figure=live_ste] .plot[data-drawn]")
    curve, words = page.locator("[data-figure=live_ste] .plot"), page.locator(".made-band output")
    assert curve.evaluate(BANDS) == [] and not any("tolerance_class" in question for question in asked)
    page.locator("#band-on").check()
    expect(words).to_contain_text("nine of ten pairs within class 6, as the case states none")
    expect(words).to_contain_text(re.compile(r"± .* µm peak to peak, .*; 1000 drawn, 16 of them solved\."))
    until(lambda: len(curve.evaluate(BANDS)) == 1)
    (band,) = curve.evaluate(BANDS)
    assert band["fillcolor"] == "#0072B233" and band["width"] > 0.0  # 20 % of the color of the line
    assert (band["x"][0], band["x"][-1]) == (0.0, 2.0)
    page.locator("#band-class").fill("4")
    page.locator("#band-class").press("Tab")
    expect(words).to_contain_text("within class 4 have")
    until(lambda: curve.evaluate(BANDS)[0]["width"] < band["width"])
    asked.clear()
    moved(page, "#live-torque_n_m", "End")
    until(lambda: len(curve.evaluate(BANDS)) == 1)
    quick = [question for question in asked if question.get("passage") and question["preview"]]
    assert quick and not any("tolerance_class" in question for question in quick)
    page.locator("#band-on").uncheck()
    until(lambda: curve.evaluate(BANDS) == [])
    expect(words).to_be_empty()
    assert visit.complaints == []


STATED = """async (stated) => {
  const { MadeBand } = await import("/page/made_band.js");
  const made = new MadeBand({ errors: { misalignment_class: stated } }, "test", () => {});
  const ends = { low_um: 1, high_um: 2, error_um: 0.1 };
  const of = { tolerance_class: Number(made.class.value), pairs: 1000, of: 16 };
  return made.said("now", { ...of, peak_to_peak: ends, first_harmonic: ends });
}"""


def test_the_class_is_that_of_the_case_where_it_states_one(visit):
    assert "within class 8, that of the case, have" in visit.page.evaluate(STATED, 8)
    assert "within class 6, as the case states none, have" in visit.page.evaluate(STATED, None)
