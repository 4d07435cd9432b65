"""Captions speak of the case at hand: from its numbers, not of a spur pair of contact ratio 1.5."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.ste import SteDatabase
from lineofaction.report.drawing.figure import Panel
from lineofaction.report.flank.flank import line_load_figure
from lineofaction.report.ste.curves import ste_curves
from lineofaction.report.ste.stiffness import load_sharing


def of_high_contact_ratio(database: SteDatabase, more: int = 1, helix: float = 0.0) -> SteDatabase:
    """Return the table with as many more pairs in contact everywhere, sharing alike."""
    counts = database.pairs_in_contact + more
    pairs = np.arange(int(counts.max()))
    share = (pairs < counts[..., None]) / counts[..., None]
    facts = replace(database.facts, base_helix_angle=helix)
    torque = database.torque * math.cos(helix)
    return replace(
        database, pairs_in_contact=counts, load_share=share, pair=pairs, facts=facts, torque=torque
    )


def words(database: SteDatabase) -> str:
    figures = [plot(database) for plot in (ste_curves, load_sharing)]
    return " ".join(f"{figure.caption} {figure.alternative}" for figure in figures)


def test_a_pair_of_contact_ratio_one_and_a_half_is_told_by_its_numbers(database: SteDatabase) -> None:
    text = words(database)
    assert "1 or 2 tooth pairs carry the load" in text
    assert "One pair carries the whole load in" in text
    assert "low where more do, high where fewer" in text
    assert "single" not in text


def test_a_pair_of_high_contact_ratio_never_stands_on_one_pair(database: SteDatabase) -> None:
    text = words(of_high_contact_ratio(database))
    assert "2 or 3 tooth pairs carry the load" in text
    assert "no pair is ever alone" in text
    assert "One pair" not in text and "single" not in text


def test_a_helical_pair_has_no_steps(database: SteDatabase) -> None:
    text = words(of_high_contact_ratio(database, 2, helix=0.3))
    assert "3 or 4 tooth pairs carry the load" in text
    assert "low where" not in text


def test_a_number_of_pairs_that_never_changes_is_said_so(database: SteDatabase) -> None:
    same = replace(database, pairs_in_contact=np.full_like(database.pairs_in_contact, 2))
    assert "2 tooth pairs carry the load at every position" in words(same)
    assert "low where" not in words(same)


def test_a_gap_plot_that_shows_nothing_is_left_out(flanks: LoadDistribution) -> None:
    figure = line_load_figure(replace(flanks, gap=np.zeros_like(flanks.gap)))
    assert [panel.y.label for panel in figure.content if isinstance(panel, Panel)] == [
        "load per face width, N/mm"
    ]
    assert figure.title == "Load over the face"
    assert "Below" not in figure.caption and "no gap" in figure.caption


@pytest.mark.parametrize(("helix", "uneven"), [(0.0, False), (0.2, True)])
def test_only_a_helical_pair_is_uneven_at_a_single_position(
    flanks: LoadDistribution, helix: float, uneven: bool
) -> None:
    figure = line_load_figure(replace(flanks, base_helix_angle=helix))
    assert ("A single position is uneven" in figure.caption) == uneven
