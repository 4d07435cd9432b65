"""The verbs of a service's jobs: what a person reads, and what a program does."""

import json
from typing import Any

import command_line
import pytest
from repository import ROOT
from small_table import small_table
from stored_jobs import state
from typer.testing import Result

from lineofaction.client import JobState, LineOfActionClient
from lineofaction.client import Result as Reference
from lineofaction.gearbox.problems import ResultNotReady

CASE = ROOT / "examples" / "palermo_spur_20_20.toml"
ADDRESS = "http://127.0.0.1:9"
KEY = "ab" * 32


def loa(*arguments: object) -> Result:
    return command_line.loa(*arguments, "--service", ADDRESS)


def job(identifier: str, status: str, **facts: Any) -> JobState:
    return JobState.from_json(state(identifier, status) | facts)


@pytest.fixture
def listed(monkeypatch):
    asked: list[dict[str, Any]] = []

    def jobs(_client, **wanted):
        asked.append(wanted)
        begun = {"remaining_s": 240.0, "created": "2026-05-06T07:08:09.123456Z", "subject": "20/20"}
        done = job("3-4", "successful", title="EV", subject="31/41")
        return [job("1-2", "running", **begun), done, job("5-6", "accepted", ahead=2)]

    monkeypatch.setattr(LineOfActionClient, "jobs", jobs)
    return asked


def test_jobs_are_a_line_each_with_the_time_left(listed):
    shown = loa("jobs", "--process", "analyze", "--status", "running", "--limit", 7)
    head, running, done, waiting = (line.split() for line in shown.stdout.splitlines())
    assert head[0] == "job"
    assert running == ["1-2", "analyze", "mesh", "10", "4", "min", "left", "2026-05-06", "07:08:09", "20/20"]
    assert done[:3] == ["3-4", "analyze", "done"] and done[-1] == "EV"
    assert waiting[:6] == ["5-6", "analyze", "waits", "behind", "2", "jobs"]
    assert listed == [{"process": ["analyze"], "status": ["running"], "limit": 7}]


def test_jobs_for_programs_have_all_that_is_known(listed):
    running, done, waiting = json.loads(loa("jobs", "--json").stdout)["jobs"]
    assert (running["id"], running["remaining_s"], done["status"]) == ("1-2", 240.0, "successful")
    assert (running["ahead"], waiting["ahead"]) == (None, 2)
    assert listed == [{"process": (), "status": (), "limit": 20}]


def test_dismiss_says_what_became_of_the_job(monkeypatch):
    monkeypatch.setattr(LineOfActionClient, "dismiss", lambda _client, name: job(name, "dismissed"))
    assert loa("dismiss", "1-2").stdout == "job 1-2, analyze: dismissed\n"
    assert json.loads(loa("dismiss", "1-2", "--json").stdout)["status"] == "dismissed"


def test_ctrl_c_while_waiting_says_how_to_go_on_and_how_to_end(monkeypatch):
    def interrupted(*_arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(LineOfActionClient, "submit", lambda *_: job("1-2", "accepted"))
    monkeypatch.setattr(LineOfActionClient, "wait", interrupted)
    ended = loa("submit", CASE, "--wait")
    assert ended.exit_code == 130
    first, *_, fetch, dismiss = ended.stderr.splitlines()
    assert first == "job 1-2"  # known before it is waited for
    assert fetch.endswith(f"loa fetch 1-2 --service {ADDRESS} --wait -o FILE")
    assert dismiss.endswith(f"loa dismiss 1-2 --service {ADDRESS}")


def test_fetch_waits_if_it_is_to_and_says_so_if_not(tmp_path, monkeypatch):
    stored, file = tmp_path / "stored.nc", tmp_path / "fetched.nc"
    small_table().to_netcdf(stored)

    def not_ready(*_arguments):
        raise ResultNotReady("Job a-1 is running.")

    monkeypatch.setattr(LineOfActionClient, "result", not_ready)
    monkeypatch.setattr(LineOfActionClient, "wait", lambda *_: Reference(KEY, "database", ""))
    monkeypatch.setattr(LineOfActionClient, "fetch_file", lambda *_: stored)
    refused = loa("fetch", "a-1", "-o", file)
    assert refused.exit_code != 0 and "loa fetch a-1 --wait -o FILE" in refused.stderr and not file.exists()
    assert loa("fetch", "a-1", "-o", file, "--wait").exit_code == 0
    assert file.read_bytes() == stored.read_bytes()
