"""CalculiX as a child: how it ended is always said. Programs of a few lines stand in for it."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest
from calculix import run_calculix, version_of

from fe_contact.types import Status


def program(folder: Path, body: str) -> str:
    """A program that does `body` in the folder of the job."""
    path = folder / "fake"
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_a_finished_job_gives_what_it_printed(tmp_path: Path) -> None:
    body = 'cat job.inp > job.dat; printf " iteration 1\\n iteration 2\\n Job finished\\n"'
    run = run_calculix(program(tmp_path, body), "deck", tmp_path, 10.0)
    assert (run.status, run.reason, run.iterations, run.printed) == (Status.CONVERGED, "", 2, "deck")


@pytest.mark.parametrize(
    ("body", "status", "said"),
    [
        ("printf ' *ERROR: increment size smaller\\n  than minimum\\n\\n'; exit 201", Status.ITERATION_LIMIT,
         "exit code 201: increment size smaller than minimum"),
        ("printf 'half a job'; exit 0", Status.ITERATION_LIMIT, "no error printed"),
        ("kill -KILL $$", Status.ITERATION_LIMIT, "exit code -9"),
        ("kill -SEGV $$", Status.ITERATION_LIMIT, "exit code -11"),
        ("while :; do :; done", Status.NOT_COMPUTED, "no result within 1 CPU s"),
    ],
)  # fmt: skip
def test_a_job_that_does_not_end_well_says_why(tmp_path: Path, body: str, status: Status, said: str) -> None:
    run = run_calculix(program(tmp_path, body), "deck", tmp_path, 1.0)
    assert run.status is status
    assert said in run.reason


def test_a_program_that_is_not_there(tmp_path: Path) -> None:
    run = run_calculix(str(tmp_path / "nothing"), "deck", tmp_path, 10.0)
    assert not run.status.usable and run.reason


def test_the_version_is_the_stated_one(tmp_path: Path) -> None:
    assert version_of(program(tmp_path, "echo; echo 'This is Version 2.20'")) == "CalculiX 2.20"
