"""The scene file: shafts, gears, bushings, meshes, drives, loads, and the run to make with them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self, get_origin

from pydantic import BaseModel, ConfigDict, Field, Strict, model_validator

from dynamics.settings.run import Integration, Outputs
from dynamics.shafts.shaft import PLACED, on_length
from lineofaction.gearbox.schemas.bearings import BushingInput, PlanetBearingInput, RollingBearingInput
from lineofaction.gearbox.schemas.bodies import CouplingInput, DiscInput, GearBodyInput, PlanetsInput
from lineofaction.gearbox.schemas.case import EffectName, Switch
from lineofaction.gearbox.schemas.complaint import ComplaintInput
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.faults import model_in
from lineofaction.gearbox.schemas.forces import ForceInput, UnbalanceInput
from lineofaction.gearbox.schemas.headlines import in_brief
from lineofaction.gearbox.schemas.housing_solid import TemperaturesInput
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.loads import (
    DriveInput,
    FreeRotationInput,
    LoadTorqueInput,
    SpeedTorqueInput,
)
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.model import Acceleration, BoundaryModel, Listed, refuse
from lineofaction.gearbox.schemas.report import ReportInput
from lineofaction.gearbox.schemas.shafts import ShaftInput


@with_fields(declared_in(Outputs))
class OutputsInput(BoundaryModel):
    """The outputs to store."""


@with_fields(declared_in(Integration))
class IntegrationInput(BoundaryModel):
    """Method and tolerances of the time integration."""


@in_brief
class SceneInput(BoundaryModel):
    """A geared system and the run to make with it."""

    model_config = ConfigDict(json_schema_extra=lambda schema: schema.update({"x-references": _references()}))

    class RunInput(BoundaryModel):
        """Duration of a run, and its reaction to an assumption that does not hold."""

        duration_s: float = Field(ge=0.0, le=1e6, description="Duration in s", examples=[5.0])
        on_violation: Literal["repeat", "fail", "report"] = Field(
            default="repeat",
            description="If a run or study violates an assumption: repeat with the effect it needs (fail if "
            "the result is invalid and no effect corrects it), fail at any, or report",
            examples=["repeat"],
        )

    class SceneAccuracyInput(BoundaryModel):
        """The tolerance that decides automatic effects."""

        tolerance: float | None = Field(
            default=None,
            ge=1e-6,
            le=0.5,
            description="Relative tolerance of the sound where a housing has a surface, of the force on the "
            "bearing of a complaint, else of mean and peak-to-peak transmission error and of bearing forces: "
            "effects of less influence are neglected, others are on; left out: level_tolerance_db",
            examples=[0.01],
        )
        level_tolerance_db: float = Field(
            default=0.1,
            ge=0.0,
            le=3.0,
            description="Change of these levels in dB that automatic effects may make by being neglected, "
            "where no relative tolerance is given; 0: effects are as the scene calls for them",
            examples=[0.1],
        )

    run: RunInput = Field(description="The run", examples=[{"duration_s": 5.0}])
    gravity_m_per_s2: Acceleration = Field(
        default=(0.0, 0.0, 0.0),
        description="Acceleration of gravity in x, y, z in m/s^2",
        examples=[[0.0, -9.81, 0.0]],
    )
    shafts: Listed[ShaftInput] = Field(
        min_length=1, max_length=1000, description="Shafts: a table [[shafts]] for each"
    )
    gears: Listed[GearBodyInput] = Field(
        default=(), max_length=1000, description="Gears on the shafts: a table [[gears]] for each"
    )
    discs: Listed[DiscInput] = Field(default=(), max_length=1000)
    bushings: Listed[BushingInput] = Field(default=(), max_length=1000)
    rolling_bearings: Listed[RollingBearingInput] = Field(default=(), max_length=1000)
    meshes: Listed[MeshInput] = Field(
        default=(), max_length=1000, description="Gear pairs in mesh: a table [[meshes]] for each"
    )
    drives: Listed[DriveInput] = Field(default=(), max_length=1000)
    free_rotations: Listed[FreeRotationInput] = Field(default=(), max_length=1000)
    planet_bearings: Listed[PlanetBearingInput] = Field(default=(), max_length=1000)
    couplings: Listed[CouplingInput] = Field(default=(), max_length=1000)
    speed_torques: Listed[SpeedTorqueInput] = Field(default=(), max_length=1000)
    housings: Listed[HousingInput] = Field(default=(), max_length=100)
    planets: Listed[PlanetsInput] = Field(default=(), max_length=100)
    loads: Listed[LoadTorqueInput] = Field(default=(), max_length=1000)
    forces: Listed[ForceInput] = Field(default=(), max_length=1000)
    unbalances: Listed[UnbalanceInput] = Field(default=(), max_length=1000)
    temperatures: TemperaturesInput | None = Field(
        default=None,
        description="Steady temperatures; left out: all parts are as drawn",
        examples=[{"housing_degc": 70.0, "housing_material": "cast_aluminum"}],
        exclude_if=lambda value: value is None,
    )
    complaint: ComplaintInput | None = Field(
        default=None,
        description="Complaint about a sound: plots mark its order, loa complaint lists its causes",
        examples=[{"frequency_hz": 400.0, "speed_rpm": 1200.0}],
        exclude_if=lambda value: value is None,
    )
    accuracy: SceneAccuracyInput = Field(
        default=SceneAccuracyInput(), description="Tolerance that decides on automatic effects", examples=[{}]
    )
    outputs: OutputsInput = Field(default=OutputsInput(), description="Output of the run", examples=[{}])
    integration: IntegrationInput = Field(
        default=IntegrationInput(), description="Time integration", examples=[{}]
    )
    left_out: Annotated[tuple[Annotated[str, Field(max_length=4000)], ...], Strict(False)] = Field(
        default=(),
        max_length=1000,
        exclude_if=lambda texts: not texts,
        description="Parts of the imported file that the scene lacks; verbs repeat them",
    )
    effects: dict[EffectName, Switch] = Field(
        default={}, description="Switches of optional physics; left out = auto"
    )
    report: ReportInput | None = Field(
        default=None, exclude=True, description="Title block of reports; no result depends on it"
    )

    @property
    def with_database(self) -> list[tuple[int, MeshInput]]:
        """The meshes that take their force from an STE database, with their numbers."""
        return [(index, mesh) for index, mesh in enumerate(self.meshes) if mesh.stiffness is None]

    @model_validator(mode="before")
    @classmethod
    def _tables(cls, data: Any) -> Any:
        """Refuse a single table where a list is meant, with the spelling of a list in TOML."""
        if isinstance(data, dict):
            for kind in _KINDS:
                if isinstance(data.get(kind), dict):
                    refuse(kind, data[kind], "a list of tables", f"Write [[{kind}]] with two brackets.")
        return data

    @model_validator(mode="after")
    def _parts_exist(self) -> Self:
        """Refuse names that are not unique, and references to parts that do not exist."""
        for kind in _with_field("name"):
            names = [part.name for part in getattr(self, kind)]
            for index, name in enumerate(names):
                if name in names[:index]:
                    refuse(f"{kind}[{index}].name", name, "a name that no other one of them has")
        shafts = [shaft.name for shaft in self.shafts]
        for field, name in _named_shafts(self):
            _refuse_unknown(field, name, shafts)
        _refuse_off_shafts(self)
        bushings = [*(part.name for part in self.bushings), *(part.name for part in self.rolling_bearings)]
        pins = [part.name for part in self.planet_bearings]
        for index, housing in enumerate(self.housings):
            for number, name in enumerate(housing.bushings):
                _refuse_unknown(f"housings[{index}].bushings[{number}]", name, bushings)
        if self.complaint is not None:
            _refuse_complaint(self.complaint, shafts, [*bushings, *pins])
        gears = [gear.name for gear in self.gears]
        for index, mesh in enumerate(self.meshes):
            _refuse_unknown(f"meshes[{index}].driver", mesh.driver, gears)
            _refuse_unknown(f"meshes[{index}].driven", mesh.driven, [g for g in gears if g != mesh.driver])
        return self


_KINDS: dict[str, type[BaseModel]] = {
    kind: part
    for kind, field in SceneInput.model_fields.items()
    if get_origin(field.annotation) is tuple and (part := model_in(field.annotation)) is not None
}
"""Kinds of parts, by the names of their tables in a scene file."""


def _with_field(name: str) -> Iterator[str]:
    """Yield the kinds of parts that have a field of this name."""
    for kind, part in _KINDS.items():
        if name in part.model_fields:
            yield kind


def _references() -> dict[str, dict[str, str]]:
    """Return the fields by which parts name other parts, and the kind of the named part, by kind of part."""
    further = {
        "shafts": {"frame": "shafts"},
        "couplings": {"first": "shafts", "second": "shafts"},
        "planets": {"planet": "shafts"},
        "forces": {"turns_with": "shafts", "of_shaft": "shafts"},
        "meshes": {"driver": "gears", "driven": "gears"},
    }
    on_shafts = {kind: {"shaft": "shafts"} for kind in _with_field("shaft")}
    return {kind: on_shafts.get(kind, {}) | further.get(kind, {}) for kind in on_shafts | further}


def _named_shafts(scene: SceneInput) -> Iterator[tuple[str, str]]:
    """Yield the fields by which parts name shafts, and the names."""
    for kind, fields in _references().items():
        for index, part in enumerate(getattr(scene, kind)):
            for field, named_kind in fields.items():
                name = getattr(part, field)
                if named_kind == "shafts" and name is not None:
                    yield f"{kind}[{index}].{field}", name


def _refuse_complaint(complaint: ComplaintInput, shafts: list[str], bearings: list[str]) -> None:
    """Refuse a complaint that names unknown parts, or that has a torque: the loads of the scene apply."""
    for name, known in (("shaft", shafts), ("final_shaft", shafts), ("bearing", bearings)):
        value = getattr(complaint, name)
        if value is not None:
            _refuse_unknown(f"complaint.{name}", value, known)
    if complaint.torque_n_m is not None:
        bound = "left out: the loads of the scene are those at which it is heard"
        refuse("complaint.torque_n_m", complaint.torque_n_m, bound, "Change the loads.")


def _refuse_off_shafts(scene: SceneInput) -> None:
    """Refuse a part whose position lies beyond an end of its shaft."""
    lengths = {shaft.name: shaft.length_mm for shaft in scene.shafts}
    for kind in PLACED:
        for index, part in enumerate(getattr(scene, kind)):
            length = lengths[part.shaft]
            if not on_length(part.position_mm, length):
                bound = f'on the shaft "{part.shaft}", from 0 to {length:g} mm from its left end'
                remedy = "Lengthen the shaft, or move what sits on it."
                refuse(f"{kind}[{index}].position_mm", part.position_mm, bound, remedy)


def _refuse_unknown(field: str, name: str, known: list[str]) -> None:
    if name not in known:
        refuse(field, name, f"one of {', '.join(known) or 'none'}", "Names are case-sensitive.")
