"""Figures of results: the documents that verbs print by ``--json`` and the service answers with.

A study declares its figures in its package; those of tables and runs are declared here. Units are in the
names. A figure that is not known is None, or left out of the document where the field has a default. The
type of a figure may be annotated with its `Source`; without one the figure is the member of the result that
has its name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from lineofaction.gearbox.units import boundary_ledger

Json = dict[str, Any]
REQUIRED = object()
"""Mark of a figure that every result has."""
LINEAR: Json = {"source": "linear response"}
"""`BearingForces` of a linear response."""


@dataclass(frozen=True)
class Source:
    """Source of a figure in a result whose members have other names than the figures, or other shapes."""

    of: str | Callable[[Any], Any]
    """Name of the member, several joined by dots, or a function of the result. Its values are in SI."""
    missing: Any = REQUIRED
    """Figure of a result of a version that did not know it."""
    document: bool = False
    """Whether the member is a JSON document, which is shown without conversion of units."""
    turned: Callable[[Any], Any] = lambda document: document
    """Function that brings a document into the shape in which it is shown."""


class Part(BaseModel):
    """A part of figures. It keeps members that a service of a later version adds."""

    model_config = ConfigDict(extra="allow", frozen=True)


class Figures(Part):
    """Figures of a result and of its file."""

    hash: str
    """Content hash of the input, the name of the result."""
    sha256: str
    """Digest of the file."""
    size: int
    """Bytes of the file."""
    warnings: list[Json] = Field(default_factory=list)
    """Warnings about implausible inputs: check, field, value, unit, message."""

    def __getitem__(self, name: str) -> Any:
        """Return a member of the document by its name there, as version 0.2 had it."""
        return self.model_dump(by_alias=True, exclude_unset=True)[name]


class TableFigures(Figures):
    """Figures of an STE database: its case, effects and receipt, its axes, and loads of teeth that differ."""

    class ToothLoads(Part):
        """Largest force and pressure on each tooth of a gear at a load; tooth 1 meshes first."""

        most_loaded: list[int]
        force_n: float
        over_mean: float
        force_by_tooth_n: list[float]
        most_pressed: list[int]
        pressure_mpa: float | None = None
        pressure_by_tooth_mpa: list[float] | None = None

    class InsertedNodes(Part):
        """Values of the axes that were inserted between the requested values to meet the tolerance."""

        torque_n_m: list[float] = Field(default_factory=list)
        normal_force_n: list[float] = Field(default_factory=list)
        misalignment_um: list[float] = Field(default_factory=list)
        center_distance_change_mm: list[float] = Field(default_factory=list)

    schema_version: int
    content_hash: str
    case: Json
    effect_ledger: list[Json] | Json
    receipt: Json
    software_versions: dict[str, str]
    failed_points: int
    period: int
    position: list[float]
    torque_n_m: list[float]
    normal_force_n: list[float]
    misalignment_um: list[float]
    center_distance_change_mm: list[float]
    inserted: InsertedNodes | None = None
    tooth_loads: list[dict[str, ToothLoads]] | None = None


class Headline(BaseModel):
    """Figures of a result in a list: its cost, and the transmission error of a table at its middle load."""

    cpu_seconds: float | None = Field(
        default=None,
        description="CPU time of the job that made the result; null: the result came along with another one",
    )
    torque_n_m: float | None = Field(default=None, description="The middle load of the table")
    peak_to_peak_um: float | None = None
    peak_to_peak_error_um: float | None = Field(default=None, description="null: not estimated")
    first_harmonic_um: float | None = Field(default=None, description="Amplitude of mesh harmonic 1")
    first_harmonic_error_um: float | None = Field(default=None, description="null: not estimated")
    ripple_um: list[float] = Field(
        default=[], description="Transmission error less its mean over two base pitches, both ends included"
    )


class RunFigures(Figures):
    """Names, sizes and attributes of the file of a run, without its data."""

    class RunVariable(Part):
        """A variable of the file of a run."""

        dimensions: list[str]
        units: str

    attributes: Json
    dimensions: dict[str, int]
    variables: dict[str, RunVariable]


class Equilibrium(Part):
    """The loaded equilibrium that studies of a scene start from."""

    status: Annotated[str, Source(lambda start: start["status"].lower())]
    residual_n: float


class PredictedCost(Part):
    """Predicted CPU seconds on the host that computed the result, and bytes of the largest working set."""

    cpu_seconds: Annotated[float, Source("seconds")]
    bytes: float


class HousingCost(Part):
    """Cost of work on a housing: bytes are null where the process had been as large before."""

    predicted_cpu_seconds: Annotated[float, Source("predicted_seconds")]
    predicted_bytes: float
    cpu_seconds: Annotated[float, Source("seconds")]
    bytes: float | None


class BearingForces(Part):
    """A linear response, or orders of a run: how its windows hold. Lists are by order, then by window."""

    source: str
    time_s: list[float] | None = None
    window_pitches: int | None = None
    windows_left_out: int | None = None
    speed_change: list[float] | None = None
    smearing: list[list[float]] | None = None
    remainder: dict[str, list[float]] | None = None
    other_housings: list[str] | None = None


Forces = Annotated[BearingForces, Source("forces", missing=LINEAR)]
"""Source of the bearing forces in a study of housings."""


class ExcitationFigures(Part):
    """A harmonic of a mesh at its torque on the driving gear: amplitudes that excite, each with its error.

    Null: the table states no error. Orders beside the mesh orders, of single teeth, have no harmonic.
    """

    mesh: str
    torque_n_m: float
    harmonic: int | None
    order: float
    transmission_error_um: float
    error_of_transmission_error_um: float | None
    load_moment_n_m: float
    error_of_load_moment_n_m: float | None
    friction_force_n: float
    error_of_friction_force_n: float | None


Excitations = Annotated[list[ExcitationFigures], Source("excitations", missing=[])]
"""Excitations of a linear response; empty if the forces come from a run."""
Ledger = Annotated[Json, Source("effect_ledger", document=True, turned=boundary_ledger)]
"""The effect ledger of a scene."""
Seconds = Annotated[dict[str, float], Source("seconds")]
"""CPU time by stage."""
ReductionCosts = Annotated[dict[str, HousingCost], Source("reduction_cost", missing={})]
"""Costs of reductions by the name of the housing."""
