"""What the receipt says of the contact solver."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.contact.problem import condition_numbers


def test_condition_numbers_leave_out_what_is_no_candidate() -> None:
    rng = np.random.default_rng(5)
    basis = rng.normal(size=(3, 5, 5))
    real = 1e-9 * (basis @ basis.transpose(0, 2, 1) + 0.1 * np.eye(5))
    wider = np.zeros((3, 7, 7))
    wider[:, 1:6, 1:6] = real
    assert condition_numbers(wider) == pytest.approx(np.linalg.cond(real), rel=1e-9)
    wider[1], wider[1, :5, :5] = 0.0, real[1]
    wider[2], wider[2, 1:5, 1:5] = 0.0, real[2, 1:, 1:]
    expected = [*np.linalg.cond(real[:2]), np.linalg.cond(real[2, 1:, 1:])]
    assert condition_numbers(wider) == pytest.approx(expected, rel=1e-9)


def test_a_matrix_that_is_not_definite_has_no_condition_number() -> None:
    assert condition_numbers(np.array([np.diag([1.0, -1.0]), np.diag([1.0, 4.0])])).tolist() == [np.inf, 4.0]
