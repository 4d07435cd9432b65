"""Notebooks run as written, each in less than a minute of CPU time, and show what is stored in them."""

import json

import notebooks
import pytest

from bounds.brief import MAX_LINES
from host import cpu_seconds

LIMIT_S = 60.0
SUBJECTS = 6
"""Published pair, helical pair, unit, tolerances, study over Dask, measured gear."""


def test_every_notebook_has_outputs_without_counts_of_runs():
    assert len(notebooks.notebooks()) >= SUBJECTS
    for file in notebooks.notebooks():
        cells = json.loads(file.read_text("utf-8"))["cells"]
        code = [cell for cell in cells if cell["cell_type"] == "code"]
        assert sum("image/png" in str(cell["outputs"]) for cell in code) >= 2, file.name
        assert all(cell["execution_count"] is None for cell in code), file.name


def test_a_line_that_is_not_printed_today_is_stale():
    stored = {"outputs": [notebooks.printed_output("ripple 1.00 µm\nmean 3.0 µm\n  made        9 CPU s\n")]}
    today = [notebooks.printed_output("ripple 1.01 µm\nmean 3.3 µm\n")]
    assert notebooks.stale_lines(stored, today) == ["mean 3.0 µm"]


@pytest.mark.nightly
@pytest.mark.parametrize("file", notebooks.notebooks(), ids=lambda file: file.stem)
def test_a_notebook_shows_within_a_minute_what_is_stored(file):
    before = cpu_seconds()
    cells = list(notebooks.executed(file))
    assert cpu_seconds() - before < LIMIT_S
    assert [line for cell, _, outputs in cells for line in notebooks.stale_lines(cell, outputs)] == []
    pictures = [output for _, _, outputs in cells for output in outputs if "image/png" in str(output)]
    assert len(pictures) == sum(
        "image/png" in str(output) for cell, _, _ in cells for output in cell["outputs"]
    )
    shown = [value for _, value, _ in cells]
    texts = [
        repr(value)
        for value in shown
        if type(value).__module__.startswith(("dynamics", "fe_contact", "lineofaction"))
    ]
    assert len(texts) >= 1 and all(text.count("\n") < MAX_LINES for text in texts)
