"""Self compliance of a contact patch converges under refinement, and is smooth in where the patch lies."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fe_contact.compliance import FlankCompliance, flank_compliance
from fe_contact.geometry import Gear
from fe_contact.mesh import MeshRecipe

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
STANDARD = MeshRecipe.standard(GEAR)
WIDTH = 1.5 * STANDARD.flank_size  # half-width of the patch


def semi_elliptic(s: np.ndarray, center: float, half_width: float) -> np.ndarray:
    """Consistent nodal forces of unit resultant: p ds = (2 / pi) sin^2(t) dt at c - a cos(t)."""
    corners = s[::2]
    inside = corners[(corners > center - half_width) & (corners < center + half_width)]
    edges = np.concatenate([[0.0], np.arccos((center - inside) / half_width), [np.pi]])
    x, weight = np.polynomial.legendre.leggauss(16)
    forces = np.zeros(len(s))
    for low, high in pairwise(edges):
        t = 0.5 * (low + high) + 0.5 * (high - low) * x
        share = 0.5 * (high - low) * weight * 2.0 / np.pi * np.sin(t) ** 2
        at = center - half_width * np.cos(t)
        e = 2 * (int(np.searchsorted(corners, at.mean())) - 1)
        z = (at - s[e]) / (s[e + 2] - s[e])
        forces[e : e + 3] += [
            share @ ((2 * z - 1) * (z - 1)),
            share @ (4 * z * (1 - z)),
            share @ (z * (2 * z - 1)),
        ]
    return forces


def self_compliance(compliance: FlankCompliance, centers: np.ndarray) -> np.ndarray:
    loads = np.array([semi_elliptic(compliance.s, center, WIDTH) for center in centers])
    return np.einsum("na,ab,nb->n", loads, compliance.block(0, 0), loads)


@pytest.fixture(scope="module")
def compliances():
    """Single-tooth compliance by refinement of the standard recipe."""
    return {f: flank_compliance(GEAR, STANDARD.refined(f), teeth=1) for f in (0.5, 1.0, 2.0)}


def centers(compliance: FlankCompliance) -> np.ndarray:
    return np.linspace(0.1, 0.85, 200) * compliance.s_tip


def test_self_compliance_converges_at_the_rate_of_the_element(compliances, record_figure):
    mean = {f: self_compliance(c, centers(c)).mean() for f, c in compliances.items()}
    # The pressure ends in square roots: the energy of such a field converges with h^3, not h^4.
    steps = mean[1.0] - mean[0.5], mean[2.0] - mean[1.0]
    assert min(steps) > 0.0  # displacement elements are too stiff
    rate = float(np.log2(steps[0] / steps[1]))
    assert rate == pytest.approx(3.0, abs=0.6)
    limit = mean[2.0] + steps[1] / (2.0**3 - 1.0)
    error = 1.0 - mean[1.0] / limit
    assert error < 1e-3
    record_figure(
        "self compliance of a patch: convergence rate", rate, "3 within 0.6", "1", "square-root ends"
    )
    record_figure("self compliance of a patch: error, standard recipe", error, "at most 1e-3", "1", "limit")


def test_position_noise_is_below_a_nanometer(compliances, record_figure):
    coarse, fine = compliances[1.0], compliances[2.0]
    at = centers(coarse)
    line_load = 106.42e3  # N/m: 100 N m on the 20/20 pair
    error = line_load * (self_compliance(coarse, at) - self_compliance(fine, at))
    noise = float(np.std(error - np.polyval(np.polyfit(at, error, 3), at)))
    assert 0.0 < noise < 0.5e-9
    record_figure(
        "position noise of one flank at 106 N/mm, rms", 1e9 * noise, "at most 0.5", "nm", "refined mesh"
    )


def test_result_does_not_hang_on_the_sizes_away_from_the_flank():
    at = centers(flank_compliance(GEAR, STANDARD, teeth=1))
    reference = self_compliance(flank_compliance(GEAR, STANDARD, teeth=1), at).mean()
    for change in (
        {"body_size": 2.0 * STANDARD.body_size},
        {"fillet_size": 0.5 * STANDARD.fillet_size},
        {"tip_size": 2.0 * STANDARD.tip_size},
    ):
        found = self_compliance(flank_compliance(GEAR, replace(STANDARD, **change), teeth=1), at).mean()
        assert found == pytest.approx(reference, rel=2e-4)
