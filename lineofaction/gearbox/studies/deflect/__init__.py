"""Load cases under which a gearbox is deflected."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from dynamics.settings import load_case
from dynamics.settings.load_case import CaseForce
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.figures import Figures, Part, Source
from lineofaction.gearbox.schemas.loads import ACTING, Vector
from lineofaction.gearbox.schemas.model import BoundaryModel, Name, Row, refuse
from lineofaction.gearbox.schemas.rules import all_of, values_or_factor

MAX_CASES = 64
MAX_FORCES = 256
RatingLife = Literal["limited", "unlimited", "none: no capacity"]


@with_fields(declared_in(CaseForce))
class CaseForceInput(BoundaryModel):
    """A force of the scene under a load case: its own force and moment, or a factor on the scene's."""

    model_config = ConfigDict(json_schema_extra=all_of(values_or_factor(*ACTING)))

    name: Name = Field(description="Name of the force in the scene", examples=["belt"])
    force_n: Vector | None = Field(
        default=None,
        description="Force in x, y, z in N; left out: the scene's",
        examples=[[0.0, 800.0, 0.0]],
    )
    moment_n_m: Vector | None = Field(
        default=None,
        description="Moment about x, y and +z in N m; left out: the scene's",
        examples=[[0.0, 0.0, 20.0]],
    )


CaseForces = Annotated[Row[CaseForceInput], Field(max_length=MAX_FORCES)]


@with_fields(declared_in(load_case.LoadCase))
class LoadCaseInput(BoundaryModel):
    """A load of the scene and the share of its duration."""

    name: Name = Field(description="Name of the load case", examples=["cruise"])
    forces: CaseForces = Field(
        default=(),
        description="Forces of the scene that differ under this load case; the others act as in the scene",
        examples=[[{"name": "belt", "force_n": [0.0, 800.0, 0.0]}]],
        exclude_if=lambda forces: not forces,
    )


LoadCases = Annotated[Row[LoadCaseInput], Field(min_length=1, max_length=MAX_CASES)]


class Inputs(BoundaryModel):
    """Load cases, and the positions of the mesh cycle at which the bodies are balanced."""

    load_cases: LoadCases = Field(
        default=(LoadCaseInput(name="load"),),
        description="Load cases; default: the loads of the scene at t = 0",
        examples=[[{"name": "cruise", "share": 0.8, "torque_n_m": 60.0, "speed_rpm": 3000.0}]],
    )
    positions: int = Field(
        default=16,
        ge=1,
        le=512,
        description="Least number of positions of the mesh cycle; every mesh takes each of them once",
        examples=[16],
    )

    @model_validator(mode="after")
    def _refuse_equal_names(self) -> Self:
        names = [case.name for case in self.load_cases]
        if len(set(names)) < len(names):
            refuse("load_cases", names, "names that differ", "Rename one of them.")
        return self


class Flanks(Part):
    """A mesh on its flanks; K_Hbeta is None in the plane."""

    torque_n_m: float
    k_h_beta: Annotated[float | None, Source("face_load_factor")]
    largest_pressure_mpa: float
    mean_um: float
    mean_error_um: float | None
    peak_to_peak_um: float
    peak_to_peak_error_um: float | None
    harmonics_um: list[float]
    harmonics_error_um: list[float | None]
    load_arm_difference_mm: float | None


class DeflectFigures(Figures):
    """Misalignment by cause, flanks and bearings under every load case."""

    class Agreement(Part):
        """Whether tables and deflections agree."""

        agreed: bool
        passes: int
        relative_change: Annotated[float | None, Source("change")]

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

    class LoadCase(Part):
        """A load case."""

        class Mesh(Part):
            """A mesh under a load case."""

            name: str
            force_n: float
            misalignment_um: float
            misalignment_over_cycle_um: Annotated[
                tuple[float, float], Source(lambda mesh: (mesh.least, mesh.largest))
            ]
            causes_um: dict[str, float]
            center_distance_change_um: float
            lead_torsion_um: float
            load_arm_mm: float | None
            in_table: bool
            flanks: Flanks | None

        class Bearing(Part):
            """A bearing under a load case, in x, y, z; without a life `rating_life` has the reason."""

            name: str
            shaft: str
            speed_rpm: float
            force_n: Annotated[list[float], Source(lambda load: load.force[:3])]
            moment_n_m: Annotated[list[float], Source(lambda load: load.force[3:])]
            radial_force_n: Annotated[float, Source("radial")]
            axial_force_n: Annotated[float, Source("axial")]
            largest_radial_force_n: Annotated[float, Source("largest_radial")]
            elastic_um: Annotated[list[float], Source(lambda load: load.elastic[:3])]
            clearance_um: Annotated[list[float], Source(lambda load: load.clearance[:3])]
            seat_um: Annotated[list[float], Source(lambda load: load.seat[:3])]
            tilt_mrad: Annotated[list[float], Source(lambda load: (load.elastic + load.clearance)[3:])]
            rating_life_hours: float | None
            rating_life: RatingLife

        class Force(Part):
            """A force of the scene under a load case in the axes x, y, z, before the factor of its course."""

            name: str
            shaft: str
            force_n: list[float]
            moment_n_m: list[float]

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

    leading_shaft: Annotated[str, Source("deflection.leading_shaft")]
    agreement: Annotated[Agreement, Source(lambda result: result)]
    load_cases: list[LoadCase]
    meshes: list[MeshOverCases]
    bearings: list[BearingOverCases]
    cpu_seconds: Annotated[float, Source("seconds")] = Field(
        description="CPU time, including the tables and housings that were made for the study"
    )
