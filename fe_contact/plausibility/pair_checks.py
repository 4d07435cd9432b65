"""Plausibility checks of a pair and of its mesh, by nominal figures.

A finding has a value that is implausible, and the plausible range `low` to `high` that a message shows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bounds import DEPTHS, Direction, Finding, Kind, engineering
from fe_contact.flank.modification import FLANK_FIELDS, fields_of
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.toothing import Toothing
from fe_contact.plausibility.check import CHECKS, assessed
from fe_contact.plausibility.nominal_intensities import (
    nominal_deflection,
    nominal_root_stresses,
    pitch_point_pressure,
)
from fe_contact.types import FloatArray

_RATED = 20.0
"""Low end of the usual loads over the lightest plausible load."""
_HEAVY = 0.5
"""High end of the usual loads over the heaviest plausible load."""
_MISALIGNED = 0.002
"""High end of usual misalignments over the face width."""


def pair_findings(
    pair: ParallelAxes,
    load: Sequence[float] | FloatArray = (),
    misalignment: Sequence[float] | FloatArray = (),
    center_distance_change: Sequence[float] | FloatArray = (),
    *,
    loads_as: str = "torques",
) -> tuple[Finding, ...]:
    """Return the implausible values of a pair and its request.

    Parameters
    ----------
    load : sequence of float
        Normal forces F_bn, N, increasing.
    misalignment, center_distance_change : sequence of float
        Values on the axes of the table, m.
    loads_as : str
        Field that the loads were given in: "torques" or "normal_forces".
    """
    sizes = tuple(_sizes(pair))
    # a wrong module, often by its unit, makes most other values implausible: it alone is reported
    if any(finding.check == "module" for finding in sizes):
        return sizes
    return (
        *sizes,
        *_gear("pinion", pair.pinion),
        *_gear("wheel", pair.wheel),
        *_shafts(pair),
        *_deviations(pair, np.asarray(misalignment), np.asarray(center_distance_change)),
        *_loads(pair, np.asarray(load, dtype=float), loads_as),
    )


def _sizes(pair: ParallelAxes) -> Iterator[Finding]:
    gear = pair.pinion
    yield from assessed(
        "module", "normal_module", gear.normal_module, "m", unit_note=", here and in all other lengths"
    )
    yield from assessed("pressure_angle", "normal_pressure_angle", gear.normal_pressure_angle, "rad")
    if gear.helix_angle:
        yield from assessed("helix_angle", "helix_angle", gear.helix_angle, "rad")


def _gear(name: str, gear: Toothing) -> Iterator[Finding]:
    material, field = gear.material, f"{name}.material"
    yield from assessed("youngs_modulus", f"{field}.youngs_modulus", material.youngs_modulus, "Pa")
    yield from assessed("density", f"{field}.density", material.density, "kg/m^3")
    module = gear.normal_module
    ratio = f"{gear.face_width / module:.3g} modules of face width are unusual"
    yield from assessed("face_width", f"{name}.face_width", gear.face_width, "m", scale=module, reason=ratio)
    bore = getattr(gear, "bore_diameter", None)
    if bore is not None:
        root = 2.0 * gear.root_radius
        reason = f"{engineering(bore / root, 2)} of the root diameter is an unusual bore"
        for finding in assessed("bore", f"{name}.bore_diameter", bore, "m", scale=root, reason=reason):
            yield replace(finding, high=root)
    shape = gear.modification
    amounts = {field: float(getattr(shape, field)) for field in fields_of(*DEPTHS)}
    amounts["thickness_allowance"] = gear.thickness_allowance
    amounts["pitch_deviation"] = max((abs(value) for value in gear.pitch_deviation.cumulative), default=0.0)
    if shape.flank_grid is not None:
        removed = max(abs(value) for row in shape.flank_grid.removed for value in row)
        amounts["flank_grid.removed"] = removed
    for field, amount in amounts.items():
        yield from _amount(f"{name}.{field}", amount, module)
    for field in fields_of(Kind.LENGTH):
        if getattr(shape, field.removesuffix("_length")) and FLANK_FIELDS[field].along is Direction.PROFILE:
            length = float(getattr(shape, field))
            yield from assessed("relief_length", f"{name}.{field}", length, "m", scale=module)


def _amount(field: str, amount: float, module: float) -> Iterator[Finding]:
    """Check a modification, allowance or pitch deviation that is not 0."""
    if not amount:
        return
    low, high = CHECKS["relief_amount"].low or 0.0, CHECKS["relief_over_module"].high or math.inf
    findings = [*assessed("relief_amount", field, amount, "m", reason="smaller than can be made or measured")]
    if not field.endswith("thickness_allowance"):
        reason = f"{engineering(abs(amount) / module, 2)} modules of modification are implausible"
        findings += assessed("relief_over_module", field, amount, "m", scale=module, reason=reason)
    for finding in findings:
        yield replace(finding, low=low, high=high * module)


def _shafts(pair: ParallelAxes) -> Iterator[Finding]:
    for gear, shaft in zip(("pinion", "wheel"), pair.shafts, strict=True):
        if shaft is None:
            continue
        name, length, stiffness = f"{gear}.shaft", shaft.length, shaft.bearing_stiffness
        reason = f"{engineering(length / shaft.diameter, 2)} diameters between the bearings are unusual"
        scale = shaft.diameter
        yield from assessed("shaft_slenderness", f"{name}.length", length, "m", scale=scale, reason=reason)
        if stiffness is not None:
            yield from assessed("bearing_stiffness", f"{name}.bearing_stiffness", stiffness, "N/m")


def _deviations(pair: ParallelAxes, skew: FloatArray, change: FloatArray) -> Iterator[Finding]:
    """Check the largest deviation of either axis, if it is not 0."""
    face = pair.face_width
    for check, values, usual in (
        ("misalignment", skew, _MISALIGNED * face),
        ("center_distance_change", change, pair.pinion.normal_module),
    ):
        index = int(np.argmax(np.abs(values))) if values.size else 0
        value = float(values[index]) if values.size else 0.0
        if not value:
            continue
        reason = "smaller than can be aligned or measured"
        name = f"{check}s[{index}]"  # the field of a request is the plural
        for finding in assessed(check, name, value, "m", reason=reason):
            yield replace(finding, high=usual)
        if check == "misalignment":
            reason = f"{1e3 * abs(value) / face:.3g} mrad of misalignment"
            for finding in assessed("misalignment_over_face", name, value, "m", scale=face, reason=reason):
                yield replace(finding, low=CHECKS["misalignment"].low or 0.0)


def _loads(pair: ParallelAxes, load: FloatArray, loads_as: str) -> Iterator[Finding]:
    """Check the largest load: its intensity, contact pressure, root stress and tooth deflection."""
    if not load.size:
        return
    force, module = float(load[-1]), pair.pinion.normal_module
    value, unit = (float(pair.torque(force)), "N m") if loads_as == "torques" else (force, "N")
    intensity = float(pair.transverse_force(force)) / (pair.face_width * module)
    pressure, stress = pitch_point_pressure(pair, force), max(nominal_root_stresses(pair, force))
    deflection = nominal_deflection(pair, force) / module
    text = f"{intensity / 1e6:.3g} N/mm^2 of load over face width and module"
    lightest, heaviest = CHECKS["light_load"].low or 0.0, CHECKS["line_load"].high or math.inf
    field = f"{loads_as}[{load.size - 1}]"
    low, high = _RATED * lightest * value / intensity, _HEAVY * heaviest * value / intensity
    for check, amount, reason in (
        ("light_load", intensity, f"the largest load of the table is negligible, {text}"),
        ("line_load", intensity, f"no gear carries {text}"),
        ("hertz_pressure", pressure, f"a nominal contact pressure of {pressure / 1e9:.3g} GPa"),
        ("root_stress", stress, f"a nominal root stress of {stress / 1e9:.3g} GPa"),
        ("transmission_error", deflection, f"tooth deflections of {engineering(deflection, 2)} modules"),
    ):
        for finding in assessed(check, "", amount, CHECKS[check].unit, reason=reason):
            yield replace(finding, field=field, value=value, unit=unit, low=low, high=high)


def mesh_findings(pair: ParallelAxes) -> Iterator[Finding]:
    """Yield the implausible values of the mesh of a pair that is geometrically possible."""
    module = pair.pinion.normal_module
    for name, gear, clearance in zip(
        ("pinion", "wheel"), (pair.pinion, pair.wheel), pair.tip_clearances, strict=True
    ):
        field, text = f"{name} tip clearance over module", "the tip comes near the root of the mating gear"
        yield from assessed("tip_clearance", field, clearance / module, "1", reason=text)
        field, text = f"{name} tip thickness over module", "the tooth is nearly pointed"
        helix = math.atan(math.tan(gear.helix_angle) * gear.tip_radius / gear.reference_radius)
        thickness = gear.tip_tooth_thickness * math.cos(helix)
        yield from assessed("tip_thickness", field, thickness / module, "1", reason=text)
    text = "the teeth hardly take over from each other"
    ratio = pair.active_contact_ratio
    yield from assessed("contact_ratio", "transverse contact ratio", ratio, "1", reason=text)
