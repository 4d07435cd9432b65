"""The benchmark's table says what was measured and whether it meets its target."""

import ast
import re
from pathlib import Path

import pytest

from benchmarks import __main__ as bench
from benchmarks.figures import Figure, markdown
from benchmarks.fresh_process import measure
from benchmarks.machine import describe
from benchmarks.page import MARKS
from benchmarks.record import Measured

FIGURES = (
    Figure("table", "cold", 2.5, "CPU s", 3.0),
    Figure("table", "cached", 0.25, "CPU s", 0.2),
    Figure("table", "memory", 210.0, "MiB"),
)
ORDER = ("static_table", "run_up")


def test_met_missed_and_without_target():
    assert [figure.met for figure in FIGURES] == [True, False, None]
    rows = markdown(FIGURES).splitlines()[2:]
    assert rows == [
        "| table | cold | 2.5 CPU s | at most 3 CPU s | yes |",
        "| table | cached | 0.25 CPU s | at most 0.2 CPU s | **no** |",
        "| table | memory | 210 MiB |  |  |",
    ]


def test_the_machine_is_named():
    machine = describe()
    assert {"processor", "cores", "memory", "python", "numpy", "lineofaction"} <= set(machine)
    assert all(machine.values())


def test_a_fresh_process_tells_its_results_and_its_time():
    result = measure("measured = {'answer': sum(range(10))}\n")
    assert result["answer"] == 45
    assert result["process_cpu_seconds"] > 0.0


def test_what_fresh_processes_import_is_there():
    folder = Path(bench.__file__).parent
    pieces = [
        node.value
        for module in folder.glob("*.py")
        for node in ast.walk(ast.parse(module.read_text("utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    imports = {line for piece in pieces for line in re.findall(r"^from [\w.]+ import [\w, ]+$", piece, re.M)}
    folders = ("", "examples", "tests/fakes", "tests/verification/dynamics")
    found = [str(folder.parent / name) for name in folders]
    code = "\n".join([f"import sys; sys.path[:0] = {found!r}", *sorted(imports), "measured = {}"])
    assert len(imports) > 10
    measure(code)


def test_code_that_fails_is_an_error():
    with pytest.raises(RuntimeError, match="no such thing"):
        measure("raise SystemExit('no such thing')\n")


def _measured(day: str, *figures: Figure) -> Measured:
    """A subject's figures on a machine that is named."""
    return Measured(day, {"processor": "P", "python": "3"}, figures)


def test_publishing_replaces_the_figures_and_nothing_else(tmp_path, monkeypatch):
    (tmp_path / "docs" / "lab").mkdir(parents=True)
    readme = tmp_path / "README.md"
    before, after = f"# Title\n\n{MARKS[0]}\n", f"{MARKS[1]}\n\nRest.\n"
    readme.write_text(before + "stale row\n" + after)
    monkeypatch.setattr(bench, "ROOT", tmp_path)
    monkeypatch.setattr(bench, "MEASURED", tmp_path / "out")
    for _ in range(2):  # publishing again changes nothing
        bench._publish({"static_table": _measured("2026-01-02", *FIGURES)}, ORDER)
        text = readme.read_text()
        assert text.startswith(before)
        assert text.endswith(after)
        assert "stale row" not in text
        assert text.count("| table | cold |") == 1
        assert "memory" not in text  # no target, so no place in the README
    assert "| table | memory |" in (tmp_path / "out" / "benchmarks.md").read_text()


def test_publishing_one_subject_keeps_the_others(tmp_path, monkeypatch):
    (tmp_path / "docs" / "lab").mkdir(parents=True)
    (tmp_path / "README.md").write_text(f"{MARKS[0]}\n{MARKS[1]}\n")
    monkeypatch.setattr(bench, "ROOT", tmp_path)
    monkeypatch.setattr(bench, "MEASURED", tmp_path / "out")
    other = Figure("run", "run-up", 0.5, "CPU s", 1.0)
    bench._publish({"static_table": _measured("2026-01-02", *FIGURES)}, ORDER)
    bench._publish({"run_up": _measured("2026-01-03", other), "gone": _measured("2026-01-03")}, ORDER)
    bench._publish({"static_table": _measured("2026-01-04", FIGURES[0])}, ORDER)
    published = (tmp_path / "out" / "benchmarks.md").read_text()
    assert [line for line in published.splitlines() if line.startswith(("## ", "2026"))] == [
        "## static_table",
        "2026-01-04",
        "## run_up",
        "2026-01-03",
        "## Machines",
    ]
    assert "| run | run-up | 0.5 CPU s |" in published
    assert "| table | cached |" not in published
    assert published.count("- processor: P") == 1
    assert "| run | run-up | 0.5 CPU s |" in (tmp_path / "README.md").read_text()


def test_only_named_subjects_are_measured(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(bench, "ROOT", tmp_path)
    monkeypatch.setattr(bench, "MEASURED", tmp_path / "out")
    monkeypatch.setattr("benchmarks.finite_width.figures", lambda: [FIGURES[0]])
    assert bench.main(["finite_width"]) == 0
    printed = capsys.readouterr().out
    assert "| table | cold |" in printed
    assert "reference_errors" not in printed
    assert bench.main(["finite_widht"]) == 2
    assert "no subject finite_widht; one of reference_errors" in capsys.readouterr().err
