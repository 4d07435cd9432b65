"""Marks of a complaint: lines at its speed and frequency, its order bold, and words for what is beyond."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from lineofaction.report.document import Inputs, page_of
from lineofaction.report.drawing.figure import Axis, Figure, HeatMap, Line, Panel
from lineofaction.report.drawing.marks import drawn_orders, marked, marks_of, of_run, order_label

MARKS: dict[str, Any] = {
    "axes": {"speed of input, rpm": 1200.0, "speed of output, rpm": 600.0, "frequency, Hz": 400.0},
    "order": 2.0 / 3.0,
    "meshes": {
        "first": {"order": 2.0 / 3.0, "driver_rpm": 1200.0},
        "second": {"order": 2.0, "driver_rpm": 600.0},
    },
    "words": "400 Hz",
}
SPEED = np.array([300.0, 3000.0])


def drawn(panel: Panel) -> Figure:
    return marked(Figure("k", "title", "Caption.", "words", (panel,)), MARKS)


def references(figure: Figure) -> list[tuple[str, float, str]]:
    return [(one.direction, one.value, one.label) for one in figure.content[0].references]


def test_speed_and_frequency_cross_where_the_complaint_is():
    line = Line("mesh orders", SPEED, SPEED / 3.0, "#000")
    figure = drawn(Panel(Axis.over("speed of input, rpm", SPEED), Axis("frequency, Hz"), (line,)))
    assert references(figure) == [
        ("vertical", 1200.0, "complaint, 1200 rpm"),
        ("horizontal", 400.0, "complaint, 400 Hz"),
    ]
    assert figure.caption == "Caption."


def test_the_speed_is_that_of_the_shaft_of_the_axis():
    line = Line("force", SPEED, SPEED, "#000")
    figure = drawn(Panel(Axis("speed of output, rpm"), Axis("force, N"), (line,)))
    assert references(figure) == [("vertical", 600.0, "complaint, 600 rpm")]


def test_a_complaint_beyond_an_axis_is_said_and_not_drawn():
    shade = HeatMap(SPEED, np.array([10.0, 20.0]), np.ones((2, 2)), "level, dB", 1.0)
    figure = drawn(Panel(Axis.over("speed of input, rpm", SPEED), Axis("frequency, Hz"), shade=shade))
    assert references(figure) == [("vertical", 1200.0, "complaint, 1200 rpm")]
    assert figure.caption == "Caption. The complaint, 400 Hz, lies beyond this axis."


def test_only_the_order_of_the_complaint_is_bold():
    lines = tuple(Line(name, SPEED, SPEED, "#000", width=1.0) for name in ("order 0.6667", "order 1"))
    panel = drawn(Panel(Axis("time, s"), Axis("force, N"), lines)).content[0]
    assert [(line.name, line.width) for line in panel.lines] == [
        ("order 0.6667 (complaint)", 2.0),
        ("order 1", 1.0),
    ]
    assert panel.references == ()


def test_a_run_is_marked_by_the_pitches_and_the_driver_of_the_mesh_that_is_shown():
    """Order map and order cuts over the speed of the driving gear, and a waterfall over frequency."""
    over = Axis("speed of the driving gear, rpm")
    shade = HeatMap(SPEED, np.array([0.0, 4.0]), np.ones((2, 2)), "level, dB", 1.0)
    cuts = tuple(Line(name, SPEED, SPEED, "#000", width=1.0) for name in ("1×", "2×"))
    panels = (
        Panel(over, Axis("mesh order"), shade=shade),
        Panel(over, Axis("frequency, Hz", limits=(0.0, 500.0)), shade=shade),
        Panel(Axis("time, s"), Axis("level, dB re 1 N"), cuts),
    )
    figure = marked(Figure("k", "title", "", "words", panels), of_run(MARKS, "second"))
    lines = [[(each.direction, each.value) for each in panel.references] for panel in figure.content]
    assert lines == [
        [("vertical", 600.0), ("horizontal", 2.0)],
        [("vertical", 600.0), ("horizontal", 400.0)],
        [],
    ]
    assert [line.name for line in figure.content[2].lines] == ["1×", "2× (complaint)"]
    plain = of_run(MARKS, "third")
    assert plain["axes"] == {"frequency, Hz": 400.0} and np.isnan(plain["order"])


def test_the_order_of_the_complaint_is_among_those_shown():
    order, sizes = np.array([2.0 / 3.0, 1.0, 4.0 / 3.0, 2.0]), np.array([0.1, 3.0, 1.0, 2.0])
    assert drawn_orders(order, sizes, 2, {}) == [1, 3]
    assert drawn_orders(order, sizes, 2, {"complaint": MARKS}) == [0, 1]


def test_a_result_without_a_complaint_has_no_marks():
    @dataclass(frozen=True)
    class Result:
        metadata: dict[str, Any] = field(default_factory=dict)

    assert marks_of(Result()) is None
    assert marks_of(Result({"complaint": MARKS})) is MARKS
    assert marks_of(object()) is None


def test_a_table_is_marked_where_its_case_is_heard(database):
    """20/20 teeth at 200 N m: order 40 of the pinion is the second harmonic."""
    case = database.metadata.case | {"complaint": {"order": 40.0, "torque_n_m": 200.0}}
    heard = replace(database, metadata=replace(database.metadata, case=case))
    marked_by = {
        figure.key: {name for panel in figure.content for name in references_of(panel)}
        for section in page_of(Inputs(heard)).sections
        for figure in section.figures
    }
    assert marked_by["ripple"] == {"complaint, 200 N m"}
    assert "complaint, mesh order 2" in marked_by["ste_spectrum"]
    plain = [figure for section in page_of(Inputs(database)).sections for figure in section.figures]
    assert not any(name for figure in plain for panel in figure.content for name in references_of(panel))


def references_of(panel: Panel) -> list[str]:
    return [one.label for one in panel.references if one.label.startswith("complaint")]


def test_an_order_between_those_of_the_mesh_is_named_and_found_by_its_number():
    metadata = {"turning": {"mesh": {"mesh": 1.0}, "shaft": {"pinion": 1.0 / 3.0}}}
    named = order_label(2.0 / 3.0, metadata)
    assert named == "0.6667 (mesh 1 - pinion 1)"
    assert [order_label(2.0, metadata), order_label(0.7, metadata), order_label(2.0 / 3.0, {})] == [
        "2",
        "0.7",
        "0.6667",
    ]
    line = Line(f"order {named}", SPEED, SPEED, "#000", width=1.0)
    assert drawn(Panel(Axis("time, s"), Axis("force, N"), (line,))).content[0].lines[0].width == 2.0
