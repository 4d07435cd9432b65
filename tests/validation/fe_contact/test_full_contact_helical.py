"""Helical full contact against that of spur pairs over the face, and tables over the face against it."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.full_contact_helical import assessed
from benchmarks.full_contact_over_face import face_cases, reference
from fe_contact.full_contact import solve_full_contact_helical

SOURCE = "helical full contact, its own convergence forgiven"
PEER = "full finite-element contact over the face, its own convergence forgiven"
LIMIT = 0.15
"""Per cent of the mean: displacements are small in the one, and change the contact by 0.06 % in the other."""
LIMITED = 3
"""Pairs on which that limit was set: 28/41 is 0.16 % off at twice its rated load, where 0.36 % are stated."""


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
    covered, ripples, all_of_them, off = (
        100.0 * float(value)
        for value in (
            np.mean([one.covered[0] for one in found]),
            np.mean([one.covered[1] for one in found]),
            np.mean([one.covered for one in found]),
            max(float(((one.true - one.own) / one.value)[0].max()) for one in found[:LIMITED]),
        )
    )
    record_figure("means of tables over the face covered", covered, "100 %", "%", SOURCE)
    record_figure("peak-to-peak of tables over the face covered", ripples, "at least 90 %", "%", SOURCE)
    record_figure("both of tables over the face covered", all_of_them, "at least 95 %", "%", SOURCE)
    assert ripples >= 90.0
    assert all_of_them >= 95.0
    record_figure("means of helical tables, worst", off, f"at most {LIMIT} %", "%", SOURCE)
    assert covered == 100.0
    assert off < LIMIT
