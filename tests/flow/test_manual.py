"""README, tutorials and how-to guides run as they stand, show what comes out, and answer newcomers."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import manual
import pytest
from condensed_once import find_condensed
from repository import ROOT

RESTS_ON = ("README.md", "docs/studies.md", "docs/tutorials", "docs/how-to", "examples")
DOCS = ROOT / "docs"


@pytest.fixture(scope="module")
def folder():
    with manual.folder() as made:
        yield made


@pytest.fixture(scope="module")
def ran():
    """Pages that have run in the folder: their files are there."""
    return set()


# Ten seconds and more, but for the tutorials and for pages whose files others read.
LONG = {
    *("complaint", "deflect", "from-rexs-to-dba", "hear-a-gearbox", "measured-housing", "planetary-stage"),
    *("quiet-flanks-by-search", "ripple-map", "service-for-the-team", "tolerance-study", "tolerances"),
    *("vibration", "whine-at-1400-hz"),
}
PAGES = [
    pytest.param(page, id=page.stem, marks=[pytest.mark.nightly] * (page.stem in LONG))
    for page in manual.pages()
]


@pytest.mark.chain
@pytest.mark.parametrize("page", PAGES)
def test_the_page_runs_and_makes_its_pictures(page, folder, ran):
    for before in manual.needed(page):
        if before not in ran | {page}:
            list(manual.run_page(before))  # whether it shows what comes out, its own test asks
        ran.add(before)
    stale = list(manual.run_page(page))
    assert not stale, "\n".join([f"python scripts/manual.py --renew {page.stem}", *map(str, stale)])
    assert [name for name in manual.pictures(page) if not (folder / name).is_file()] == []


def test_a_number_that_is_wrong_is_seen():
    output = "torque N m  force N\n     100  2660.4 ±2\n"
    assert manual.shown("100 2660 ±2", output)
    assert not manual.shown("100 2760 ±2", output)
    assert not manual.shown("torque kN m", output)


PRINTED = """mean STE at 120 N m: 16.65 µm ± 0.20 µm
tip relief  60 N m        120 N m
  0  0.327 ±0.03   0.563 ±0.06
  8  0.0475 ±0.01  0.293 ±0.02
mean force 8 N
mean moment 9 N m
"""


def renewed_page(folder: Path, shown: str) -> tuple[list[str], str]:
    page = folder / "page.md"
    page.write_text(f"Text.\n\n```python\nprint({PRINTED!r})\n```\n\n```text\n{shown}```\n\nMore.\n", "utf-8")
    stale = list(manual.run_page(page))
    manual.renew(page, stale)
    return [found.nearest for found in stale if found.renewed is None], page.read_text("utf-8")


def test_a_stale_number_is_renewed_and_the_rest_of_its_page_left(tmp_path):
    rest = "\nmean force 8 N\n"
    alone, text = renewed_page(tmp_path, f"mean STE at 120 N m: 15.00 µm\n8   0.06 ±0.01   0.29 ±0.02{rest}")
    assert alone == []
    today = f"mean STE at 120 N m: 16.65 µm\n8   0.0475 ±0.01   0.293 ±0.02{rest}"
    assert text.endswith(f"```text\n{today}```\n\nMore.\n")
    assert list(manual.run_page(tmp_path / "page.md")) == []


def test_a_line_without_a_partner_is_reported_beside_the_nearest_and_left(tmp_path):
    lines = "9  0.06 ±0.01  0.30 ±0.02\nmean moment 9 kN\n"
    alone, text = renewed_page(tmp_path, lines)
    assert alone == ["  8  0.0475 ±0.01  0.293 ±0.02", "mean moment 9 N m"]
    assert lines in text


def test_a_guide_runs_after_those_whose_files_it_goes_on_with():
    by_name = {(page.parent.name, page.stem): page for page in manual.pages()}
    guide, spur = by_name["how-to", "quiet-flanks-by-search"], by_name["tutorials", "industrial-spur-pair"]
    assert manual.needed(guide) == [spur, guide]
    assert manual.needed(spur) == [spur]


def links(page: Path) -> set[Path]:
    """Return the pages that a page leads to, by links and by the contents that it shows."""
    text = page.read_text("utf-8")
    targets = re.findall(r"\]\(([^)#\s]+\.md)", text)
    for contents in re.findall(r"```\{toctree\}\n:maxdepth: 1\n\n(.*?)```", text, re.DOTALL):
        targets += [f"{name}.md" for name in contents.split()]
    return {(page.parent / target).resolve() for target in targets}


def questions() -> list[tuple[str, Path]]:
    rows = re.findall(r"^\d+\. \[([^]]+)\]\(([^)#]+)", (DOCS / "questions.md").read_text("utf-8"), re.M)
    return [(question, (DOCS / target).resolve()) for question, target in rows]


def test_there_are_twenty_questions():
    assert len(questions()) == 20


@pytest.mark.parametrize(("question", "answer"), questions(), ids=lambda value: getattr(value, "stem", ""))
def test_a_question_is_answered_within_two_clicks(question, answer):
    front, list_of_questions = DOCS / "index.md", DOCS / "questions.md"
    doors = links(front) - {list_of_questions}
    assert answer in doors | {page for door in doors for page in links(door)}, question


README = (ROOT / "README.md").read_text(encoding="utf-8")
WRITE_CASE = """
import json, pathlib, subprocess, sys
sys.path.insert(0, {example!r})
from gear_case import points
import lineofaction as loa
from dynamics.housings import step_solid
from lineofaction.gearbox.from_step.housing import step_housing
import warnings
warnings.simplefilter("ignore")
unit = loa.open_unit("unit.rexs")
pathlib.Path("scene.toml").write_text(unit.files()["scene.toml"])
subprocess.run([sys.executable, {example!r} + "/gear_case.py", "scene.toml", "gear_case.step"], check=True)
found = step_housing(unit.scene, step_solid("gear_case.step"), "spheroidal_cast_iron", "-y").fields
settings = dict(name="housing", step_file="gear_case.step", modes=10, element_size_mm=40.0, points=points())
pathlib.Path("housings.json").write_text(json.dumps([found | settings]))
"""


def blocks(language: str, page: str = README) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)


def run_python(code: str, folder: Path, warnings: str = "error") -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [sys.executable, "-W", warnings, "-c", code],
        cwd=folder,
        env=os.environ | {"OMP_NUM_THREADS": "1", "XDG_CACHE_HOME": str(folder / "cache")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done


@pytest.mark.chain  # by the bodies of its tutorial
def test_the_helical_example_has_six_lines_and_runs(tmp_path, condensed_bodies):
    find_condensed(condensed_bodies, tmp_path / "cache" / "lineofaction")
    code = blocks("python")[0]
    assert len([line for line in code.splitlines() if line]) == 6
    value, error = map(float, re.findall(r"[\d.]+", run_python(code, tmp_path).stdout))  # "0.565 ± 0.051 µm"
    assert value == pytest.approx(0.56, abs=error)  # docs/tutorials/helical-ev-pair.md
    assert error < 0.2 * value


@pytest.mark.nightly
def test_a_unit_sounds_in_six_lines_without_a_server(tmp_path):
    example = ROOT / "examples" / "two_stage"
    shutil.copyfile(example / "two_stage.rexs", tmp_path / "unit.rexs")
    run_python(WRITE_CASE.format(example=str(example)), tmp_path)
    studies = (DOCS / "studies.md").read_text("utf-8")
    (code,) = (block for block in blocks("python", studies) if "open_unit" in block)
    assert len([line for line in code.splitlines() if line and not line.startswith("import")]) <= 6
    assert "level" in run_python(code, tmp_path, "default").stdout


def test_a_new_user_finds_the_program_and_the_examples():
    shell = "".join(blocks("sh"))
    assert shell.index("./scripts/run") < shell.index("source .venv/bin/activate") < shell.index("loa ")
    named = re.findall(r"examples/\S+\.toml", shell)
    assert len(named) >= 3 and [name for name in named if not (ROOT / name).is_file()] == []


def test_the_page_is_short():
    assert len(README.splitlines()) <= 120


def test_links_and_pictures_lead_somewhere():
    targets = re.findall(r"\]\(([^)#]+)\)", README)
    assert len(targets) > 5
    missing = [t for t in targets if not t.startswith("https://") and not (ROOT / t).exists()]
    assert missing == []


def test_commands_named_in_the_readme_exist():
    scripts = set(re.findall(r"\./(scripts/[a-z-]+)", README))
    assert scripts >= {"scripts/run", "scripts/test", "scripts/bench"}
    for script in scripts:
        assert os.access(ROOT / script, os.X_OK), script
