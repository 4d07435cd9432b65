"""``loa database``: told and brought up to date from the command line, passwords never shown."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import loa
from postgres_server import PostgresServer
from typer.testing import CliRunner

from lineofaction.cli.commands import app
from service.store.migrations import REVISIONS


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_a_new_database_is_made_and_then_up_to_date(
    kind: str, tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LOA_DATA_DIRECTORY", str(tmp_path))
    if kind == "postgresql":
        server: PostgresServer = request.getfixturevalue("postgres")
        url = server.new_database().replace("postgres@", "postgres:geheim@")
        monkeypatch.setenv("LOA_DATABASE_URL", url)
    run = CliRunner()
    before = run.invoke(app, ["database", "status", "--json"])
    assert (before.exit_code, json.loads(before.stdout)["schema"]) == (1, None)
    assert run.invoke(app, ["database", "upgrade"]).stdout.endswith(f"no tables -> {REVISIONS[-1]}\n")
    after = run.invoke(app, ["database", "status", "--json"])
    assert (after.exit_code, json.loads(after.stdout)["up_to_date"]) == (0, True)
    assert "geheim" not in before.output + after.output


def test_a_server_that_does_not_answer_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LOA_DATABASE_URL", f"postgresql://loa:geheim@/loa?host={tmp_path}")
    answer = loa("database", "status")
    assert answer.exit_code == 4
    assert "The database cannot be reached" in answer.stderr
    assert "geheim" not in answer.output
