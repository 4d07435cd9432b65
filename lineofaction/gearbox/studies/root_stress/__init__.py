"""Load and alignment at which the tooth roots are looked at."""

from __future__ import annotations

from typing import Annotated

from lineofaction.gearbox.schemas.figures import Figures, Json, Part, Source
from lineofaction.gearbox.schemas.flank_point import FlankPoint


class Inputs(FlankPoint):
    """One load and one alignment; the case supplies the fields that are left out."""


class RootStressFigures(Figures):
    """The roots of both gears at one load and one alignment."""

    class GearRootFigures(Part):
        """The roots of one gear."""

        class PeakFigures(Part):
            """The largest stress of a root, its place, and the position of the tooth's pair at that time."""

            stress_mpa: Annotated[float, Source("stress.value")]
            error_mpa: Annotated[float, Source("stress.error")]
            position: Annotated[float, Source(lambda peak: peak.position % 1.0 + peak.pair)]
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

        tension: PeakFigures
        compression: PeakFigures
        critical_section_mm: Annotated[float, Source("critical_coordinate")]
        iso_6336_3_mpa: Annotated[float | None, Source("nominal")]
        passage: PassageFigures

    torque_n_m: float
    normal_force_n: float
    misalignment_um: float
    center_distance_change_mm: float
    pinion: GearRootFigures
    wheel: GearRootFigures
    receipt: Json
