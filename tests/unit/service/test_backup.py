"""A backup while the service works (how-to/back-up-and-upgrade.md): what was entered before is in it."""

import shutil
import sqlite3
import subprocess
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from postgres_server import PostgresServer, program
from running_service import Bench, bench, until
from service_fakes import REGISTRY

from service.store.maintenance import verify_store


def copied(file: Path, copy: Path) -> str:
    """Copy a SQLite database that others write to, as ``sqlite3 FILE '.backup COPY'`` does."""
    with closing(sqlite3.connect(file)) as source, closing(sqlite3.connect(copy)) as target:
        source.backup(target)
    return f"sqlite:///{copy}"


def dumped(url: str, server: PostgresServer, folder: Path) -> str:
    """Dump a database of a server and restore it under another name."""
    pg_dump, pg_restore = program("pg_dump"), program("pg_restore")
    if pg_dump is None or pg_restore is None:
        pytest.skip("pg_dump and pg_restore are not installed")
    dump, restored = folder / "dump", server.new_database()
    subprocess.run([pg_dump, "--format=custom", f"--file={dump}", f"--dbname={url}"], check=True)
    subprocess.run([pg_restore, "--no-owner", f"--dbname={restored}", str(dump)], check=True)
    return restored


@contextmanager
def submitting(machine: Bench) -> Iterator[None]:
    stop = threading.Event()

    def submit():
        number = 0
        while not stop.wait(0.01):
            machine.submit(text=f"meanwhile {number}")
            number += 1

    thread = threading.Thread(target=submit)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


@pytest.mark.law
def test_a_backup_holds_what_was_entered_before_and_goes_on(tmp_path, database_url, request):
    """The database first, then the files: each line has its file, and what waited and ran is done again."""
    machine = bench(tmp_path / "old", REGISTRY, database_url=database_url, queue_limit=100_000)
    machine.scheduler.start()
    done = [machine.ended(machine.submit(text=f"done {number}")) for number in range(2)]
    running = machine.submit(mode="die_once", text="runs")
    waiting = machine.submit(text="waits")
    with submitting(machine):
        if database_url is None:
            copy = copied(tmp_path / "old/service.sqlite3", tmp_path / "copy.sqlite3")
        else:
            copy = dumped(database_url, request.getfixturevalue("postgres"), tmp_path)
        unfinished = shutil.ignore_patterns("*.part")  # they are gone once they have their name
        shutil.copytree(tmp_path / "old/results", tmp_path / "new/results", ignore=unfinished)
    machine.close()
    restored = bench(tmp_path / "new", REGISTRY, database_url=copy, queue_limit=100_000)
    assert [restored.submissions.find(job.id) for job in done] == done
    assert (found := verify_store(restored.store)).missing == found.damaged == () and found.sound >= 2
    assert restored.store.verified(done[1].key, "database").path.read_text() == "done 1"
    assert {restored.submissions.find(job.id).key for job in (running, waiting)} == {running.key, waiting.key}
    restored.close()


def test_what_ran_at_the_time_of_a_backup_is_done_after_its_restoration(tmp_path):
    machine = bench(tmp_path / "old", REGISTRY)
    jobs = [machine.submit(text=text) for text in ("runs", "waits")]
    machine.claimed()
    copy = copied(tmp_path / "old/service.sqlite3", tmp_path / "copy.sqlite3")
    machine.close()
    restored = bench(tmp_path / "new", REGISTRY, database_url=copy)
    restored.scheduler.start()
    until(lambda: all(restored.submissions.find(job.id).ended for job in jobs))
    # the end of its server is none of the job's attempts
    assert [restored.submissions.find(job.id).attempts for job in jobs] == [1, 1]
    restored.close()


def test_the_file_of_the_database_alone_is_no_backup(tmp_path):
    """What was committed last is in the log beside it, as long as anybody has the database open."""
    machine = bench(tmp_path, REGISTRY)
    with closing(sqlite3.connect(tmp_path / "service.sqlite3")) as reader:
        reader.execute("SELECT count(*) FROM job").fetchone()
        job = machine.submit(text="last")
        alone = shutil.copyfile(tmp_path / "service.sqlite3", tmp_path / "alone.sqlite3")
        copied(tmp_path / "service.sqlite3", tmp_path / "copy.sqlite3")
    counts = []
    for file in (alone, tmp_path / "copy.sqlite3"):
        with closing(sqlite3.connect(file)) as found:
            counts.append(found.execute("SELECT count(*) FROM job WHERE id = ?", (job.id,)).fetchone()[0])
    assert counts == [0, 1]
    machine.close()
