from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

from lineofaction import client as public
from lineofaction.cli import scene_tables
from lineofaction.client import JobState, scene_calls


@pytest.mark.parametrize(
    ("seen", "times"),
    [(("accepted", "running", "running", "successful"), 1), (("successful",), 0)],
    ids=["a table that is waited for", "a table that is there"],
)
def test_the_loops_of_a_run_are_compiled_once_while_it_waits(monkeypatch, seen, times):
    compiled: list[int] = []

    def client(_service, progress):
        def run(_steps):
            for status in seen:
                progress(JobState("1-2", "analyze", status, "", "", 0, 0))
            return "table"

        return nullcontext(SimpleNamespace(driver=SimpleNamespace(run=run)))

    monkeypatch.setattr(public, "LineOfActionClient", client)
    monkeypatch.setattr(scene_calls, "ServiceTables", lambda _: None)
    monkeypatch.setattr(scene_tables, "MeshTables", lambda *_: SimpleNamespace(of=lambda *_: None))
    monkeypatch.setattr(
        scene_tables, "scene_by_tables", lambda scene, folder, table_of, *_: table_of(0, scene)
    )
    monkeypatch.setattr("dynamics.simulation.compile_ahead", lambda: compiled.append(1))
    assert scene_tables.tabled_scene(None, Path(), "http://127.0.0.1:9", print) == "table"
    assert len(compiled) == times
