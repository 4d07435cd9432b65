"""A scene of one's own on the page: written for the pair, edited, opened from a file, computed, refused."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from page_visit import Visit, shown
from playwright.sync_api import Browser, expect

EXAMPLE = Path(__file__).parents[2] / "examples" / "planetary_scene.toml"


@pytest.fixture(scope="module")
def visit(browser: Browser, address: str, analyzed: str) -> Iterator[Visit]:
    seen = shown(browser, address, analyzed)
    yield seen
    seen.page.close()


def test_the_scene_of_the_pair_is_edited_and_computed_over_speed(visit: Visit, analyzed: str) -> None:
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
    page.get_by_label("Speeds from, rpm").fill("500")
    page.get_by_label("number", exact=True).fill("5")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    plot = page.locator("#scene-body [data-figure=response] .plot")
    expect(plot).to_have_attribute("data-drawn", "yes")
    speeds = page.locator("#scene-body .js-plotly-plot").evaluate("node => node.data[0].x.length")
    assert speeds == 5


def test_many_runs_at_constant_speeds_are_drawn_over_speed(visit: Visit, analyzed: str) -> None:
    page = visit.page
    page.get_by_role("button", name="Write the scene of the pair").press("Enter")
    text = page.get_by_label("Scene, TOML")
    expect(text).to_have_value(re.compile("database_hash"))
    text.fill(text.input_value().replace("duration_s = 1.0", "duration_s = 0.1"))
    page.get_by_label("Compute", exact=True).select_option("study")
    page.get_by_label("number", exact=True).fill("3")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    for name in ("study_curves", "study_distribution", "study_tornado"):
        expect(page.locator(f"#scene-body [data-figure={name}] .plot")).to_have_attribute("data-drawn", "yes")
    assert visit.complaints == []


def test_a_scene_that_cannot_be_used_is_refused_by_field(visit: Visit) -> None:
    page = visit.page
    refused = page.locator("#scene-body [role=alert]")
    page.get_by_label("Scene, TOML").fill("[run]\nduration_s = 1.0\nend_s = 3.0\n")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    expect(refused).to_contain_text("run.end_s must be")


def test_a_scene_file_is_opened_and_what_it_names_by_file_is_refused(visit: Visit) -> None:
    page = visit.page
    page.locator("#scene-file").set_input_files(EXAMPLE)
    expect(page.get_by_label("Scene, TOML")).to_have_value(EXAMPLE.read_text(encoding="utf-8"))
    page.get_by_role("button", name="Compute the scene").press("Enter")
    expect(page.locator("#scene-body [role=alert]")).to_contain_text("meshes[0]")
    assert visit.complaints == []
