"""Figures of an accuracy study of a case or a scene."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Figures, Json, Part


class FidelityFigures(Part):
    """One fidelity: its CPU time, and its errors against the finest one, relative."""

    name: str
    title: str
    cpu_seconds: float
    mean_m: list[float] | None = None
    peak_to_peak_m: list[float] | None = None
    stated_error: float | None = None
    stages: dict[str, float] | None = None
    peak_memory_bytes: int | None = None
    mean_error: float | None = None
    peak_to_peak_error: float | None = None
    family: str | None = None
    errors: dict[str, float] | None = None


class FrontierFigures(Figures):
    """Error against time; the reference is the finest fidelity, the knee where time buys least."""

    rungs: list[FidelityFigures]
    left_out: dict[str, str]
    knee: str | None
    chosen: str | None
    reference: str
    solves: int | None = None
    full_finite_element_contact: list[Json] | None = None
    full_finite_element_contact_origin: str | None = None
    full_contact: Json | None = None
    orders: int | None = None
    blocks: int | None = None
    transmission_error_rms_m: list[list[float]] | None = None


ANSWER = FrontierFigures
