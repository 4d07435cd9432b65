"""A row for every study of the registry: a small question, what its figures must be, and its CSV.

The contract of studies (tests/api/test_contract_of_studies.py) asks each question in Python, by the verb and
over HTTP. A study without a row here fails it.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from pytest import approx
from small_inputs import small_inputs

from bounds.error_digits import error_text, to_error
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.study import Study

Json = dict[str, Any]
Pairs = Iterator[tuple[Any, Any]]
Witness = Callable[[Json, Any, SteDatabase], Pairs]

FORCE_N = 1.0 / (0.010 * math.cos(math.radians(20.0)))
"""1 N m on the base circle of 20 teeth of module 1 mm."""
TORQUE = 1
"""Index of 1 N m in the small case, whose loads are 0.5 and 1 N m."""


@dataclass(frozen=True)
class StudyRow:
    """One study of one kind of subject.

    `witness` yields, of figures, result and the table of the small case, pairs of a figure in the units of
    the boundary and what it must be: from the result in SI, from another study or in closed form.
    `columns` are those of the CSV, `own` the figures that differ by who asks (the verb has the name of a
    file), `ends` how the lines begin in which the verb says its main results.
    """

    study: str
    subject: str
    witness: Witness
    question: Json | None = None
    columns: Callable[[Json], dict[str, Sequence[Any]]] | None = None
    own: tuple[str, ...] = ()
    ends: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.study}-{self.subject}"

    @property
    def registered(self) -> Study:
        return STUDIES[self.study]

    @property
    def inputs(self) -> Json:
        """The subject, and beside it what is varied; that of `listen` lacks the hash of its run."""
        inputs = small_inputs(self.study)
        if self.question is None:
            return inputs
        return {
            "scene": small_inputs(self.study).get("scene", small_inputs("modes")["scene"])
        } | self.question


def mean_um(table: SteDatabase) -> Any:
    """Return the mean transmission error of the table over a pitch, by torque."""
    return 1e6 * table.static_transmission_error[:, :, 0, 0].mean(axis=0)


def ripple_um(table: SteDatabase) -> Any:
    """Return the peak-to-peak transmission error at the points of the table, by torque."""
    return 1e6 * np.ptp(table.static_transmission_error[:, :, 0, 0], axis=0)


def _flank(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    yield figures["normal_force_n"], FORCE_N
    yield figures["torque_n_m"], 1.0
    yield figures["largest_pressure_mpa"], 1e-6 * result.clear_pressure.max()
    yield figures["edge_pressure_mpa"], 1e-6 * result.edge_pressure
    yield figures["largest_line_load_n_per_mm"], 1e-3 * result.line_load.max()
    yield figures["largest_line_load_n_per_mm"], FORCE_N / 4.0  # a pair carries all on 4 mm


def _ablated_case(figures: Json, result: Any, table: SteDatabase) -> Pairs:
    yield figures["nominal"]["mean_um"][TORQUE], mean_um(table)[TORQUE]
    coupling = figures["effects"][0]
    for with_, without, change in zip(
        coupling["with"]["mean_um"], coupling["without"]["mean_um"], coupling["mean_change_um"], strict=True
    ):
        yield change, without - with_
    yield figures["torque_n_m"], [0.5, 1.0]


def _ablated_scene(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    (lateral,) = figures["effects"]
    yield lateral["name"], "lateral"
    yield lateral["level"]["decibels"], result.effects[0].level.decibels
    yield lateral["level_change"]["decibels"], result.effects[0].level_change.decibels
    yield np.shape(lateral["order_change_um"]), (1, 5)
    yield np.shape(lateral["bearing_order_change_n"])[1], 5


def _case_ladder(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    (thin, corrected), half = figures["rungs"], figures["rungs"][0]["mean_um"][0]
    yield thin["mean_um"][TORQUE], 2.0 * half  # thin slices are linear
    yield corrected["mean_um"], (1e6 * result.results[1].mean).tolist()
    yield corrected["peak_to_peak_um"], (1e6 * result.results[1].peak_to_peak).tolist()
    off = [abs(a / b - 1.0) for a, b in zip(thin["mean_um"], corrected["mean_um"], strict=True)]
    yield thin["mean_error"], max(off)
    yield (figures["reference"], figures["solves"]), ("corrected", 16 * 2)


def _scene_ladder(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    yield [rung["name"] for rung in figures["rungs"]], ["quasi_static", "100_nm", "10_nm"]
    yield figures["reference"], "10_nm"


def _sensitivity(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    (pair,), (study,) = figures["pairs"], result
    yield pair["normal_force_n"], FORCE_N
    yield pair["center_distance_mm"], 20.0
    for told, curves in zip(pair["curves"], study.curves, strict=True):
        skew = told["misalignment"]
        first, last = skew["peak_to_peak_um"]
        yield skew["misalignment_um"], [0.0, 5.0]
        yield skew["peak_to_peak_um"], (1e6 * curves.misalignment.peak_to_peak).tolist()
        yield skew["peak_to_peak_error_um"], (1e6 * curves.misalignment.error).tolist()
        yield skew["change_percent"], [0.0, 100.0 * (last / first - 1.0)]
        distance, change = told["center_distance"], curves.center_distance_change
        yield distance["center_distance_change_percent"], (100.0 * change.deviation / 20e-3).tolist()
        yield distance["peak_to_peak_um"], (1e6 * change.peak_to_peak).tolist()


def _root_stress(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    for gear in ("pinion", "wheel"):
        tension, passage = figures[gear]["tension"], figures[gear]["passage"]
        yield tension["stress_mpa"], approx(73.0, rel=0.03)  # 25 MPa of F_t / (b m) by 1.71 by 1.78
        yield max(passage["tension_mpa"]), tension["stress_mpa"]
        yield min(passage["compression_mpa"]), figures[gear]["compression"]["stress_mpa"]
    yield figures["normal_force_n"], FORCE_N


def _optimum(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    for told, design in ((figures["start"], result.start), (figures["optimum"], result.optimum)):
        yield told["peak_to_peak_um"], (1e6 * design.figures.peak_to_peak).tolist()
        yield told["objective_um"], float(np.mean(told["peak_to_peak_um"]))  # without scatter and weights
        for gear, values in told["values"].items():
            length = design.values[f"{gear}.tip_relief_length"]
            yield values["tip_relief_length_mm"], 1e3 * length
    yield figures["torque_n_m"], [0.5, 1.0]
    yield figures["gain_um"], figures["start"]["objective_um"] - figures["optimum"]["objective_um"]


def _scatter(figures: Json, result: Any, table: SteDatabase) -> Pairs:
    yield figures["nominal_um"], ripple_um(table).tolist()
    yield figures["mean_um"], np.mean(figures["peak_to_peak_um"], axis=0).tolist()
    yield figures["deviation_um"], (1e6 * result.deviation).tolist()
    # class 6: (0.4 m_n + 0.001 d + 4) sqrt(2) = 6.25 um, in steps of half a micrometer
    yield figures["asked"]["tolerances"]["pinion.profile_slope_um"], 6.5
    yield np.shape(figures["peak_to_peak_um"]), (4, 2)
    yield (figures["exact"], figures["held"]), (4, 3)
    above = np.array([[amplitude > 0.5e-6 for amplitude in row] for row in result.above.amplitude])
    yield figures["above"]["share"], above.mean(axis=0).tolist()
    yield figures["above"]["limit_um"], 0.5


def _sweep(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    (ripple,) = (each for each in result.sweep.quantities if each.name == "peak_to_peak")
    (pressure,) = (each for each in result.sweep.quantities if each.name == "max_pressure")
    points = figures["points"]
    yield [point["load.torque_n_m"] for point in points], [0.5, 1.0]
    yield [point["peak_to_peak_um"] for point in points], (1e6 * ripple.value).tolist()
    yield [point["peak_to_peak_error_um"] for point in points], (1e6 * ripple.error).tolist()
    half, full = (point["max_pressure_mpa"] for point in points)
    yield [half, full], (1e-6 * pressure.value).tolist()
    yield half, approx(full / math.sqrt(2.0), rel=0.01)  # Hertz


def _modes(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    yield [mode["frequency_hz"] for mode in figures["at_rest"]], result.natural_frequency.tolist()
    yield figures["equilibrium"]["mesh_force_n"]["mesh"], FORCE_N
    yield figures["mesh_frequency_hz"]["mesh"], [0.0]


def _response(figures: Json, result: Any, table: SteDatabase) -> Pairs:
    mesh = figures["meshes"]["mesh"]
    yield mesh["static_transmission_error_um"], (1e6 * np.abs(result.static_transmission_error[0])).tolist()
    yield mesh["mesh_force_n"], np.abs(result.mesh_force[0]).T.tolist()
    yield mesh["load_moment_n_m"], np.abs(result.load_moment[0]).tolist()
    yield mesh["friction_force_n"], np.abs(result.friction_force[0]).tolist()
    yield from _excitations(figures, mesh["static_transmission_error_um"], table)
    bearing = figures["bearings"]["input at 0"]["force_n"]
    yield np.shape(bearing), np.shape(mesh["mesh_force_n"])


def _excitations(figures: Json, transmission_error_um: list[float], table: SteDatabase) -> Pairs:
    """What excites at 1 N m, harmonic by harmonic; a table with the minimal receipt states no errors."""
    rows = figures["excitations"]
    yield [row["harmonic"] for row in rows], list(range(1, len(rows) + 1))
    yield [row["transmission_error_um"] for row in rows], transmission_error_um[: len(rows)]
    yield {row["error_of_transmission_error_um"] for row in rows}, {None}
    yield {round(row["torque_n_m"], 6) for row in rows}, {float(table.torque[-1])}


def _complaint(figures: Json, result: Any, table: SteDatabase) -> Pairs:
    (first,) = figures["passing"]
    harmonic = table.harmonics(torque=1.0)[0].value  # times the stiffness at 1 N m
    stiffness = float(np.mean(1.0 / table.tangent_compliance[:, -1]))
    yield first["excitation_n"], approx(harmonic * stiffness, rel=0.02)
    yield figures["ranked_by"], "excitation"
    yield figures["torque_n_m"], {"mesh": approx(1.0)}
    yield (first["kind"], first["name"], first["harmonic"]), ("mesh", "mesh", 1)
    yield (first["frequency_hz"], first["order"]), (1200.0 / 60.0 * 20, 20.0)
    yield first["force_n"], result.forces[0].force
    yield [mode["frequency_hz"] for mode in figures["modes"]], [mode.frequency for mode in result.modes]


def _complaint_of_case(figures: Json, result: Any, table: SteDatabase) -> Pairs:
    (first,) = figures["passing"]
    yield (first["name"], first["harmonic"], first["frequency_hz"]), ("pair", 1, approx(400.0))
    yield figures["torque_n_m"], {"pair": float(table.torque[-1])}
    yield [figures[name] for name in ("equilibrium", "effect_ledger")], [None, None]
    yield (figures["modes"], result.modes), ([], ())


def _force_waves(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    """A pulsation of 2 kPa and waves of 30 and 1 kPa in a bore of 80 mm by 150 mm at 300 rpm."""
    area = 2.0 * math.pi * 0.080 * 0.150
    yield (
        [wave["name"] for wave in figures["waves"]],
        ["motor 20, r = 2", "motor 48, r = 0", "motor 48, r = 1"],
    )
    yield [wave["frequency_hz"] for wave in figures["waves"]], [100.0, 240.0, 240.0]
    yield [wave["radial_pressure_mpa"] for wave in figures["waves"]], [30e-3, 12e-3, 1e-3]
    yield [row["torque_n_m"] for row in figures["orders"]], [0.0, 2e3 * 0.080 * area]
    yield [row["pull_n"] for row in figures["orders"]], [0.0, 0.5 * area * abs(1e3 + 200.0 * 1j * -1j)]
    (line,) = figures["mesh_orders"]
    yield (line["temporal_order"], line["mesh"], line["harmonic"]), (20, "mesh", 1)
    yield (
        (line["mesh_order"], line["mesh_frequency_hz"], line["distance_percent"]),
        (20.0, 100.0, approx(0.0)),
    )
    yield (figures["largest"], figures["error"]), ("motor 20, r = 2", "the table states no error")
    yield figures["shaft"], result.shaft


def _noise(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    yield np.transpose(figures["level_db"]).tolist(), (10.0 * np.log10(result.power / 1e-12)).tolist()
    yield figures["frequency_hz"][0], [300.0 / 60.0 * 20]
    yield figures["speed_rpm"], [300.0]
    total = 10.0 * math.log10(sum(10.0 ** (level / 10.0) for (level,) in figures["level_db_a"]))
    yield figures["total_level_db_a"], [total]


def _vibration(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    velocity = result.analysis.vibration.velocity[0]  # of the cover, amplitudes in m/s
    along = np.moveaxis(1e3 * np.abs(velocity) / math.sqrt(2.0), -1, 1)
    cover = figures["points"]["cover"]
    yield cover["velocity_xyz_mm_per_s"], along.tolist()
    yield cover["velocity_mm_per_s"], np.linalg.norm(cover["velocity_xyz_mm_per_s"], axis=0).tolist()
    yield cover["overall_mm_per_s"], np.linalg.norm(cover["velocity_mm_per_s"], axis=0).tolist()
    yield figures["contributions"]["frequency_hz"], figures["contributions"]["order"] * 300.0 / 60.0 * 20


def _recording(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    rms = math.sqrt(float(np.mean(result.recording.samples**2)))
    yield figures["rms"], rms
    yield figures["sound"]["level_db"], 20.0 * math.log10(rms / 20e-6)
    yield figures["full_scale"], float(np.abs(result.recording.samples).max())
    yield (figures["unit"], figures["sample_rate_hz"]), ("Pa", 48000)


def _steady(figures: Json, result: Any, table: SteDatabase) -> Pairs:
    (up,) = figures["up"]
    mesh = up["meshes"]["mesh"]
    yield mesh["mean_error_um"], float(1e6 * result.mean_error[0, 0])
    yield mesh["mean_error_um"], approx(mean_um(table)[TORQUE], rel=0.02)  # near that of the table
    yield 0.5 * (mesh["least_force_n"] + mesh["largest_force_n"]), approx(FORCE_N, rel=0.1)
    yield up["speed_rpm"], 3000.0
    yield up["bearings"]["input at 0"]["rms_force_n"], float(result.rms_bearing_force[0, 0])


def _deflection(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    (case,) = figures["load_cases"]
    (mesh,), left = case["meshes"], case["bearings"][0]
    yield mesh["force_n"], FORCE_N
    yield left["elastic_um"][:2], [1e6 * force / 1e8 for force in left["force_n"][:2]]
    yield left["force_n"][1], -0.5 / 0.010  # the pinion's half of the tangential force
    yield mesh["flanks"]["peak_to_peak_um"], 1e6 * result.flanks[0].peak_to_peak
    yield (case["torque_n_m"], case["status"]), (1.0, "converged")


def _elastic_ring(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    first, last = figures["load_cases"]
    yield last["force_n"], FORCE_N
    yield last["ring_deflection_um"], approx(2.0 * first["ring_deflection_um"])
    yield last["ring_deflection_um"], float(1e6 * result.ring_deflection[1].mean())
    yield sum(last["share"]), approx(4.0)
    yield [line["order"] % 4 for line in figures["side_lines"]], [0] * len(figures["side_lines"])
    yield figures["modes"][0]["frequency_hz"], float(result.mode_frequency[0])


def _change(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    (case,) = figures["load_cases"]
    whole, first, *_ = case["lines"]
    yield [line["order"] for line in case["lines"]], ["all", "1", "2", "3"]
    yield case["torque_n_m"], approx(1.0)
    for side, design in (("before", result.before), ("after", result.after)):
        orders = sum(10.0 ** (0.1 * line[side]["nominal_db"]) for line in case["lines"][1:])
        yield whole[side]["nominal_db"], approx(10.0 * math.log10(orders))
        yield whole[side]["median_db"], float(np.median(design.pairs[:, 0, 0]))
    yield first["change"]["nominal_db"], float(result.after.nominal[0, 1] - result.before.nominal[0, 1])
    yield figures["pairs"], 4


def _heard_optimum(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    heard = figures["heard"]
    (levels,) = heard["levels"]
    yield heard["torque_n_m"], [approx(1.0)]
    yield heard["gain_db"], result.start.objective.value - result.optimum.objective.value
    for design, side in (("start", "before_db"), ("optimum", "after_db")):
        orders = sum(10.0 ** (0.1 * line[side]) for line in levels[1:])
        yield levels[0][side], approx(10.0 * math.log10(orders))
        relief = getattr(result, design).values["pinion.tip_relief"]
        yield heard[design]["values"]["pinion"]["tip_relief_um"], approx(1e6 * relief)
    yield (figures.get("runs"), figures["outcome"]), (None, result.outcome.value)


def _many_scenes(figures: Json, result: Any, _table: SteDatabase) -> Pairs:
    (response,) = figures["responses"]
    yield response["mean"], (1e6 * result.figure[:, 0]).tolist()
    low, high = response["mean"]
    yield response["spread_of_level_means"]["loads.brake.torque_n_m"], high - low
    yield (figures["points"], figures["usable"], response["unit"]), (2, 2, "um")


# What stands in the columns of CSV.


def _sensitivity_columns(figures: Json) -> dict[str, Sequence[Any]]:
    curves = [
        curve
        for pair in figures["pairs"]
        for told in pair["curves"]
        for curve in (told["misalignment"], told["center_distance"])
    ]
    ripples = [
        ripple
        for curve in curves
        for ripple in zip(curve["peak_to_peak_um"], curve["peak_to_peak_error_um"], strict=True)
    ]
    return {
        "peak to peak, µm": [to_error(*ripple) for ripple in ripples],
        "error, µm": [error_text(*ripple) for ripple in ripples],
    }


def _ring_columns(figures: Json) -> dict[str, Sequence[Any]]:
    return {"torque_n_m": [case["torque_n_m"] for case in figures["load_cases"] for _ in range(48)]}


def _wave_columns(figures: Json) -> dict[str, Sequence[Any]]:
    names = ("temporal_order", "spatial_order", "frequency_hz", "radial_phase_deg", "tangential_phase_deg")
    columns = {name: [wave[name] for wave in figures["waves"]] for name in names}
    for name in ("radial_pressure", "tangential_pressure"):
        columns[f"{name}_kpa"] = [1e3 * wave[f"{name}_mpa"] for wave in figures["waves"]]
    return columns


def _root_columns(figures: Json) -> dict[str, Sequence[Any]]:
    passages = [figures[gear]["passage"] for gear in ("pinion", "wheel")]
    names = ("position", "tension_mpa", "compression_mpa", "at_tension_peak_mpa", "at_compression_peak_mpa")
    return {name: list(chain(*(passage[name] for passage in passages))) for name in names}


def _sweep_columns(figures: Json) -> dict[str, Sequence[Any]]:
    return {name: [point[name] for point in figures["points"]] for name in figures["points"][0]}


def _vibration_columns(figures: Json) -> dict[str, Sequence[Any]]:
    """Of one speed: a row for each order."""
    cover = figures["points"]["cover"]["velocity_xyz_mm_per_s"]
    along = {f"cover_{axis}_mm_per_s": list(chain(*cover[k])) for k, axis in enumerate("xyz")}
    orders = figures["order"]
    return along | {
        "speed_rpm": figures["speed_rpm"] * len(orders),
        "order": orders,
        "valid": [float(order not in figures["orders_beyond"]) for order in orders],
        "frequency_hz": [300.0 / 60.0 * 20 * order for order in orders],
        "surface_mm_per_s": list(chain(*figures["surface_mm_per_s"])),
    }


NUMBER = r"-?[\d.]+"
FEW_ORDERS: Json = {"speed_rpm": [300.0], "orders": 3}
HEARD_MIN: Json = {
    "heard": FEW_ORDERS,
    "search": {"evaluations": 8, "sample": 4, "trials": 1, "positions": 16},
}

ROWS = (
    StudyRow("flank", "case", _flank, ends=(r"\S.*: [\d.]+ MPa",)),
    StudyRow("ablate", "case", _ablated_case),
    StudyRow("ablate", "scene", _ablated_scene, {"only": ["lateral"]}),
    StudyRow("frontier", "case", _case_ladder),
    StudyRow("frontier", "scene", _scene_ladder, {"rungs": ["quasi_static", "100_nm", "10_nm"]}),
    StudyRow("sensitivity", "case", _sensitivity, columns=_sensitivity_columns, own=("name",)),
    StudyRow("root-stress", "case", _root_stress, columns=_root_columns, ends=(r"\S.*: [\d.]+ MPa",)),
    StudyRow("optimize", "case", _optimum),
    StudyRow("optimize", "scene", _heard_optimum, HEARD_MIN),
    StudyRow("scatter", "case", _scatter),
    StudyRow("sweep", "case", _sweep, columns=_sweep_columns),
    StudyRow(
        "modes",
        "scene",
        _modes,
        ends=(rf"lowest natural frequency: {NUMBER} Hz \(", "critical speeds: none"),
    ),
    StudyRow(
        "response",
        "scene",
        _response,
        ends=(rf"largest mesh force of .+: {NUMBER} N \(order {NUMBER} of ", "largest force on bearing"),
    ),
    StudyRow(
        "complaint",
        "case",
        _complaint_of_case,
        ends=(rf"complaint: order {NUMBER} of the pinion, harmonic 1 \(at {NUMBER} Hz",),
    ),
    StudyRow(
        "complaint",
        "scene",
        _complaint,
        {"frequency_hz": 400.0, "speed_rpm": 1200.0},
        ends=(rf'complaint: order {NUMBER} of \S+, harmonic 1 of mesh "mesh" \(at {NUMBER} Hz',),
    ),
    StudyRow(
        "force-waves",
        "scene",
        _force_waves,
        columns=_wave_columns,
        ends=(r"largest force order: motor 20, r = 2",),
    ),
    StudyRow("noise", "scene", _noise, FEW_ORDERS),
    StudyRow("vibration", "scene", _vibration, FEW_ORDERS, columns=_vibration_columns),
    StudyRow("listen", "scene", _recording, own=("run",)),
    StudyRow(
        "steady",
        "scene",
        _steady,
        {"speed_rpm": [3000.0], "branch": False, "settling_periods": 1},
        ends=(
            rf"largest rms transmission error of .+: {NUMBER} µm",
            rf"largest mesh force of .+: {NUMBER} N",
        ),
    ),
    StudyRow("deflect", "scene", _deflection),
    StudyRow("elastic-ring", "case", _elastic_ring, columns=_ring_columns, own=("receipt",)),
    StudyRow("change", "scene", _change),
    StudyRow("study", "scene", _many_scenes),
)
