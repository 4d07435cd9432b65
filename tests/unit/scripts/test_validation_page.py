"""The validation page holds every figure, in an order that reads."""

import json
from typing import Any

import validation_page


def figure(name: str, kind: str = "validation", **changes: Any) -> dict[str, Any]:
    test = f"tests/{kind}/test_a.py::test_b[{name}]"
    record = {
        "name": name,
        "value": 1.25,
        "target": "at most 2 %",
        "unit": "%",
        "source": "ISO",
        "kind": kind,
    }
    return record | {"test": test} | changes


def test_every_figure_is_a_row():
    page = validation_page.page([figure("mean"), figure("level", value=16.2813, target=16.28, unit="1")])
    assert "| mean | 1.25 | at most 2 % | % |" in page
    assert "| level | 16.2813 | 16.28 |  |" in page
    assert page.count("ISO (`tests/validation/test_a.py`)") == 1


def test_published_results_come_first_and_unknown_kinds_last():
    page = validation_page.page([figure("a", "odd"), figure("b", "unit"), figure("c", "validation")])
    titles = [line for line in page.splitlines() if line.startswith("## ")]
    assert titles == ["## Against published and independently computed results", "## Parts", "## Odd"]


def test_loads_fake_the_order_of_their_size():
    page = validation_page.page([figure(f"mean, {load} N m") for load in (100, 50, 400, 10)])
    places = [page.index(f"mean, {load} N m") for load in (10, 50, 100, 400)]
    assert places == sorted(places)


def test_a_bar_does_not_end_a_cell():
    assert "| a\\|b | 1.25 |" in validation_page.page([figure("a|b")])


def test_the_page_is_written_from_files(tmp_path):
    (tmp_path / "one.json").write_text(json.dumps(figure("mean")))
    assert validation_page.main([str(tmp_path), str(tmp_path / "page.md")]) == 0
    assert "| mean |" in (tmp_path / "page.md").read_text()


def test_no_figures_are_an_error(tmp_path):
    assert validation_page.main([str(tmp_path), str(tmp_path / "page.md")]) == 1
    assert not (tmp_path / "page.md").exists()
