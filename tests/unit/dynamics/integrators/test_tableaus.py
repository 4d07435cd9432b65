"""Order conditions of the Runge-Kutta methods (Butcher), and the implicit method's stability at infinity."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.integrators import tableaus as t

METHODS = {
    "implicit": (t.IMPLICIT_STAGES, t.IMPLICIT_NODES, t.IMPLICIT_WEIGHTS, t.IMPLICIT_EMBEDDED, 4, 3),
    "explicit": (t.EXPLICIT_STAGES, t.EXPLICIT_NODES, t.EXPLICIT_WEIGHTS, t.EXPLICIT_EMBEDDED, 5, 4),
}


def trees(a, c):
    """(order, elementary weight vector, 1/density) of all rooted trees up to order 5."""
    one = np.ones_like(c)
    ac, ac2, ac3, aac = a @ c, a @ c**2, a @ c**3, a @ (a @ c)
    return [
        (1, one, 1.0),
        (2, c, 1 / 2),
        (3, c**2, 1 / 3),
        (3, ac, 1 / 6),
        (4, c**3, 1 / 4),
        (4, c * ac, 1 / 8),
        (4, ac2, 1 / 12),
        (4, aac, 1 / 24),
        (5, c**4, 1 / 5),
        (5, c**2 * ac, 1 / 10),
        (5, c * ac2, 1 / 15),
        (5, c * aac, 1 / 30),
        (5, ac**2, 1 / 20),
        (5, ac3, 1 / 20),
        (5, a @ (c * ac), 1 / 40),
        (5, a @ ac2, 1 / 60),
        (5, a @ aac, 1 / 120),
    ]


@pytest.mark.parametrize("name", METHODS)
def test_order_conditions(name):
    a, c, weights, embedded, order, embedded_order = METHODS[name]
    np.testing.assert_allclose(a.sum(axis=1), c, atol=1e-14)
    for b, upto in ((weights, order), (embedded, embedded_order)):
        residual = {n: max(abs(b @ w - d) for k, w, d in trees(a, c) if k == n) for n in range(1, upto + 1)}
        assert max(residual.values()) < 1e-13
        if upto < 5:  # and no higher: otherwise the error estimate would vanish
            assert max(abs(b @ w - d) for k, w, d in trees(a, c) if k == upto + 1) > 1e-5


@pytest.mark.parametrize("name", METHODS)
def test_the_last_stage_is_the_end_of_the_step(name):
    a, c, weights, *_ = METHODS[name]
    np.testing.assert_array_equal(a[-1], weights)
    assert c[-1] == 1.0


def test_the_implicit_method_is_l_stable():
    a, b = t.IMPLICIT_STAGES, t.IMPLICIT_WEIGHTS

    def growth(z):
        return 1.0 + z * (b @ np.linalg.solve(np.eye(6) - z * a, np.ones(6)))

    for frequency in np.geomspace(1e-2, 1e4, 200):
        assert abs(growth(1j * frequency)) <= 1.0 + 1e-12
    assert abs(growth(-1e9)) < 1e-6
    np.testing.assert_array_equal(np.diag(a)[1:], t.IMPLICIT_DIAGONAL)
