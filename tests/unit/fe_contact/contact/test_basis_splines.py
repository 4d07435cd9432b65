"""Curves over the face and sizes of a mesh are those of scipy, whose modules a first table need not load."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial.distance import cdist

from fe_contact.contact.slices import basis_splines
from fe_contact.mesh.curve_division import spread

FIRST_TABLE = """
import sys
from fe_contact import Gear, GearPair, analyze
gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
pair = GearPair(gear, gear, center_distance=80e-3)
table = analyze(pair, torques=[100.0], positions=8, model="plane_strain", receipt="minimal")
print(table.n_failed, *sys.modules)
"""


@pytest.mark.parametrize("count", [1, 2, 3, 4, 9, 40])
@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_basis_splines_are_those_of_scipy_to_the_last_bit(count, degree):
    inner = np.arange(1.0, count)
    knots = np.concatenate([np.zeros(degree + 1), inner, np.full(degree + 1, float(count))])
    at = np.concatenate([np.random.default_rng(count).uniform(0.0, count, 200), np.arange(count + 1.0)])
    expected = BSpline.design_matrix(at, knots, degree).toarray()
    np.testing.assert_array_equal(basis_splines(at, knots, degree), expected)


def test_sizes_spread_by_the_distances_of_scipy_to_the_last_bit():
    rng = np.random.default_rng(0)
    points, at, sizes = rng.normal(size=(30, 2)), rng.normal(size=(200, 2)), rng.uniform(0.1, 0.5, 30)
    expected = np.minimum(np.min(sizes + 0.3 * cdist(at, points), axis=1), 0.6)
    np.testing.assert_array_equal(spread(points, sizes, 0.3, 0.6)(at), expected)


def test_a_first_table_of_a_plane_pair_loads_no_interpolation():
    """They were a fifth of the first table, most of it for reading the texts of their own functions."""
    done = subprocess.run([sys.executable, "-c", FIRST_TABLE], capture_output=True, text=True, check=True)
    failed, *loaded = done.stdout.split()
    assert failed == "0" and "fe_contact.contact.sweep" in loaded
    assert not {"scipy.interpolate", "scipy.optimize", "scipy.spatial", "scipy.special"} & {*loaded}
