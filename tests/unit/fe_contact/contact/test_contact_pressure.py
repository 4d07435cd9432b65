"""Peak pressure: Hertz's on plain flanks and at edges, more where a relief narrows the strip."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from fe_contact.contact import at_edges, contact_pressure
from fe_contact.contact.strip import Gap
from fe_contact.hertz import half_width, peak_pressure

MODULUS, RADIUS, WIDTH = 115e9, 6e-3, 25e-3
LOAD = 4000.0
FORCE = np.array([[[LOAD]]])
B = float(half_width(LOAD / WIDTH, RADIUS, MODULUS))


def problem(slope=0.0, low=-math.inf, high=math.inf, place=math.inf, jump=0.0) -> SimpleNamespace:
    one = [np.array([[value]]) for value in (slope, 1.0 / RADIUS, low, high)]
    breaks = [np.array([[[value]]]) for value in (place, jump, 0.0)]
    candidates = SimpleNamespace(gap_about=Gap(*one, *breaks), width=np.array([[WIDTH]]))
    return SimpleNamespace(candidates=candidates, modulus=MODULUS)


def pressure(**about) -> float:
    return float(contact_pressure(problem(**about), FORCE)[0, 0, 0])


def edge(force=None, **about) -> bool:
    force = FORCE if force is None else force
    contact = problem(**about)
    return bool(at_edges(contact, force, contact_pressure(contact, force))[0, 0, 0])


HERTZ = float(peak_pressure(LOAD / WIDTH, RADIUS, MODULUS))


def test_a_plain_flank_has_the_pressure_of_hertz():
    assert pressure() == pytest.approx(HERTZ, rel=1e-12)


@pytest.mark.parametrize(
    "edge", [{"low": 0.0, "slope": 0.1}, {"low": -0.3 * B}, {"high": 0.0, "slope": -0.01}]
)
def test_an_edge_does_not_count(edge):
    assert pressure(**edge) == pytest.approx(HERTZ, rel=1e-9)


def test_a_relief_that_begins_within_the_strip_raises_it():
    beside = [pressure(place=share * B, jump=0.01) for share in (1.01, 0.5, 0.0)]
    assert beside[0] == pytest.approx(HERTZ, rel=1e-12)
    assert beside[0] < beside[1] < beside[2] < 2.0 * HERTZ


@pytest.mark.parametrize(
    "about",
    [{"low": 0.0, "slope": 0.1}, {"low": -0.99 * B}, {"high": 0.99 * B}, {"place": 0.5 * B, "jump": 0.5}],
)
def test_a_strip_that_reaches_an_edge_or_a_chamfer_is_told_apart(about):
    assert edge(**about)
    assert not edge(force=0.0 * FORCE, **about)


@pytest.mark.parametrize(
    "about", [{}, {"low": -1.01 * B}, {"high": 1.01 * B}, {"place": 0.5 * B, "jump": 0.01}]
)
def test_a_strip_on_the_flank_reaches_none(about):
    assert not edge(**about)
