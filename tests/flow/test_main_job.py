"""The main job runs from case to report, says what it found, and leaves nothing running."""

import json
import os
import re
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from condensed_once import find_condensed
from repository import ROOT
from running_service import PATIENCE_S, until

from service.page.example_cases import examples

RESTS_ON = ("examples",)
JOB = ROOT / "examples" / "main_job.py"
HELICAL = ROOT / "examples" / "helical_ev_23_67.toml"


def environment(folder: Path) -> dict[str, str]:
    """Keep caches out of the user's home."""
    return os.environ | {"XDG_CACHE_HOME": str(folder / "cache"), "OMP_NUM_THREADS": "1"}


def running(folder: Path) -> list[int]:
    """Processes that name `folder` on their command line."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and int(entry.name) != os.getpid():
            try:
                if str(folder) in (entry / "cmdline").read_bytes().decode(errors="replace"):
                    found.append(int(entry.name))
            except OSError:  # it ended meanwhile
                continue
    return found


@pytest.fixture(scope="module")
def job(tmp_path_factory, condensed_bodies):
    """Run the whole job once; return its folder and what it printed."""
    folder = tmp_path_factory.mktemp("main-job")
    find_condensed(condensed_bodies, folder / "out" / "service")
    done = subprocess.run(
        [sys.executable, str(JOB), "--exit", "--out", str(folder / "out")],
        env=environment(folder),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return folder / "out", done.stdout


def number(text: str, label: str) -> float:
    found = re.search(rf"{re.escape(label)}\s+([-\d.]+)", text)
    assert found, f"{label} is not in:\n{text}"
    return float(found.group(1))


def test_the_summary_holds_the_known_figures(job):
    _, text = job
    assert number(text, "mean STE at 100 N m") == pytest.approx(6.245, rel=0.003)
    assert number(text, "peak-to-peak STE at 100 N m") == pytest.approx(2.799, rel=0.01)
    band = re.search(r"mean STE at 100 N m +[\d.]+ ± ([\d.]+)", text)
    assert band and float(band[1]) < 0.02  # the bias of a plane is no error
    assert "bias of plane strain: over the face of 25 mm mean +2.8 %" in text
    assert number(text, "mean contact force") == pytest.approx(2660.4, rel=0.002)
    assert 286.5 <= number(text, "spectrum: fundamental") <= 302.5
    _, helical = text.split("helical 23/67")
    # the cutter of a tooth thinned by 50 um stands deeper: 14.41 and 0.408 with the root of the nominal shift
    assert number(helical, "mean STE at 100 N m") == pytest.approx(14.51, rel=0.003)
    assert number(helical, "peak-to-peak STE at 100 N m") == pytest.approx(0.392, rel=0.02)


def test_the_report_and_its_images_are_written(job):
    folder, text = job
    assert str(folder / "report.html") in text
    page = (folder / "report.html").read_text(encoding="utf-8")
    keys = re.findall(r'<figure id="(\w+)">', page)
    static = ["pair_drawing", "ste", "ripple", "ste_spectrum", "ste_waterfall"]
    static += ["load_sharing", "mesh_stiffness", "deflection_budget", "flanks_over_torque"]
    dynamic = [
        "dynamic_error",
        "signal",
        "spectrum",
        "levels",
        "order_map",
        "campbell",
        "mode_shares",
        "octave_bands",
        "dynamic_factor",
    ]
    assert keys[0].startswith("unit_") and keys[1:] == static + dynamic
    assert sorted(path.stem for path in (folder / "images").iterdir()) == sorted(keys)
    helical = (folder / "helical.html").read_text(encoding="utf-8")
    assert "Gear pair 23/67" in helical and '<figure id="face_load">' in helical


def test_the_page_will_open_on_figures_that_are_drawn(job):
    folder, _ = job
    first = tomllib.loads(HELICAL.read_text(encoding="utf-8"))
    assert first == examples()[0].content
    (kept,) = (folder / "service" / "cache" / "figures").iterdir()
    assert json.loads(kept.read_text(encoding="utf-8"))["title"] == "Gear pair 23/67"


def test_nothing_is_left_running(job):
    assert running(job[0]) == []


@pytest.mark.law
def test_stopped_in_the_middle_it_stops_its_service(tmp_path):
    started = subprocess.Popen(
        [sys.executable, str(JOB), "--out", str(tmp_path / "out")],
        env=environment(tmp_path),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    log = tmp_path / "out" / "service.log"
    until(lambda: log.exists() and "execution" in log.read_text())
    assert started.poll() is None
    started.send_signal(signal.SIGTERM)
    output, _ = started.communicate(timeout=PATIENCE_S)
    assert started.returncode == 143, output
    assert running(tmp_path) == []
