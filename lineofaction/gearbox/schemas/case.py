"""The case file: a gear pair, its material, loads, errors, accuracy and effects."""

from __future__ import annotations

from dataclasses import MISSING, replace
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from fe_contact.geometry.gear_pair import GearPair
from lineofaction.gearbox.schemas.complaint import ComplaintInput
from lineofaction.gearbox.schemas.declared import as_fields, figures, with_fields
from lineofaction.gearbox.schemas.driven_gear import WheelInput
from lineofaction.gearbox.schemas.gear import SHARED, GearInput, MaterialInput
from lineofaction.gearbox.schemas.headlines import in_brief
from lineofaction.gearbox.schemas.model import BoundaryModel, Listed, refuse, refuse_unsorted
from lineofaction.gearbox.schemas.report import ReportInput
from lineofaction.gearbox.schemas.rules import all_of, at_most_one_of, exactly_one_of

Load = Annotated[float, Field(ge=1e-9, le=1e9)]  # smaller ones underflow where they are squared
Misalignment = Annotated[float, Field(ge=-10_000.0, le=10_000.0)]
Clearance = Annotated[float, Field(ge=0.0, le=10_000.0)]
CenterDistanceChange = Annotated[float, Field(ge=-10.0, le=10.0)]
Loads = Annotated[Listed[Load], Field(min_length=1, max_length=256)]
Misalignments = Annotated[Listed[Misalignment], Field(min_length=1, max_length=64)]
CenterDistanceChanges = Annotated[Listed[CenterDistanceChange], Field(min_length=1, max_length=64)]
_WISHES = ("tolerance", "time_budget_s", "level")
_USUAL_TOLERANCE = 0.01
Switch = Literal["on", "off", "auto"]
EffectName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,63}$")]
OF_PAIR = (*SHARED, *(replace(figure, default=MISSING) for figure in figures(GearPair)))
"""Figures that a case has in ``[pair]``."""


@with_fields(as_fields(OF_PAIR))
class _PairFigures(BoundaryModel):
    """The figures of a pair."""

    normal_module_mm: float


class PairInput(_PairFigures):
    """A pinion, an external wheel or a ring gear of the same basic rack, and their center distance."""

    pinion: GearInput = Field(description="The driving gear")
    wheel: WheelInput = Field(description="The driven gear, external or a ring gear")

    @model_validator(mode="before")
    @classmethod
    def _positive_center_distance(cls, data: Any) -> Any:
        """Take the center distance of a ring gear as ISO 21771-1 writes it, with negative teeth: negative."""
        if isinstance(data, dict) and isinstance(data.get("wheel"), dict):
            teeth, distance = data["wheel"].get("teeth"), data.get("center_distance_mm")
            if isinstance(teeth, int) and teeth < 0 and isinstance(distance, int | float) and distance < 0:
                return {**data, "center_distance_mm": -distance}
        return data


class LoadInput(BoundaryModel):
    """Loads of the table: torques on the driving gear or normal forces."""

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of("torque_n_m", "normal_force_n")))

    torque_n_m: Loads | None = Field(
        default=None,
        description="Torques on the driving gear in N m, increasing",
        examples=[[10.0, 100.0, 400.0]],
    )
    normal_force_n: Loads | None = Field(
        default=None, description="Normal tooth forces in N, increasing", examples=[[266.0, 2660.0]]
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.torque_n_m is None) == (self.normal_force_n is None):
            value = None if self.torque_n_m is None else list(self.torque_n_m)
            bound = "given, or normal_force_n instead, but not both"
            refuse("torque_n_m", value, bound, "For example torque_n_m = [10, 100, 400].")
        refuse_unsorted("torque_n_m", self.torque_n_m)
        refuse_unsorted("normal_force_n", self.normal_force_n)
        return self


def _is_absent(value: object) -> bool:
    """Whether a field that came after results had been stored is not there."""
    return value is None


class ErrorsInput(BoundaryModel):
    """Errors of assembly: axes of the table when they hold more than one value."""

    misalignment_um: Misalignments = Field(
        default=(0.0,),
        description="Tilt of the axes in the plane of action: gap growth in µm over the common face width",
        examples=[[0.0, 30.0]],
    )
    misalignment_class: int | None = Field(
        default=None,
        ge=1,
        le=11,
        description="Accuracy class in place of misalignment_um: five misalignments, to both sides, over "
        "the range that gears and axes of this class allow (ISO 1328-1:2013, ISO/TR 10064-3)",
        examples=[7],
        exclude_if=_is_absent,
    )
    bearing_clearance_um: Listed[Clearance] | None = Field(
        default=None,
        min_length=2,
        max_length=2,
        description="Radial internal clearance in µm of the bearings of both shafts, by which the shafts "
        "tilt; needs misalignment_class",
        examples=[[20.0, 25.0]],
        exclude_if=_is_absent,
    )
    center_distance_change_mm: CenterDistanceChanges = Field(
        default=(0.0,), description="Changes of the center distance in mm", examples=[[0.0]]
    )

    @model_validator(mode="after")
    def _axes_increase(self) -> Self:
        refuse_unsorted("misalignment_um", self.misalignment_um)
        refuse_unsorted("center_distance_change_mm", self.center_distance_change_mm)
        if self.misalignment_class is not None and self.misalignment_um != (0.0,):
            remedy = "The class makes the range."
            refuse("misalignment_um", list(self.misalignment_um), "left out with misalignment_class", remedy)
        if self.misalignment_class is None and self.bearing_clearance_um is not None:
            refuse("bearing_clearance_um", list(self.bearing_clearance_um), "given with misalignment_class")
        return self


@in_brief
class Case(BoundaryModel):
    """A gear pair, its loads and alignment, and the requested accuracy."""

    class AccuracyInput(BoundaryModel):
        """The request to the planner: an accuracy, a time or a level; by default tolerance 0.01."""

        model_config = ConfigDict(
            json_schema_extra=all_of(
                at_most_one_of("level", "tolerance"), at_most_one_of("level", "time_budget_s")
            )
        )

        tolerance: float | None = Field(
            default=None,
            ge=1e-4,
            le=0.5,
            description="Allowed relative error of mean and peak-to-peak STE",
            examples=[0.01],
            json_schema_extra={"x-usual": {"value": _USUAL_TOLERANCE, "without": [*_WISHES[1:]]}},
        )
        tolerance_floor_nm: float = Field(
            default=20.0,
            ge=0.0,
            le=1e6,
            description="Error in nm that a tolerance always allows, even if it is more than the relative "
            "error of a small ripple",
            examples=[20.0],
        )
        time_budget_s: float | None = Field(
            default=None,
            gt=0.0,
            le=1e6,
            description="Budget in CPU seconds; with a tolerance, refinement ends there",
            examples=[10.0],
        )
        level: Literal["draft", "standard", "fine"] | None = Field(
            default=None, description="A mesh by name", examples=["standard"]
        )
        model: Literal["auto", "plane_strain", "plane_stress", "3d"] = Field(
            default="auto", description="The body model; auto lets the planner choose", examples=["auto"]
        )
        receipt: Literal["full", "minimal"] = Field(
            default="full",
            description="full: errors by source; minimal: no error estimates",
            examples=["full"],
        )
        on_violation: Literal["repeat", "fail", "report"] = Field(
            default="repeat",
            description="If an assumption is violated: repeat with the effect it needs, fail, or report",
            examples=["repeat"],
        )
        positions: int | None = Field(
            default=None,
            ge=8,
            le=4096,
            description="Positions in one base pitch; left out: chosen by the planner",
            examples=[64],
        )
        pitches: int | None = Field(
            default=None,
            ge=1,
            le=1_000_000,
            description="Base pitches that the table covers if gears have pitch deviations; left out: the "
            "full period, one revolution of one gear or the hunting cycle of both",
            examples=[20],
        )

        @model_validator(mode="before")
        @classmethod
        def _default_wish(cls, data: Any) -> Any:
            """Request the default tolerance where nothing is requested, so that the echo has it."""
            if isinstance(data, dict) and all(data.get(name) is None for name in _WISHES):
                return {**data, "tolerance": _USUAL_TOLERANCE}
            return data

        @model_validator(mode="after")
        def _one_wish(self) -> Self:
            """Refuse a tolerance or a time budget together with a level, which fixes the mesh."""
            wishes = [name for name in ("tolerance", "time_budget_s") if getattr(self, name) is not None]
            if wishes and self.level is not None:
                remedy = "A level is a mesh, regardless of cost."
                refuse("level", self.level, f"left out when {wishes[0]} is given", remedy)
            return self

    pair: PairInput = Field(description="The gear pair")
    material: MaterialInput = Field(
        default=MaterialInput(),
        description="Material of both gears",
        examples=[{"youngs_modulus_gpa": 210.0}],
    )
    load: LoadInput = Field(description="The loads", examples=[{"torque_n_m": [10, 100, 400]}])
    errors: ErrorsInput = Field(default=ErrorsInput(), description="Assembly errors", examples=[{}])
    accuracy: AccuracyInput = Field(
        default=AccuracyInput(), description="The accuracy requested", examples=[{}]
    )
    complaint: ComplaintInput | None = Field(
        default=None,
        description="Complaint about a sound: plots of the table mark its order, loa complaint lists its "
        "causes",
        examples=[{"frequency_hz": 400.0, "speed_rpm": 1200.0}],
        exclude_if=_is_absent,
    )
    effects: dict[EffectName, Switch] = Field(
        default={},
        description="Switches of optional physics; left out = auto",
        examples=[{"corner_contact": "auto"}],
    )
    report: ReportInput | None = Field(
        default=None, exclude=True, description="Title block of reports; no result depends on it"
    )

    @model_validator(mode="after")
    def _complaint_of_pair(self) -> Self:
        """Refuse a complaint about other shafts, or about parts that a pair lacks."""
        for name in ("shaft", "final_shaft", "bearing", "microphone_mm"):
            value = None if self.complaint is None else getattr(self.complaint, name)
            if value is not None and name.endswith("shaft") and value not in ("pinion", "wheel"):
                refuse(f"complaint.{name}", value, "one of pinion, wheel")
            if value is not None and not name.endswith("shaft"):
                bound = "left out: a pair has neither bearings nor housing"
                refuse(f"complaint.{name}", value, bound, "The scene of the gearbox has them.")
        return self
