"""Vibration of housings under the forces of their bearings."""

from dynamics.vibration.housing_motion import (
    BearingHarmonics,
    ReportedHarmonics,
    finer_seat_forces,
    housing_motion,
    run_seat_forces,
    seat_forces,
)
from dynamics.vibration.housing_vibration import (
    MotionQuantity,
    housing_vibration,
    mean_square,
    overall,
    surface_weight,
    vibration_level,
)
from dynamics.vibration.measured_mobility import (
    Direction,
    MeasuredMobility,
    MeasuredVibration,
    bearing_shares,
    measured_vibration,
)
from dynamics.vibration.time_signal import motion_pieces, point_signal
from dynamics.vibration.vibration_analysis import (
    Parts,
    SurfaceShape,
    VibrationAnalysis,
    analyze_vibration,
    mean_square_mobility,
    mode_shape,
    operating_deflection,
    transfer_functions,
)

__all__ = [
    "BearingHarmonics",
    "Direction",
    "MeasuredMobility",
    "MeasuredVibration",
    "MotionQuantity",
    "Parts",
    "ReportedHarmonics",
    "SurfaceShape",
    "VibrationAnalysis",
    "analyze_vibration",
    "bearing_shares",
    "finer_seat_forces",
    "housing_motion",
    "housing_vibration",
    "mean_square",
    "mean_square_mobility",
    "measured_vibration",
    "mode_shape",
    "motion_pieces",
    "operating_deflection",
    "overall",
    "point_signal",
    "run_seat_forces",
    "seat_forces",
    "surface_weight",
    "transfer_functions",
    "vibration_level",
]
