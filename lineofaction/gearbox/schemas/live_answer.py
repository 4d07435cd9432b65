"""Answers to live questions: curves of other flanks, their errors and derivatives, results on the flanks."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.plan import ModelBias


class LiveCurve(BoundaryModel):
    """Transmission error over one period at one load, with its errors.

    An error covers the discretization of the same model, all sources together; see docs/accuracy.md.
    """

    class SourceError(BoundaryModel):
        """Error of one source; null where it is not known."""

        mean: float | None = Field(description="Error of the mean in µm", examples=[0.01])
        peak_to_peak: float | None = Field(description="Error of peak-to-peak in µm", examples=[0.02])
        first_harmonic: float | None = Field(
            description="Error of the first mesh harmonic in µm", examples=[0.01]
        )

    class CurveDerivatives(BoundaryModel):
        """The derivatives of a curve, to first order; see docs/theory/contact.md."""

        class CurveDerivative(BoundaryModel):
            """Derivatives of a curve by one figure, per unit of the figure."""

            ste_um: list[float] = Field(
                description="Derivative of the transmission error at each position", examples=[[0.1, 0.2]]
            )
            mean_um: float = Field(description="Derivative of the mean", examples=[0.15])
            peak_to_peak_um: float = Field(description="Derivative of peak-to-peak", examples=[0.02])
            harmonics_um: list[float | None] = Field(
                description="Derivatives of the amplitudes of the mesh harmonics; null if the positions do "
                "not resolve one",
                examples=[[0.01, -0.02]],
            )

        class FlankDerivative(BoundaryModel):
            """Change per micrometer removed at each node of a grid on a flank, bilinear between the nodes."""

            roll_length_mm: list[float] = Field(
                description="Rows of the grid: roll lengths", examples=[[4.0, 9.0]]
            )
            face_position_mm: list[float] = Field(
                description="Columns: distance from the gear's mid-face", examples=[[-5.0, 5.0]]
            )
            mean_um: list[list[float]] = Field(
                description="Derivative of the mean", examples=[[[0.2, 0.3], [0.3, 0.2]]]
            )
            peak_to_peak_um: list[list[float]] = Field(
                description="Derivative of peak-to-peak", examples=[[[0.1, 0.0], [-0.1, 0.0]]]
            )

        by: dict[str, CurveDerivative] = Field(
            description="Derivatives by every active quantity: per µm, per mm of a length, per N m",
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
        pinion: FlankDerivative = Field(description="Derivatives by the flank of the driving gear")
        wheel: FlankDerivative = Field(description="Derivatives by the flank of the driven gear")

    class LiveFlanks(BoundaryModel):
        """Results on the flanks over one period at one load; no error is stated for them."""

        largest_pressure_mpa: float = Field(
            description="Largest Hertz pressure in MPa away from edges", examples=[1093.0]
        )
        edge_pressure_mpa: float = Field(
            description="Hertz pressure in MPa at edges, as if the flank continued beyond them; the true "
            "pressure is singular. 0: no contact reaches an edge",
            examples=[0.0],
        )
        k_h_beta: float | None = Field(
            description="Face load factor: largest over mean load per face width, averaged over the "
            "positions; null in the plane model, which assumes a uniform load",
            examples=[1.2],
        )
        roll_length_mm: list[float] = Field(
            description="Rows of the pressure: roll lengths of the driving gear", examples=[[4.0, 9.0]]
        )
        face_position_mm: list[float] = Field(
            description="Columns of the pressure: distance from the driving gear's mid-face",
            examples=[[-5.0, 5.0]],
        )
        pressure_mpa: list[list[float]] = Field(
            description="Largest pressure in MPa at each point of the driving gear's flank over the "
            "positions",
            examples=[[[900.0, 1093.0], [850.0, 1010.0]]],
        )
        mean_load_n_per_mm: list[float] = Field(
            description="Load of all pairs per face width in N/mm, averaged over the positions",
            examples=[[110.0, 160.0]],
        )
        worst_load_n_per_mm: list[float] = Field(
            description="Load of all pairs per face width in N/mm at the position of the largest load",
            examples=[[120.0, 190.0]],
        )
        worst_position: float = Field(
            description="Position of the largest load in base pitches", examples=[0.25]
        )

    class LivePassage(BoundaryModel):
        """Pressure and load of a pair of teeth through the mesh; rows by place, columns over the face.

        The place of a pair is the position plus the index of the pair. Its contact line is where the roll
        length of the driving gear is that of the pitch point, plus place times base pitch, less face
        position times tan(beta_b).
        """

        first_place: float = Field(description="Place of the first row, base pitches", examples=[-1.5])
        step: float = Field(description="Step of the place between rows", examples=[0.03125])
        face_position_mm: list[float] = Field(
            description="Columns: distance from the driving gear's mid-face", examples=[[-5.0, 5.0]]
        )
        pressure_mpa: list[list[int]] = Field(description="Hertz pressure in MPa", examples=[[[0, 900]]])
        apart_um: list[list[float]] = Field(
            description="Separation of the pair's flanks under load in µm", examples=[[[8.1, 9.2]]]
        )

    class LiveBand(BoundaryModel):
        """The range of nine in ten pairs whose flanks deviate within a class: 5 % lie below, 5 % above."""

        class Spread(BoundaryModel):
            """The ends of the range of a figure, and the error of the ends."""

            low_um: float = Field(description="A twentieth of the pairs has less, in µm", examples=[0.26])
            high_um: float = Field(description="A twentieth of the pairs has more, in µm", examples=[1.31])
            error_um: float = Field(
                description="Error of the ends in µm: bounds of quantiles of so many pairs at 95 % "
                "confidence, and what tangents miss of the pairs that are held against them",
                examples=[0.13],
            )

        tolerance_class: int = Field(description="The class", examples=[6])
        pairs: int = Field(description="Pairs drawn, by a fixed seed", examples=[1000])
        solved: int = Field(description="Pairs solved by now; tangents stand for the others", examples=[16])
        of: int = Field(description="Pairs to be solved; before, there is no band", examples=[16])
        position: list[float] = Field(
            default=[], description="Positions of the band in base pitches", examples=[[0.0, 0.5]]
        )
        low_um: list[float] = Field(
            default=[],
            description="Transmission error less its mean: a twentieth of the pairs has less, in µm",
            examples=[[-0.4, -0.2]],
        )
        high_um: list[float] = Field(
            default=[],
            description="Transmission error less its mean: a twentieth of the pairs has more, in µm",
            examples=[[0.3, 0.5]],
        )
        peak_to_peak: Spread | None = Field(default=None, description="Peak to peak")
        first_harmonic: Spread | None = Field(default=None, description="First mesh harmonic")

    class LiveToothLoads(BoundaryModel):
        """Largest force and pressure on each tooth of a gear, in the order of meshing from tooth 1."""

        most_loaded: list[int] = Field(
            description="Numbers of the teeth of the largest force; empty: all carry as much", examples=[[7]]
        )
        force_n: float = Field(description="The largest normal force on a tooth in N", examples=[2310.0])
        over_mean: float = Field(
            description="Largest normal force on a tooth over the mean of all teeth", examples=[1.08]
        )
        force_by_tooth_n: list[float] = Field(
            description="Largest normal force on each tooth in N", examples=[[2130.0, 2310.0]]
        )
        most_pressed: list[int] = Field(
            description="Numbers of the teeth of the largest pressure; empty: all alike, or not known",
            examples=[[7]],
        )
        pressure_mpa: float | None = Field(
            default=None, description="Largest pressure on a tooth, off edges, in MPa", examples=[1710.0]
        )
        pressure_by_tooth_mpa: list[float] | None = Field(
            default=None,
            description="Largest pressure on each tooth, off edges, in MPa",
            examples=[[1520.0, 1710.0]],
        )

    torque_n_m: float = Field(description="Torque on the driving gear in N m", examples=[100.0])
    normal_force_n: float = Field(description="Normal tooth force in N", examples=[2660.4])
    misalignment_um: float = Field(description="Misalignment in µm", examples=[0.0])
    center_distance_change_mm: float = Field(
        description="Change of the center distance in mm", examples=[0.0]
    )
    period: int = Field(description="Base pitches after which the curve repeats", examples=[1])
    position: list[float] = Field(
        description="Positions in base pitches; 0 = pitch point", examples=[[0.0, 0.5]]
    )
    ste_um: list[float] = Field(description="Static transmission error in µm", examples=[[9.7, 12.1]])
    error_um: list[float] | None = Field(
        default=None, description="Error of each point in µm", examples=[[0.06, 0.07]]
    )
    interval_error_um: float | None = Field(
        default=None,
        description="Part of it by interpolation between nodes: 0 at loads and alignments that are solved",
        examples=[0.0],
    )
    pair: list[int] = Field(description="Tooth pair of each column of load_share", examples=[[-1, 0]])
    load_share: list[list[float]] = Field(
        description="Share of each pair", examples=[[[0.5, 0.5], [0.0, 1.0]]]
    )
    mean_um: float = Field(description="Mean in µm", examples=[10.9])
    mean_error_um: float | None = Field(default=None, description="Error of the mean in µm", examples=[0.02])
    peak_to_peak_um: float = Field(description="Peak to peak in µm", examples=[2.8])
    peak_to_peak_error_um: float | None = Field(
        default=None, description="Error of the peak to peak in µm", examples=[0.03]
    )
    mean_over_face_um: float | None = Field(
        default=None,
        description="Mean of the gears of finite width in µm: the mean of the plane model, corrected",
    )
    mean_over_face_error_um: float | None = Field(
        default=None, description="Error of mean_over_face_um in µm"
    )
    peak_to_peak_over_face_um: float | None = Field(
        default=None, description="Peak to peak of the gears of finite width in µm, corrected alike"
    )
    peak_to_peak_over_face_error_um: float | None = Field(
        default=None, description="Error of peak_to_peak_over_face_um in µm"
    )
    harmonics_um: list[float] = Field(
        description="Amplitudes of the mesh harmonics in µm", examples=[[1.1, 0.4]]
    )
    harmonics_error_um: list[float] | None = Field(
        default=None, description="Errors of the amplitudes in µm", examples=[[0.02, 0.01]]
    )
    error_by_source_um: dict[str, SourceError] = Field(
        description="Errors by source; the total is the root of the sum of squares",
        examples=[{"discretisation": {"mean": 0.01, "peak_to_peak": 0.02, "first_harmonic": 0.01}}],
    )
    bias: ModelBias | None = Field(
        default=None, description="Bias of a plane model: a correction, in none of the errors"
    )
    order: list[float] | None = Field(
        default=None, description="Orders of the amplitudes, if the period has several base pitches"
    )
    order_name: list[str] | None = Field(default=None, description="Name of each order")
    amplitude_um: list[float] | None = Field(default=None, description="Amplitude at each order in µm")
    amplitude_error_um: list[float] | None = Field(default=None, description="Error of each amplitude in µm")
    tooth_loads: dict[str, LiveToothLoads] | None = Field(
        default=None,
        description="Loads of each tooth by gear, where teeth differ and the period tells them apart",
    )
    derivatives: CurveDerivatives | None = Field(
        default=None, description="Derivatives of the curve, if requested"
    )
    flanks: LiveFlanks | None = Field(
        default=None, description="Load and pressure on the flanks, if requested"
    )
    passage: LivePassage | None = Field(
        default=None, description="A pair of teeth on its way through the mesh, if requested"
    )
    band: LiveBand | None = Field(default=None, description="Pairs within a tolerance class, if requested")


class LiveOutput(BoundaryModel):
    """Curves of other flanks."""

    class LiveAssumption(BoundaryModel):
        """An assumption of the answer."""

        effect: str = Field(description="Effect that removes the assumption; empty if there is none")
        assumption: str = Field(description="The assumption", examples=["coast flanks stay apart"])
        holds: bool | None = Field(description="Null: not checked, or not assessable", examples=[True])
        reason: str = Field(description="Finding of the check", examples=["the least clearance is 12 µm"])
        change: float | None = Field(
            default=None, description="Upper bound of its relative change of mean or peak-to-peak"
        )

    class LiveCost(BoundaryModel):
        """CPU seconds of the parts of an answer."""

        compliance_cpu_seconds: float = Field(
            description="Reading and assembling the compliance; negligible if it is in memory",
            examples=[0.001],
        )
        contact_cpu_seconds: float = Field(description="Computing the curves", examples=[0.02])
        error_estimate_cpu_seconds: float = Field(description="Estimating their errors", examples=[0.02])
        flanks_cpu_seconds: float = Field(
            default=0.0, description="Load and pressure on the flanks, if requested", examples=[0.01]
        )
        passage_cpu_seconds: float = Field(
            default=0.0, description="A pair of teeth on its way, if requested", examples=[0.01]
        )
        derivatives_cpu_seconds: float = Field(
            default=0.0, description="Computing their derivatives, if requested", examples=[0.03]
        )
        band_cpu_seconds: float = Field(
            default=0.0, description="Pairs within a class, if requested", examples=[0.13]
        )

    curves: list[LiveCurve] = Field(description="One curve for each torque")
    effects: dict[str, bool] = Field(description="Effects that are on", examples=[{"corner_contact": True}])
    beyond_load_patches: int = Field(
        description="Points at which a contact strip is wider than its load patch: 0.5 % of the mean there",
        examples=[0],
    )
    discretisation_error: Literal["measured", "expected"] | None = Field(
        description="Origin of the discretization error: measured on coarse meshes with these flanks, or "
        "expected, the usual error of the level, if those meshes are not in the cache (tables "
        "with a minimal receipt); null in a preview",
        examples=["measured"],
    )
    not_estimated: list[str] = Field(description="Sources of error without an estimate", examples=[[]])
    residuals_max: float = Field(description="Largest relative residual of the contact", examples=[1e-12])
    assumptions: list[LiveAssumption] = Field(description="Assumptions that were checked")
    not_checked: list[LiveAssumption] = Field(description="Assumptions that were not checked")
    cost: LiveCost = Field(description="CPU time by part")
    cpu_seconds: float = Field(description="CPU time of the answer", examples=[0.03])
