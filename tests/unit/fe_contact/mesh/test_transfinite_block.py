"""Blocks of quadrilaterals: gmsh's interpolation, given sides, failures."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from fe_contact.errors import MeshError
from fe_contact.mesh.quad_sector import _Block, _fill_blocks

U, V = np.linspace(0.0, 1.0, 6) ** 1.3, np.linspace(0.0, 1.0, 4)


def bent(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.stack([u + 0.2 * v**2, v + 0.3 * u * (1.0 - u)], axis=-1)


BENT = _Block(bent(U, 0.0 * U), bent(1.0 + 0.0 * V, V), bent(U, 1.0 + 0.0 * U), bent(0.0 * V, V))
SQUARE = _Block(
    *(
        np.array(side, float)
        for side in ([[0, 0], [1, 0]], [[1, 0], [1, 1]], [[0, 1], [1, 1]], [[0, 0], [0, 1]])
    )
)


def arc_share(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    lengths = sum(np.cumsum(np.linalg.norm(np.diff(side, axis=0), axis=1)) for side in (first, second))
    return np.concatenate([[0.0], lengths / lengths[-1]])


def test_is_the_transfinite_interpolation_of_the_sides() -> None:
    (found,) = _fill_blocks([BENT], 1.0)
    u = arc_share(BENT.bottom, BENT.top)[None, :, None]
    v = arc_share(BENT.left, BENT.right)[:, None, None]
    low = (1 - u) * BENT.bottom[0] + u * BENT.bottom[-1]
    high = (1 - u) * BENT.top[0] + u * BENT.top[-1]
    rows, columns = (
        (1 - v) * BENT.bottom + v * BENT.top,
        (1 - u) * BENT.left[:, None] + u * BENT.right[:, None],
    )
    assert found == pytest.approx(rows + columns - (1 - v) * low - v * high, abs=1e-14)


def test_keeps_the_given_sides_bit_for_bit() -> None:
    found, small = _fill_blocks([BENT, SQUARE], 0.7)
    assert np.array_equal(found[0], BENT.bottom)
    assert np.array_equal(found[-1], BENT.top)
    assert np.array_equal(found[:, 0], BENT.left)
    assert np.array_equal(found[:, -1], BENT.right)
    assert small.shape == (2, 2, 2)


def test_orientation_plays_no_part() -> None:
    turned = _Block(BENT.bottom[::-1], BENT.left, BENT.top[::-1], BENT.right)
    one, other = _fill_blocks([BENT, turned], 1.0)
    assert other == pytest.approx(one[:, ::-1], abs=1e-14)


@pytest.mark.parametrize(
    ("answer", "cause"),
    [
        ('{"blocks": [[[[0, 0], [1, 0]]]]}', "unusable"),
        ('{"blocks": []}', "unusable"),
        ("{}", "unusable"),
        ('{"error": "no surface"}', "no surface"),
    ],
)
def test_a_useless_answer_is_a_mesh_error(answer: str, cause: str) -> None:
    with pytest.raises(MeshError, match=cause):
        _fill_blocks([SQUARE], 1.0, command=(sys.executable, "-c", f"print('{answer}')"))


def test_sides_divided_unlike_are_a_mesh_error() -> None:
    uneven = _Block(BENT.bottom, BENT.right, BENT.top[[0, -1]], BENT.left)
    with pytest.raises(MeshError):
        _fill_blocks([uneven], 1.0)
