"""The models side by side: errors against the finest, and what is left out with its reason."""

import sys
import time

import numpy as np
import pytest
from hulls import box, sphere

from dynamics.acoustics import (
    Air,
    BoundaryElements,
    ElementalRadiators,
    Hull,
    compare_models,
    errors_db,
    layer_operators,
)
from dynamics.acoustics.model_comparison import MODELS
from dynamics.errors import InputError

AIR = Air()


def test_the_errors_on_a_sphere_are_those_in_closed_form():
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")
    hull = sphere(4)
    made = compare_models(hull, AIR.sound_speed / (2.0 * np.pi), np.ones(len(hull.areas)), AIR)
    assert not made.omitted
    for name, stated in errors_db(1.0).items():
        assert made.errors[name] == pytest.approx(stated[0], abs=0.1)
    assert made.errors["boundary_elements"] == 0.0
    assert made.results["boundary_elements"].efficiency == pytest.approx(0.5, rel=0.01)
    assert made.results["equivalent_radiated_power"].efficiency == pytest.approx(1.0, rel=1e-9)


def test_every_rung_states_cost_and_error_computed_or_not(tmp_path):
    hull = box((0.4, 0.3, 0.2), (4, 4, 4))
    velocity, asked = np.ones(len(hull.areas)), MODELS[:2]
    made = compare_models(hull, 100.0, velocity, AIR, asked, offered=MODELS, cache=tmp_path)
    names = [model.model_name for model in MODELS]
    assert list(made.predicted) == list(made.error_band) == names
    assert list(made.results) == names[:2] and not made.omitted
    for name, result in made.results.items():
        assert result.cost.predicted_seconds == made.predicted[name].seconds
        assert result.cost.seconds >= 0.0
    seconds = [cost.seconds for cost in made.predicted.values()]
    assert seconds[-1] == max(seconds) > 100.0 * seconds[0]


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.model_name)
def test_cost_grows_with_panels_and_shapes(model):
    few, many = model.cost(1000, 2.0, 40), model.cost(2000, 2.0, 40)
    assert few.seconds < many.seconds and few.bytes < many.bytes
    assert model.cost(1000, 2.0, 80).seconds >= few.seconds
    assert model.cost(30_000, 20.0, 40).seconds >= model.cost(30_000, 2.0, 40).seconds


def test_monopoles_take_more_at_high_frequency():
    waves = ElementalRadiators()
    assert waves.cost(30_000, 20.0, 40).seconds > 3.0 * waves.cost(30_000, 2.0, 40).seconds


def test_boundary_elements_take_the_predicted_multiple_of_fewer_panels():
    """Each within 1.3, their ratio within its square; the least of up to ten counts each."""
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")
    model, hulls, least = BoundaryElements(), (sphere(3), sphere(5)), [np.inf, np.inf]
    small, large = (model.cost(len(hull.areas), 1.0, 1).seconds for hull in hulls)
    for _ in range(10):
        for index, hull in enumerate(hulls):
            began = time.process_time()
            model.resistance(hull, 30.0, np.ones((len(hull.areas), 1)), AIR)
            least[index] = min(least[index], time.process_time() - began)
        predicted_over_paid = (large / small) / (least[1] / least[0])
        if 1.0 / 1.3**2 < predicted_over_paid < 1.3**2:
            return
    pytest.fail(f"predicted over paid: {predicted_over_paid:.2f}")


def test_the_whole_of_7040_panels_is_what_was_measured():
    """615 CPU s and 5.9 GB, on a host like the reference: a box of 180 x 120 x 230 mm at 3200 Hz."""
    cost = BoundaryElements().cost(7040, 6.0, 1)
    assert 615.0 / 1.3 < cost.seconds < 615.0 * 1.3
    assert cost.bytes == pytest.approx(5.9e9, rel=0.1)


def test_boundary_elements_report_their_assembly(monkeypatch):
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")
    monkeypatch.setattr(layer_operators, "BLOCK", 50)
    told: list[tuple[str, float]] = []
    hull = sphere(2)
    reporting = BoundaryElements(progress=lambda *step: told.append(step))
    reporting.resistance(hull, 30.0, np.ones((len(hull.areas), 1)), AIR)
    assert {stage for stage, _ in told} == {"boundary elements"}
    fractions = [fraction for _, fraction in told]
    assert len(hull.areas) == 80
    assert len(fractions) == 3 and fractions == sorted(fractions) and fractions[-1] == pytest.approx(1.0)
    assert reporting == BoundaryElements() and repr(reporting) == repr(BoundaryElements())


def test_what_takes_long_is_announced_before_it_begins(monkeypatch):
    monkeypatch.setattr("dynamics.work_cost.ANNOUNCED", 0.0)
    hull, told = box((0.4, 0.3, 0.2), (4, 4, 4)), []
    compare_models(
        hull, 100.0, np.ones(len(hull.areas)), AIR, MODELS[1:2], lambda stage, _: told.append(stage)
    )
    assert any(stage.startswith(f"monopoles; {len(hull.areas)} panels: about ") for stage in told)


@pytest.mark.parametrize("ka", [0.3, 0.6, 1.1, 2.3, 3.7])
def test_stated_errors_hold_on_spheres_in_closed_form(ka):
    """But for pulsation alone near ka = pi, where monopoles cancel each other."""
    for model in MODELS[:2]:
        low, high = model.error_band(ka)
        errors = errors_db(ka)[model.model_name]
        assert np.all((low <= errors) & (errors <= high))


@pytest.mark.parametrize("hertz", [200.0, 700.0])
def test_stated_errors_hold_on_a_box_by_boundary_elements(hertz):
    """Pulsation, one wall that bulges, one that bends in two waves, the whole up and down."""
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")
    sides = np.array([0.36, 0.24, 0.18])
    hull = box(sides, (6, 5, 4))
    x, y, _ = (hull.centers / sides + 0.5).T
    top = (hull.normals[:, 2] > 0.5) * np.sin(np.pi * y)
    shapes = np.stack(
        [np.ones(x.size), top * np.sin(np.pi * x), top * np.sin(2.0 * np.pi * x), hull.normals[:, 2]], axis=1
    )
    ka = 2.0 * np.pi * hertz / AIR.sound_speed * hull.equivalent_radius
    exact = np.diag(BoundaryElements().resistance(hull, hertz, shapes, AIR)).real
    for model in MODELS[:-1]:
        power = np.diag(model.resistance(hull, hertz, shapes, AIR)).real
        low, high = model.error_band(ka)
        errors = 10.0 * np.log10(power / exact)
        assert np.all((low <= errors) & (errors <= high)), (model.model_name, errors)


def test_models_without_their_library_or_mesh_are_left_out_with_the_reason(monkeypatch):
    monkeypatch.setitem(sys.modules, "ngsolve", None)
    hull = box((0.4, 0.3, 0.2), (4, 4, 4))
    velocity = np.ones(len(hull.areas))
    made = compare_models(hull, 100.0, velocity, AIR)
    assert list(made.omitted) == ["boundary_elements"]
    assert "lineofaction[boundary-elements]" in made.omitted["boundary_elements"]
    coarse = compare_models(Hull(hull.nodes, hull.triangles[1:]), 3000.0, velocity[1:], AIR)
    assert list(coarse.results) == ["equivalent_radiated_power"]
    assert "6 edges in a wavelength" in coarse.omitted["monopoles"]
    with pytest.raises(InputError, match="Nothing moves"):
        compare_models(hull, 100.0, 0.0 * velocity, AIR)
