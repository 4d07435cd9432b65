"""Inputs of a micro-geometry optimization: variables, scatter, objective."""

from __future__ import annotations

from itertools import cycle, pairwise
from typing import Annotated, Any, ClassVar, Literal, Optional, Self

from pydantic import Field, Strict, model_validator

from bounds import DEPTHS, Kind
from fe_contact.flank.modification import FlankModification
from lineofaction.gearbox.schemas.case import Load, Misalignment
from lineofaction.gearbox.schemas.declared import Figure, figures, with_fields
from lineofaction.gearbox.schemas.figures import Figures, Json, Part, Source
from lineofaction.gearbox.schemas.model import BoundaryModel, Name, refuse
from lineofaction.gearbox.schemas.query import MANY, ONE, ONE_OR_MANY
from lineofaction.gearbox.schemas.studied import OverOrders
from lineofaction.gearbox.studies.change import HeardInput
from lineofaction.gearbox.studies.deflect import LoadCaseInput, LoadCases
from lineofaction.gearbox.studies.scatter import ToleranceInputs

TRIALS, SOUND_TRIALS = 3, 8
"""Number of best start designs from which a search begins, of a case and of a scene."""
PAIRS = 32
"""Number of pairs over which start and optimum are compared: a few CPU seconds."""
Deviation = Annotated[float, Field(gt=0.0, le=1000.0)]
_LIST = (Strict(False), Field(min_length=1, max_length=64))
Torques = Annotated[tuple[Load, ...], *_LIST]
Misalignments = Annotated[
    Annotated[Misalignment, ONE] | Annotated[tuple[Misalignment, ...], *_LIST, MANY], ONE_OR_MANY
]
_FREE = figures(FlankModification, Kind.AMOUNT, Kind.DEVIATION, Kind.LENGTH)


def _ends(figure: Figure) -> tuple[Any, Any]:
    """Return the field of a figure's lowest and highest value; no length may vanish."""
    number: Any = figure.accepted
    if figure.what.kind is Kind.LENGTH:
        number = Annotated[float, Field(gt=0.0, le=figure.limits.le)]
    pair: Any = Annotated[tuple[number, ...], Strict(False), Field(min_length=2, max_length=2)]
    text = figure.with_unit(f"Bounds of the {figure.label}")
    example = [[0.0 if figure.what.kind in DEPTHS else 0.5, figure.boundary_value(2.0 * figure.what.example)]]
    return Optional[pair], Field(default=None, description=text, examples=example)  # noqa: UP045


def _deviation(figure: Figure) -> tuple[Any, Any]:
    text = figure.with_unit(f"Standard deviation of the {figure.label}")
    return Optional[Deviation], Field(default=None, description=text, examples=[3.0])  # noqa: UP045


@with_fields({figure.field: _ends(figure) for figure in _FREE})
class GearVariablesInput(BoundaryModel):
    """Figures of one gear's modifications that are free, each between two bounds; all others stay."""

    @model_validator(mode="after")
    def _rising(self) -> Self:
        """Refuse a lower bound that is not the lower one."""
        for name in type(self).model_fields:
            ends = getattr(self, name)
            if ends is not None and ends[1] <= ends[0]:
                refuse(name, list(ends), "a lower bound and a higher one", "For example [0, 30].")
        return self


@with_fields({figure.field: _deviation(figure) for figure in _FREE})
class GearScatterInput(BoundaryModel):
    """Standard deviations of one gear's modifications as manufactured; one that is left out is 0."""


class ScatterInput(BoundaryModel):
    """Independent normal deviations from the design, and the quadrature rule of their expectation."""

    misalignment_um: float = Field(
        default=0.0,
        title="Misalignment, standard deviation, µm",
        ge=0.0,
        le=1000.0,
        description="Standard deviation of the misalignment in µm",
        examples=[8.0],
    )
    pinion: GearScatterInput = Field(
        default=GearScatterInput(), description="Modifications of the driving gear"
    )
    wheel: GearScatterInput = Field(
        default=GearScatterInput(), description="Modifications of the driven gear"
    )
    rule: Literal["gauss_hermite", "sobol_sample"] = Field(
        default="gauss_hermite",
        description="Method of averaging: Gauss-Hermite points in each deviation, or one fixed Sobol sample",
        examples=["gauss_hermite"],
    )
    points: int = Field(
        default=5, ge=1, le=33, description="Number of Gauss-Hermite points in each deviation", examples=[5]
    )
    log2_size: int = Field(
        default=4, ge=0, le=10, description="Binary logarithm of the size of the Sobol sample", examples=[4]
    )


class SearchInput(BoundaryModel):
    """Method and settings of the search for the best design."""

    method: Literal["sequential_linear_programming", "differential_evolution", "nelder_mead"] = Field(
        default="sequential_linear_programming",
        description="Search with derivatives from the best start designs, or without derivatives, global or "
        "local",
        examples=["differential_evolution"],
    )
    sample: int = Field(
        default=64,
        ge=0,
        le=4096,
        description="Number of start designs that sequential_linear_programming ranks",
        examples=[64],
    )
    trials: int | None = Field(
        default=None,
        ge=0,
        le=64,
        description="Number of best start designs from which a search begins; left out: "
        f"{TRIALS}, of a scene {SOUND_TRIALS}",
        examples=[TRIALS],
    )
    population: int = Field(
        default=5, ge=3, le=50, description="Population of differential_evolution per variable", examples=[5]
    )
    seed: int = Field(
        default=0, ge=0, le=2**32 - 1, description="Equal seeds give equal results", examples=[0]
    )
    starts: int = Field(default=1, ge=1, le=256, description="Independent searches", examples=[1])
    evaluations: int = Field(
        default=1000,
        title="Largest number of designs",
        ge=1,
        le=1_000_000,
        description="Largest number of designs per search",
        examples=[1000],
    )
    positions: int = Field(
        default=64, ge=8, le=4096, description="Positions in a base pitch during the search", examples=[64]
    )
    exploration: int = Field(
        default=16,
        ge=8,
        le=4096,
        description="Positions for the ranking of start designs and of evolution",
        examples=[16],
    )


class HeardObjectiveInput(OverOrders, HeardInput):
    """Level of a scene over speeds and load cases, which is minimized."""

    MANUAL: ClassVar[str] = "docs/studies.md"
    mesh: Name | None = Field(
        default=None,
        description="Mesh of the scene whose flanks are varied; left out: the only one with a case",
        examples=["mesh"],
    )
    load_cases: LoadCases = Field(
        default=(LoadCaseInput(name="load"),),
        description="Load cases on the driving flanks; default: the loads of the scene at t = 0",
        examples=[[{"name": "cruise", "torque_n_m": 60.0, "speed_rpm": 3000.0}]],
    )
    misalignment_um: Misalignments | None = Field(
        default=None,
        description="Misalignment of the mesh in µm, one value or one for each load case; left out: that of "
        "the mesh in the scene, where it is none those of the deflection of the scene",
        examples=[[3.0]],
    )
    over_loads: Literal["worst", "energy_mean"] = Field(
        default="worst",
        description="The loudest load case, or the mean of the power by the shares of the load cases",
        examples=["energy_mean"],
    )
    counted_orders: Annotated[
        tuple[Annotated[int, Field(ge=1, le=100)], ...], Strict(False), Field(max_length=100)
    ] = Field(default=(), description="Orders of the mesh that count; left out: all", examples=[[1]])
    tolerances: ToleranceInputs = Field(
        default=ToleranceInputs(samples=PAIRS),
        description="Tolerances of both gears and the sample of pairs over which start and optimum are told",
        examples=[{"tolerance_class": 5, "samples": 32}],
    )
    quantile: Annotated[float, Field(ge=0.5, le=0.99)] | None = Field(
        default=None,
        description="Share of the pairs within tolerances that are no louder than what is minimized; left "
        "out: the level as designed, or that of the mean power over scatter",
        examples=[0.9],
    )

    @property
    def heard(self) -> HeardInput:
        """The quantity of the scene's vibration whose level is minimized."""
        return self

    @model_validator(mode="after")
    def _orders_in_range(self) -> Self:
        """Refuse orders beyond the computed ones, and misalignments of other load cases."""
        for index, order in enumerate(self.counted_orders):
            if order > self.orders:
                refuse(f"counted_orders[{index}]", order, f"at most orders, {self.orders}", "Raise orders.")
        misalignment, loads = self.misalignment_um, len(self.load_cases)
        if isinstance(misalignment, tuple) and len(misalignment) not in (1, loads):
            bound = f"one value, or {loads}, one for each load case"
            refuse("misalignment_um", f"{len(misalignment)} values", bound)
        return self


class Inputs(BoundaryModel):
    """Inputs of an optimization of flank modifications: of a case by its ripple, of a scene by its level."""

    class VariablesInput(BoundaryModel):
        """Design variables of both gears."""

        pinion: GearVariablesInput = Field(
            default=GearVariablesInput(), description="Modifications of the driving gear"
        )
        wheel: GearVariablesInput = Field(
            default=GearVariablesInput(), description="Modifications of the driven gear"
        )
        most_tip_relief_um: float = Field(
            default=40.0,
            title="Largest tip relief, µm",
            gt=0.0,
            le=1000.0,
            description="If no modification is named: tip relief of both gears up to this amount, 0.15 to "
            "0.8 modules long, and lead crowning of the driving gear up to 30 µm unless the model is "
            "plane",
            examples=[40.0],
        )

    class ObjectiveInput(BoundaryModel):
        """Objective from the expected peak-to-peak at the torques."""

        kind: Literal["weighted_mean", "worst"] = Field(
            default="weighted_mean", description="Mean over the torques, or the largest", examples=["worst"]
        )
        weights: Annotated[tuple[Annotated[float, Field(ge=0.0, le=1e6)], ...], Strict(False)] = Field(
            default=(),
            max_length=64,
            description="Weights of weighted_mean, one for each torque",
            examples=[[1.0, 2.0]],
        )
        harmonic: Annotated[int, Field(ge=1, le=20)] | None = Field(
            default=None,
            description="Harmonic of the mesh whose amplitude counts in place of the peak-to-peak; left out: "
            "that of the complaint of the case, where it has one and no objective is given",
            examples=[1],
            exclude_if=lambda value: value is None,
        )

    class LimitsInput(BoundaryModel):
        """Limits that a design keeps at every torque and deviation."""

        max_pressure_mpa: float | None = Field(
            default=None, gt=0.0, le=1e5, description="Largest Hertzian pressure in MPa", examples=[1500.0]
        )
        face_load_factor: float | None = Field(
            default=None, gt=1.0, le=100.0, description="Largest K_Hbeta of the mesh cycle", examples=[1.5]
        )
        edge_load_share: float | None = Field(
            default=None,
            ge=0.0,
            lt=1.0,
            description="Largest share of the load on tip edges; 0 forbids their contact",
            examples=[0.0],
        )
        peak_to_peak_um: float | None = Field(
            default=None,
            gt=0.0,
            le=1e4,
            description="Largest peak-to-peak of the transmission error in µm",
            examples=[0.5],
        )
        root_stress_mpa: float | None = Field(
            default=None,
            gt=0.0,
            le=1e5,
            description="Largest stress in the tension roots of both gears in MPa",
            examples=[400.0],
        )

    torque_n_m: Torques | None = Field(
        default=None,
        description="Design torques in N m on the driving gear, increasing, and equal only at different "
        "misalignments; default: those of the case",
        examples=[[100.0, 200.0, 300.0]],
    )
    misalignment_um: Misalignments = Field(
        default=0.0,
        description="Misalignment in µm, one value or one for each torque",
        examples=[0.0],
    )
    variables: VariablesInput = Field(
        default=VariablesInput(),
        description="Modifications to vary, with bounds; default: those of most_tip_relief_um",
        examples=[{"pinion": {"tip_relief_um": [0.0, 60.0], "tip_relief_length_mm": [0.5, 3.0]}}],
    )
    scatter: ScatterInput = Field(default=ScatterInput(), description="Assembly and manufacturing deviations")
    objective: ObjectiveInput = Field(default=ObjectiveInput(), description="Objective to minimize")
    limits: LimitsInput = Field(default=LimitsInput(), description="Limits to meet")
    heard: HeardObjectiveInput | None = Field(
        default=None,
        description="Level of a scene that is minimized in place of the peak-to-peak",
        examples=[None],
        exclude_if=lambda value: value is None,
    )
    search: SearchInput = Field(default=SearchInput(), description="Search method and its settings")

    @model_validator(mode="after")
    def _one_sample(self) -> Self:
        """Refuse a quantile of pairs over the expectation of others."""
        if self.heard is not None and self.heard.quantile is not None and self.scatter != ScatterInput():
            refuse("scatter", "given", "left out with heard.quantile", "Its pairs are heard.tolerances.")
        return self

    @model_validator(mode="after")
    def _loads(self) -> Self:
        """Refuse misalignments of other loads, torques that fall, and a load twice."""
        torques, misalignment_um = self.torque_n_m, self.misalignment_um
        if torques is None:
            return self
        misalignments = misalignment_um if isinstance(misalignment_um, tuple) else (misalignment_um,)
        if len(misalignments) not in (1, len(torques)):
            bound = f"one value, or {len(torques)}, one for each torque"
            refuse("misalignment_um", f"{len(misalignments)} values", bound)
        loads = {*zip(torques, cycle(misalignments), strict=False)}
        if any(b < a for a, b in pairwise(torques)) or len(loads) < len(torques):
            bound = "increasing, and equal only at different misalignments"
            refuse("torque_n_m", list(torques), bound, "Sort the list and drop repeats.")
        return self


class HeardDesignFigures(Part):
    """A design by its load cases; its values by gear and field of a case file."""

    values: dict[str, dict[str, float]]
    objective_db: Annotated[float, Source("objective.value")]
    objective_error_db: Annotated[float, Source("objective.error")]
    violation: float
    peak_to_peak_um: list[float]
    peak_to_peak_error_um: list[float]
    max_pressure_mpa: Annotated[list[float], Source("pressure")]
    max_pressure_error_mpa: Annotated[list[float | None], Source("pressure_error")]
    face_load_factor: list[float]
    face_load_factor_error: list[float | None]
    edge_load_share: list[float]
    root_stress_mpa: list[float | None]
    root_stress_error_mpa: list[float | None]


class WithinFigures(Part):
    """Levels of pairs within tolerances: quantiles of 5, 50 and 95 %, and the share that gets louder."""

    tolerance_class: int
    pairs: int
    before_db: tuple[float, float, float]
    after_db: tuple[float, float, float]
    change_db: tuple[float, float, float]
    louder_share: float


class HeardFigures(Part):
    """Levels before and after, by load case then by order ("all": all orders together)."""

    class LineFigures(Part):
        """An order of the mesh, or all orders together."""

        order: str
        before_db: float
        after_db: float
        error_db: float

    mesh: str
    quantity: str
    unit: str
    over_speeds: str
    over_loads: str
    load_case: list[str]
    torque_n_m: list[float]
    misalignment_um: list[float]
    gain_db: Annotated[float, Source("gain.value")]
    gain_error_db: Annotated[float, Source("gain.error")]
    start: HeardDesignFigures
    optimum: HeardDesignFigures
    levels: list[list[LineFigures]]
    worse: list[str]
    parting: list[str]
    ended: str
    pairs: WithinFigures | None = None


class OptimizeFigures(Figures):
    """The start and the optimum, the variables, and the end of the search; for a scene the levels."""

    class VariableFigures(Part):
        """A variable of the search, with bounds in the unit of its name."""

        name: str
        bounds: tuple[float, float]

    class StepFigures(Part):
        """Change of the objective by a step of a variable down and up from the optimum."""

        name: str
        values: tuple[float, float]
        change_um: tuple[float, float]

    class NodeFigures(Part):
        """The nodes of the scatter and their weights."""

        names: list[str]
        deviation: list[list[float]]
        weight: list[float]

    class DesignFigures(Part):
        """One design as analyzed in full: its values by gear and field of a case file."""

        class HarrisMapFigures(Part):
            """Transmission error over position and torque, with its errors."""

            torque_n_m: list[float]
            position: list[float]
            ste_um: Annotated[list[Any], Source("ste.T")]
            nominal_peak_to_peak_um: Annotated[list[float], Source("nominal")]
            nominal_error_um: list[float]
            expected_peak_to_peak_um: Annotated[list[float], Source("expected")]
            expected_error_um: list[float]
            peak_to_peak_um: list[Any]
            error_um: list[Any]

        values: dict[str, dict[str, float]]
        objective_um: Annotated[float, Source("objective.value")]
        objective_error_um: Annotated[float, Source("objective.error")]
        scatter_error_um: float
        violation: float
        peak_to_peak_um: Annotated[list[Any], Source("figures.peak_to_peak")]
        face_load_factor: Annotated[list[float], Source(lambda d: d.figures.face_load_factor.max(axis=0))]
        face_load_factor_error: Annotated[
            list[float | None], Source(lambda d: d.figures.face_load_factor_error.max(axis=0))
        ]
        edge_load_share: Annotated[list[float], Source(lambda d: d.figures.edge_load_share.max(axis=0))]
        harris_map: HarrisMapFigures
        max_pressure_mpa: Annotated[list[float], Source(lambda d: d.figures.pressure.max(axis=0))]
        max_pressure_error_mpa: Annotated[
            list[float | None], Source(lambda d: d.figures.pressure_error.max(axis=0))
        ]
        root_stress_mpa: Annotated[list[float | None], Source(lambda d: d.figures.root_stress.max(axis=0))]
        root_stress_error_mpa: Annotated[
            list[float | None], Source(lambda d: d.figures.root_stress_error.max(axis=0))
        ]

    class SearchFigures(Part):
        """The result of one start of the search."""

        objective_um: Annotated[float, Source("assessed.objective")]
        violation: Annotated[float, Source("assessed.violation")]
        evaluations: int
        explored: int
        converged: bool
        ended: Annotated[str, Source("ended.value")]
        spread_um: float
        cpu_seconds: float

    outcome: Annotated[str, Source("outcome.value")]
    reason: str
    variables: list[VariableFigures]
    evaluations: int
    best_run: int
    cost: Json
    heard: HeardFigures | None = None
    torque_n_m: list[float] | None = None
    misalignment_um: list[float] | None = None
    nodes: NodeFigures | None = None
    gain_um: Annotated[float | None, Source("gain.value")] = None
    gain_error_um: Annotated[float | None, Source("gain.error")] = None
    start: DesignFigures | None = None
    optimum: DesignFigures | None = None
    runs: list[SearchFigures] | None = None
    sensitivity: list[StepFigures] | None = None
    not_tried: list[str] | None = None
    asked: Json | None = None
