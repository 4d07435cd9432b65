"""The models side by side: errors against the finest, and what is left out with its reason."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from hulls import box, sphere

from dynamics.acoustics import Air, Hull, compare_models, errors_db
from dynamics.errors import InputError

AIR = Air()


def test_the_errors_on_a_sphere_are_those_in_closed_form() -> None:
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")
    hull = sphere(4)
    made = compare_models(hull, AIR.sound_speed / (2.0 * np.pi), np.ones(len(hull.areas)), AIR)
    assert not made.left_out
    for name, stated in errors_db(1.0).items():
        assert made.errors[name] == pytest.approx(stated[0], abs=0.1)
    assert made.errors["boundary_elements"] == 0.0
    assert made.results["boundary_elements"].efficiency == pytest.approx(0.5, rel=0.01)
    assert made.results["equivalent_radiated_power"].efficiency == pytest.approx(1.0, rel=1e-9)


def test_models_without_their_library_or_mesh_are_left_out_with_the_reason(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "ngsolve", None)
    hull = box((0.4, 0.3, 0.2), (4, 4, 4))
    velocity = np.ones(len(hull.areas))
    made = compare_models(hull, 100.0, velocity, AIR)
    assert list(made.left_out) == ["boundary_elements"]
    assert "lineofaction[boundary-elements]" in made.left_out["boundary_elements"]
    coarse = compare_models(Hull(hull.nodes, hull.triangles[1:]), 3000.0, velocity[1:], AIR)
    assert list(coarse.results) == ["equivalent_radiated_power"]
    assert "six edges in a wavelength" in coarse.left_out["monopoles"]
    with pytest.raises(InputError, match="Nothing moves"):
        compare_models(hull, 100.0, 0.0 * velocity, AIR)
