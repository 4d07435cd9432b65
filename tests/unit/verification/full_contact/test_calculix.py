"""CalculiX as a child: the deck it reads, how it ended, and results that come back."""

import re
import stat
from pathlib import Path

import numpy as np
import pytest
from calculix import (
    Loading,
    flank_sides,
    input_deck,
    numbered_bodies,
    placed_pair,
    read_printed,
    run_calculix,
    version_of,
)
from spur_gears import GEAR

from fe_contact import GearPair, Status
from verification.full_contact import Resolution
from verification.full_contact.condensation.placed_mesh import placed_bodies
from verification.full_contact.condensation.sites import Range, contact_sites


def program(folder: Path, body: str) -> str:
    path = folder / "fake"
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_a_finished_job_gives_what_it_printed(tmp_path):
    body = 'cat job.inp > job.dat; printf " iteration 1\\n iteration 2\\n Job finished\\n"'
    run = run_calculix(program(tmp_path, body), "deck", tmp_path, 10.0)
    assert (run.status, run.reason, run.iterations, run.printed) == (Status.CONVERGED, "", 2, "deck")
    run = run_calculix(str(tmp_path / "nothing"), "deck", tmp_path, 10.0)
    assert not run.status.usable and run.reason
    assert version_of(program(tmp_path, "echo; echo 'This is Version 2.20'")) == "CalculiX 2.20"


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
def test_a_job_that_does_not_end_well_says_why(tmp_path, body, status, said):
    run = run_calculix(program(tmp_path, body), "deck", tmp_path, 1.0)
    assert run.status is status
    assert said in run.reason


LOADING = Loading((GEAR.material, GEAR.material), GEAR.base_radius, 25e-3, 2660.0, 1e18)
PRINTED = """
 displacements (vx,vy,vz) for set TURNING and time  0.1000000E+01

     15981  7.510317E-03  0.000000E+00  0.000000E+00

 forces (fx,fy,fz) for set HELD and time  0.1000000E+01

     15355 -1.000000E+01  2.000000E+00  7.216450E-15
     15657  3.000000E+01  0.000000E+00 -1.897787E-14
"""


@pytest.fixture(scope="module")
def placed():
    pair, coarse = GearPair(GEAR, GEAR, 80e-3), Resolution(1.5)
    sites = contact_sites(pair, 0.3, Range((1e5, 1e5), 1e-6), coarse)
    return placed_pair(pair, placed_bodies(pair, 0.3, sites, coarse), 0.0)


def test_the_deck_has_short_fields_and_surfaces_for_every_pair(placed):
    fields = [field for line in input_deck(placed, LOADING).splitlines()[2:] if line[0] != "*"
              for field in line.split(",")]  # fmt: skip
    assert max(len(field) for field in fields) <= 20
    assert not any("nan" in field or "inf" in field for field in fields)
    deck = input_deck(placed, LOADING)
    assert deck.count("*CONTACT PAIR") == len(placed.meetings) == 2
    for number, (_, tooth) in enumerate(placed.meetings):
        surface = re.search(rf"NAME=GEAR2FLANK{number}, TYPE=ELEMENT\n((?:\d+,S\d\n)+)", deck)
        assert len(surface.group(1).split()) == len(flank_sides(placed.gears[1], tooth))
    assert "\n1.000000000000e+09\n" in deck  # 1e18 Pa/m in N/mm^3


def test_the_bore_of_gear_1_turns_rigidly_and_clockwise(placed):
    deck = input_deck(placed, LOADING)
    ties = re.findall(r"\*EQUATION\n2\n(\d+),(\d),1\.,(\d+),1,(\S+)", deck)
    gear, (first, second) = placed.gears[0], numbered_bodies(placed.gears)
    assert len(ties) == 2 * len(gear.bore_nodes)
    assert {int(tie[2]) for tie in ties} == {second.last_node + 1}
    lag = 1e-5  # of the turning node: every node moves by lag / r_b1 times its arm, at right angles to it
    for node, axis, _, factor in ties:
        x, y = gear.points[int(node) - first.first_node]
        moved = -float(factor) * lag
        assert moved == pytest.approx(
            lag / GEAR.base_radius * (y if axis == "1" else -x), rel=1e-9, abs=1e-18
        )


def test_printed_results_are_read_in_si():
    printed = read_printed(PRINTED)
    assert printed.turning == pytest.approx(7.510317e-6, rel=1e-12, abs=0.0)
    assert printed.nodes.tolist() == [15355, 15657]
    points = np.array([[0.0, 0.01], [0.02, 0.0]])
    assert printed.moment(points, np.zeros(2)) == pytest.approx(0.1, rel=1e-12)
    assert printed.moment(points, np.array([0.0, 0.01])) == pytest.approx(0.3, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "printed no displacements of TURNING"),
        (PRINTED.partition(" forces")[0], "printed no forces of HELD"),
        (PRINTED.replace("7.510317E-03", "NaN"), "no finite"),
        (PRINTED.replace("3.000000E+01", "Infinity"), "no finite"),
    ],
)
def test_a_result_that_is_not_whole_is_refused(text, said):
    with pytest.raises(ValueError, match=said):
        read_printed(text)
