"""Names of the libraries' fields as the files of the boundary have them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from bounds import Declared
from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.bearings.ring_fits import RingFits
from dynamics.bearings.rolling_bearing import RollingBearing
from dynamics.bearings.seat import Bushing, PlanetBearing
from dynamics.joints.coupling import Coupling
from dynamics.joints.housing import Housing
from dynamics.joints.rotations import FreeRotation, ImposedRotation
from dynamics.loads.applied_force import AppliedForce, Unbalance
from dynamics.settings.run import Integration, Outputs
from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.bodies import Inertia
from dynamics.shafts.rigid_bodies import DiscBody, GearBody
from dynamics.shafts.shaft import Shaft as TurningShaft
from dynamics.solid_housing import Material as HousingMaterial
from dynamics.solid_housing import ReductionSettings, SeatWall
from dynamics.temperatures import Temperatures
from fe_contact.flank.drawing_starts import DrawingStarts
from fe_contact.flank.modification import FlankModification
from fe_contact.geometry import Gear, GearPair, RingGear
from fe_contact.geometry.toothing import MATING
from fe_contact.material import Material
from fe_contact.shaft import Shaft
from lineofaction.gearbox.schemas.declared import figures, parts_of
from lineofaction.gearbox.schemas.gear import SHARED

# Fields of a case, by the library's name (see fe_contact.geometry and fe_contact.planning).
_CASE = {figure.name: f"pair.{figure.field}" for figure in (*SHARED, *figures(GearPair))} | {
    "torques": "load.torque_n_m",
    "normal_forces": "load.normal_force_n",
    "misalignments": "errors.misalignment_um",
    "clearances": "errors.bearing_clearance_um",
    "center_distance_changes": "errors.center_distance_change_mm",
    "tolerance": "accuracy.tolerance",
    "tolerance_floor": "accuracy.tolerance_floor_nm",
    "time_budget": "accuracy.time_budget_s",
    "level": "accuracy.level",
    "model": "accuracy.model",
    "positions": "accuracy.positions",
    "pitches": "accuracy.pitches",
    "receipt": "accuracy.receipt",
    "on_violation": "accuracy.on_violation",
}
_OF_TABLE = {"drives": ImposedRotation, "integration": Integration, "temperatures": Temperatures}
"""Dataclasses by table, whose fields have names that mean something else in other tables."""


def _with_parts(parts: Mapping[str, Declared]) -> Iterator[type]:
    """Yield the dataclasses of parts, and of their parts."""
    for entry in parts.values():
        if entry.part is not None and figures(entry.part):
            yield entry.part
            yield from _with_parts(parts_of(entry.part))


_ANYWHERE = (
    *(FlankModification, DrawingStarts, Material, Shaft, *(Gear, RingGear, *_with_parts(parts_of(Gear)))),
    *(GearBody, DiscBody, Inertia, TurningShaft, BeamSection),
    Outputs,
    *(Bushing, Housing, PlanetBearing, Coupling, FreeRotation, AppliedForce, Unbalance),
    *(SeatWall, HousingMaterial, ReductionSettings),
    *(RollingBearing, BallBearing, RollerBearing, CatalogLine, RingFits),
)
"""Dataclasses that declare fields whose names mean the same in every table."""
DECLARED = (*_ANYWHERE, *_OF_TABLE.values())


def _fields_of(*kinds: type) -> dict[str, str]:
    return {figure.name: figure.field for kind in kinds for figure in figures(kind)}


# Boundary's name of a field by the library's, the last part of a path such as `pinion.tip_relief`.
_LAST = _fields_of(*_ANYWHERE) | {
    # gear
    "pitch_deviation": "pitch_deviation_um",
    "single_pitch_deviation": "single_pitch_deviation_um",
    "roll_length": "roll_length_mm",
    "face_position": "face_position_mm",
    "removed": "removed_um",
    "reference_diameter": "reference_diameter_mm",
    # scene
    "duration": "duration_s",
    "gravity": "gravity_m_per_s2",
    "base_radius": "base_radius_mm",
    "damping": "damping_n_s_per_m",
    "nominal_force": "nominal_force_n",
    "misalignment": "misalignment_um",
    "center_distance_change": "center_distance_change_mm",
    "angles": "angles_deg",
    "tooth_angles": "tooth_angles_deg",
    "fade": "speed_rpm",
    "speed": "speed_rpm",
    "torque": "torque_n_m",
    "force": "force_n",
    "moment": "moment_n_m",
    "highest_frequency": "highest_frequency_hz",
    "radial_clearance": "radial_clearance_um",
    "seat_positions": "seat_positions_mm",
    "point": "point_mm",
    "microphone": "microphone_mm",
    "low": "low_mm",
    "high": "high_mm",
    "backlash": "backlash_um",
    # results
    "max_pressure": "max_pressure_gpa",
    "root_stress": "root_stress_gpa",
    "transmission_error": "transmission_error_um",
}


def case_field(name: str) -> str:
    """Return the case file's name of a field of fe_contact, e.g. ``pair.pinion.bore_diameter_mm``."""
    parts = [part for part in name.split(".") if part != "modification"]
    head, index = _split_index(parts[-1])
    if len(parts) == 1 or head in MATING:  # what both share lies in [pair], whichever gear reports it
        return _CASE.get(head, _LAST.get(head, head)) + index
    parts[-1] = _LAST.get(head, head) + index
    return ".".join(["pair", *parts] if parts[0] in ("pinion", "wheel") else parts)


def boundary_name(name: str) -> str:
    """Return the boundary's name of a field of fe_contact, in the same table: ``pinion.tip_relief_um``."""
    table, dot, field = name.rpartition(".")
    return f"{table}{dot}{_LAST.get(field, field)}"


def scene_field(name: str) -> str:
    """Return the scene file's name of a field of dynamics, e.g. ``bushings[0].radial_stiffness_n_per_m``."""
    parts = ["coast_flank" if part == "coast" else part for part in name.split(".")]
    head, index = _split_index(parts[-1])
    table = _OF_TABLE.get(_split_index(parts[0])[0])
    fields = _fields_of(table) if table and len(parts) == 2 else {}
    if head in fields:
        return f"{parts[0]}.{fields[head]}"
    if len(parts) == 1 and head == "duration":
        return "run.duration_s"
    has_matrices = parts[0].startswith(("bushings", "planet_bearings", "housings", "couplings"))
    if len(parts) == 2 and has_matrices and head in ("stiffness", "damping", "mass"):
        parts[-1] = f"{head}_matrix"
    elif head == "preload":
        parts[-1] = "preload_force_n"
    else:
        parts[-1] = _LAST.get(head, head) + index
    return ".".join(parts)


def _split_index(part: str) -> tuple[str, str]:
    """Split ``torques[2]`` into the name and the index."""
    name, bracket, index = part.partition("[")
    return name, bracket + index
