"""Run the notebooks of examples/notebooks and compare what their cells show with the outputs stored in them.

    python scripts/notebooks.py [--renew] [NAME ...]     all notebooks, or those of these names
    python scripts/notebooks.py --code FOLDER            their code as modules, for checkers of types

Lists every line that a notebook shows and its cells do not print today: same words, numbers within 2 %, but
for costs. With --renew the outputs of today are stored. Without a kernel: a notebook is plain Python.
"""

from __future__ import annotations

import ast
import base64
import contextlib
import io
import json
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from manual import shown
from PIL import Image

FOLDER = Path(__file__).parents[1] / "examples" / "notebooks"
_DPI, _COLORS = 75, 48
"""Of stored pictures: a quarter of the bytes of all colors."""
_COST = re.compile(r"^\s*(made|cost|cost of a run)  ", re.M)
"""Lines of a result that differ with every run: its cost, the version and the hash."""

Json = dict[str, Any]


def notebooks() -> list[Path]:
    """Return the notebooks of the examples."""
    return sorted(FOLDER.glob("*.ipynb"))


def source(cell: Json) -> str:
    """Return the text of a cell."""
    return "".join(cell["source"])


def executed(file: Path) -> Iterator[tuple[Json, object, list[Json]]]:
    """Run the code cells of a notebook in its folder; yield each with its value and its outputs.

    The value is that of an expression at the end of a cell; a semicolon after it keeps it out of the outputs.
    """
    names: Json = {"__name__": "__main__"}
    plt.switch_backend("Agg")
    plt.close("all")
    with contextlib.chdir(FOLDER):
        for number, cell in enumerate(json.loads(file.read_text("utf-8"))["cells"]):
            if cell["cell_type"] == "code":
                yield cell, *_run(source(cell), f"{file.name}, cell {number}", names)
                plt.close("all")


def _run(text: str, name: str, names: Json) -> tuple[object, list[Json]]:
    body = ast.parse(text).body
    last = body.pop() if isinstance(body[-1], ast.Expr) else None
    printed, value = io.StringIO(), None
    with contextlib.redirect_stdout(printed):
        exec(compile(ast.Module(body, []), name, "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), name, "eval"), names)
    silent = value is None or text.rstrip().endswith(";")
    return value, [
        *([printed_output(printed.getvalue())] if printed.getvalue() else []),
        *([] if silent else [_result(value)]),
        *map(_picture, plt.get_fignums()),
    ]


def printed_output(text: str) -> Json:
    """Return the output of a cell that printed a text."""
    return {"name": "stdout", "output_type": "stream", "text": text.splitlines(keepends=True)}


def _result(value: object) -> Json:
    data = {"text/plain": repr(value).splitlines(keepends=True)}
    return {"data": data, "execution_count": None, "metadata": {}, "output_type": "execute_result"}


def _picture(number: int) -> Json:
    drawn, content = io.BytesIO(), io.BytesIO()
    plt.figure(number).savefig(drawn, format="png", dpi=_DPI)
    Image.open(drawn).convert("RGB").quantize(_COLORS).save(content, format="png", optimize=True)
    data = {"image/png": base64.b64encode(content.getvalue()).decode()}
    return {"data": data, "metadata": {}, "output_type": "display_data"}


def text_of(outputs: list[Json]) -> str:
    """Return what outputs say, without what differs with every run."""
    parts = (output.get("text") or output["data"].get("text/plain", []) for output in outputs)
    lines = (line for part in parts for line in "".join(part).splitlines())
    return "\n".join(line for line in lines if not _COST.match(line))


def stale_lines(cell: Json, outputs: list[Json]) -> list[str]:
    """Return the stored lines of a cell that its outputs of today lack."""
    today = text_of(outputs)
    return [line for line in text_of(cell["outputs"]).splitlines() if line and not shown(line, today)]


def renew(file: Path, outputs: list[list[Json]]) -> None:
    """Store the outputs of the code cells of a notebook."""
    content = json.loads(file.read_text("utf-8"))
    code = (cell for cell in content["cells"] if cell["cell_type"] == "code")
    for cell, of_cell in zip(code, outputs, strict=True):
        cell["outputs"] = of_cell
    file.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def write_code(folder: Path) -> None:
    """Write the code cells of each notebook as a module."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in notebooks():
        cells = json.loads(file.read_text("utf-8"))["cells"]
        code = "\n\n".join(source(cell) for cell in cells if cell["cell_type"] == "code")
        (folder / f"notebook_{file.stem}.py").write_text(code + "\n", "utf-8")


def main(arguments: list[str]) -> None:
    """Run notebooks, list stale lines, and renew outputs where asked."""
    if arguments[:1] == ["--code"]:
        write_code(Path(arguments[1]))
        return
    names = {name for name in arguments if name != "--renew"}
    for file in notebooks():
        if names and file.stem not in names:
            continue
        cells = list(executed(file))
        stale = [line for cell, _, outputs in cells for line in stale_lines(cell, outputs)]
        print(f"{file.stem}: {len(stale)} stale lines", *stale, sep="\n  ")
        if "--renew" in arguments:
            renew(file, [outputs for _, _, outputs in cells])


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
