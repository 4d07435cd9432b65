"""The runbooks: each tells the same four things, names what exists, and its commands do what they say."""

import os
import re
import subprocess
import sys
from pathlib import Path

import h5py
import pytest
from repository import ROOT
from running_service import Bench, bench
from service_fakes import FAKE, REGISTRY
from sqlalchemy import update
from typer.main import get_command

from lineofaction.cli.commands import app
from lineofaction.gearbox.problems import ServiceError
from service.queue.tables import computations, jobs
from service.store.database import writing
from service.store.maintenance import verify_store
from service.store.results import results

PAGE = (ROOT / "docs" / "how-to" / "runbooks.md").read_text("utf-8")
SECTIONS = {part.partition("\n")[0]: part for part in PAGE.split("\n## ")[1:]}
SOURCE = "\n".join(
    file.read_text("utf-8") for house in ("service", "lineofaction") for file in (ROOT / house).rglob("*.py")
)
LONG_AGO = "2020-01-01T00:00:00.000000Z"


def kinds(problem: type[ServiceError]) -> set[str]:
    """Return the last part of the type of a problem and of all below it."""
    return {problem.type.rpartition(":")[2]}.union(*map(kinds, problem.__subclasses__()))


KINDS = kinds(ServiceError)


def anchor(title: str) -> str:
    return title.lower().replace(" ", "-")


def test_there_are_ten_with_the_anchors_of_alarms():
    assert len(SECTIONS) == 10
    for title in SECTIONS:
        assert f"\n(runbook-{anchor(title)})=\n## {title}\n" in PAGE


@pytest.mark.parametrize("title", SECTIONS)
def test_a_runbook_tells_what_one_sees_and_does(title):
    words = ("How it shows.", "The service itself", "What to do.", "Over when")
    places = [SECTIONS[title].find(f"**{word}**") for word in words]
    assert -1 not in places and places == sorted(places)


@pytest.mark.parametrize("title", SECTIONS)
def test_what_a_runbook_names_exists(title):
    text = SECTIONS[title]
    for metric in re.findall(r"\b(loa_[a-z_]+)", text):
        assert metric.removesuffix("_count") in SOURCE or metric.removesuffix("_total") in SOURCE, metric
    for setting in re.findall(r"`LOA_([A-Z_]+)`", text):
        assert f"    {setting.lower()}: " in SOURCE, setting
    for kind in re.findall(r"`([a-z]+-[a-z]+)`", text):
        assert kind in KINDS, kind
    for listed in re.findall(r"\blog ((?:`[^`]+`(?:, )?)+)", text.replace("\n", " ")):
        for event in re.findall(r"`([^`]+)`", listed):
            assert f'"{event}' in SOURCE, event


@pytest.mark.parametrize(
    "command", sorted(set(re.findall(r"^(?:    |LOA_\w+=\S+ )?loa (.+)$", PAGE, re.MULTILINE)))
)
def test_a_command_is_one_of_the_program(command):
    group, verb, *rest = command.split()
    found = get_command(app).commands[group].commands[verb]
    assert found.make_context(verb, list(rest), resilient_parsing=False).command is found


def commands(title: str) -> str:
    (block,) = re.findall(r"```bash\n(.*?)```", SECTIONS[title], re.DOTALL)
    return block


def follow(title: str, tmp_path: Path) -> subprocess.CompletedProcess[str]:
    """Run the commands of a runbook; `loa` is this program."""
    loa = tmp_path / "bin" / "loa"
    loa.parent.mkdir(exist_ok=True)
    loa.write_text(
        f"#!/bin/sh\nexec {sys.executable} -c 'from lineofaction.cli import main; main()' \"$@\"\n"
    )
    loa.chmod(0o755)
    place = {"DATA": str(tmp_path / "data"), "LOA_DATA_DIRECTORY": str(tmp_path / "data")}
    place |= {"BACKUP": str(tmp_path / "backup"), "PATH": f"{loa.parent}{os.pathsep}{os.environ['PATH']}"}
    place["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    words = ["bash", "-eu", "-c", commands(title)]
    return subprocess.run(words, env={**os.environ, **place}, check=False, capture_output=True, text=True)


def with_results(directory: Path, *texts: str) -> Bench:
    machine = bench(directory, REGISTRY)
    for text in texts:
        made = directory / "made.nc"
        h5py.File(made, "w").close()
        key = FAKE.key({"wish": {"mode": "write", "text": text, "number": 0.0}})
        machine.store.put(key, "database", made)
        assert machine.submit(text=text).status == "successful"
    return machine


def test_a_damaged_database_is_restored_with_the_results_that_are_newer(tmp_path):
    data = tmp_path / "data"
    with_results(data, "before").close()
    (tmp_path / "backup").mkdir()
    (tmp_path / "backup" / "service.sqlite3").write_bytes((data / "service.sqlite3").read_bytes())
    with_results(data, "after").close()
    (data / "service.sqlite3").write_bytes(b"garbage!" * 4096)
    done = follow("Database damaged", tmp_path)
    assert done.returncode == 0, done.stderr
    machine = bench(data, REGISTRY)
    assert verify_store(machine.store).sound == 2
    assert [machine.submit(text=text).status for text in ("before", "after")] == ["successful"] * 2
    machine.close()


def test_room_is_made_at_once(tmp_path):
    machine = with_results(tmp_path / "data", "old", "new")
    old = machine.submit(text="old")
    with writing(machine.engine) as connection:
        connection.execute(update(results).where(results.c.key == old.key).values(used=LONG_AGO))
        connection.execute(update(computations).where(computations.c.key == old.key).values(updated=LONG_AGO))
        mine = jobs.c.computation_id == old.computation
        connection.execute(update(jobs).where(mine).values(created=LONG_AGO, asked=LONG_AGO))
    machine.close()
    done = follow("Disk full", tmp_path)
    assert done.returncode == 0, done.stderr
    left = [file.name for file in (tmp_path / "data" / "results").rglob("*") if file.is_file()]
    assert [name for name in left if old.key in name] == [], done.stdout
    assert sum(name.endswith(".nc") for name in left) == 1


def test_a_damaged_result_is_named_and_then_no_more(tmp_path):
    machine = with_results(tmp_path / "data", "sound", "harmed")
    line = machine.store.find(machine.submit(text="harmed").key, "database")
    (tmp_path / "data" / "results" / line.file).write_bytes(b"tabla")
    machine.close()
    first = follow("Result damaged", tmp_path)
    assert first.returncode == 1 and line.file in first.stdout
    second = follow("Result damaged", tmp_path)
    assert second.returncode == 0 and f"{line.file}\n" not in second.stdout
