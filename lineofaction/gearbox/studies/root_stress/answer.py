"""Figures of the tooth-root stress."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Figures, Json, Part


class PeakFigures(Part):
    """The largest stress of a root, and where it is; the position is that of the tooth's own pair."""

    stress_mpa: float
    error_mpa: float
    position: float
    flank_coordinate_mm: float
    tangent_angle_deg: float
    face_position_mm: float


class PassageFigures(Part):
    """Stress over the passage of a tooth, in base pitches of its own pair."""

    position: list[float]
    tension_mpa: list[float]
    compression_mpa: list[float]
    at_tension_peak_mpa: list[float]
    at_compression_peak_mpa: list[float]


class GearRootFigures(Part):
    """The roots of one gear."""

    tension: PeakFigures
    compression: PeakFigures
    critical_section_mm: float
    iso_6336_3_mpa: float | None
    passage: PassageFigures


class RootStressFigures(Figures):
    """The roots of both gears at one load and one alignment."""

    torque_n_m: float
    normal_force_n: float
    misalignment_um: float
    center_distance_change_mm: float
    pinion: GearRootFigures
    wheel: GearRootFigures
    receipt: Json


ANSWER = RootStressFigures
