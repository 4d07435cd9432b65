"""Other flanks, another load and alignment for the gears of a stored database; and a case to be planned."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Optional

from pydantic import Field, Strict, create_model

from fe_contact.flank.modification import FlankModification
from service.schemas.case import Case
from service.schemas.declared import figures
from service.schemas.gear import ToothingInput
from service.schemas.model import BoundaryModel


def _left_out(name: str) -> Any:
    """Return a field of a gear that may be left out: it is then as in the case."""
    field = ToothingInput.model_fields[name]
    kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    text = f"{field.description}; left out: as in the case"
    return Optional[kind], Field(default=None, description=text, examples=field.examples)  # noqa: UP045


FlankChange = create_model(
    "FlankChange",
    __base__=BoundaryModel,
    __doc__="Flank modifications of one gear; > 0 is material removed.",
    **{figure.field: _left_out(figure.field) for figure in figures(FlankModification)},
)

Torque = Annotated[float, Field(ge=1e-9, le=1e9)]
Torques = Annotated[tuple[Torque, ...], Strict(False), Field(min_length=1, max_length=16)]
Caller = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$")]


class LiveInput(BoundaryModel):
    """The differences from the case of the database."""

    torque_n_m: Torques = Field(
        description="Torques on the driving gear in N m, increasing, at most twice the highest of the case",
        examples=[[100.0]],
    )
    misalignment_um: float = Field(
        default=0.0,
        ge=-10_000.0,
        le=10_000.0,
        description="Gap growth in um over the common face width in the plane of action, zero at mid-face",
        examples=[0.0],
    )
    center_distance_change_mm: float = Field(
        default=0.0,
        ge=-10.0,
        le=10.0,
        description="Change of the center distance in mm; each new one is assembled first (0.2 to 1 s)",
        examples=[0.0],
    )
    pinion: FlankChange = Field(  # type: ignore[valid-type]
        default=FlankChange(), description="Flanks of the driving gear", examples=[{"tip_relief_um": 10.0}]
    )
    wheel: FlankChange = Field(  # type: ignore[valid-type]
        default=FlankChange(), description="Flanks of the driven gear", examples=[{"tip_relief_um": 10.0}]
    )
    derivatives: bool = Field(
        default=False,
        description="Also return the derivatives of every curve by its flanks, misalignment and torque, and "
        "where on the flanks a micrometer matters",
        examples=[True],
    )
    condense: bool = Field(
        default=False,
        description="Compute the compliance first if this service has none in its cache, as of gears that "
        "were analyzed elsewhere (else refused, not-analysed); what a minute is too short for goes on when "
        "asked again",
        examples=[False],
    )
    caller: Caller | None = Field(
        default=None,
        description="A name for whoever asks: a later question under it takes the place of one that waits",
        examples=["slider-1"],
    )


class SourceError(BoundaryModel):
    """Error of one source; null where it is not known."""

    mean: float | None = Field(description="Of the mean in um", examples=[0.01])
    peak_to_peak: float | None = Field(description="Of peak-to-peak in um", examples=[0.02])
    first_harmonic: float | None = Field(description="Of the first mesh harmonic in um", examples=[0.01])


class CurveDerivative(BoundaryModel):
    """Derivatives of a curve by one figure, per unit of the figure."""

    ste_um: list[float] = Field(
        description="Of the transmission error at each position", examples=[[0.1, 0.2]]
    )
    mean_um: float = Field(description="Of the mean", examples=[0.15])
    peak_to_peak_um: float = Field(description="Of peak-to-peak", examples=[0.02])
    harmonics_um: list[float | None] = Field(
        description="Of the amplitudes of the mesh harmonics; null where the positions do not resolve one",
        examples=[[0.01, -0.02]],
    )


class FlankDerivative(BoundaryModel):
    """Change per micrometer removed at each node of a grid on a flank, bilinear between the nodes."""

    roll_length_mm: list[float] = Field(description="Rows of the grid: roll lengths", examples=[[4.0, 9.0]])
    face_position_mm: list[float] = Field(
        description="Columns: distance from the gear's mid-face", examples=[[-5.0, 5.0]]
    )
    mean_um: list[list[float]] = Field(description="Of the mean", examples=[[[0.2, 0.3], [0.3, 0.2]]])
    peak_to_peak_um: list[list[float]] = Field(
        description="Of peak-to-peak", examples=[[[0.1, 0.0], [-0.1, 0.0]]]
    )


class CurveDerivatives(BoundaryModel):
    """The derivatives of a curve, to first order; see docs/theory/contact.md."""

    by: dict[str, CurveDerivative] = Field(
        description="By every figure that acts: per um, per mm of a length, per N m",
        examples=[
            {
                "pinion.tip_relief_um": {
                    "ste_um": [0.1, 0.2],
                    "mean_um": 0.15,
                    "peak_to_peak_um": 0.02,
                    "harmonics_um": [0.01, -0.02],
                }
            }
        ],
    )
    pinion: FlankDerivative = Field(description="By the flank of the driving gear")
    wheel: FlankDerivative = Field(description="By the flank of the driven gear")


class LiveCurve(BoundaryModel):
    """Transmission error over one period at one load, with what it may be wrong by.

    An error covers the discretization of the same model, all sources together; see docs/accuracy.md.
    """

    torque_n_m: float = Field(description="Torque on the driving gear in N m", examples=[100.0])
    normal_force_n: float = Field(description="Normal tooth force in N", examples=[2660.4])
    misalignment_um: float = Field(description="Misalignment in um", examples=[0.0])
    center_distance_change_mm: float = Field(
        description="Change of the center distance in mm", examples=[0.0]
    )
    period: int = Field(description="Base pitches after which all repeats", examples=[1])
    position: list[float] = Field(description="Base pitches; 0 = pitch point", examples=[[0.0, 0.5]])
    ste_um: list[float] = Field(description="Static transmission error in um", examples=[[9.7, 12.1]])
    pair: list[int] = Field(description="Tooth pair of each column of load_share", examples=[[-1, 0]])
    load_share: list[list[float]] = Field(
        description="Share of each pair", examples=[[[0.5, 0.5], [0.0, 1.0]]]
    )
    mean_um: float = Field(description="Mean in um", examples=[10.9])
    mean_error_um: float | None = Field(default=None, description="Its error in um", examples=[0.02])
    peak_to_peak_um: float = Field(description="Peak to peak in um", examples=[2.8])
    peak_to_peak_error_um: float | None = Field(default=None, description="Its error in um", examples=[0.03])
    harmonics_um: list[float] = Field(
        description="Amplitudes of the mesh harmonics in um", examples=[[1.1, 0.4]]
    )
    harmonics_error_um: list[float] | None = Field(
        default=None, description="Their errors in um", examples=[[0.02, 0.01]]
    )
    error_by_source_um: dict[str, SourceError] = Field(
        description="What the errors are made of: root of the sum of squares",
        examples=[{"discretisation": {"mean": 0.01, "peak_to_peak": 0.02, "first_harmonic": 0.01}}],
    )
    order: list[float] | None = Field(default=None, description="Orders of a period of several base pitches")
    amplitude_um: list[float] | None = Field(default=None, description="Their amplitudes in um")
    derivatives: CurveDerivatives | None = Field(
        default=None, description="What changes the curve, if that was asked"
    )


class LiveAssumption(BoundaryModel):
    """One thing that the answer took for granted."""

    effect: str = Field(description="The effect that would not need it; empty if there is none")
    assumption: str = Field(description="What", examples=["coast flanks stay apart"])
    holds: bool | None = Field(description="Null: not checked, or it could not be assessed", examples=[True])
    reason: str = Field(description="What was found", examples=["the least room is 12 um"])
    change: float | None = Field(
        default=None, description="Largest relative change of mean or peak-to-peak that it can make"
    )


class LiveCost(BoundaryModel):
    """CPU seconds of the parts of an answer."""

    compliance_cpu_seconds: float = Field(
        description="Reading and assembling it: next to nothing if it was in memory", examples=[0.001]
    )
    contact_cpu_seconds: float = Field(description="The curves", examples=[0.02])
    error_estimate_cpu_seconds: float = Field(description="Their errors", examples=[0.02])
    derivatives_cpu_seconds: float = Field(
        default=0.0, description="Their derivatives, if those were asked", examples=[0.03]
    )


class LiveOutput(BoundaryModel):
    """Curves of other flanks."""

    curves: list[LiveCurve] = Field(description="One for each torque")
    effects: dict[str, bool] = Field(
        description="Which optional physics was on", examples=[{"corner_contact": True}]
    )
    beyond_load_patches: int = Field(
        description="Points at which a contact strip outgrew its load patch: 0.5 % of the mean there",
        examples=[0],
    )
    discretisation_error: Literal["measured", "expected"] = Field(
        description="How the error of the meshes is known: measured on coarse ones with these flanks, or, "
        "where those are not in the cache (the table has a minimal receipt), as usual of the level",
        examples=["measured"],
    )
    not_estimated: list[str] = Field(description="Sources of errors that are not known", examples=[[]])
    residuals_max: float = Field(description="Largest relative residual of the contact", examples=[1e-12])
    assumptions: list[LiveAssumption] = Field(description="What was taken for granted, and checked")
    not_checked: list[LiveAssumption] = Field(description="What was taken for granted, and was not")
    cost: LiveCost = Field(description="Of that work its parts")
    cpu_seconds: float = Field(description="Work of the answer", examples=[0.03])


class PlanInputs(BoundaryModel):
    """The case to plan."""

    case: Case = Field(description="The case, as in a case file")
    time_budget_s: float | None = Field(
        default=None,
        gt=0.0,
        le=1e6,
        description="CPU seconds that may be spent, beside a tolerance or a level of the case",
        examples=[30.0],
    )


class PlanRequest(BoundaryModel):
    """The body of an execution of analyze, planned instead of run."""

    inputs: PlanInputs = Field(description="Inputs of the plan")
    caller: Caller | None = Field(
        default=None,
        description="A name for whoever asks: a later question under it takes the place of one that waits",
        examples=["form-1"],
    )
