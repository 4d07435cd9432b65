"""What `loa doctor` says of an installation, and which verbs it says work."""

import json
import subprocess
from typing import Any

import pytest
from packaging.requirements import Requirement
from typer.testing import CliRunner

from lineofaction.cli import doctor
from lineofaction.cli.commands import app

Answer = dict[str, Any]


def answer(monkeypatch: pytest.MonkeyPatch, analysis: list[str], broken: str = "") -> Answer:
    """Return the answer where the extra requires `analysis` and the module `broken` does not load."""
    required = {"": ["numpy"], "analysis": analysis, "service": ["numpy"]}
    packages = {extra: list(map(Requirement, names)) for extra, names in required.items()}
    monkeypatch.setattr(doctor, "_requirements", lambda: packages)

    def ended(command: list[str], **_options: Any) -> subprocess.CompletedProcess[str]:
        code = int(command[-1] == f"import {broken}")
        return subprocess.CompletedProcess(
            command, code, "", "Traceback ...\nOSError: lib.so.1: no such file\n"
        )

    monkeypatch.setattr("subprocess.run", ended)
    done = CliRunner().invoke(app, ["doctor", "--json"])
    assert (done.exit_code, done.stderr) == (0, "")
    told: Answer = json.loads(done.stdout)
    return told | {"findings": {finding["name"]: finding for finding in told["findings"]}}


def test_with_all_packages_all_verbs_work(monkeypatch):
    told = answer(monkeypatch, ["numpy>=1", "scipy"])
    assert all(told["verbs"].values()) and {"analyze", "modes", "serve", "ste"} <= told["verbs"].keys()
    assert told["findings"]["extra analysis"]["state"] == "has"
    assert {"machine", "program", "cache", "base", "gmsh", "browser"} <= told["findings"].keys()


def test_missing_packages_and_untested_versions_are_named_with_the_remedy(monkeypatch):
    told = answer(monkeypatch, ["numpy<1", "no-such-package", "scipy"])
    finding = told["findings"]["extra analysis"]
    assert finding["state"] == "lacks"
    assert ", not <1; no-such-package is missing: pip install 'lineofaction[analysis]'" in finding["text"]
    assert {verb for verb, works in told["verbs"].items() if works} == set(doctor.BASE)


def test_a_mesher_that_does_not_load_says_which_libraries_it_needs(monkeypatch):
    told = answer(monkeypatch, ["numpy"], broken="gmsh")
    finding = told["findings"]["gmsh"]
    assert finding["state"] == "lacks" and "lib.so.1" in finding["text"] and "apt-get" in finding["text"]
    assert not told["verbs"]["analyze"] and told["verbs"]["ste"]


def test_boundary_elements_that_do_not_load_limit_the_sound_alone(monkeypatch):
    monkeypatch.setattr(doctor, "find_spec", lambda _name: True)
    told = answer(monkeypatch, ["numpy"], broken="ngsolve")
    finding = told["findings"]["ngsolve"]
    assert finding["state"] == "limited" and "apt-get install libquadmath0" in finding["text"]
    assert all(told["verbs"].values())


def test_a_requirement_belongs_to_the_base_or_to_its_extras():
    plain, extra, other = map(
        Requirement,
        (
            "numpy",
            'numba>=0.61; extra == "analysis"',
            'psutil; sys_platform == "none" and extra == "analysis"',
        ),
    )
    assert doctor._belongs(plain, "") and not doctor._belongs(plain, "analysis")
    assert doctor._belongs(extra, "analysis") and not doctor._belongs(extra, "")
    assert not doctor._belongs(extra, "service") and not doctor._belongs(other, "analysis")


def test_the_shell_completes_verbs(monkeypatch):
    environment = {"_LOA_COMPLETE": "complete_bash", "COMP_WORDS": "loa resp", "COMP_CWORD": "1"}
    done = CliRunner().invoke(app, prog_name="loa", env=environment)
    assert done.stdout.split() == ["response"]
