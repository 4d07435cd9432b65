"""The drawing of a gearbox: names of gears stand free, and the drawing holds them."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from two_stage_scenes import two_stages

from dynamics.deflection import deflect
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, Outline
from lineofaction.gearbox.studies.deflect.run import _pattern
from lineofaction.report.deflection.gearbox_drawing import (
    _gear_names,
    _view_direction,
    gearbox_drawing,
    micrometers,
)
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, panel_height
from lineofaction.report.drawing.interactive import plotly_figure


@pytest.fixture(scope="module")
def outline():
    found = Outline.of(two_stages())
    return replace(found, gears=("first pinion", "wheel of the first stage", "second pinion", "second wheel"))


@pytest.mark.law
def test_the_pieces_of_a_shaft_are_as_long_as_it_and_a_rigid_shaft_is_one():
    scene = two_stages()
    first, *others = scene.shafts
    scene = replace(scene, shafts=(replace(first, sections=()), *others))
    found = Outline.of(scene)
    lengths = [found.piece[found.piece_shaft == k, 1] for k in range(len(found.shafts))]
    assert lengths[0].size == 1
    np.testing.assert_allclose([length.sum() for length in lengths], found.length)


@pytest.mark.parametrize(
    ("length", "written"),
    [(0.0, "0"), (-8.81e-11, "< 0.001"), (1e-9, "0.00100"), (-1.2345e-5, "-12.3")],
)
def test_a_length_below_a_nanometer_is_not_written_out(length, written):
    assert micrometers(length) == written


def test_no_name_of_a_gear_touches_a_circle_or_another_name(outline):
    names = _gear_names(outline)
    center, radius = outline.origin[outline.gear_shaft, :2], 0.5 * outline.gear[:, 2]
    size = float(np.ptp(center[:, 0]))
    for k, name in enumerate(names):
        assert name.note.text == outline.gears[k]
        distance = np.linalg.norm(name.points[:, None] - center, axis=2)
        assert np.min(np.abs(distance - radius)) > 0.01 * size
        assert np.all(distance[:, k] > radius[k])
        for other in names[:k]:
            assert np.min(np.linalg.norm(name.points[:, None] - other.points, axis=2)) > 0.03 * size


def test_the_end_view_holds_circles_and_names(outline):
    found = deflect(two_stages(), positions=1)
    result = GearboxDeflection(found, (), 1, 0.0, True, outline, {}, 0.0)
    view = gearbox_drawing(result, found.cases[0]).content[1]
    for axis, pick in ((view.x, 0), (view.y, 1)):
        low, high = axis.limits
        texts = [1e3 * name.points[:, pick] for name in _gear_names(outline)]
        values = np.concatenate([*texts, *((line.x, line.y)[pick] for line in view.lines)])
        assert low < values.min() and values.max() < high


@pytest.mark.parametrize(
    ("across", "along", "height"), [(330.0, 50.0, 1.0), (330.0, 150.0, 1.5), (1.0, 1.0, 2.0)]
)
def test_a_drawing_is_as_tall_as_it_needs_within_bounds(across, along, height):
    box = Line("box", np.array([0.0, across]), np.array([0.0, along]), "#000000")
    panel = Panel(Axis("mm"), Axis("mm"), (box,), equal=True)
    assert panel_height(panel) == pytest.approx(height)
    assert panel_height(replace(panel, equal=False)) == 1.0
    panels = (replace(panel, equal=False), panel)
    layout = plotly_figure(Figure("boxes", "", "", "", panels))["layout"]
    curves, drawing = (np.diff(layout[axis]["domain"])[0] for axis in ("yaxis", "yaxis2"))
    assert drawing / curves == pytest.approx(height, rel=1e-4)


def test_shafts_that_end_in_one_place_are_named_in_one_row(outline):
    origin = outline.origin.copy()
    origin[1] = origin[0] + [0.0, 0.001, 0.0]
    found = deflect(two_stages(), positions=1)
    result = GearboxDeflection(found, (), 1, 0.0, True, replace(outline, origin=origin), {}, 0.0)
    notes = gearbox_drawing(result, found.cases[0]).content[0].notes
    assert [note.text for note in notes] == ["in, mid", "out"]


def test_a_bent_train_is_seen_from_where_its_axes_lie_apart(outline):
    origin = np.array([[0.0, 0.0, 0.0], [0.1, 0.04, 0.0], [0.14, -0.09, 0.0]])
    across = np.array([0.17, -0.06, 0.0])  # as far from the first to the second as to the third
    case = deflect(two_stages(), positions=1).cases[0]
    seen = _view_direction(replace(outline, origin=origin), case)
    assert seen == pytest.approx(across / np.linalg.norm(across), abs=np.radians(1.0))


@pytest.mark.parametrize(("rows", "slices"), [(96, 90), (10, 7)])
def test_a_contact_pattern_keeps_the_largest_pressure(rows, slices):
    face = np.linspace(-0.01, 0.01, slices)
    flanks: Any = SimpleNamespace(
        face_position=face, slice_width=face[1] - face[0], face_load=np.ones((1, slices))
    )
    roll, peak = np.linspace(0.004, 0.019, rows), np.zeros((rows, slices))
    for row, column in ((3, 2), (rows - 2, slices // 2)):
        pressure = peak.copy()
        pressure[row, column] = 1e9
        along, pattern = _pattern(flanks, roll, pressure)
        assert pattern.shape == (40, 41) and pattern.max() == 1e9
        at = np.unravel_index(pattern.argmax(), pattern.shape)
        assert abs(along[at[0]] - roll[row]) <= 0.5 * max(np.diff(along)[0], np.diff(roll)[0]) * 1.001
