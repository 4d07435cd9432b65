"""Helical full contact against that of spur pairs over the face, and tables over the face against it."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.full_contact_helical import POSITIONS, assessed, helical_cases
from benchmarks.full_contact_helical import reference as reference_of_helical
from benchmarks.full_contact_over_face import POSITIONS as FACE_POSITIONS
from benchmarks.full_contact_over_face import face_cases, reference
from fe_contact import analyze
from fe_contact.geometry import Toothing
from verification.full_contact import solve_full_contact_helical

SOURCE = "helical full contact, its own convergence forgiven"
PEER = "full finite-element contact over the face, its own convergence forgiven"
LIMIT = 0.15
"""Per cent of the mean: displacements are small in the one, and change the contact by 0.06 % in the other."""
MEAN = 0.15
"""Per cent of the mean; with a few real teeth and a plain ring at the root circle it is 0.27 % off."""
PLAIN = (6.46557, 13.58390, 24.54187)
"""Mean STE of helical full contact of 32/60 with plain profiles at every other position, um."""
ADDED = 0.06
"""Per cent of the mean that what reliefs add to it may be off; patches that stay leave out 0.14 %."""


@pytest.mark.nightly
@pytest.mark.law
@pytest.mark.xfail(reason="0.20 % under the lightest load; 31 hats across a line leave 0.17 %")
def test_without_helix_it_is_full_contact_over_the_face(record_figure):
    case = face_cases()[1]
    tables = solve_full_contact_helical(case.pair, case.torques, FACE_POSITIONS, case.misalignments)
    for misalignment, table in zip(case.misalignments, tables, strict=True):
        exact, own = reference(case, misalignment)
        off = np.maximum(np.abs(table.transmission_error - exact) - own, 0.0) / np.mean(exact, axis=0)
        worst = 100.0 * float(off.max())
        name = f"helical full contact of a spur pair, misaligned {1e6 * misalignment:g} um"
        record_figure(name, worst, f"at most {LIMIT} %", "%", PEER)
        assert worst < LIMIT


@pytest.mark.nightly
def test_stated_errors_of_tables_cover_full_contact(record_figure):
    found = assessed()
    assert len(found) == 8
    for quantity, name in enumerate(("means", "peak-to-peak")):
        covered = 100.0 * float(np.mean([one.covered[quantity] for one in found]))
        record_figure(f"{name} of tables over the face covered", covered, "100 %", "%", SOURCE)
        assert covered == 100.0


@pytest.mark.nightly
@pytest.mark.law
@pytest.mark.xfail(reason="0.20 % of 19/52, where full contact over the face is 0.05 to 0.3 % stiffer")
def test_means_of_tables_over_the_face_are_those_of_full_contact(record_figure):
    off = [np.maximum(one.true[0] - one.own[0], 0.0) / one.value[0] for one in assessed()]
    worst = 100.0 * float(np.max(off))
    record_figure("worst mean of tables over the face", worst, f"at most {MEAN} %", "%", SOURCE)
    assert worst < MEAN


@pytest.mark.nightly
@pytest.mark.law
@pytest.mark.xfail(reason="0.10 %; the error of full contact on plain profiles is not known")
def test_reliefs_add_to_the_mean_what_they_add_in_full_contact(record_figure):
    case, at = helical_cases()[2], POSITIONS[::2]
    plain = {gear: without_reliefs(getattr(case.pair, gear)) for gear in ("pinion", "wheel")}
    means = []
    for pair in (case.pair, replace(case.pair, **plain)):
        table = analyze(pair, *case.request(level="standard"))
        means.append([table.curve(force=force, at=at.tolist()).ste.mean() for force in case.forces])
    exact = reference_of_helical(case)[0][::2].mean(axis=0)
    added = np.array(means[0]) - means[1] - (exact - 1e-6 * np.array(PLAIN))
    off = 100.0 * float(np.abs(added / exact).max())
    record_figure("what reliefs add to the mean of 32/60", off, f"at most {ADDED} %", "%", SOURCE)
    assert off < ADDED


def without_reliefs(gear: Toothing) -> Toothing:
    return replace(gear, modification=gear.modification.along_face)
