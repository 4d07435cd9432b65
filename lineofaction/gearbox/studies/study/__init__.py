"""Inputs and figures of a study of scenes: factors, responses, sample.

A factor is a field of the scene that the study varies. Factors with levels form a grid, in which every level
meets every other; factors with values form a list, and change together; factors with a distribution are
sampled. A combination is one point of the grid and of the list; it is run with every sample. A point is one
run.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from lineofaction.gearbox.schemas.figures import Figures, Json, Part
from lineofaction.gearbox.schemas.model import BoundaryModel, Name, Row, refuse
from lineofaction.gearbox.schemas.rules import all_of, exactly_one_of

Value = Annotated[float, Field(ge=-1e20, le=1e20)]
Values = Row[Value]
Path = Annotated[str, Field(min_length=1, max_length=500)]

QuantityName = Literal[
    "bearing_force",
    "dte_order",
    "dte_rms",
    "dte_peak_to_peak",
    "peak_mesh_force",
    "dynamic_factor",
    "contact_loss",
    "mesh_load_factor",
]
"""Names of `dynamics.study.QUANTITIES`, repeated here because loading that module would slow the start of a
service.
"""
SAMPLED = ("normal", "uniform", "iso1328_class")
"""Kinds of factors that have a distribution."""
_KINDS = ("levels", "values", *SAMPLED)
MAX_POINTS = 100_000
"""Highest number of points of a study, whose result holds the figures of all of them."""


class FactorInput(BoundaryModel):
    """Something that the scene file declares, and the values it takes; in the unit of its name."""

    class NormalInput(BoundaryModel):
        """A truncated normal distribution."""

        mean: Value = Field(description="Mean before truncation", examples=[1e8])
        standard_deviation: float = Field(
            gt=0.0, le=1e20, description="Standard deviation before truncation", examples=[5e6]
        )
        low: Value | None = Field(
            default=None, description="Lower limit; values below are rejected", examples=[8e7]
        )
        high: Value | None = Field(
            default=None, description="Upper limit; values above are rejected", examples=[1.2e8]
        )

    class UniformInput(BoundaryModel):
        """A uniform distribution between two bounds."""

        low: Value = Field(description="Lowest value", examples=[0.05])
        high: Value = Field(description="Highest value", examples=[0.15])

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of(*_KINDS)))

    path: Path = Field(
        description="Field of the scene as a path KIND.NAME.FIELD; * is every part, [0] an entry of a list",
        examples=["loads.brake.torque_n_m"],
    )
    levels: Values | None = Field(
        default=None,
        min_length=1,
        max_length=10_000,
        description="Levels of a grid, combined with every level of the other factors",
        examples=[[50.0, 100.0, 150.0]],
    )
    values: Values | None = Field(
        default=None,
        min_length=1,
        max_length=MAX_POINTS,
        description="Values of a list, which change together with those of other lists",
        examples=[[50.0, 100.0]],
    )
    normal: NormalInput | None = Field(default=None, description="Normal distribution")
    uniform: UniformInput | None = Field(default=None, description="Uniform distribution")
    iso1328_class: int | None = Field(
        default=None,
        ge=1,
        le=11,
        description="Tolerance class of ISO 1328-1:2013 of a profile or helix slope: normal about the design "
        "value with three standard deviations at the tolerance, truncated there",
        examples=[6],
    )

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        """Refuse a factor that has no kind, or more than one."""
        kinds = [kind for kind in _KINDS if getattr(self, kind) is not None]
        if len(kinds) != 1:
            bound = f"given once, as one of {', '.join(_KINDS)}"
            refuse("levels", kinds or None, bound, "Keep one of them.")  # None: the field is missing
        return self

    @property
    def sampled(self) -> bool:
        """Whether the factor has a distribution."""
        return any(getattr(self, kind) is not None for kind in SAMPLED)


class Inputs(BoundaryModel):
    """Inputs of a study of a scene: factors that are varied, and responses of every run."""

    class ResponseInput(BoundaryModel):
        """A figure that is taken from every run."""

        quantity: QuantityName = Field(description="Name of the response", examples=["bearing_force"])
        part: Name | None = Field(
            default=None,
            description="Mesh or bearing of the response; left out: the largest over all",
            examples=["input left"],
        )
        order: int | None = Field(
            default=None,
            ge=1,
            le=1000,
            description="Mesh order, for bearing_force and dte_order",
            examples=[1],
        )
        mesh: Name | None = Field(
            default=None,
            description="Mesh whose orders a bearing force has; left out: the first mesh",
            examples=["mesh"],
        )

    factors: Row[FactorInput] = Field(
        min_length=1,
        max_length=100,
        description="Factors to vary: a table [[factors]] for each",
        examples=[[{"path": "loads.brake.torque_n_m", "levels": [50.0, 100.0]}]],
    )
    responses: Row[ResponseInput] = Field(
        min_length=1,
        max_length=100,
        description="Responses of every run: a table [[responses]] for each",
        examples=[[{"quantity": "dte_rms"}]],
    )
    samples: int = Field(
        default=1,
        ge=1,
        le=MAX_POINTS,
        description="Number of samples of the distributions, the same for every combination of levels",
        examples=[1],
    )
    seed: int = Field(
        default=0,
        ge=0,
        le=2**32 - 1,
        description="Seed of the samples; equal seeds give equal samples",
        examples=[0],
    )
    start_s: float = Field(
        default=0.0, ge=0.0, le=1e6, description="Start time of the responses in s", examples=[0.5]
    )
    receipt: Literal["minimal", "full"] = Field(
        default="minimal",
        description="minimal: state the tolerance of the steps; full: measure the errors of every run",
        examples=["minimal"],
    )
    confidence: float = Field(
        default=0.95,
        ge=0.5,
        le=0.9999,
        description="Confidence level of the bounds of quantiles",
        examples=[0.95],
    )
    keep_worst: int = Field(
        default=0,
        ge=0,
        le=100,
        description="Number of runs with the largest first response to store in full",
        examples=[3],
    )

    @model_validator(mode="after")
    def _check_samples_and_paths(self) -> Self:
        """Refuse samples without a distribution, a distribution without samples, and a path used twice."""
        if any(factor.sampled for factor in self.factors) != (self.samples > 1):
            bound = "above 1 where a factor has a distribution, else left out"
            refuse("samples", self.samples, bound, "For example samples = 50.")
        paths = [factor.path for factor in self.factors]
        for index, path in enumerate(paths):
            if path in paths[:index]:
                refuse(f"factors[{index}].path", path, "a path that no other factor has")
        return self


class StudyFigures(Figures):
    """Factors, statistics of all responses, worst and failed points."""

    class FactorFigures(Part):
        """A factor by its path, and the kind of its values."""

        path: str
        kind: str

    class ResponseFigures(Part):
        """Statistics of a response by combination of grid and list, in its unit."""

        class QuantileFigures(Part):
            """A quantile by combination of grid and list, with its confidence bounds; None: not known."""

            fraction: float
            """Part of the samples that is below the quantile, 0..1."""
            value: list[float | None]
            low: list[float | None]
            high: list[float | None]
            """`value`, `low`, `high`: The quantile and its confidence bounds, one entry a combination."""

        name: str
        unit: str
        mean: list[float | None]
        standard_error: list[float | None]
        """`mean`, `standard_error`: Mean of the response over the samples and its standard error, one entry a
        combination."""
        confidence: float
        """Confidence level of the bounds of the quantiles."""
        quantiles: list[QuantileFigures]
        spread_of_level_means: dict[str, float | None]
        """Largest less smallest mean of the response over the values of a factor, by factor of the grid or
        the list.
        """
        rank_correlation: dict[str, float | None]
        """Rank correlation of a factor's values with the response, -1..1, by factor with a distribution."""

    class PointFigures(Part):
        """A point: the values of the factors and its responses."""

        class PointResponse(Part):
            """A response at a point with its stated error."""

            value: float | None
            unit: str
            error: float | None

        point: int
        """Number of the point, from 0."""
        values: dict[str, float]
        """Values of the factors by path."""
        responses: dict[str, PointResponse]

    class FailedPoint(Part):
        """A point without responses."""

        point: int
        values: dict[str, float]
        reason: str

    points: int
    """Number of runs."""
    usable: int
    """Number of runs that have responses."""
    samples: int
    """Number of samples of every combination."""
    factors: list[FactorFigures]
    responses: list[ResponseFigures]
    worst: list[PointFigures]
    failed: list[FailedPoint]
    cpu_seconds: dict[str, float | None]
    seed: int
    start: Any
    """Start time of the responses, s."""
    receipt: str
    neglected: Any
    """Names of the checks that the runs do without, a list."""
    effects: Json | None = None
    """Decision on effects for all runs: effects that are on, influences of the neglected ones, the largest of
    them, number of points and CPU time of the decision.
    """
    design: Json
    """Inputs of the study, as JSON."""
    runs: dict[str, str]
    """Content hashes of the runs that are stored in full, by point."""
