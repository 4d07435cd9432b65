"""The notebooks run as they are written, each in less than a minute of CPU time, and hold no outputs."""

import ast
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

from bounds.brief import MAX_LINES
from host import cpu_seconds

FOLDER = Path(__file__).parents[2] / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
LIMIT_S = 60.0


def cells(file: Path) -> list[dict[str, Any]]:
    content: list[dict[str, Any]] = json.loads(file.read_text("utf-8"))["cells"]
    return content


def values(file: Path) -> Iterator[object]:
    """Run a notebook; yield what its cells show: the value of an expression at the end of a cell."""
    names: dict[str, Any] = {}
    for number, cell in enumerate(cell for cell in cells(file) if cell["cell_type"] == "code"):
        body = ast.parse("".join(cell["source"])).body
        last = body.pop() if isinstance(body[-1], ast.Expr) else None
        exec(compile(ast.Module(body, []), f"{file.name}, cell {number}", "exec"), names)
        if isinstance(last, ast.Expr):
            yield eval(compile(ast.Expression(last.value), f"{file.name}, cell {number}", "eval"), names)


def test_there_are_notebooks_without_outputs():
    assert len(NOTEBOOKS) >= 2
    for cell in (cell for file in NOTEBOOKS for cell in cells(file)):
        assert not cell.get("outputs"), cell
        assert cell.get("execution_count") is None


@pytest.mark.nightly
@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_runs_within_a_minute(file, monkeypatch):
    monkeypatch.chdir(FOLDER)
    plt.switch_backend("Agg")
    before = cpu_seconds()
    shown = list(values(file))
    assert cpu_seconds() - before < LIMIT_S
    assert len(plt.get_fignums()) >= 2
    texts = [
        repr(value) for value in shown if type(value).__module__.startswith(("fe_contact", "lineofaction"))
    ]
    assert len(texts) >= 2 and all(text.count("\n") < MAX_LINES for text in texts)
    plt.close("all")
