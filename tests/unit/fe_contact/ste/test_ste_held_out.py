"""Error at points a table does not hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from held_out import held_out_error

from fe_contact.errors import InputError, SolveError
from fe_contact.types import Status

OFFSET = (np.arange(64) + 0.5) / 64


def test_a_table_has_no_error_against_itself(spur):
    result = held_out_error(spur, spur)
    assert result.maximum == 0.0
    assert result.relative_rms == 0.0


def test_a_known_difference_is_found_where_it_is(make, spur):
    other = make(position=spur.position[::4], force=spur.force[1:4])
    shifted = other.static_transmission_error.copy()
    shifted[5, 2] += 1e-8
    result = held_out_error(spur, replace(other, static_transmission_error=shifted))
    assert result.maximum == pytest.approx(1e-8, rel=1e-6)
    assert (result.position, result.force) == (other.position[5], other.force[2])
    assert result.rms == pytest.approx(1e-8 / np.sqrt(16 * 3), rel=1e-6)
    swing = np.ptp(shifted[:, 2])
    assert result.relative_maximum == pytest.approx(1e-8 / swing, rel=1e-6)
    assert result.relative_rms == pytest.approx(1e-8 / 4 / swing, rel=1e-6)


def test_position_error_falls_with_the_spacing(make):
    """At the stored loads; the curves have kinks, so the largest error falls with the first power."""
    force = [500.0, 2000.0, 8000.0]
    truth = make(position=(np.arange(97) + 0.31) / 97, force=force)
    results = [held_out_error(make(position=np.arange(n) / n, force=force), truth) for n in (64, 256, 1024)]
    assert results[1].maximum < 0.35 * results[0].maximum
    assert results[2].maximum < 0.35 * results[1].maximum
    assert results[2].relative_rms < 0.05 * results[0].relative_rms


def test_load_error_alone_falls_fast(make):
    """At the stored positions only the load direction is interpolated."""
    truth = make(force=[500.0, 2000.0, 8000.0])
    coarse = held_out_error(make(force=np.geomspace(266.0, 10640.0, 6)), truth)
    fine = held_out_error(make(force=np.geomspace(266.0, 10640.0, 24)), truth)
    assert fine.maximum < 0.2 * coarse.maximum


def test_points_outside_are_refused(make, spur):
    with pytest.raises(InputError, match=r"other\.force.*from 266 to 10640"):
        held_out_error(spur, make(force=[100.0]))
    with pytest.raises(InputError, match="two or more positions"):
        held_out_error(spur, make(position=[0.5]))


def test_failed_points_are_refused(make, spur):
    ste, status = spur.static_transmission_error.copy(), spur.status.copy()
    ste[0, 0], status[0, 0] = np.nan, Status.SINGULAR
    with pytest.raises(SolveError, match="1 of 320"):
        held_out_error(spur, replace(spur, static_transmission_error=ste, status=status))
