"""Accuracy to discretization, and the receipt."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest
from spur_gears import PAIR

from fe_contact import AllowedError, AnalysisOptions
from fe_contact.contact import ContactModel
from fe_contact.errors import InputError
from fe_contact.hertz import half_width, relative_radius
from fe_contact.planning.plan import Plan, make_plan
from model_studies.stage_clock import StageClock


@pytest.fixture(scope="module")
def pair():
    return PAIR


def plan(pair, model: ContactModel | None = None, **accuracy: object) -> Plan:
    return make_plan(pair, np.array([1e3]), AnalysisOptions(**accuracy), model or ContactModel())


def test_levels_are_nested_refinements_with_a_coarse_mesh(pair):
    sizes = [
        plan(pair, level=name).discretization.recipes[0].flank_size for name in ("draft", "standard", "fine")
    ]
    assert sizes[0] > sizes[1] > sizes[2]
    made = plan(pair).discretization
    assert made.coarse_recipes[1].flank_size == pytest.approx(2.0 * made.recipes[1].flank_size)


def test_patches_follow_strips_of_half_the_load_and_the_law_holds_all_of_them(pair):
    """A patch as wide as the tooth would spoil the curves of the usual loads (docs/theory/contact.md)."""
    module, radius = pair.pinion.normal_module, relative_radius(*pair.roll_lengths(0.0))

    def strip(load):
        return float(half_width(load / pair.face_width, radius, 115e9))

    overload = make_plan(pair, np.array([pair.normal_force(1e5)]), AnalysisOptions(), ContactModel()).patch
    assert overload.half_width == pytest.approx(math.sqrt(1.5) * 0.225 * module, rel=1e-12)
    assert overload.law_length == pytest.approx(0.375 * module, rel=1e-12)
    heavy = 0.4 * (0.225 * module / strip(1.0)) ** 2
    found = make_plan(pair, np.array([1e3, heavy]), AnalysisOptions(), ContactModel(), "fine").patch
    assert found.half_width == pytest.approx(math.sqrt(1.5) * strip(0.5 * heavy), rel=0.01)
    assert found.law_length >= strip(2.0 * heavy) / 0.66


def test_coarse_patches_are_wider_as_the_elements_are_but_for_strips_and_slices(pair):
    light, heavy = np.array([1.0]), np.array([pair.normal_force(1e5)])
    for model in (ContactModel(), ContactModel(across_face=True)):
        found = make_plan(pair, light, AnalysisOptions(), model)
        made = found.discretization
        elements = made.coarse_recipes[0].flank_size / made.recipes[0].flank_size
        assert found.coarse_patch.half_width / found.patch.half_width == pytest.approx(elements, rel=1e-12)
        loaded = make_plan(pair, heavy, AnalysisOptions(), model)
        widest = max(found.coarse_patch.half_width, loaded.patch.half_width)
        assert loaded.coarse_patch.half_width == pytest.approx(widest, rel=1e-12)
    narrow = replace(pair, pinion=replace(pair.pinion, face_width=2e-3))
    found = make_plan(narrow, light, AnalysisOptions(), ContactModel(across_face=True))
    slice_width = narrow.face_width / found.discretization.slices
    assert found.coarse_patch.half_width <= max(slice_width, found.patch.half_width)


def test_slices_follow_the_layers(pair):
    """More slices than freedoms along the face would make the compliance between them singular."""
    for level in ("draft", "standard", "fine"):
        made = plan(pair, ContactModel(across_face=True), level=level).discretization
        assert made.slices <= min(2 * recipe.layers for recipe in made.recipes)
        assert made.coarse_recipes[0].layers < made.recipes[0].layers
    # Layers are of each gear's own face; slices of the common one.
    wide = replace(pair, pinion=replace(pair.pinion, face_width=4.0 * pair.wheel.face_width))
    made = plan(wide, ContactModel(across_face=True), level="draft").discretization
    layer = wide.pinion.face_width / made.recipes[0].layers
    assert wide.face_width / made.slices >= 0.66 * layer
    assert wide.face_width / (made.slices + 1) < 0.67 * layer
    assert made.in_slices(31).slices == made.slices


@pytest.mark.parametrize("wish", [{"tolerance": AllowedError(0.01)}, {"time_budget": 5.0}])
def test_a_level_is_a_mesh_and_takes_no_other_wish(wish):
    with pytest.raises(InputError, match="level"):
        AnalysisOptions(level="draft", **wish)


def test_the_clock_adds_stages_and_books_the_rest():
    clock = StageClock()
    for _ in range(2):
        with clock.stage("work"):
            end = time.process_time() + 0.02
            while time.process_time() < end:
                pass
    receipt = clock.to_json()
    assert receipt["stages"]["work"]["cpu_seconds"] >= 0.04
    assert receipt["cpu_seconds"] == pytest.approx(receipt["stages"]["work"]["cpu_seconds"])
    assert receipt["peak_memory_bytes"] > 1e6
    end = time.process_time() + 0.02
    while time.process_time() < end:
        pass
    clock.finish("mesh")
    clock.finish("rest")
    assert list(clock.seconds) == ["work", "mesh", "rest"]
    assert clock.seconds["mesh"] >= 0.015
    assert clock.seconds["rest"] < clock.seconds["mesh"]
