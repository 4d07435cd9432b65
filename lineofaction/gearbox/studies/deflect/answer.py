"""Figures of a deflection."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Part

RatingLife = Literal["limited", "unlimited", "none: no capacity"]


class Agreement(Part):
    """Whether tables and deflections agree."""

    agreed: bool
    passes: int
    relative_change: float | None


class Flanks(Part):
    """A mesh on its flanks; K_Hbeta is None in the plane."""

    torque_n_m: float
    k_h_beta: float | None
    largest_pressure_mpa: float
    mean_um: float
    mean_error_um: float | None
    peak_to_peak_um: float
    peak_to_peak_error_um: float | None
    harmonics_um: list[float]
    harmonics_error_um: list[float | None]
    centroid_difference_mm: float | None


class Mesh(Part):
    """A mesh under a load case."""

    name: str
    force_n: float
    misalignment_um: float
    misalignment_over_cycle_um: tuple[float, float]
    causes_um: dict[str, float]
    center_distance_change_um: float
    lead_torsion_um: float
    face_centroid_mm: float | None
    in_table: bool
    flanks: Flanks | None


class Bearing(Part):
    """A bearing under a load case, in the axes x, y, z; no life in hours: `rating_life` says why."""

    name: str
    shaft: str
    speed_rpm: float
    force_n: list[float]
    moment_n_m: list[float]
    radial_force_n: float
    axial_force_n: float
    largest_radial_force_n: float
    elastic_um: list[float]
    clearance_um: list[float]
    seat_um: list[float]
    tilt_mrad: list[float]
    rating_life_hours: float | None
    rating_life: RatingLife


class Force(Part):
    """A force of the scene under a load case in the axes x, y, z, before the factor of its course."""

    name: str
    shaft: str
    force_n: list[float]
    moment_n_m: list[float]


class LoadCase(Part):
    """A load case."""

    name: str
    direction: str
    share: float
    torque_n_m: float
    speed_rpm: float
    status: str
    residual: float | None
    forces: list[Force]
    meshes: list[Mesh]
    bearings: list[Bearing]


class MeshOverCases(Part):
    """A mesh over all load cases, means by their shares."""

    name: str
    mean_misalignment_um: float
    largest_misalignment_um: float
    largest_in: str
    mean_peak_to_peak_um: float | None
    largest_k_h_beta: float | None


class BearingOverCases(Part):
    """A bearing over all load cases: its life, and constant loads of the same life by kind of element."""

    name: str
    mean_speed_rpm: float
    largest_radial_force_n: float
    equivalent_radial_force_n: dict[str, float]
    equivalent_axial_force_n: dict[str, float]
    rating_life_hours: float | None
    rating_life: RatingLife


class DeflectionFigures(Figures):
    """Misalignment by cause, flanks and bearings under every load case."""

    leading_shaft: str
    agreement: Agreement
    load_cases: list[LoadCase]
    meshes: list[MeshOverCases]
    bearings: list[BearingOverCases]
    cpu_seconds: float = Field(description="With the tables and housings that were made for it")


ANSWER = DeflectionFigures
