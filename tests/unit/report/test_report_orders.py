"""Figures of orders, and runs that hold too little for them: what is missing is said in a sentence."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from command_line import loa
from planetary_scenes import driven_scene, planetary_scene, published_set
from rich.table import Table

from dynamics import RunResult, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import whirl_modes
from dynamics.orders import order_waterfall
from dynamics.results.run_result import SERIES
from lineofaction.cli.output import console
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES
from lineofaction.report.comparison.compare import stored_comparison
from lineofaction.report.document import _study_page, stored_figures
from lineofaction.report.drawing.figure import Panel
from lineofaction.report.response.excitations import excitation_figures, excitation_table
from lineofaction.report.run.levels import MAP_DEPTH as DEPTH
from lineofaction.report.run.levels import (
    campbell,
    frequency_blocks,
    levels_over_speed,
    order_blocks,
    order_map,
)
from lineofaction.report.run.page import (
    _dynamic_factor_figure,
    _planet_sharing,
    _sideband_tables,
    dynamic_results,
)
from lineofaction.report.run.signals import TOO_SHORT, octave_bands
from lineofaction.report.run.view import RunView, selected_signal

MODES = {
    "frequency": [0.0, 300.0, 301.0, 900.0],
    "damping_ratio": [0.0, 0.05, 0.05, 0.02],
    "freedom": ["input.y"] * 4,
}


def panel(figure) -> Panel:
    (found,) = figure.content
    return found


def diagram(run: RunResult):
    signal = selected_signal(run, RunView())
    return campbell(run, signal, frequency_blocks(run, signal))


def levels(run: RunResult, **view):
    signal = selected_signal(run, RunView(**view))
    return panel(levels_over_speed(run, signal, order_blocks(run, signal)))


def test_the_campbell_diagram_is_loudest_along_the_second_order(run):
    figure = diagram(replace(run, modes=MODES))
    shade = panel(figure).shade
    assert shade.z.max() == pytest.approx(DEPTH)
    loudest = shade.y[np.argmax(shade.z, axis=0)]
    np.testing.assert_allclose(loudest[20:], 2 * 20 * shade.x[20:] / 60, atol=11.3)  # half a line
    modes = [line.y[0] for line in panel(figure).lines if line.name == "natural modes"]
    assert modes == [300.0, 900.0]
    assert figure.table.rows[0][:3] == ("300.0", "5.0", "input.y")
    assert figure.table.rows[0][3].startswith("1 at 300 Hz, 2 at 150 Hz")


def test_whirl_modes_follow_the_speed_of_the_run(run):
    """A mode of 250 Hz that rises by 0.2 Hz per Hz of the mesh, and one that falls."""
    mesh = np.linspace(0.0, 300.0, 7)
    over = {
        "shaft": "input",
        "speed": (mesh * np.pi / 10.0).tolist(),
        "mesh_frequency": [mesh.tolist()],
        "frequency": [(250.0 - 0.2 * mesh).tolist(), (250.0 + 0.2 * mesh).tolist()],
        "damping_ratio": [[0.05] * 7, [0.04] * 7],
        "whirl": [[0.0, *[-1.0] * 6], [0.0, *[1.0] * 6]],
        "freedom": ["input.tilt_x"] * 2,
    }
    figure = diagram(replace(run, modes=MODES | {"over_speed": over}))
    lines = {line.name: line for line in panel(figure).lines if "whirl" in line.name}
    excited = next(line for line in panel(figure).lines if line.name == "mesh orders")
    np.testing.assert_allclose(lines["forward whirl"].y, 250.0 + 0.2 * excited.y, rtol=1e-9)
    np.testing.assert_allclose(lines["backward whirl"].y, 250.0 - 0.2 * excited.y, rtol=1e-9)
    assert not any(line.name == "natural modes" for line in panel(figure).lines)
    falls, rises = figure.table.rows
    assert rises[:4] == ("250.0", "310.0", "4.0", "forward whirl")
    # 250 + 0.2 f = k f, within 0 to 300 Hz
    assert rises[5].startswith(f"2 at {250 / 1.8:.0f} Hz, 3 at {250 / 2.8:.1f} Hz")
    assert falls[5].startswith(f"1 at {250 / 1.2:.0f} Hz, 2 at {250 / 2.2:.0f} Hz")


def test_only_runs_with_gyroscopic_terms_hold_modes_over_speed():
    scene = driven_scene(published_set(3), speed=TimeLaw.constant(900.0), duration=0.002)
    plain = simulate(replace(scene, effects={"gyroscopic": "off"}))
    assert "over_speed" not in plain.modes
    whole = simulate(replace(scene, effects={"gyroscopic": "on"}))
    over = whole.modes["over_speed"]
    assert over["speed"][-1] == pytest.approx(900.0) and over["shaft"] == "sun"
    assert sorted(row[-1] for row in over["frequency"]) == pytest.approx(
        whirl_modes(assemble(scene)).frequency, rel=1e-12
    )


def test_a_mode_is_named_by_what_moves(run):
    moves = [{"output, torsional": 0.9, "input, lateral": 0.1}] * 4
    figure = diagram(replace(run, modes=MODES | {"moves": moves}))
    assert figure.table.rows[0][2] == "output, torsional 90 %; input, lateral 10 %"
    notes = {note.text for note in panel(figure).notes}
    assert {"output, torsional 300.0 Hz", "1×", "2×"} <= notes


def test_levels_are_those_of_the_run(run):
    """Orders 1 and 2 of 10 and 20 N; levels in dB re 1 N, rms or peak, and their sum."""
    overall, first, second, *others = levels(run, orders=(1, 2, 4), scale="peak").lines
    middle = slice(8, -4)
    np.testing.assert_allclose(first.y[middle], 20.0, atol=0.2)
    np.testing.assert_allclose(second.y[middle], 20.0 * np.log10(20.0), atol=0.2)
    np.testing.assert_allclose(overall.y[middle], 20.0 * np.log10(np.sqrt(250.0)), atol=0.2)
    assert max(line.y[middle].max() for line in others) < 0.0
    _, effective, _ = levels(run, orders=(1, 2)).lines
    np.testing.assert_allclose(first.y - effective.y, 10.0 * np.log10(2.0), atol=1e-9)


def test_the_largest_orders_are_cut_unless_named(run):
    names = [line.name for line in levels(run).lines]
    assert names[:3] == ["overall, rms", "1×", "2×"] and len(names) == 6


def test_an_order_map_has_its_lines_at_the_orders_of_the_run(run):
    signal = selected_signal(run, RunView())
    shade = panel(order_map(run, signal, order_blocks(run, signal))).shade
    np.testing.assert_allclose(shade.y[np.argmax(shade.z, axis=0)], 2.0, atol=1.0 / 16)


def test_octave_bands_hold_the_power_of_the_signal(run):
    signal = selected_signal(run, RunView())
    blocks = frequency_blocks(run, signal)
    figure = octave_bands(run, signal, blocks)
    maximum = panel(figure).lines[0]
    assert float(np.max(maximum.y)) == pytest.approx(20.0 * np.log10(np.sqrt(0.5) * 20.0), abs=0.3)


def test_at_constant_speed_the_axis_is_time(run):
    steady = replace(run, speed=np.full_like(run.speed, 50.0))
    assert levels(steady).x.label == "time, s"


def test_the_dynamic_factor_of_a_constant_force_is_its_ratio(run):
    largest, mean, minimum = panel(_dynamic_factor_figure(run)).lines
    for line in (largest, mean, minimum):
        np.testing.assert_allclose(line.y, 2660.0 / 2660.44, rtol=1e-12)


def test_load_sharing_is_drawn_for_sun_and_ring_and_only_for_planets():
    run = simulate(planetary_scene(published_set(3), duration=0.02))
    figure = _planet_sharing(run)
    assert [part.title for part in figure.content] == ["sun", "ring"]
    assert len(figure.table.rows) == 6
    assert [section.title for section in dynamic_results(run, RunView())][-1] == "Mesh forces"


def sidebands_of(run: RunResult):
    return _sideband_tables(run, selected_signal(run, RunView()))


def test_sidebands_are_tabulated_with_what_modulates(run):
    travel = np.unwrap(run.position[0], period=1.0)
    force = run.bearing_force.copy()
    force[1, 1] *= 1.0 + 0.3 * np.cos(2 * np.pi * travel / 20)
    (table,) = sidebands_of(replace(run, bearing_force=force))
    assert table.rows[0][0] in ("1", "2")
    assert {row[1] for row in table.rows[:2]} <= {"+1 × pinion", "-1 × pinion", "+1 × wheel", "-1 × wheel"}
    assert sidebands_of(run) == ()


STORED = "lineofaction.report.document"
SHAPES = {name: series.dimensions for name, series in SERIES.items()}


def first(run: RunResult, samples: int, **changes: Any) -> RunResult:
    cut = {
        name: value[..., :samples]
        for name, value in vars(run).items()
        if isinstance(value, np.ndarray) and value.shape[-1:] == run.time.shape
    }
    return replace(run, **(cut | changes))


@pytest.mark.parametrize("samples", [1, 2, 21, 100, 161])
def test_a_run_of_few_samples_is_drawn(run, samples, tmp_path):
    first(run, samples).to_netcdf(tmp_path / "run.nc")
    report = stored_figures({"file": str(tmp_path / "run.nc")})
    assert json.dumps(report, allow_nan=False)
    drawn = [figure["key"] for section in report["sections"] for figure in section["figures"]]
    assert "signal" in drawn
    assert ("spectrum" in drawn) == (TOO_SHORT not in [section["text"] for section in report["sections"]])


@pytest.mark.parametrize("speed", [0.0, 1e-9])
def test_a_run_without_motion_is_drawn(run, speed, tmp_path):
    """Nothing varies, and the mesh frequency lies below the first line of the spectrum."""
    still = {"mesh_frequency": np.full_like(run.mesh_frequency, speed), "position": 0.0 * run.position}
    replace(run, bearing_force=0.0 * run.bearing_force, **still).to_netcdf(tmp_path / "run.nc")
    report = stored_figures({"file": str(tmp_path / "run.nc")})
    assert json.dumps(report, allow_nan=False)
    assert "spectrum" in [figure["key"] for section in report["sections"] for figure in section["figures"]]


def test_runs_too_short_for_orders_are_refused_by_their_length(run, tmp_path):
    first(run, 400).to_netcdf(tmp_path / "run.nc")
    with pytest.raises(BadInput, match="at least 16 base pitches"):
        stored_comparison({"files": [str(tmp_path / "run.nc")] * 2})


def test_a_run_without_meshes_is_not_compared(run, tmp_path):
    alone = {name: value[:0] for name, value in vars(run).items() if SHAPES.get(name, ("",))[0] == "mesh"}
    case = run.case | {"meshes": [], "gears": []}
    replace(run, **(alone | {"mesh": (), "case": case})).to_netcdf(tmp_path / "run.nc")
    with pytest.raises(BadInput, match="a run without meshes"):
        stored_comparison({"files": [str(tmp_path / "run.nc")] * 2})


def test_orders_of_a_run_without_meshes_are_refused(run, tmp_path):
    rotor = replace(run, mesh=(), position=run.position[:0], mesh_frequency=run.mesh_frequency[:0])
    with pytest.raises(InputError, match="orders are those of a mesh"):
        order_waterfall(rotor, "bearing_force")


def test_a_defect_of_drawing_is_no_damage_of_the_file(tmp_path, monkeypatch):
    study = STUDIES["response"]

    monkeypatch.setattr(f"{STORED}.read_stored", lambda _study, _file: object())
    monkeypatch.setattr(f"{STORED}.page_with_database", _defect)
    with pytest.raises(ValueError, match="argmax of an empty sequence"):
        _study_page(study, tmp_path / "response.nc", None)


def _defect(*_arguments: object) -> None:
    raise ValueError("argmax of an empty sequence")


def test_a_table_is_no_run_to_export(database, tmp_path):
    database.to_netcdf(tmp_path / "ste.nc")
    ended = loa("export", tmp_path / "ste.nc", "-o", tmp_path / "run.csv")
    assert (ended.exit_code, ended.stderr[:12]) == (2, "error: file ")
    assert "must be a run" in ended.stderr


@pytest.mark.parametrize("name", ["[/b]", "[red]", ":smile:"])
def test_a_terminal_shows_names_as_they_are(name, capsys):
    grid = Table(name, title=name)
    grid.add_row(name)
    console().print(f"bearing {name}")
    console().print(grid)
    assert capsys.readouterr().out.count(name) == 4


def test_orders_beside_the_mesh_are_listed_by_name_and_not_drawn_among_harmonics():
    amounts = {"transmission_error": 2e-7, "load_moment": 0.1, "friction_force": 0.0}
    amounts |= {
        "error_of_transmission_error": 1e-9,
        "error_of_load_moment": None,
        "error_of_friction_force": None,
    }
    row = {"mesh": "mesh", "torque": 40.0} | amounts
    facts = {
        "turning": {"mesh": {"mesh": 1.0}, "shaft": {"pinion": 1.0 / 19.0}},
        "excitations": [row | {"harmonic": 1, "order": 1.0}, row | {"harmonic": None, "order": 11.0 / 19.0}],
    }
    table = excitation_table(facts)
    assert [cells[2:5] for cells in table.rows] == [
        ("1", "1", "200.0 ± 1.0"),
        ("", "0.5789 (pinion 11)", "200.0 ± 1.0"),
    ]
    (figure,) = excitation_figures(facts)
    assert [bars.x.size for bars in figure.content[0].bars] == [1, 1]
