"""A design was edited only where somebody edited it: what the service completes is no edit."""

import tomllib
from typing import Any

import pytest
from page_visit import opened
from playwright.sync_api import Page
from repository import EXAMPLES

from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.inspection.as_made import Inspected, drawn_case, measured_case
from lineofaction.gearbox.inspection.measured_gear import inspected
from lineofaction.gearbox.inspection.sheet import sheet_text
from lineofaction.gearbox.schemas import Case, validated

EDITED = """async ([typed, completed]) => {
  const [{ leaves, at, put }, { Field }, { differences }] = await Promise.all(
    ["schema", "field", "comparison"].map((name) => import(`/page/${name}.js`)));
  const { schema } = (await (await fetch("/v1/processes/analyze")).json()).inputs.case;
  const fields = leaves(schema, schema).map((leaf) => new Field(leaf));
  const content = {};
  for (const field of fields) {
    field.value = at(typed, field.path);
    if (field.value !== undefined) put(content, field.path, field.value);
  }
  const found = differences(fields, completed, content);
  return [content, found.map(({ field, text }) => [field.key, text])];
}"""


def cases() -> dict[str, dict[str, Any]]:
    texts = {file.stem: file.read_text(encoding="utf-8") for file in sorted(EXAMPLES.glob("*.toml"))}
    tables = {name: tomllib.loads(text) for name, text in texts.items() if "_csv" not in text}
    return {name: table for name, table in tables.items() if {"pair", "load"} <= set(table)}


CASES = cases()


@pytest.fixture(scope="module")
def page(browser, address):
    page = opened(browser, address).page
    yield page
    page.close()


def edited(page: Page, typed: dict[str, Any]) -> list[list[str]]:
    """Return what the page calls edited since in a case as typed, of the same as completed."""
    completed = case_json(validated(Case, typed))
    content, found = page.evaluate(EDITED, [typed, completed])
    assert case_json(validated(Case, content)) == completed, "the form holds the case"
    again, twice = page.evaluate(EDITED, [completed, completed])
    assert case_json(validated(Case, again)) == completed
    return [*found, *twice]


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("name", CASES)
def test_what_the_service_completes_is_no_edit(page, name):
    assert edited(page, CASES[name]) == []


def test_a_pair_without_a_tolerance_is_not_edited_by_the_usual_one(page):
    case = CASES["palermo_spur_20_20"]
    for accuracy in ({}, {"level": "draft"}, {"time_budget_s": 5.0}, {"tolerance": 0.02}):
        assert edited(page, case | {"accuracy": accuracy}) == []
    _, found = page.evaluate(EDITED, [case | {"accuracy": {}}, case | {"accuracy": {"tolerance": 0.02}}])
    assert [key for key, *_ in found] == ["accuracy.tolerance"]


def test_measured_and_drawn_gears_pass_the_form(page):
    drawn = drawn_case(validated(Case, CASES["palermo_spur_20_20"]), 6)
    assert edited(page, case_json(drawn)) == []
    of = Inspected("pinion", "left", None)
    measured, _ = measured_case(drawn, sheet_text(inspected(of.chart(drawn))), "pinion.csv", of)
    assert edited(page, case_json(measured)) == []
