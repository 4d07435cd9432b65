"""The scene file: shafts, gears, bushings, meshes, drives, loads, and the run to make with them."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import Field, Strict, model_validator

from service.schemas.case import Case, EffectName, Switch
from service.schemas.model import BoundaryModel, refuse

Name = Annotated[str, Field(min_length=1, max_length=64)]
Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Times = Annotated[tuple[Annotated[float, Field(ge=0.0, le=1e9)], ...], Strict(False)]
Numbers = Annotated[tuple[Number, ...], Strict(False)]
Course = Literal["linear", "smooth"]
_NAMED = (
    "shafts",
    "gears",
    "bushings",
    "planet_bearings",
    "couplings",
    "meshes",
    "drives",
    "free_rotations",
    "loads",
    "speed_torques",
)
_SOURCES = ("case", "case_file", "database_file", "database_hash")


class InertiaInput(BoundaryModel):
    """Inertia of a body of revolution about its own centre of mass."""

    mass_kg: float = Field(ge=0.0, le=1e9, description="Mass in kg", examples=[2.0])
    polar_kg_m2: float = Field(
        ge=0.0, le=1e12, description="Moment of inertia about the axis of rotation in kg m^2", examples=[4e-4]
    )
    transverse_kg_m2: float = Field(
        ge=0.0, le=1e12, description="Moment of inertia across the axis in kg m^2", examples=[7e-3]
    )


class ShaftInput(BoundaryModel):
    """A rigid shaft parallel to the z axis."""

    name: Name = Field(description="Name of the shaft", examples=["input"])
    length_mm: float = Field(gt=0.0, le=1e6, description="Length in mm", examples=[200.0])
    origin_mm: Annotated[tuple[Coordinate, ...], Strict(False)] = Field(
        default=(0.0, 0.0, 0.0),
        min_length=3,
        max_length=3,
        description="Left end of the axis, x, y, z in mm",
        examples=[[0.0, 0.0, 0.0]],
    )
    diameter_mm: float | None = Field(
        default=None,
        gt=0.0,
        le=1e5,
        description="Diameter in mm of a solid steel shaft, for its inertia",
        examples=[40.0],
    )
    inertia: InertiaInput | None = Field(
        default=None,
        description="Inertia of the bare shaft, instead of a diameter",
        examples=[{"mass_kg": 2.0}],
    )
    frame: Name | None = Field(
        default=None,
        description="The carrier of the planetary set it belongs to; a carrier names itself",
        examples=["carrier"],
    )

    @model_validator(mode="after")
    def _one_inertia(self) -> Self:
        """Exactly one source of inertia."""
        if (self.diameter_mm is None) == (self.inertia is None):
            refuse(
                "diameter_mm",
                self.diameter_mm,
                "given, or inertia instead, but not both",
                "For example 40.0.",
            )
        return self


class GearBodyInput(BoundaryModel):
    """A gear on a shaft; its teeth, base radius, helix and face width come from the mesh it takes part in."""

    name: Name = Field(description="Name of the gear", examples=["pinion"])
    shaft: Name = Field(description="The shaft that carries it", examples=["input"])
    position_mm: Coordinate = Field(description="Mid-face along the shaft in mm", examples=[100.0])
    bore_diameter_mm: float = Field(
        default=0.0,
        ge=0.0,
        le=1e5,
        description="Bore in mm of the steel cylinder that stands for its inertia",
        examples=[40.0],
    )
    inertia: InertiaInput | None = Field(
        default=None,
        description="Inertia; left out: a steel cylinder of pitch diameter and face width",
        examples=[{"mass_kg": 0.7, "polar_kg_m2": 7e-4, "transverse_kg_m2": 4e-4}],
    )


class BushingInput(BoundaryModel):
    """A linear bearing between a shaft and the ground."""

    name: Name = Field(description="Name of the bushing", examples=["input left"])
    shaft: Name = Field(description="The shaft it carries", examples=["input"])
    position_mm: Coordinate = Field(description="Place along the shaft in mm", examples=[0.0])
    radial_stiffness_n_per_m: float = Field(
        ge=0.0, le=1e15, description="Radial stiffness in N/m", examples=[1e8]
    )
    axial_stiffness_n_per_m: float = Field(
        default=0.0, ge=0.0, le=1e15, description="Axial stiffness in N/m", examples=[1e8]
    )
    radial_damping_n_s_per_m: float | None = Field(
        default=None,
        ge=0.0,
        le=1e12,
        description="Radial damping in N s/m; left out: from damping_ratio",
        examples=[1e3],
    )
    axial_damping_n_s_per_m: float | None = Field(
        default=None,
        ge=0.0,
        le=1e12,
        description="Axial damping in N s/m; left out: from damping_ratio",
        examples=[1e3],
    )
    damping_ratio: float = Field(default=0.05, ge=0.0, le=10.0, description="Damping ratio", examples=[0.05])


class PlanetBearingInput(BushingInput):
    """A linear bearing between a planet and its pin in the carrier."""

    shaft: Name = Field(description="The planet's shaft", examples=["planet"])
    carrier: Name = Field(description="The carrier's shaft", examples=["carrier"])
    radial_error_um: float = Field(
        default=0.0, ge=-1e4, le=1e4, description="Pin off its place, outwards, in um", examples=[0.0]
    )
    tangential_error_um: float = Field(
        default=0.0, ge=-1e4, le=1e4, description="Pin off its place, about +z, in um", examples=[20.0]
    )


Row = Annotated[tuple[Number, ...], Strict(False)]
Rows = Annotated[tuple[Row, ...], Strict(False)]


class CouplingInput(BoundaryModel):
    """A flexible coupling between two shafts of the same speed."""

    name: Name = Field(description="Name of the coupling", examples=["joint"])
    first: Name = Field(description="One shaft", examples=["output"])
    second: Name = Field(description="The other shaft", examples=["machine"])
    torsional_stiffness_n_m_per_rad: float = Field(
        ge=0.0, le=1e15, description="Torsional stiffness in N m/rad", examples=[5e4]
    )
    torsional_damping_n_m_s_per_rad: float = Field(
        default=0.0, ge=0.0, le=1e12, description="Torsional damping in N m s/rad", examples=[5.0]
    )
    position_mm: Coordinate = Field(
        default=0.0, description="Place along the first shaft in mm, for the matrices", examples=[200.0]
    )
    stiffness_matrix: Rows | None = Field(
        default=None,
        min_length=6,
        max_length=6,
        description="Added: 6 by 6 in x, y, z, tilt_x, tilt_y, rotation; N, m, rad",
    )
    damping_matrix: Rows | None = Field(
        default=None, min_length=6, max_length=6, description="Added: the same for rates; N, m, rad, s"
    )


class PlanetsInput(BoundaryModel):
    """Several planets from one, whose shaft, gears, bearings and meshes are in the scene."""

    planet: Name = Field(description="The shaft of the first planet", examples=["planet"])
    number: int = Field(ge=1, le=100, description="Number of planets in all", examples=[3])
    angles_deg: Annotated[tuple[Coordinate, ...], Strict(False)] | None = Field(
        default=None,
        description="Angles from the first planet about +z in degrees; left out: equally spaced",
        examples=[[0.0, 120.0, 240.0]],
    )
    radial_errors_um: Annotated[tuple[Coordinate, ...], Strict(False)] | None = Field(
        default=None, description="Of all pins, outwards, in um", examples=[[0.0, 0.0, 0.0]]
    )
    tangential_errors_um: Annotated[tuple[Coordinate, ...], Strict(False)] | None = Field(
        default=None, description="Of all pins, about +z, in um", examples=[[20.0, 0.0, 0.0]]
    )

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        """As many values as planets."""
        for field in ("angles_deg", "radial_errors_um", "tangential_errors_um"):
            given = getattr(self, field)
            if given is not None and len(given) != self.number:
                refuse(
                    field, list(given), f"a list of {self.number}, one for each planet", "Or leave it out."
                )
        return self


class CoastFlankInput(BoundaryModel):
    """The backs of a mesh's teeth, alike to their fronts, for the effect "backlash"."""

    backlash_um: float = Field(
        gt=0.0, le=1e5, description="Backlash along the transverse line of action in um", examples=[80.0]
    )
    tooth_thickness: float | None = Field(
        default=None,
        gt=0.0,
        lt=1.0,
        description="Thickness of the driver's teeth over the pitch, both on the operating pitch circle; "
        "left out: both gears' teeth are equally thick",
        examples=[0.49],
    )


class MeshInput(BoundaryModel):
    """Two gears in mesh and the source of their STE database."""

    name: Name = Field(description="Name of the mesh", examples=["mesh"])
    driver: Name = Field(description="The driving gear: the pinion of the case", examples=["pinion"])
    driven: Name = Field(description="The driven gear: the wheel of the case", examples=["wheel"])
    case: Case | None = Field(default=None, description="The case, written out")
    case_file: str | None = Field(
        default=None,
        max_length=4096,
        description="A case file, relative to the scene file",
        examples=["pair.toml"],
    )
    database_file: str | None = Field(
        default=None,
        max_length=4096,
        description="An STE database, relative to the scene file",
        examples=["ste.nc"],
    )
    database_hash: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] | None = Field(
        default=None, description="Content hash of a database the service holds", examples=["0" * 64]
    )
    technique: Literal["constant_torque", "variable_torque"] = Field(
        default="variable_torque", description="How the mesh force is found", examples=["variable_torque"]
    )
    damping_n_s_per_m: float | None = Field(
        default=None,
        ge=0.0,
        le=1e12,
        description="Mesh damping in N s/m; left out: from damping_ratio",
        examples=[1e3],
    )
    damping_ratio: float = Field(default=0.05, ge=0.0, le=10.0, description="Damping ratio", examples=[0.05])
    nominal_force_n: float | None = Field(
        default=None,
        gt=0.0,
        le=1e9,
        description="Transverse mesh force in N; left out: the load's",
        examples=[2660.0],
    )
    position_offset: float = Field(
        default=0.0, ge=-1e6, le=1e6, description="Position in base pitches at the start", examples=[0.0]
    )
    misalignment_um: float = Field(
        default=0.0, ge=-1e4, le=1e4, description="Misalignment in um", examples=[0.0]
    )
    center_distance_change_mm: float = Field(
        default=0.0, ge=-100.0, le=100.0, description="Change of the centre distance in mm", examples=[0.0]
    )
    coast_flank: CoastFlankInput | None = Field(
        default=None,
        description="The backs of the teeth; left out: only the driving flank carries force",
        examples=[{"backlash_um": 80.0}],
    )

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        """Exactly one source of the table."""
        given = [name for name in _SOURCES if getattr(self, name) is not None]
        if len(given) != 1:
            refuse("case", given or None, f"given once, as one of {', '.join(_SOURCES)}", "Keep one of them.")
        return self


class DriveInput(BoundaryModel):
    """A shaft whose speed or angle is imposed over time."""

    name: Name = Field(description="Name of the drive", examples=["motor"])
    shaft: Name = Field(description="The driven shaft", examples=["input"])
    time_s: Times = Field(
        default=(0.0,), min_length=1, max_length=100_000, description="Times in s", examples=[[0.0, 5.0]]
    )
    speed_rpm: Numbers | None = Field(
        default=None,
        min_length=1,
        max_length=100_000,
        description="Speeds in rpm at these times",
        examples=[[0.0, 955.0]],
    )
    angle_deg: Numbers | None = Field(
        default=None,
        min_length=4,
        max_length=100_000,
        description="Angles in degrees at these times instead of speeds, joined by a cubic spline",
        examples=[[0.0, 1.0, 2.1, 3.0]],
    )
    course: Course = Field(default="linear", description="Course between the times", examples=["linear"])
    stiffness_n_m_per_rad: float | None = Field(
        default=None,
        gt=0.0,
        le=1e15,
        description="Torsional spring to the imposed rotation in N m/rad; left out: rigid",
        examples=[1e7],
    )
    damping_n_m_s_per_rad: float = Field(
        default=0.0, ge=0.0, le=1e12, description="Damping beside that spring in N m s/rad", examples=[0.0]
    )

    @model_validator(mode="after")
    def _law(self) -> Self:
        if (self.speed_rpm is None) == (self.angle_deg is None):
            bound = "given, or angle_deg instead, but not both"
            refuse("speed_rpm", self.speed_rpm and list(self.speed_rpm), bound, "For example [1000.0].")
        if self.speed_rpm is not None:
            _check_law("speed_rpm", self.time_s, self.speed_rpm)
        if self.angle_deg is not None:
            _check_law("angle_deg", self.time_s, self.angle_deg)
        return self


class FreeRotationInput(BoundaryModel):
    """A train that no drive moves: it starts at a speed and turns as torques make it."""

    name: Name = Field(description="Name of the free rotation", examples=["train"])
    shaft: Name = Field(description="Any one shaft of the train", examples=["input"])
    initial_speed_rpm: float = Field(
        default=0.0, ge=-1e7, le=1e7, description="Speed at the start in rpm", examples=[1000.0]
    )
    sense: Literal["+z", "-z"] = Field(
        default="+z", description="Where it turns if it starts from rest", examples=["+z"]
    )


class LoadTorqueInput(BoundaryModel):
    """A torque that resists a shaft's rotation, or drives it where it is negative."""

    name: Name = Field(description="Name of the load", examples=["brake"])
    shaft: Name = Field(description="The loaded shaft", examples=["output"])
    time_s: Times = Field(
        default=(0.0,), min_length=1, max_length=100_000, description="Times in s", examples=[[0.0]]
    )
    torque_n_m: Numbers = Field(
        min_length=1,
        max_length=100_000,
        description="Resisting torques in N m at these times",
        examples=[[100.0]],
    )
    course: Course = Field(default="linear", description="Course between the times", examples=["linear"])

    @model_validator(mode="after")
    def _law(self) -> Self:
        _check_law("torque_n_m", self.time_s, self.torque_n_m)
        return self


class SpeedTorqueInput(BoundaryModel):
    """A torque that depends on the shaft's speed."""

    name: Name = Field(description="Name of the torque", examples=["fan"])
    shaft: Name = Field(description="The shaft it acts on", examples=["output"])
    kind: Literal["table", "quadratic", "constant"] = Field(
        description="Through a table; as the square of the speed; constant against either sense of rotation",
        examples=["table"],
    )
    speed_rpm: Numbers = Field(
        min_length=1,
        max_length=100_000,
        description="Speeds of a table; the speed of the torque of a square; where a constant has set in",
        examples=[[0.0, 1500.0]],
    )
    torque_n_m: Numbers = Field(
        min_length=1,
        max_length=100_000,
        description="Torques in N m against the rotation at these speeds; negative: driving",
        examples=[[-50.0, -40.0]],
    )

    @model_validator(mode="after")
    def _as_many(self) -> Self:
        """Refuse a table of fewer than two points, and more than one for the others."""
        least, most = (2, 100_000) if self.kind == "table" else (1, 1)
        if not least <= len(self.speed_rpm) <= most:
            bound = "a list of at least 2" if self.kind == "table" else "a list of one"
            refuse("speed_rpm", list(self.speed_rpm), bound)
        if len(self.torque_n_m) != len(self.speed_rpm):
            bound = f"a list of {len(self.speed_rpm)}, one for each of speed_rpm"
            refuse("torque_n_m", list(self.torque_n_m), bound, "Give one value per speed.")
        return self


def _check_law(field: str, times: tuple[float, ...], values: tuple[float, ...]) -> None:
    """As many values as times, and times that increase."""
    if any(later <= earlier for earlier, later in pairwise(times)):
        refuse("time_s", list(times), "strictly increasing", "Sort the list and drop repeats.")
    if len(times) != len(values):
        refuse(
            field, list(values), f"a list of {len(times)}, one for each of time_s", "Give one value per time."
        )


class RunInput(BoundaryModel):
    """How long."""

    duration_s: float = Field(ge=0.0, le=1e6, description="Duration in s", examples=[5.0])


class OutputsInput(BoundaryModel):
    """What to store."""

    sample_rate_hz: float = Field(
        default=20e3, gt=0.0, le=1e7, description="Samples per second", examples=[20000.0]
    )
    bearing_forces: bool = Field(
        default=True, description="Store the forces of every bushing", examples=[True]
    )
    displacements: bool = Field(default=False, description="Store every freedom", examples=[False])


class IntegrationInput(BoundaryModel):
    """How to integrate in time."""

    method: Literal["implicit", "explicit"] = Field(
        default="implicit", description="Integrator", examples=["implicit"]
    )
    tolerance_nm: float = Field(
        default=1.0, gt=0.0, le=1e6, description="Step error of the displacements in nm rms", examples=[1.0]
    )
    fixed_step_s: float | None = Field(
        default=None,
        gt=0.0,
        le=1.0,
        description="Step in s; left out: chosen by error control",
        examples=[1e-5],
    )
    largest_step_s: float = Field(
        default=1e-3, gt=1e-12, le=1.0, description="Largest step in s", examples=[1e-3]
    )


class SceneInput(BoundaryModel):
    """A geared system and the run to make with it."""

    run: RunInput = Field(description="The run", examples=[{"duration_s": 5.0}])
    shafts: Annotated[tuple[ShaftInput, ...], Strict(False)] = Field(min_length=1, max_length=1000)
    gears: Annotated[tuple[GearBodyInput, ...], Strict(False)] = Field(min_length=2, max_length=1000)
    bushings: Annotated[tuple[BushingInput, ...], Strict(False)] = Field(default=(), max_length=1000)
    meshes: Annotated[tuple[MeshInput, ...], Strict(False)] = Field(min_length=1, max_length=1000)
    drives: Annotated[tuple[DriveInput, ...], Strict(False)] = Field(default=(), max_length=1000)
    free_rotations: Annotated[tuple[FreeRotationInput, ...], Strict(False)] = Field(
        default=(), max_length=1000
    )
    planet_bearings: Annotated[tuple[PlanetBearingInput, ...], Strict(False)] = Field(
        default=(), max_length=1000
    )
    couplings: Annotated[tuple[CouplingInput, ...], Strict(False)] = Field(default=(), max_length=1000)
    speed_torques: Annotated[tuple[SpeedTorqueInput, ...], Strict(False)] = Field(default=(), max_length=1000)
    planets: Annotated[tuple[PlanetsInput, ...], Strict(False)] = Field(default=(), max_length=100)
    loads: Annotated[tuple[LoadTorqueInput, ...], Strict(False)] = Field(default=(), max_length=1000)
    outputs: OutputsInput = Field(default=OutputsInput(), description="What to store", examples=[{}])
    integration: IntegrationInput = Field(
        default=IntegrationInput(), description="How to integrate", examples=[{}]
    )
    effects: dict[EffectName, Switch] = Field(
        default={}, description="Switches of optional physics; left out = auto"
    )

    @model_validator(mode="before")
    @classmethod
    def _tables(cls, data: Any) -> Any:
        """Say how a part is written when a single table stands where a list is meant."""
        if isinstance(data, dict):
            for kind in (*_NAMED, "planets"):
                if isinstance(data.get(kind), dict):
                    refuse(kind, data[kind], "a list of tables", f"Write [[{kind}]] with two brackets.")
        return data

    @model_validator(mode="after")
    def _parts_exist(self) -> Self:
        """Names are unique, and every part names parts that exist."""
        for kind in _NAMED:
            _refuse_repeated(kind, [part.name for part in getattr(self, kind)])
        shafts = [shaft.name for shaft in self.shafts]
        on_one_shaft = ("gears", "bushings", "planet_bearings", "drives", "free_rotations", "loads")
        for kind in (*on_one_shaft, "speed_torques"):
            for index, part in enumerate(getattr(self, kind)):
                _refuse_unknown(f"{kind}[{index}].shaft", part.shaft, shafts)
        for index, shaft in enumerate(self.shafts):
            if shaft.frame is not None:
                _refuse_unknown(f"shafts[{index}].frame", shaft.frame, shafts)
        for index, coupling in enumerate(self.couplings):
            _refuse_unknown(f"couplings[{index}].first", coupling.first, shafts)
            _refuse_unknown(f"couplings[{index}].second", coupling.second, shafts)
        for index, planets in enumerate(self.planets):
            _refuse_unknown(f"planets[{index}].planet", planets.planet, shafts)
        gears = [gear.name for gear in self.gears]
        for index, mesh in enumerate(self.meshes):
            _refuse_unknown(f"meshes[{index}].driver", mesh.driver, gears)
            _refuse_unknown(f"meshes[{index}].driven", mesh.driven, [g for g in gears if g != mesh.driver])
        return self


def _refuse_repeated(kind: str, names: list[str]) -> None:
    """Names of one kind are unique."""
    for index, name in enumerate(names):
        if name in names[:index]:
            refuse(f"{kind}[{index}].name", name, "a name that no other one of them has")


def _refuse_unknown(field: str, name: str, known: list[str]) -> None:
    """Refuse a part that names one that does not exist."""
    if name not in known:
        refuse(field, name, f"one of {', '.join(known)}", "Names are case-sensitive.")
