"""Vibration of housings under the forces of their bearings."""

from dynamics.vibration.bearing_harmonics import BearingHarmonics, ReportedHarmonics
from dynamics.vibration.housing_motion import housing_motion
from dynamics.vibration.housing_power import HousingPower, housing_power
from dynamics.vibration.housing_vibration import HousingVibration, housing_vibration
from dynamics.vibration.levels import overall, vibration_level
from dynamics.vibration.motion_quantity import MotionQuantity
from dynamics.vibration.points import named_points
from dynamics.vibration.seat_forces import finer_seat_forces, run_seat_forces, seat_forces
from dynamics.vibration.surface_weight import mean_square, surface_weight
from dynamics.vibration.time_signal import motion_pieces, motion_signal, point_signal
from dynamics.vibration.vibration_analysis import (
    Parts,
    SurfaceShape,
    VibrationAnalysis,
    analyze_vibration,
    bearing_parts,
    mean_square_mobility,
    mode_parts,
    mode_shape,
    operating_deflection,
    transfer_functions,
)

__all__ = [
    "BearingHarmonics",
    "HousingPower",
    "HousingVibration",
    "MotionQuantity",
    "Parts",
    "ReportedHarmonics",
    "SurfaceShape",
    "VibrationAnalysis",
    "analyze_vibration",
    "bearing_parts",
    "finer_seat_forces",
    "housing_motion",
    "housing_power",
    "housing_vibration",
    "mean_square",
    "mean_square_mobility",
    "mode_parts",
    "mode_shape",
    "motion_pieces",
    "motion_signal",
    "named_points",
    "operating_deflection",
    "overall",
    "point_signal",
    "run_seat_forces",
    "seat_forces",
    "surface_weight",
    "transfer_functions",
    "vibration_level",
]
