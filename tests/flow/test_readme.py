"""What the README shows runs as shown."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from fe_contact.ste import SteDatabase
from service.app import create_app
from service.schemas import Case
from service.settings import Settings

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    """Return the code blocks of a language."""
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def run_python(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a block in an interpreter of its own, warnings being errors."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=folder,
        env=os.environ | {"OMP_NUM_THREADS": "1", "XDG_CACHE_HOME": str(folder / "cache")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done


def test_the_python_examples_write_a_database_and_run_a_scene_on_it(tmp_path: Path) -> None:
    analysis, scene, _ = blocks("python")
    done = run_python(analysis, tmp_path)
    assert done.stdout.count("Estimate(value=") == 2
    database = SteDatabase.from_netcdf(tmp_path / "spur_20_20.nc")
    # full finite-element contact in plane strain gives 2.799 um; the finite width adds 3.2 %
    assert database.peak_to_peak(torque=100).value == pytest.approx(2.89e-6, rel=0.01)
    assert run_python(scene, tmp_path).stdout.startswith("COMPLETED (4, 3, ")


def test_the_http_example_is_a_case() -> None:
    shell, _ = [block for block in blocks("sh") if "curl" in block]
    body = json.loads(re.search(r"-d '(.*)'", shell, re.DOTALL).group(1))  # type: ignore[union-attr]
    case = Case.model_validate_json(json.dumps(body["inputs"]["case"]))
    example = tomllib.loads((ROOT / "examples" / "palermo_spur_20_20.toml").read_text(encoding="utf-8"))
    assert case.pair == Case.model_validate_json(json.dumps(example)).pair


def test_the_client_example_is_the_one_of_its_page_which_runs() -> None:
    *_, code = blocks("python")
    assert f"```python\n{code}```" in (ROOT / "docs" / "client.md").read_text(encoding="utf-8")


def test_the_paths_of_the_http_example_are_those_of_the_service(tmp_path: Path) -> None:
    _, shell = [block for block in blocks("sh") if "curl" in block]
    shown = re.findall(r"127\.0\.0\.1:8321(/\S+)", shell)
    known = create_app(Settings(data_directory=tmp_path)).openapi()["paths"]
    generic = [path.replace("{id}", "{job_id}").replace("{hash}", "{key}") for path in shown]
    assert len(generic) == 3 and [path for path in generic if path not in known] == []


def test_links_and_pictures_lead_somewhere() -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", README)
    assert len(targets) > 5
    missing = [t for t in targets if not t.startswith("https://") and not (ROOT / t).exists()]
    assert missing == []


def test_commands_named_in_the_readme_exist() -> None:
    scripts = set(re.findall(r"\./(scripts/[a-z-]+)", README))
    assert scripts >= {"scripts/run", "scripts/test", "scripts/bench"}
    for script in scripts:
        assert os.access(ROOT / script, os.X_OK), script


@pytest.mark.parametrize("page", sorted(ROOT.glob("docs/*.md")), ids=lambda page: page.name)
def test_links_between_the_pages_lead_somewhere(page: Path) -> None:
    targets = re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8"))
    missing = [t for t in targets if "://" not in t and not (page.parent / t).exists()]
    assert missing == []


def test_every_page_is_in_the_index() -> None:
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    pages = sorted(path for room in ("", "theory", "effects") for path in (ROOT / "docs" / room).glob("*.md"))
    missing = [str(p.relative_to(ROOT / "docs")) for p in pages if p.name != "index.md"]
    assert [name for name in missing if f"({name})" not in index] == []
