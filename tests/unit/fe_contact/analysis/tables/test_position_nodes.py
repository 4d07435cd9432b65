"""Nodes gather where the curve bends, and the error they state is the error there is."""

import numpy as np
import pytest

from fe_contact.analysis.tables import _adaptive_nodes
from fe_contact.planning.plan import NodeRule
from fe_contact.ste.interpolation import Axis, interpolate


def trapezoid_wave(position: np.ndarray) -> np.ndarray:
    """Near-square waves with kinks at places no grid knows, one per load level."""
    kinks = np.array([0.2137, 0.2071])
    phase = np.abs((position[:, None] + 0.5) % 1.0 - 0.5)
    return np.array([1e-6, 3e-6]) * (2.0 - np.clip((phase - kinks) / 0.03, 0.0, 1.0))


def repeating(wave):
    """Return the wave as curves of one base pitch that repeats."""
    return lambda position: wave(position)[None]


def held_out(nodes: np.ndarray) -> np.ndarray:
    query = np.random.default_rng(1).random(2000)
    found = interpolate(Axis(nodes, 1.0), trapezoid_wave(nodes), query)
    return np.abs(found - trapezoid_wave(query)).max(axis=0)


def test_adaptive_nodes_meet_their_tolerance_at_held_out_positions():
    nodes = _adaptive_nodes(NodeRule(32, 0.002, 768), repeating(trapezoid_wave))
    assert np.all(nodes.error <= 0.002 * np.array([1e-6, 3e-6]))
    # the middles of the intervals are not the worst places, so some slack over the stated error
    assert np.all(held_out(nodes.position) <= 2.0 * 0.002 * np.array([1e-6, 3e-6]))


def test_nodes_gather_at_the_kinks():
    nodes = _adaptive_nodes(NodeRule(32, 0.002, 768), repeating(trapezoid_wave)).position
    spacing = np.diff(nodes, append=nodes[0] + 1.0)
    near = np.abs((nodes + 0.5) % 1.0 - 0.5)
    assert spacing[(near > 0.2) & (near < 0.25)].min() < spacing[near < 0.15].min() / 8.0


def test_a_jump_ends_at_the_node_limit_with_a_finite_error():
    def jump(position):
        return np.where(position < 0.3, 0.0, 1.0)[:, None] + 0.01 * np.sin(2 * np.pi * position)[:, None]

    nodes = _adaptive_nodes(NodeRule(16, 1e-9, 768), repeating(jump))
    assert nodes.position.size <= 768
    assert np.all(np.isfinite(nodes.error))
    assert nodes.error.max() > 0.1


def test_constant_curves_need_no_nodes():
    nodes = _adaptive_nodes(NodeRule(16, 0.002, 768), lambda x: np.ones((1, x.size, 1)))
    assert nodes.position.size == 16
    assert nodes.error == pytest.approx(0.0, abs=1e-12)
