"""Inputs of a change of flanks: two designs of a mesh, speeds, loads, and tolerances of both."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.figures import Figures, Json, Part
from lineofaction.gearbox.schemas.model import BoundaryModel, Name
from lineofaction.gearbox.schemas.studied import OverOrders
from lineofaction.gearbox.studies.deflect import LoadCaseInput, LoadCases
from lineofaction.gearbox.studies.listen import Position
from lineofaction.gearbox.studies.scatter import ToleranceInputs

PAIRS = 200
BEARING_FORCE, SOUND_POWER = "bearing_force", "sound_power"
SURFACE_VELOCITY, SOUND_PRESSURE = "surface_velocity", "sound_pressure"

_GEAR = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0}
_RELIEVED = {"tip_relief_um": 20.0, "tip_relief_length_mm": 1.5}
_AFTER = {
    "pair": {
        "normal_module_mm": 4.0,
        "center_distance_mm": 80.0,
        "pinion": _GEAR | _RELIEVED,
        "wheel": _GEAR | _RELIEVED,
    },
    "load": {"torque_n_m": [10.0, 50.0, 100.0, 200.0, 400.0]},
}


class HeardInput(BoundaryModel):
    """Quantity whose levels are compared, and the figure that is formed from its levels over the speeds."""

    quantity: Literal["sound_power", "sound_pressure", "surface_velocity", "bearing_force"] | None = Field(
        default=None,
        description="Sound power of the housings in dB(A) re 1 pW, sound pressure at a microphone in dB(A) "
        "re 20 uPa, normal velocity of a housing's surface in dB re 1 nm/s, or force on bearings in dB re "
        "1 N; left out: pressure with a microphone, power where a housing has a surface",
        examples=["bearing_force"],
    )
    housing: Name | None = Field(
        default=None,
        description="Housing whose surface or sound pressure is heard; left out: the only one with a surface",
        examples=["case"],
    )
    microphone_mm: Position | None = Field(
        default=None,
        description="Microphone of the sound pressure, x, y, z in mm in the frame of the scene",
        examples=[[0.0, 1000.0, 0.0]],
    )
    bearing: Name | None = Field(
        default=None,
        description="Bearing whose force is compared; left out: all, their mean squares added",
        examples=["input left"],
    )
    over_speeds: Literal["worst", "energy_mean"] = Field(
        default="worst", description="The loudest speed, or the mean of the power", examples=["energy_mean"]
    )


class Inputs(OverOrders):
    """The flanks before and after, and how they are compared."""

    after: Case = Field(
        description="Case with the flanks after the change; its pair is that of the scene", examples=[_AFTER]
    )
    before: Case | None = Field(
        default=None,
        description="Case with the flanks before it; left out: the case of the mesh in the scene",
    )
    mesh: Name | None = Field(
        default=None,
        description="Mesh of the scene whose flanks they are; left out: the only one with a case",
        examples=["mesh"],
    )
    load_cases: LoadCases = Field(
        default=(LoadCaseInput(name="load"),),
        description="Load cases on the driving flanks; default: the loads of the scene at t = 0",
        examples=[[{"name": "cruise", "torque_n_m": 60.0, "speed_rpm": 3000.0}]],
    )
    heard: HeardInput = Field(default=HeardInput(), description="Quantity that is compared")
    tolerances: ToleranceInputs = Field(
        default=ToleranceInputs(samples=PAIRS),
        description="Tolerances of both designs and the sample, drawn once: each pair takes two contact "
        "solutions, 0.4 to 2 CPU s each in three dimensions",
    )
    requirement_db: float | None = Field(
        default=None,
        ge=-300.0,
        le=300.0,
        description="Highest level of all orders of the mesh that 95 % of the pairs may have after the "
        "change, under every load case",
        examples=[72.0],
    )


class QuantileFigures(Part):
    """A level of all pairs: the nominal one, and the quantiles of 5, 50 and 95 %."""

    nominal_db: float
    low_db: float
    median_db: float
    high_db: float


class ChangeFigures(Figures):
    """Levels before and after by load case, then by order ("all": all of them together)."""

    class LoadCaseFigures(Part):
        """A load case by the torque on the driving gear of the mesh."""

        class LineFigures(Part):
            """An order of the mesh, or all of them together."""

            order: str
            before: QuantileFigures
            after: QuantileFigures
            change: QuantileFigures
            louder_share: float

        torque_n_m: float
        lines: list[LineFigures]
        influence_on_change: dict[str, float]
        influence_after: dict[str, float]

    mesh: str
    quantity: str
    unit: str
    over_speeds: str
    verdict: str
    met: bool | None
    requirement_db: float | None
    pairs: int
    load_cases: list[LoadCaseFigures]
    louder: list[str]
    parting: list[str]
    cost: Json
