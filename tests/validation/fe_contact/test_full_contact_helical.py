"""Helical full contact against that of spur pairs over the face, and tables over the face against it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.full_contact_helical import POSITIONS, assessed, helical_cases
from benchmarks.full_contact_helical import reference as reference_of_helical
from benchmarks.full_contact_over_face import face_cases, reference
from fe_contact import ste_database
from fe_contact.full_contact import solve_full_contact_helical
from fe_contact.geometry import Toothing

SOURCE = "helical full contact, its own convergence forgiven"
PEER = "full finite-element contact over the face, its own convergence forgiven"
LIMIT = 0.15
"""Per cent of the mean: displacements are small in the one, and change the contact by 0.06 % in the other."""
PLAIN = (6.47922, 13.60049, 24.58178)
"""Mean STE of helical full contact of 32/60 with plain profiles at every other position, um."""
ADDED = 0.06
"""Per cent of the mean that what reliefs add to it may be off; patches that stay leave out 0.14 %."""


@pytest.mark.nightly
@pytest.mark.law
def test_without_helix_it_is_full_contact_over_the_face(record_figure) -> None:
    case = face_cases()[1]
    tables = solve_full_contact_helical(case.pair, case.torques, case.positions, case.misalignments)
    for misalignment, table in zip(case.misalignments, tables, strict=True):
        exact, own = reference(case, misalignment)
        off = np.maximum(np.abs(table.transmission_error - exact) - own, 0.0) / np.mean(exact, axis=0)
        worst = 100.0 * float(off.max())
        name = f"helical full contact of a spur pair, misaligned {1e6 * misalignment:g} um"
        record_figure(name, worst, f"at most {LIMIT} %", "%", PEER)
        assert worst < LIMIT


@pytest.mark.nightly
def test_stated_errors_of_tables_cover_full_contact(record_figure) -> None:
    """Peak-to-peak is not covered at every load: docs/accuracy.md says where."""
    found = assessed()
    assert len(found) == 8
    covered, ripples, all_of_them = (
        100.0 * float(value)
        for value in (
            np.mean([one.covered[0] for one in found]),
            np.mean([one.covered[1] for one in found]),
            np.mean([one.covered for one in found]),
        )
    )
    record_figure("means of tables over the face covered", covered, "100 %", "%", SOURCE)
    record_figure("peak-to-peak of tables over the face covered", ripples, "at least 90 %", "%", SOURCE)
    record_figure("both of tables over the face covered", all_of_them, "at least 95 %", "%", SOURCE)
    assert ripples >= 90.0
    assert all_of_them >= 95.0
    assert covered == 100.0


@pytest.mark.nightly
@pytest.mark.law
def test_reliefs_add_to_the_mean_what_they_add_in_full_contact(record_figure) -> None:
    """The mean itself is off by as much on plain profiles: 0.17 to 0.31 %, of the mesh and the method."""
    case, at = helical_cases()[2], POSITIONS[::2]
    plain = {gear: without_reliefs(getattr(case.pair, gear)) for gear in ("pinion", "wheel")}
    means = []
    for pair in (case.pair, replace(case.pair, **plain)):
        table = ste_database(pair, *case.request(level="standard"))
        means.append([table.curve(force=force, at=at.tolist()).ste.mean() for force in case.forces])
    exact = reference_of_helical(case)[0][::2].mean(axis=0)
    added = np.array(means[0]) - means[1] - (exact - 1e-6 * np.array(PLAIN))
    off = 100.0 * float(np.abs(added / exact).max())
    record_figure("what reliefs add to the mean of 32/60", off, f"at most {ADDED} %", "%", SOURCE)
    assert off < ADDED


def without_reliefs(gear: Toothing) -> Toothing:
    return replace(gear, modification=gear.modification.along_face)
