"""Strips at tip edges: where their pressure acts, and the energy whose derivatives their motions are."""

import numpy as np
import pytest

from fe_contact.contact.edge_strip import (
    EdgeStrips,
    edge_motion,
    edge_motions,
    edge_position,
    edge_table,
    no_edges,
)

RADIUS, WIDTH, SOFTNESS, PATCH = 8e-3, 20e-3, 5e-10, 6e-5
OFFSETS = (-3e-4, -2e-5, 0.0, 4e-5, 3e-4)
FORCES = (3.0, 300.0, 4000.0)


def table(offset: float, missing: float = 0.4, side: float = 1.0) -> np.ndarray:
    columns = side, offset, RADIUS, SOFTNESS, PATCH, missing, 3e-10, 1.1e-4
    strips = EdgeStrips(*(np.array([[value]]) for value in columns))
    return edge_table(strips, np.ones((1, 1), dtype=bool))[0]


def centroid(offset: float, force: float) -> float:
    """Centroid of the pressure sqrt((c - x)/x) [phi + (x + c/2)/R] in m, summed over x = c sin(t)^2."""
    slope, scaled = -offset / RADIUS, SOFTNESS * force
    length = np.roots([0.75 / RADIUS, slope, -scaled]).max()
    t = (np.arange(2000) + 0.5) * 0.25 * np.pi / 1000.0
    x = length * np.sin(t) ** 2
    load = np.cos(t) ** 2 * (slope + (x + 0.5 * length) / RADIUS)
    return float(np.sum(load * x) / np.sum(load))


@pytest.mark.law
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("force", FORCES)
def test_the_centroid_is_that_of_the_pressure(offset, force):
    """On the edge; where the strip does not reach it, that of Hertz: where flanks touch."""
    expected = centroid(offset, force) if np.sqrt(SOFTNESS * force * RADIUS) > offset else offset
    assert edge_position(offset, RADIUS, SOFTNESS, force)[0] == pytest.approx(expected, rel=1e-6)


@pytest.mark.law
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("force", FORCES)
def test_motions_are_derivatives_of_one_energy(offset, force, side):
    """The energy is the force times the integral of the centroid's way over the tilt, on both sides."""
    edge, tilt = table(offset, side=side), 1.3e-3
    step, turn = 1e-4 * force, 1e-4 * tilt

    def energy(force, tilt):
        place = edge_position(offset - 0.5 * RADIUS * side * tilt, RADIUS, SOFTNESS, force)[0]
        return force * side * tilt * (place - PATCH)

    at = edge_motion(edge, 0, force, tilt)
    more, less = (edge_motion(edge, 0, force + way, tilt) for way in (step, -step))
    over, under = (edge_motion(edge, 0, force, tilt + way) for way in (turn, -turn))
    by_force = (energy(force + step, tilt) - energy(force - step, tilt)) / (2.0 * step)
    by_tilt = (energy(force, tilt + turn) - energy(force, tilt - turn)) / (2.0 * turn)
    reach = abs(tilt) * 3e-4
    assert at.by_force == pytest.approx(by_force, rel=1e-5, abs=1e-6 * reach)
    assert at.by_tilt == pytest.approx(by_tilt, rel=1e-5, abs=1e-6 * force * 3e-4)
    second = (more.by_force - less.by_force) / (2.0 * step)
    assert at.force_force == pytest.approx(second, rel=1e-4, abs=1e-6 * reach / force)
    for mixed in (
        (over.by_force - under.by_force) / (2.0 * turn),
        (more.by_tilt - less.by_tilt) / (2.0 * step),
    ):
        assert at.force_tilt == pytest.approx(mixed, rel=1e-4, abs=1e-9)
    twice = (over.by_tilt - under.by_tilt) / (2.0 * turn)
    assert at.tilt_tilt == pytest.approx(twice, rel=1e-4, abs=1e-9 * force)
    softness = (more.corner - less.corner) / (2.0 * step)
    assert at.softness == pytest.approx(softness, rel=1e-5, abs=1e-14)


@pytest.mark.law
def test_nothing_jumps_as_a_strip_comes_to_its_edge():
    offset = 8e-5
    reached = offset**2 / (RADIUS * SOFTNESS)
    edge = table(offset)
    before, after = (edge_motion(edge, 0, (1.0 + way) * reached, 0.0) for way in (-1e-9, 1e-9))
    for name in ("by_force", "by_tilt", "force_tilt", "corner", "softness"):
        assert getattr(after, name) == pytest.approx(getattr(before, name), rel=1e-6, abs=1e-12)


def test_a_strip_that_ends_at_the_edge_to_the_last_bit_is_as_those_beside_it():
    """It had half of what the corner yields too much, 0.25 in place of -0.25."""
    # half the strip is the root of softness, force and radius: 1, as is the offset
    edge = np.array([(1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 1.0, 1.0)])
    reaching, beside = (edge_motion(edge, 0, force, 0.0) for force in (1.0 + 1e-9, 1.0 - 1e-9))
    at = edge_motion(edge, 0, 1.0, 0.0)
    assert at.corner == pytest.approx(0.5 * (reaching.corner + beside.corner), abs=1e-8)
    assert at.softness == pytest.approx(0.0, abs=1e-8)


def test_a_short_strip_beside_the_edge_knows_no_corner_and_rolls_as_anywhere():
    edge, tilt = table(3e-4, missing=1.0), 2e-3
    edge[0, EdgeStrips._fields.index("length")] = edge[0, EdgeStrips._fields.index("patch")] = 3e-4
    motion = edge_motion(edge, 0, 20.0, tilt)
    assert motion.corner == motion.softness == 0.0
    assert motion.by_force == pytest.approx(-0.5 * RADIUS * tilt**2, rel=1e-12)
    assert motion.by_tilt == pytest.approx(-20.0 * RADIUS * tilt, rel=1e-12)


def test_a_strip_off_the_line_of_action_has_the_whole_corner_in_its_law():
    motion = edge_motion(table(-1e-4, missing=0.0), 0, 500.0, 1e-3)
    assert motion.corner == motion.softness == 0.0


def test_slices_without_an_edge_do_not_move_and_others_pull_their_neighbors():
    tilt, force = np.array([[[3e-7, 1e-7], [2e-7, 4e-7]]]), np.array([[[200.0, 100.0]]])
    moved = np.zeros(force.shape)
    edge_motions(no_edges(2), tilt, force, moved)
    assert not moved.any()
    edge = np.concatenate([table(-1e-4, missing=0.0, side=-1.0), np.zeros((1, 8))])[None]
    edge_motions(edge, tilt, force, moved)
    motion = edge_motion(edge[0], 0, 200.0, tilt[0, 0] @ force[0, 0])
    expected = motion.by_tilt * tilt[0, 0] + motion.by_force * np.array([1.0, 0.0])
    assert moved[0, 0] == pytest.approx(expected, rel=1e-12)
