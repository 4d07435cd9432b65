"""Live curves as sounds: twice the ripple is twice as loud, and a sweep ends where it should."""

from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

RENDERED = """async ({ voices, sweep }) => {
  const { sounded, strength } = await import("/page/live_sound.js");
  const full = Math.max(...voices.map((voice) => strength(voice, sweep)));
  return Promise.all(voices.map(async (voice) => {
    const context = new OfflineAudioContext(1, 48000 * sweep.seconds, 48000);
    sounded(context, voice, sweep, full);
    return [...(await context.startRendering()).getChannelData(0)];
  }));
}"""
SWEEP = {"from": 1200, "to": 2400, "seconds": 1}


def rendered(page: Page, *harmonics: list[float]) -> np.ndarray:
    """Return the samples of voices with 20 teeth (voices, samples)."""
    voices: list[dict[str, Any]] = [
        {"name": str(k), "teeth": 20, "harmonics": h} for k, h in enumerate(harmonics)
    ]
    return np.array(page.evaluate(RENDERED, {"voices": voices, "sweep": SWEEP}))


@pytest.mark.law
def test_levels_of_live_sounds_are_in_the_ratio_of_what_excites_them(scripts):
    single, double, second = rendered(scripts, [0.1], [0.2], [0.0, 0.1])
    level = np.sqrt(np.mean(np.square([single, double, second]), axis=1))
    assert level[1] / level[0] == pytest.approx(2.0, rel=1e-3)
    assert level[2] / level[0] == pytest.approx(2.0, rel=0.02)  # twice the frequency: twice the velocity
    assert 0.4 < np.abs(double).max() <= 0.501
    together = rendered(scripts, [0.1] * 6, [0.1])[0]
    assert 0.2 < np.abs(together).max() <= 0.501, "harmonics together stay within the scale"


@pytest.mark.law
def test_a_live_sound_sweeps_over_the_mesh_frequencies(scripts):
    (samples,) = rendered(scripts, [0.1])
    edges = np.flatnonzero((samples[:-1] < 0.0) & (samples[1:] >= 0.0)) / 48000.0
    frequency, at = 1.0 / np.diff(edges), edges[:-1]
    for moment, rpm in ((0.25, 1500), (0.75, 2100)):
        assert np.interp(moment, at, frequency) == pytest.approx(20 * rpm / 60, rel=0.02)


HEARD = """async () => {
  const { heardAt } = await import("/page/order_tone.js");
  const { Tone } = await import("/page/live_sound.js");
  const map = { x: [0, 600, 1200], y: [1, 2], z: [[40, 54, 60], [0, 0, 20]], zmax: 60 };
  const track = { along: [0, 1200], mesh_hz: [0, 400] };
  const heard = (x, order) => heardAt(map, track, { x, order });
  const tone = async ({ frequency, part }) => {
    const context = new OfflineAudioContext(1, 24000, 24000);
    new Tone(context).sound(frequency, part);
    return [...(await context.startRendering()).getChannelData(0)].slice(12000);
  };
  const places = [heard(1200, 1), heard(610, 1.1), heard(600, 2)];
  return { places, tones: await Promise.all(places.map(tone)) };
}"""


@pytest.mark.law
def test_an_order_of_the_map_is_heard_at_its_frequency_and_level(scripts):
    heard = scripts.evaluate(HEARD)
    assert [place["frequency"] for place in heard["places"]] == pytest.approx([400.0, 1.1 * 610 / 3, 400.0])
    loudest, softer, silent = (np.array(tone) for tone in heard["tones"])
    assert np.abs(loudest).max() == pytest.approx(0.5, rel=1e-3)
    assert np.abs(softer).max() == pytest.approx(0.5 * 10 ** (-6 / 20), rel=1e-3)
    assert np.abs(silent).max() < 1e-6
    assert np.count_nonzero(np.diff(np.sign(loudest)) > 0.0) == pytest.approx(200, abs=1)


FOLLOWED = """async () => {
  const { orderTone } = await import("/page/order_tone.js");
  const set = [];
  const own = AudioParam.prototype.setTargetAtTime;
  AudioParam.prototype.setTargetAtTime = function (value, ...how) {
    set.push(value);
    return own.call(this, value, ...how);
  };
  const node = document.createElement("div");
  node.innerHTML = '<div class="nsewdrag"></div>';
  const place = { position: "fixed", left: "50px", top: "60px", width: "400px", height: "200px" };
  Object.assign(node.firstChild.style, place);
  document.body.append(node);
  node.data = [{ x: [0, 3000, 6000], y: [1, 2, 3], z: [[9, 9, 9], [9, 9, 9], [9, 9, 9]], zmax: 9 }];
  const title = { text: "speed, rpm" };
  node.layout = { xaxis: { range: [1000, 5000], title }, yaxis: { range: [0.5, 3.5] } };
  const sound = { tracks: [{ along: [6000, 2000, 6000], mesh_hz: [2000, 2000 / 3, 2000] }] };
  const row = orderTone(node, { title: "map", sound });
  row.querySelector("button").click();
  const heard = [[0, 0.5], [0.25, 0.5], [0.5, 0.25], [0.9, 0.9]].map(([across, up]) => {
    set.length = 0;
    const [clientX, clientY] = [50 + 400 * across, 260 - 200 * up];
    node.dispatchEvent(new PointerEvent("pointermove", { clientX, clientY }));
    return [1000 + 4000 * across, 0.5 + 3 * up, ...set, row.querySelector("output").textContent];
  });
  AudioParam.prototype.setTargetAtTime = own;
  row.querySelector("button").click();
  node.remove();
  return heard;
}"""


@pytest.mark.law
def test_the_tone_follows_the_cursor_over_speed_and_order(scripts):
    """A run down and up again: speeds below its least one sound as that one."""
    for speed, order, frequency, level, said in scripts.evaluate(FOLLOWED):
        assert frequency == pytest.approx(order * max(speed, 2000.0) / 3.0)
        assert level == pytest.approx(0.5)
        assert f"at {speed:.0f}" in said.replace(".0", "")


def test_the_sound_tab_plays_what_is_shown(visit):
    visit.page.get_by_role("tab", name="Sound", exact=True).click()
    for name in ("Play as analyzed", "Play now"):
        button = visit.page.get_by_role("button", name=name, exact=True)
        expect(button).to_be_visible()
        button.click()
    assert visit.complaints == []
