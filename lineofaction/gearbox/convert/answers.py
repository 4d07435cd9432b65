"""Answers of an STE database in boundary units: curves, summaries, metadata, drafts.

A draft is a table that is not yet refined to its tolerance. A figure whose error was not estimated has the
error NaN in the table and no error in an answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from bounds.error_digits import with_error
from bounds.types import Json
from fe_contact.ste import Curve, SteDatabase, ToothLoads
from fe_contact.ste.curve_errors import source_words
from fe_contact.ste.curve_quantities import BY_SOURCE
from fe_contact.ste.fields import CENTER_DISTANCE, MISALIGNMENT
from fe_contact.ste.operating_point import OperatingPoint
from fe_contact.types import Estimate, FloatArray
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.problems import JobFailed
from lineofaction.gearbox.units import MM, MPA, UM, as_typed, boundary_ledger

GEARS = "pinion", "wheel"
"""Names of the driving and the driven gear in an answer."""
_RIPPLE = np.linspace(0.0, 2.0, 49)
"""Positions of the small ripple of a headline, base pitches: six in a period of the fourth harmonic."""
_ROUNDING = 1e-12
"""Length, m, below which an error is rounding."""


def curve_json(
    database: SteDatabase,
    *,
    torque_n_m: float | None = None,
    force_n: float | None = None,
    at: Sequence[float] | None = None,
    misalignment_um: float | None = None,
    center_distance_change_mm: float | None = None,
) -> Json:
    """Return one curve: position in base pitches by the driving gear, 0 = reference pair at the pitch point.

    Raises `BadInput`: the load or the alignment is outside what is stored; `JobFailed`: the table has failed
    points.
    """
    with boundary_errors():
        curve = database.curve(
            torque=torque_n_m,
            force=force_n,
            at=None if at is None else np.asarray(at, dtype=float),
            misalignment=None if misalignment_um is None else misalignment_um * UM,
            center_distance_change=None
            if center_distance_change_mm is None
            else center_distance_change_mm * MM,
        )
    answer = {
        "torque_n_m": as_typed(curve.torque),
        "normal_force_n": curve.point.force,
        "misalignment_um": as_typed(curve.point.misalignment, UM),
        "center_distance_change_mm": as_typed(curve.point.center_distance_change, MM),
        "period": curve.period,
        "position": curve.position.tolist(),
        "ste_um": (curve.ste / UM).tolist(),
        **_bands(curve),
        "pair": curve.pair.tolist(),
        "load_share": curve.load_share.tolist(),
        **_figures(curve),
    }
    inserted = inserted_json(database)
    if inserted:
        answer["inserted"] = inserted
    teeth = tooth_loads_json(database, curve.point)
    if teeth:
        answer["tooth_loads"] = teeth
    if curve.period > 1:  # over one base pitch the orders are the harmonics
        answer["order"] = curve.spectrum.order.tolist()
        answer["order_name"] = list(curve.spectrum.names)
        answer["amplitude_um"] = (curve.spectrum.amplitude / UM).tolist()
        if np.all(np.isfinite(curve.spectrum.error)):
            answer["amplitude_error_um"] = (curve.spectrum.error / UM).tolist()
    if not all(np.all(np.isfinite(answer[name])) for name in ("ste_um", "load_share")):
        raise JobFailed(
            "The curve has points without a solution. Compute the table again with other settings."
        )
    return answer


def _bands(curve: Curve) -> Json:
    """Return the error of every point, and its share by interpolation between nodes, if estimated."""
    bands = {"error_um": (curve.error / UM).tolist(), "interval_error_um": curve.interval_error / UM}
    return {name: band for name, band in bands.items() if np.isfinite(band).all()}


def inserted_json(database: SteDatabase) -> Json:
    """Return the nodes that were inserted to meet a tolerance, by the names of the axes that have any."""
    force = database.inserted_force
    torque_per_force = float(database.torque[-1] / database.force[-1])  # m, the same at all loads
    axes = {
        "torque_n_m": _typed(force, 1.0 / torque_per_force),
        "normal_force_n": force.tolist(),
        "misalignment_um": _typed(database.inserted_misalignment, UM),
        "center_distance_change_mm": _typed(database.inserted_center_distance_change, MM),
    }
    return {name: nodes for name, nodes in axes.items() if nodes}


def _typed(values: FloatArray, unit: float) -> list[float]:
    return [as_typed(float(value), unit) for value in values]


def tooth_loads_json(database: SteDatabase, point: OperatingPoint) -> Json:
    """Return the loads of the teeth by the names of the gears whose teeth differ."""
    loads = database.tooth_loads(**asdict(point), allow_failed=True)
    return {GEARS[loads_of_gear.gear]: _tooth_loads(loads_of_gear) for loads_of_gear in loads}


def teeth_text(teeth: Sequence[int]) -> str:
    """Name teeth by their numbers: "tooth 7", "teeth 1 and 10", "tooth 1 and 4 more"."""
    first, *others = teeth
    if not others:
        return f"tooth {first}"
    return f"teeth {first} and {others[0]}" if len(others) == 1 else f"tooth {first} and {len(others)} more"


def _tooth_loads(loads: ToothLoads) -> Json:
    answer: Json = {
        "most_loaded": list(loads.most_loaded),
        "force_n": float(loads.force.max()),
        "over_mean": loads.over_mean,
        "force_by_tooth_n": loads.force.tolist(),
        "most_pressed": list(loads.most_pressed),
    }
    if np.isfinite(loads.pressure).all():
        answer["pressure_mpa"] = float(loads.pressure.max()) / MPA
        answer["pressure_by_tooth_mpa"] = (loads.pressure / MPA).tolist()
    return answer


def _figures(curve: Curve) -> Json:
    """Return mean, peak-to-peak and harmonics with their errors, or without errors if not estimated."""
    figures = {
        "mean_um": curve.mean.value / UM,
        "mean_error_um": curve.mean.error / UM,
        "peak_to_peak_um": curve.peak_to_peak.value / UM,
        "peak_to_peak_error_um": curve.peak_to_peak.error / UM,
        "harmonics_um": [item.value / UM for item in curve.harmonics],
        "harmonics_error_um": [item.error / UM for item in curve.harmonics],
    }
    if curve.over_face is not None:
        mean, ripple = curve.over_face.mean, curve.over_face.peak_to_peak
        figures["mean_over_face_um"] = mean.value / UM
        figures["mean_over_face_error_um"] = mean.error / UM
        figures["peak_to_peak_over_face_um"] = ripple.value / UM
        figures["peak_to_peak_over_face_error_um"] = ripple.error / UM
    errors = [item.error for item in (curve.mean, curve.peak_to_peak, *curve.harmonics)]
    estimated = np.isfinite(errors).all()
    return {name: value for name, value in figures.items() if estimated or "error" not in name}


def headline_json(table: SteDatabase) -> Json:
    """Return the headline of a table at its middle load: ripple over two pitches, main figures.

    The ripple is in um less its mean; an error that was not estimated is None.
    """
    force = float(table.force[table.force.size // 2])
    curve = table.curve(force=force, at=_RIPPLE, allow_failed=True)
    ripple = (curve.ste - curve.mean.value) / UM
    tone = curve.harmonics[0]
    errors = [estimate.error / UM for estimate in (curve.peak_to_peak, tone)]
    ripple_error, tone_error = (error if np.isfinite(error) else None for error in errors)
    return {
        "torque_n_m": as_typed(curve.torque),
        "peak_to_peak_um": curve.peak_to_peak.value / UM,
        "peak_to_peak_error_um": ripple_error,
        "first_harmonic_um": tone.value / UM,
        "first_harmonic_error_um": tone_error,
        "ripple_um": [float(f"{value:.4g}") for value in ripple],
    }


def summary_json(database: SteDatabase) -> Json:
    """Return the summary of `loa analyze`: figures for every load, effect ledger, receipt, failed points."""
    with boundary_errors():
        curves = [database.curve(force=float(force), allow_failed=True) for force in database.force]
    loads = [
        {"torque_n_m": as_typed(curve.torque), "normal_force_n": curve.point.force, **_figures(curve)}
        for curve in curves
    ]
    for load, curve in zip(loads, curves, strict=True):
        if teeth := tooth_loads_json(database, curve.point):
            load["tooth_loads"] = teeth
    return {
        "content_hash": database.metadata.content_hash,
        "points": int(database.status.size),
        "failed_points": database.n_failed,
        "loads": loads,
        "effect_ledger": boundary_ledger(database.metadata.effect_ledger),
        "receipt": database.metadata.receipt,
        "warnings": database.metadata.warnings,
    }


def metadata_json(database: SteDatabase) -> Json:
    """Return the metadata of a database with its axes, and the loads of teeth that differ."""
    teeth = _tooth_loads_by_load(database)
    inserted = inserted_json(database)
    return {
        "schema_version": database.metadata.schema_version,
        "content_hash": database.metadata.content_hash,
        "case": database.metadata.case,
        "effect_ledger": boundary_ledger(database.metadata.effect_ledger),
        "receipt": database.metadata.receipt,
        "warnings": database.metadata.warnings,
        "software_versions": database.metadata.software_versions,
        "failed_points": database.n_failed,
        "period": database.period,
        "position": database.position.tolist(),
        "torque_n_m": [as_typed(torque) for torque in database.torque],
        "normal_force_n": database.force.tolist(),
        "misalignment_um": _typed(database.requested_nodes(MISALIGNMENT), UM),
        "center_distance_change_mm": _typed(database.requested_nodes(CENTER_DISTANCE), MM),
        **({"inserted": inserted} if inserted else {}),
        **({"tooth_loads": teeth} if any(teeth) else {}),
    }


def _tooth_loads_by_load(database: SteDatabase) -> list[Json]:
    """Return the loads of teeth at every load of the table, at the alignment nearest to zero.

    The list is empty if the table has failed points.
    """
    axes = (database.requested_nodes(axis) for axis in (MISALIGNMENT, CENTER_DISTANCE))
    aligned = [float(axis[np.argmin(np.abs(axis))]) for axis in axes]
    if database.n_failed:
        return []
    return [tooth_loads_json(database, OperatingPoint(float(f), *aligned)) for f in database.force]


def source_rows(receipt: Json, load: int) -> list[tuple[str, float, float, float]]:
    """Return a row for each source of error at the load of an index: the source, then its errors in m.

    The errors are those of the mean, the peak-to-peak and the first harmonic. Rounding has no row.
    """
    rows = []
    for name, parts in receipt.get("curve_error", {}).items():
        mean, ripple, harmonic = (float(parts[quantity][load]) for quantity in BY_SOURCE)
        if max(mean, ripple, harmonic) > _ROUNDING:
            rows.append((source_words(name), mean, ripple, harmonic))
    return rows


def draft_line(table: SteDatabase, refining: str) -> str:
    """Return mean and peak-to-peak with errors at the highest load, and the next refinement."""
    curve = table.curve(force=float(table.force[-1]), allow_failed=True)
    mean, ripple = _figure(curve.mean), _figure(curve.peak_to_peak)
    return f"draft: mean {mean} µm, p-p {ripple} µm at {curve.torque:.6g} N m (refining {refining})"


def _figure(estimate: Estimate) -> str:
    return with_error(estimate.value / UM, estimate.error / UM)
