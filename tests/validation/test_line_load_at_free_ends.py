"""Largest line load and K_Hbeta of misaligned pairs against full contact that resolves the free ends."""

from __future__ import annotations

import pytest

from benchmarks.full_contact_line_load import LineLoadCase, compared, line_load_cases


@pytest.mark.law
@pytest.mark.parametrize("case", line_load_cases(), ids=lambda case: case.name)
def test_stated_errors_of_a_draft_cover_full_contact(case: LineLoadCase) -> None:
    peaks = [peak for peak in compared(case, "draft") if peak.stated == peak.stated]
    assert {peak.quantity for peak in peaks} >= {"line_load_n_per_mm"}
    for peak in peaks:
        assert peak.covered, peak
        assert peak.stated < (0.3 if peak.quantity.startswith("edge") else 0.12) * peak.value


@pytest.mark.nightly
@pytest.mark.parametrize("case", line_load_cases(), ids=lambda case: case.name)
def test_the_standard_level_is_within_two_percent_of_full_contact(case: LineLoadCase) -> None:
    for peak in compared(case, "standard"):
        assert abs(peak.value - peak.peer) <= 0.02 * peak.peer + peak.peer_error, peak
