"""Where verbs keep what can be computed again: one place, which the environment names."""

import subprocess
import sys
from pathlib import Path

import pytest
from command_line import loa
from spur_case import spur_case

from host.directories import cache_home

CASE = spur_case(torques=[100], model="plane_strain", positions=16)


@pytest.mark.parametrize("verb", [["analyze", "-o", "ste.nc"], ["flank"], ["plan"]], ids=lambda verb: verb[0])
def test_verbs_keep_where_the_environment_says(verb, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LINEOFACTION_CACHE", "kept")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "other"))
    Path("case.toml").write_text(CASE)
    result = loa(verb[0], "case.toml", *verb[1:])
    assert result.exit_code == 0, result.output
    assert list((tmp_path / "kept" / "compliance").iterdir())
    assert not (tmp_path / "other").exists()


def test_nothing_outlives_a_process_whose_cache_is_off(tmp_path):
    code = "from host.directories import cache_home as c; (c() / 'x').write_text('x'); print(c())"
    told = {"LINEOFACTION_CACHE": "off", "TMPDIR": str(tmp_path), "PYTHONPATH": ":".join(sys.path)}
    done = subprocess.run([sys.executable, "-c", code], env=told, capture_output=True, text=True, check=True)
    assert Path(done.stdout.strip()).parent == tmp_path
    assert not list(tmp_path.iterdir())


def test_a_cache_of_the_environment_means_the_same_in_any_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LINEOFACTION_CACHE", "kept")
    assert cache_home() == tmp_path / "kept"
