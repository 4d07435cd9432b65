"""What somebody who finds the project looks for: how to cite, report, change and decide."""

import json
import re
import tomllib

import pytest
import yaml
from packaging.specifiers import SpecifierSet
from repository import ROOT

GITHUB = ROOT / ".github"
TEXTS = sorted([*GITHUB.rglob("*.md"), ROOT / "CONTRIBUTING.md", ROOT / "README.md"])


def test_the_citation_names_the_license_of_the_package():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert cited["cff-version"] == "1.2.0"
    assert cited["license"] == project["license"]
    assert cited["title"].startswith(project["name"])
    released = cited.get("version")  # a release writes it; between releases it stands in one place
    assert released in {None, project["version"]} or ".dev" in project["version"]


@pytest.mark.parametrize("text", TEXTS, ids=lambda file: file.name)
def test_links_lead_somewhere(text):
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text.read_text("utf-8"))
    missing = [link for link in links if ":" not in link and not (text.parent / link).exists()]
    assert missing == []


def test_changes_of_forks_run_what_every_change_must_pass():
    (job,) = yaml.safe_load((GITHUB / "workflows" / "check.yml").read_text("utf-8"))["jobs"].values()
    assert job["steps"][-1]["run"] == "bash .ci/run"
    requires = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["requires-python"]
    minors = [minor for minor in range(30) if f"3.{minor}" in SpecifierSet(requires)]
    assert {f"3.{minors[0]}", f"3.{minors[-1]}"} <= set(job["strategy"]["matrix"]["python"])
    container = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text("utf-8"))
    script, _ = container["postCreateCommand"].split()
    assert (ROOT / script).exists()


def test_a_template_asks_what_an_answer_needs():
    wrong = (GITHUB / "ISSUE_TEMPLATE" / "wrong-number.md").read_text("utf-8")
    assert "source, unit and condition" in wrong and "the error that the program states" in wrong
    for template in (GITHUB / "ISSUE_TEMPLATE").iterdir():
        head = yaml.safe_load(template.read_text("utf-8").split("---")[1])
        assert set(head) == {"name", "about", "labels"}


def test_sources_of_the_paper_are_listed_and_used():
    paper = (ROOT / "docs" / "paper" / "paper.md").read_text("utf-8")
    listed = re.findall(r"^@\w+\{(\w+),", (ROOT / "docs" / "paper" / "paper.bib").read_text("utf-8"), re.M)
    assert set(re.findall(r"@(\w+)\b", paper.partition("# Summary")[2])) == set(listed)
    assert len(paper.split()) < 1000
