"""The surface of a housing as the page gets it: nodes, normals, motion, levels."""

import base64

import numpy as np
import pytest
from hulls import sphere
from sounding_housings import rigid_housing, with_surface

from dynamics.vibration.vibration_analysis import SurfaceShape, operating_deflection
from lineofaction.gearbox.problems import DamagedFile
from lineofaction.gearbox.studies.motion import UnitMotion
from lineofaction.report import unit_motion
from lineofaction.report.unit_motion import motion_json


@pytest.fixture(scope="module")
def pulsating():
    """A sphere whose nodes move outward by 1 mm/s."""
    hull = sphere(6, 0.1)
    outward = hull.nodes / np.linalg.norm(hull.nodes, axis=1)[:, None]
    motion = np.repeat(outward[:, :, None], 3, axis=2)
    housing = with_surface(rigid_housing(1.0, 1e6, 0.01, hull), hull, motion)
    return operating_deflection(housing, np.array([1e-3, 0.0, 0.0]))


def sent(shape: SurfaceShape, *, is_velocity: bool = True) -> dict[str, np.ndarray]:
    surface = motion_json(UnitMotion.of_surface(shape, is_velocity=is_velocity))["surface"]
    assert surface.pop("level_re") == ("50 nm/s" if is_velocity else "the largest")
    kinds = {name: "<u4" if name == "facets" else "<f4" for name in surface}
    return {name: np.frombuffer(base64.b64decode(text), kinds[name]) for name, text in surface.items()}


@pytest.mark.law
def test_a_sphere_that_pulsates_has_one_level_everywhere(pulsating):
    surface = sent(pulsating)
    level = 20.0 * np.log10(1e-3 / np.sqrt(2.0) / 5e-8)
    np.testing.assert_allclose(surface["level_db"], level, atol=0.15)  # of chords of the sphere
    place, normal = (np.reshape(surface[name], (-1, 3)) for name in ("place_mm", "normal"))
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-6)
    assert np.all(np.sum(place * normal, axis=1) > 0.0), "outward"
    assert surface["facets"].max() < len(place)
    of_shape = sent(pulsating, is_velocity=False)["level_db"]
    assert of_shape.max() == 0.0, "a shape has levels re its own largest"
    np.testing.assert_allclose(of_shape, 0.0, atol=0.15)


def test_a_large_surface_is_drawn_by_its_corners(pulsating, monkeypatch):
    whole = sent(pulsating)
    monkeypatch.setattr(unit_motion, "MAX_FACETS", 10)
    corners = sent(pulsating)
    assert 4 * corners["facets"].size == whole["facets"].size
    assert 3 * corners["place_mm"].size < whole["place_mm"].size
    np.testing.assert_allclose(corners["level_db"], np.mean(whole["level_db"]), atol=0.3)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_is_refused(pulsating, value):
    motion = pulsating.motion.copy()
    motion[3, 1] = value
    with pytest.raises(DamagedFile, match="not finite"):
        sent(SurfaceShape(pulsating.points, pulsating.triangles, motion))
