"""A release is refused, and changes nothing, where the tree is not ready; else it is a commit and a tag."""

import shutil
import subprocess
from pathlib import Path

import pytest
from repository import ROOT

GIT = ("git", "-c", "user.name=a tester", "-c", "user.email=tester@example.org")
STUBS = {
    "scripts/environment": """
say() { printf '%s\\n' "$*" >&2; }
fail() { say "error: $*"; exit 1; }
environment() { PATH="$PWD/scripts/stubs:$PATH"; }
system_libraries() { :; }
""",
    "scripts/stubs/python": """#!/usr/bin/env bash
case "$*" in
    "-m build --sdist"*) cp README.md out/release/readme && touch "out/release/one.tar.gz" ;;
    "-m build --wheel"*) touch out/release/one.whl ;;
    "-m zipfile"*) echo host/shipped_loops/a.nbc ;;
    scripts/index_readme.py*) echo "of an index: $2" >README.md ;;
esac
""",
    "scripts/stubs/twine": "#!/usr/bin/env bash\n",
    "scripts/docs": "#!/usr/bin/env bash\n",
    "deploy/kubernetes/image/kustomization.yaml": 'newTag: "1.2.0.dev7"\n',
    "CITATION.cff": "cff-version: 1.2.0\n",
    "README.md": "a readme\n",
    ".gitignore": "out\n",
}
"""Files of a release whose commands build nothing."""


@pytest.fixture
def project(tmp_path):
    """A repository with what a release reads: scripts, changelog, version."""
    for name in ("scripts/release", "scripts/environment"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "CHANGELOG.md").write_text("# Changelog\n\n## Unreleased (1.2.0)\n\n- a change\n", "utf-8")
    (tmp_path / "pyproject.toml").write_text('version = "1.2.0.dev7"\n', "utf-8")
    for command in (("init", "-q"), ("add", "--all"), ("commit", "-qm", "Begin")):
        subprocess.run([*GIT, *command], cwd=tmp_path, check=True)
    return tmp_path


def contents(project: Path) -> list[bytes]:
    return [(project / name).read_bytes() for name in ("CHANGELOG.md", "pyproject.toml")]


def changed(project: Path) -> None:
    (project / "CHANGELOG.md").write_text("another\n", "utf-8")


def tagged(project: Path) -> None:
    subprocess.run([*GIT, "tag", "v1.2.0"], cwd=project, check=True)


def ready(_project: Path) -> None:
    pass


@pytest.mark.parametrize(
    ("version", "prepare", "reason"),
    [
        ("", ready, "must be X.Y.Z"),
        ("1.2", ready, "must be X.Y.Z"),
        ("1.2.0; touch x", ready, "must be X.Y.Z"),
        ("1.2.0", changed, "the tree has changes"),
        ("1.2.0", tagged, "v1.2.0 is a tag already"),
        ("1.3.0", ready, "must have the page '## Unreleased (1.3.0)'"),
    ],
)
def test_a_release_that_is_not_ready_is_refused(project, version, prepare, reason):
    prepare(project)
    before = contents(project)
    ended = subprocess.run(
        ["scripts/release", version], cwd=project, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 1 and reason in ended.stderr
    assert ended.stderr.count("error: ") == 1
    assert before == contents(project)


def test_a_version_follows_its_development_versions_alone(project):
    (project / "pyproject.toml").write_text('version = "1.1.0.dev3"\n', "utf-8")
    subprocess.run([*GIT, "commit", "-qam", "Another version"], cwd=project, check=True)
    ended = subprocess.run(
        ["scripts/release", "1.2.0"], cwd=project, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 1 and "1.2.0 follows 1.2.0.devN alone" in ended.stderr


def test_a_release_is_a_commit_and_a_tag_with_its_page(project):
    for name, text in STUBS.items():
        file = project / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, "utf-8")
        file.chmod(0o755)
    changes = project / "CHANGELOG.md"
    changes.write_text(f"{changes.read_text('utf-8')}\n### Speed\n- fast\n\n## 1.1.0 - 2020-01-01\n", "utf-8")
    for command in (
        ("config", "user.name", "a tester"),
        ("config", "user.email", "tester@example.org"),
        ("add", "--all"),
        ("commit", "-qm", "Build nothing"),
    ):
        subprocess.run(["git", *command], cwd=project, check=True)
    ended = subprocess.run(
        ["scripts/release", "1.2.0"], cwd=project, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr

    def told(*command: str) -> str:
        return subprocess.run(
            ["git", *command], cwd=project, capture_output=True, text=True, check=True
        ).stdout

    assert told("status", "--porcelain") == "" and told("log", "-1", "--format=%s") == "Release 1.2.0\n"
    assert told("tag", "-l", "--format=%(contents)").strip() == "- a change\n\n### Speed\n- fast"
    assert (project / "pyproject.toml").read_text("utf-8") == 'version = "1.2.0"\n'
    assert "\nversion: 1.2.0\ndate-released: " in (project / "CITATION.cff").read_text("utf-8")
    assert (project / "out/release/readme").read_text("utf-8") == "of an index: v1.2.0\n"
    assert (project / "README.md").read_text("utf-8") == "a readme\n"
