"""Forces, deflection and ripple of a pair, and contact of cylinders."""

from __future__ import annotations

import math
from collections.abc import Mapping

from fe_contact import AnalysisOptions, GearPair, TableAxes, analyze
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus, half_width, peak_pressure
from fe_contact.material import Material
from fe_contact.types import Estimate


def tooth_forces(pair: ParallelAxes, torque_n_m: float) -> Mapping[str, float]:
    """Return normal, transverse and axial tooth force in N under a torque on the driving gear."""
    normal = pair.normal_force(torque_n_m)
    forces = {
        "normal": normal,
        "transverse": pair.transverse_force(normal),
        "axial": pair.axial_force(normal),
    }
    return {name: float(force) for name, force in forces.items()}


def mesh_stiffness(pair: GearPair, torque_n_m: float) -> Estimate:
    """Return force over mean transmission error along the line of action, N/m."""
    mean = analyze(pair, TableAxes(torques=[torque_n_m])).mean(torque=torque_n_m)
    force = torque_n_m / pair.pinion.base_radius
    return Estimate(force / mean.value, force / mean.value * mean.error / mean.value, "N/m")


def misaligned_ripple(
    pair: ParallelAxes, normal_force_n: float, misalignment_um: float, level: str, effects: Mapping[str, str]
) -> Mapping[str, Estimate]:
    """Return the growth of peak-to-peak transmission error by misalignment under choices of effects, %."""
    tilts = 0.0, 1e-6 * misalignment_um
    axes = TableAxes(normal_forces=[normal_force_n], misalignments=tilts)
    table = analyze(pair, axes, AnalysisOptions(level=level, effects=effects))
    aligned, tilted = (table.peak_to_peak(force=normal_force_n, misalignment=tilt) for tilt in tilts)
    ratio = tilted.value / aligned.value
    error = ratio * math.hypot(aligned.error / aligned.value, tilted.error / tilted.value)
    return {"growth": Estimate(100.0 * (ratio - 1.0), 100.0 * error, "%")}


def cylinder_on_plane(
    radius_mm: float, line_load_n_per_mm: float, moduli_gpa: tuple[float, float]
) -> Mapping[str, float]:
    """Return half-width in mm and peak pressure in MPa of a cylinder on a plane, Poisson's ratio 0.3."""
    first, second = (Material(1e9 * modulus, 0.3) for modulus in moduli_gpa)
    modulus = contact_modulus(first, second)
    line = 1e3 * line_load_n_per_mm, 1e-3 * radius_mm, modulus
    return {"half_width": 1e3 * float(half_width(*line)), "pressure": 1e-6 * float(peak_pressure(*line))}
