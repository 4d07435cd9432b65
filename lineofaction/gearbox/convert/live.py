"""Live questions: from a stored table and a change of its flanks to curves, and results on the flanks.

The gears of a stored table are *condensed*: the compliance of their flanks is known, so that the contact of
changed flanks is solved at once. A *passage* is the load of a tooth pair on its way through the mesh. The
*band* has the curves of pairs that are drawn within a tolerance class.
"""

from __future__ import annotations

import json
import math
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from bounds.types import Json
from fe_contact.analysis.flanks.load_distribution import LoadDistribution, load_distribution
from fe_contact.analysis.flanks.pressure_map import pressure_map
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.curve_derivatives import CurveDerivatives, FlankDerivatives, curve_derivatives
from fe_contact.microgeometry.tolerances import iso1328_tolerances
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import BETWEEN_NODES, errors_by_source, source_names
from fe_contact.ste.curve_quantities import BY_SOURCE
from fe_contact.ste.operating_point import OperatingPoint
from fe_contact.types import FloatArray
from host import cpu_seconds
from lineofaction.gearbox.convert.answers import curve_json
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.convert.case import gear_pair, with_flanks
from lineofaction.gearbox.problems import BadInput, Fault, NotAnalyzed, NotFound
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.live import LiveInput
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.units import MM, MPA, UM, factor, in_um

if TYPE_CHECKING:
    from fe_contact.microgeometry.drawn_ripple import DrawnRipple

_N_PER_MM = 1e3
"""N/m in a N/mm."""
_SAME_LOAD = 1e-9
"""Relative rounding by which a torque may differ from a load of a table."""
_DIGITS = 5
"""Significant digits of numbers that are only drawn."""
_STEPS, _COLUMNS = 32, 64
"""Positions in a base pitch and most columns over the face of a passage."""
_PLACES = ("pair.", "load.", "errors.")
"""Prefixes of a case's fields, which the fields of a question do not have."""
_OF_BAND = {"torque_n_m", "misalignment_um", "center_distance_change_mm"}
_OF_BAND |= {"pinion", "wheel", "tolerance_class"}
"""Fields of a question on which its band depends."""
_MAX_DRAWN = 4
"""Most bands of a case that stay in memory."""
_FLANK_POINTS, _ROOT_POINTS, _TIP_POINTS = 24, 24, 5
"""Points of a drawn tooth outline along its flank, its root and its tip."""


def _derivatives_json(derivatives: CurveDerivatives) -> Iterator[Json]:
    """Yield, for each torque, the derivatives of the curve in um by figures of the flanks in their units."""
    names = [boundary_name(name) for name in derivatives.names]
    flanks = {gear: derivatives.on_flank(gear) for gear in ("pinion", "wheel")}
    for k in range(derivatives.torque.size):
        by = {}
        for a, name in enumerate(names):
            scale = factor(name) / UM
            harmonics = scale * derivatives.harmonics[a, :, k]
            by[name] = {
                "ste_um": (scale * derivatives.by[a, :, k]).tolist(),
                "mean_um": float(scale * derivatives.mean[a, k]),
                "peak_to_peak_um": float(scale * derivatives.peak_to_peak[a, k]),
                "harmonics_um": [float(value) if np.isfinite(value) else None for value in harmonics],
            }
        yield {"by": by} | {gear: _flank(flank, k) for gear, flank in flanks.items()}


def _flank(flank: FlankDerivatives, k: int) -> Json:
    """Return the grid of one flank at a torque, per um removed."""
    return {
        "roll_length_mm": (flank.roll_length / MM).tolist(),
        "face_position_mm": (flank.face_position / MM).tolist(),
        "mean_um": flank.mean[k].tolist(),
        "peak_to_peak_um": flank.peak_to_peak[k].tolist(),
    }


def _flanks_json(flanks: LoadDistribution) -> Json:
    """Return the results on the flanks; K_Hbeta is null in the plane, whose load is even by assumption."""
    roll, pressure = pressure_map(flanks, flanks.roll_length_1)
    load = flanks.face_load
    worst = int(load.max(axis=-1).argmax())
    over_face = flanks.face_position.size > 1
    return {
        "largest_pressure_mpa": float(flanks.clear_pressure.max() / MPA),
        "edge_pressure_mpa": flanks.edge_pressure / MPA,
        "k_h_beta": flanks.mean_face_load_factor if over_face else None,
        "roll_length_mm": _short(roll / MM),
        "face_position_mm": _short(flanks.face_position / MM),
        "pressure_mpa": _short(pressure / MPA),
        "mean_load_n_per_mm": _short(load.mean(axis=0) / _N_PER_MM),
        "worst_load_n_per_mm": _short(load[worst] / _N_PER_MM),
        "worst_position": float(flanks.position[worst]),
    }


def _passage_json(flanks: LoadDistribution, separation: FloatArray) -> Json:
    """Return load and separation of a pair of teeth through the mesh; `separation` (P, N, K) in m.

    The place of a pair is its position plus its index, in base pitches. Rows are evenly spaced over the
    places at which the pair carries load. Where teeth differ, only the first base pitch of the period counts.
    """
    first = flanks.position - flanks.position[0] < 1.0
    path_position = (flanks.position[first, None] + flanks.pair).ravel()
    order = np.argsort(path_position)
    loaded = (flanks.pressure[first] > 0.0).any(axis=-1).ravel()
    # one more row at either end, where the pair carries no load
    low = math.floor(path_position[loaded].min() * _STEPS) - 1
    high = math.ceil(path_position[loaded].max() * _STEPS) + 1
    rows = np.arange(low, high + 1) / _STEPS
    columns = min(_COLUMNS, separation.shape[-1])
    face = np.linspace(flanks.face_position[0], flanks.face_position[-1], columns)

    def on_grid(values: FloatArray) -> FloatArray:
        """Interpolate values (P, N, K) at the rows and at the face positions."""
        table = values[first].reshape(path_position.size, -1)[order]
        by_row = interpolated_columns(rows, path_position[order], table)
        return interpolated_columns(face, flanks.face_position, by_row.T).T

    return {
        "first_place": low / _STEPS,
        "step": 1.0 / _STEPS,
        "face_position_mm": _short(face / MM),
        "pressure_mpa": np.rint(on_grid(flanks.pressure) / MPA).astype(int).tolist(),
        "apart_um": np.round(on_grid(separation) / UM, 2).tolist(),
    }


def interpolated_columns(x: FloatArray, knots: FloatArray, values: FloatArray) -> FloatArray:
    """Return `numpy.interp` of every column of `values`, (knots, ...), at once: (x, ...)."""
    if knots.size == 1:
        return np.repeat(values, x.size, axis=0)
    left = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, knots.size - 2)
    slope = (values[left + 1] - values[left]) / (knots[left + 1] - knots[left])[:, None]
    inside = slope * (x - knots[left])[:, None] + values[left]
    low, high = (x < knots[0])[:, None], (x >= knots[-1])[:, None]
    return np.where(low, values[0], np.where(high, values[-1], inside))


def _short(values: FloatArray) -> Any:
    """Return numbers rounded to `_DIGITS` digits, as lists."""
    # exponent of the first digit
    size = np.floor(np.log10(np.where(values == 0.0, 1.0, np.abs(values))))
    scale = 10.0 ** (_DIGITS - 1 - size)
    return (np.rint(values * scale) / scale).tolist()


@dataclass(frozen=True)
class CondensedCase:
    """A case with condensed gears, and state that its questions share."""

    case: Case
    pair: ParallelAxes
    """Gear pair with the flanks that the case states."""
    bodies: CondensedPair
    table: SteDatabase
    """Stored table, which states the figures of these flanks at its loads and alignments."""
    drawn: OrderedDict[str, DrawnRipple] = field(default_factory=OrderedDict)
    """Pairs drawn within tolerances, by the text of the question; every answer solves some more."""


def condensed_of(file: Path, cache: Path, *, compute: bool = False) -> CondensedCase:
    """Return the case of a stored table, and its gears with the compliance by which the table was computed.

    Raises `NotFound`: the table was removed since it was requested; `NotAnalyzed`: the compliance is not in
    the cache, and is not to be computed.
    """
    if not file.exists():
        raise NotFound("The database was removed from the store during the request. Submit its case again.")
    database = SteDatabase.from_netcdf(file)
    # strict models take JSON's lists for tuples only from text
    case = Case.model_validate_json(json.dumps(database.metadata.case))
    pair = gear_pair(case)
    with boundary_errors():
        bodies = condensed_pair(pair, database, dict(case.effects), cache, compute=compute)
    if bodies is None:
        raise NotAnalyzed(
            "The compliance of these gears is not in the cache of this service: they were analyzed "
            "elsewhere, or it was removed. Ask once with condense = true: it is then computed here first, in "
            "seconds in the plane and up to some minutes over the face."
        )
    return CondensedCase(case, pair, bodies, database)


def live_curves(condensed: CondensedCase, change: LiveInput) -> Json:
    """Return the curves of the changed flanks; raises `BadInput` by the fields of the question.

    The case was checked when its table was computed, so that only the changed flanks are checked.
    """
    try:
        changes = {name: _figures_of(getattr(change, name)) for name in ("pinion", "wheel")}
        pair = with_flanks(condensed.pair, condensed.case, changes)
        with boundary_errors():
            table = None if change.preview or any(changes.values()) else condensed.table
            answer = _answer(condensed.bodies, pair, change, table)
            if change.tolerance_class is not None:
                _add_band(answer, condensed.bodies, pair, change, condensed.drawn)
        return answer
    except BadInput as error:
        raise BadInput(_by_question(fault) for fault in error.faults) from None


def _figures_of(flank: BoundaryModel) -> dict[str, object]:
    """Return the figures that a change of a flank states."""
    return {name: value for name, value in flank if value is not None}


def _add_band(
    answer: Json,
    bodies: CondensedPair,
    pair: ParallelAxes,
    change: LiveInput,
    drawn: OrderedDict[str, DrawnRipple],
) -> None:
    """Solve further drawn pairs within the class, and add the band to the answer once there are enough."""
    from fe_contact.microgeometry.drawn_ripple import DrawnRipple  # noqa: PLC0415 (start-up time)

    begin, chosen = cpu_seconds(), change.tolerance_class
    if len(change.torque_n_m) > 1 or chosen is None:
        raise BadInput.of("tolerance_class", chosen, "left out, or with one torque", "Request them in turn.")
    name = change.model_dump_json(include=_OF_BAND)
    ripple = drawn.pop(name, None)
    if ripple is None:
        across = bodies.checked.model.across_face
        tolerances = iso1328_tolerances(pair, chosen, across_face=across)
        alignment = change.misalignment_um * UM, change.center_distance_change_mm * MM
        ripple = DrawnRipple.of(bodies, pair, change.torque_n_m[0], tolerances, *alignment)
    drawn[name] = ripple.further() if ripple.missing else ripple
    while len(drawn) > _MAX_DRAWN:
        drawn.popitem(last=False)
    answer["curves"][0]["band"] = _band(drawn[name], chosen)
    answer["cost"]["band_cpu_seconds"] = cpu_seconds() - begin


def _band(ripple: DrawnRipple, tolerance_class: int) -> Json:
    """Return the band of the drawn pairs, in um; only their numbers until all are solved."""
    pairs = len(ripple.deviation)
    known = {"tolerance_class": tolerance_class, "pairs": pairs, "solved": ripple.solved}
    known["of"] = ripple.solved + ripple.missing
    if ripple.missing:
        return known
    band = ripple.band()
    figures = {"peak_to_peak": band.peak_to_peak, "first_harmonic": band.first_harmonic}
    return known | {
        "position": band.position.tolist(),
        "low_um": _short(band.low / UM),
        "high_um": _short(band.high / UM),
        **{
            name: {f"{end}_um": value / UM for end, value in vars(spread).items()}
            for name, spread in figures.items()
        },
    }


def _answer(bodies: CondensedPair, pair: ParallelAxes, change: LiveInput, stored: SteDatabase | None) -> Json:
    """Return the curves, each with the further answers that the question requests, and the cost.

    The curves at loads and alignments of `stored` are those of that table: a report, the terminal and this
    answer state one number with one error. A table without errors has those of the answer here, and what it
    is off from it.
    """
    torques = np.array(change.torque_n_m)
    alignment = change.misalignment_um * UM, change.center_distance_change_mm * MM
    table, solved = bodies.solve_table(pair, torques, *alignment, preview=change.preview)
    nodes = [_stored_load(stored, table, k) for k in range(table.force.size)]
    curves = [
        _curve(table, k) if stored is None or node is None else _stored_curve(stored, node, table, k)
        for k, node in enumerate(nodes)
    ]
    answer = {"curves": curves, **_receipt(table)}

    @cache
    def loaded(k: int) -> LoadDistribution:
        return load_distribution(solved.pair, solved.problem, solved.solution, k)

    def on_flanks() -> Iterator[Json]:
        for k, node in enumerate(nodes):
            known = {} if stored is None or node is None else _stored_pressure(stored, node)
            yield _flanks_json(loaded(k)) | known

    def passages() -> Iterator[Json]:
        separation = solved.problem.displacement(solved.solution.force)
        for k in range(table.force.size):
            yield _passage_json(loaded(k), separation[:, k].reshape(loaded(k).force.shape))

    def derivatives() -> Iterator[Json]:
        return iter(_derivatives_json(curve_derivatives(bodies, pair, torques, None, *alignment)))

    for name, made in (("flanks", on_flanks), ("passage", passages), ("derivatives", derivatives)):
        if getattr(change, name):
            begin = cpu_seconds()
            for curve, part in zip(curves, made(), strict=True):
                curve[name] = part
            answer["cost"][f"{name}_cpu_seconds"] = cpu_seconds() - begin
    return answer


def _stored_load(stored: SteDatabase | None, solved: SteDatabase, k: int) -> tuple[int, int, int] | None:
    """Return the node of the stored table at load k: indices of load, misalignment and center distance.

    None is returned if the stored table has no node there.

    Between loads and alignments the table interpolates, with a larger error than an answer that is solved.
    """
    if stored is None or stored.n_failed:
        return None
    load = int(np.argmin(np.abs(stored.force - solved.force[k])))
    tilts = np.flatnonzero(stored.misalignment == solved.misalignment[0])
    distances = np.flatnonzero(stored.center_distance_change == solved.center_distance_change[0])
    if abs(stored.force[load] / solved.force[k] - 1.0) > _SAME_LOAD or not tilts.size or not distances.size:
        return None
    return load, int(tilts[0]), int(distances[0])


def _stored_pressure(stored: SteDatabase, node: tuple[int, int, int]) -> Json:
    """Return the largest pressures of the stored table at one load and alignment."""
    at = (slice(None), *node)
    edge = float(np.nanmax(stored.edge_pressure[at])) if stored.edge_pressure.size else 0.0
    return {
        "largest_pressure_mpa": float(np.nanmax(stored.max_pressure[at])) / MPA,
        "edge_pressure_mpa": edge / MPA,
    }


def _stored_curve(stored: SteDatabase, node: tuple[int, int, int], solved: SteDatabase, k: int) -> Json:
    """Return the curve of the stored table at one load and alignment, at the positions of the solved one."""
    load, tilt, distance = node
    nearest = stored.force[load]
    alignment = float(stored.misalignment[tilt]), float(stored.center_distance_change[distance])
    curve = curve_json(
        stored,
        force_n=float(nearest),
        at=solved.position.tolist(),
        misalignment_um=alignment[0] / UM,
        center_distance_change_mm=alignment[1] / MM,
    )
    if "mean_error_um" not in curve:
        return curve | _errors_beside(curve, _curve(solved, k))
    errors = errors_by_source(stored, OperatingPoint(float(nearest), *alignment))
    return curve | {
        "bias": in_um(stored.metadata.receipt.get("bias")),
        "error_by_source_um": {
            source: {
                name.removesuffix("_m"): float(of_source[index] / UM) for name, index in BY_SOURCE.items()
            }
            for source, of_source in zip(source_names(errors), errors, strict=True)
            if source not in BETWEEN_NODES and np.isfinite(of_source).all()
        },
    }


def _errors_beside(curve: Json, solved: Json) -> Json:
    """Return errors of a curve without any: those of one solved now, and what the curve is off from it."""
    bounds: Json = {"bias": solved["bias"]}
    for name, error in solved.items():
        value = name.replace("error_um", "um") if name != "error_um" else "ste_um"
        if not name.endswith("error_um") or curve.get(value) is None or solved.get(value) is None:
            continue
        bound = np.asarray(error) + np.abs(np.asarray(curve[value]) - np.asarray(solved[value]))
        bounds[name] = bound.tolist()
    further = {}
    for name in BY_SOURCE:
        key = name.removesuffix("_m")
        if key == "first_harmonic":
            own, whole = solved["harmonics_error_um"][0], bounds["harmonics_error_um"][0]
        else:
            own, whole = solved[f"{key}_error_um"], bounds[f"{key}_error_um"]
        further[key] = float(np.sqrt(whole**2 - own**2))
    return bounds | {"error_by_source_um": solved["error_by_source_um"] | {"positions": further}}


def _curve(table: SteDatabase, k: int) -> Json:
    return curve_json(table, force_n=float(table.force[k])) | {
        "bias": in_um(table.metadata.receipt.get("bias")),
        "error_by_source_um": {
            source: {
                name.removesuffix("_m"): error if np.isfinite(error := values[k] / UM) else None
                for name, values in errors.items()
            }
            for source, errors in table.metadata.receipt["curve_error"].items()
        },
    }


def _receipt(table: SteDatabase) -> Json:
    receipt, ledger = table.metadata.receipt, cast("list[Json]", table.metadata.effect_ledger)
    assumptions: list[Json] = receipt["assumptions"]
    stages = receipt["stages"]
    return {
        "effects": {entry["name"]: entry["on"] for entry in ledger},
        "beyond_load_patches": receipt["beyond_load_patches"],
        "discretisation_error": receipt["discretisation_error"],
        "not_estimated": receipt["not_estimated"],
        "residuals_max": receipt["residuals_max"],
        "assumptions": [check for check in assumptions if check["holds"] is not None],
        "not_checked": [check for check in assumptions if check["holds"] is None],
        "cost": {
            f"{name.replace(' ', '_')}_cpu_seconds": stage["cpu_seconds"] for name, stage in stages.items()
        },
    }


def _by_question(fault: Fault) -> Fault:
    """Return a fault of the case by the field of the question, whose alignments are single values."""
    name = fault.field.removesuffix("[0]") if fault.field.startswith("errors.") else fault.field
    name = next((name.removeprefix(prefix) for prefix in _PLACES if name.startswith(prefix)), name)
    return Fault(name, fault.value, fault.bound, fault.suggestion)
