"""Speeds at which the sound of the housings is looked for."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from lineofaction.gearbox.schemas.figures import (
    Equilibrium,
    Excitations,
    Figures,
    Forces,
    HousingCost,
    Ledger,
    Part,
    PredictedCost,
    ReductionCosts,
    Seconds,
    Source,
)
from lineofaction.gearbox.schemas.model import Point
from lineofaction.gearbox.schemas.noise_ranges import NoiseRanges
from lineofaction.gearbox.schemas.studied import OverSpeedsOrRun


class Inputs(NoiseRanges, OverSpeedsOrRun):
    """Speeds at which the sound of the housings is looked for, the radiation model, and ranges of guesses."""

    MANUAL: ClassVar[str] = "docs/service.md"
    radiation: Literal["estimate", "monopoles", "equivalent_radiated_power"] = Field(
        default="estimate",
        description="Radiation model: the estimate, a level that the other two both allow, mode by mode, "
        "mostly within 1.5 dB; panels as monopoles that interfere, within 9 dB and mostly too quiet, both 10 "
        "to 60 CPU s, kept; or as parts of a plane that moves as one: too loud at low frequency, by 10 dB "
        "and more, but at once",
        examples=["estimate"],
    )
    boundary_elements: bool = Field(
        default=True,
        description="Whether boundary elements correct the estimate at the loudest lines of each housing, at "
        "most four, and in 60 CPU s, kept; a line is then within 0.5 dB. Needs the extra boundary-elements; "
        "without it the result says so, and the estimate stands with its wider band",
        examples=[False],
    )
    microphone_mm: Point | None = Field(
        default=None,
        description="Microphone of the sound pressure in a free field, x, y, z in mm in the frame of the "
        "scene; default: the microphone of the scene's complaint, if it has one",
        examples=[[40.0, 60.0, 1000.0]],
    )


class ExactLineFigures(Part):
    """A line that boundary elements correct: its level by the estimate, its corrected level, and the cost."""

    frequency_hz: float
    estimate_db: Annotated[float, Source("estimate")]
    level_db: Annotated[float, Source("level")]
    panels: int
    cpu_seconds: Annotated[float, Source("seconds")]


class HousingSound(Part):
    """Radiation of a housing: outer hull, radiation model, models at the loudest lines, and their cost.

    Stated error and predicted cost are those of all models, computed or not.
    """

    radiation: Annotated[str, Source("model_name")]
    outer_area_m2: Annotated[float, Source("area")]
    inner_area_m2: float
    cap_area_m2: float
    panels: int
    resolved_hz: Annotated[float, Source("resolved_frequency")]
    valid_hz: Annotated[float, Source("valid_frequency")]
    interpolation_error_db: float
    models_db: Annotated[dict[str, float], Source("level", missing={})]
    model_error_db: Annotated[dict[str, float], Source("error", missing={})]
    models_left_out: Annotated[dict[str, str], Source("left_out", missing={})]
    models_cpu_seconds: Annotated[dict[str, float], Source("seconds", missing={})]
    models_error_band_db: Annotated[dict[str, tuple[float, float]], Source("error_band", missing={})]
    models_predicted: Annotated[dict[str, PredictedCost], Source("predicted", missing={})]
    exact_lines: Annotated[list[ExactLineFigures], Source("lines", missing=[])]
    radiation_cost: Annotated[HousingCost | None, Source("cost", missing=None)]


class RegionSound(Part):
    """A part of a housing that faces an axis: named points, place, and power, below 0 where it takes some."""

    housing: str
    facing: str
    points: list[str]
    normal: list[float]
    center_mm: list[float]
    area_m2: float
    power_w: float
    share: float


class LevelBandFigures(Part):
    """A level, its band, the deviations that make it, and the width that is left without each of them."""

    level_db_a: Annotated[float, Source("nominal")]
    low_db_a: float
    high_db_a: float
    below_db: dict[str, float]
    above_db: dict[str, float]
    width_db: float
    widths_without_db: dict[str, float]


def _by_order(band: Any) -> list[dict[str, Any]]:
    rows = zip(band.order, band.largest, band.loudest_speed, band.there, strict=True)
    return [dict(zip(("order", "largest", "speed", "there"), row, strict=True)) for row in rows]


class SoundBandFigures(Part):
    """Bands of levels: the largest total, its mean over the speeds, orders, and the total by speed."""

    class OrderBand(Part):
        """Bands of an order: of its largest level over the speeds, and of that at its loudest speed."""

        order: float
        largest: LevelBandFigures
        speed_rpm: float
        there: LevelBandFigures

    damping_source: str
    damping_range: tuple[float, float]
    largest_total: LevelBandFigures
    mean_total: LevelBandFigures
    orders: Annotated[list[OrderBand], Source(_by_order)]
    total_low_db_a: Annotated[list[float], Source(lambda band: [level.low for level in band.total])]
    total_high_db_a: Annotated[list[float], Source(lambda band: [level.high for level in band.total])]


class SensitivityFigures(Part):
    """Changes of the largest level by steps of a figure; None: without limit."""

    figure: Annotated[str, Source("figure.name")]
    unit: Annotated[str, Source("figure.unit")]
    value: Annotated[float, Source("figure.value")]
    step: Annotated[float, Source("figure.step")]
    change_db: float
    change_of_two_steps_db: Annotated[float, Source("change_of_two")]
    slope_db: float
    for_one_db_less: float | None
    linear_range: float | None
    linear: bool


class SoundOverTimeFigures(Part):
    """Sound power over a run, all that its bearing forces hold; third octaves by band, then by time."""

    time_s: list[float]
    speed_rpm: list[float]
    third_octave_hz: Annotated[list[float], Source("nominal")]
    third_octave_db: list[list[float]]
    total_level_db: Annotated[list[float], Source("total_level")]
    total_level_db_a: Annotated[list[float], Source("total_weighted_level")]
    lowest_hz: float
    highest_hz: float


class PressureFigures(Part):
    """Sound pressure at a microphone: levels by order, then by speed; orders where each is loudest.

    Bands are those of the sound power; null without one.
    """

    class OrderPressure(Part):
        """The largest level of an order over the speeds, and its band."""

        order: float
        speed_rpm: float
        level_db_a: float
        low_db_a: float | None
        high_db_a: float | None

    microphone_mm: list[float]
    level_db_a: list[list[float]]
    total_level_db_a: list[float]
    orders: list[OrderPressure]


class NoiseFigures(Figures):
    """Sound power levels re 1 pW by order, then by speed; third octaves; the loudest points.

    Totals and bands have the orders of long tables that are not listed: `left_out_db_a`, null where all are,
    and `total_error_db`, what the total may be off for them.
    """

    class BearingSound(Part):
        """Levels by order, then by speed: by the force of a bearing alone, and without this force."""

        alone_db_a: Annotated[list[list[float]], Source("bearing_alone_level")]
        without_db_a: Annotated[list[list[float]], Source("level_without_bearing")]

    class LoudPoint(Part):
        """An order at a speed at which it is louder than at the neighboring speeds."""

        order: float
        speed_rpm: float
        frequency_hz: float
        level_db: Annotated[float, Source("level")]
        level_db_a: Annotated[float, Source("weighted_level")]
        radiation_efficiency: Annotated[float, Source("efficiency")]
        housing: Annotated[str, Source("mode_housing")]
        mode: int
        natural_frequency_hz: float
        mode_share: float
        bearing: str
        bearing_alone_db_a: Annotated[float, Source("bearing_level")]
        without_bearing_db_a: Annotated[float, Source("level_without_bearing")]
        in_contact: bool
        regions: list[RegionSound]

    leading_shaft: str
    speed_rpm: list[float]
    order: list[float]
    order_name: list[str]
    frequency_hz: Annotated[list[list[float]], Source("orders.frequency")]
    level_db: Annotated[list[list[float]], Source("orders.level")]
    level_db_a: Annotated[list[list[float]], Source("orders.weighted_level")]
    total_level_db: Annotated[list[float], Source("orders.total_level")]
    total_level_db_a: Annotated[list[float], Source("orders.total_weighted_level")]
    left_out_db_a: Annotated[list[float] | None, Source("orders.floor_level")]
    total_error_db: Annotated[list[float] | None, Source("orders.total_error")]
    third_octave_hz: list[float]
    third_octave_db: list[list[float]]
    radiation_efficiency: list[list[float]]
    bearings: dict[str, BearingSound]
    loudest: list[LoudPoint]
    housings: dict[str, HousingSound]
    natural_frequency_hz: list[float]
    parting_rpm: list[float]
    pressure: Annotated[PressureFigures | None, Source("pressure", missing=None, document=True)]
    band: Annotated[SoundBandFigures | None, Source("band", document=True)]
    sensitivities: Annotated[list[SensitivityFigures], Source("sensitivities", document=True)]
    sensitivities_left_out: dict[str, str]
    equilibrium: Equilibrium | None
    forces: Forces
    excitations: Excitations
    over_time: Annotated[SoundOverTimeFigures | None, Source("over_time", missing=None, document=True)]
    cpu_seconds: Seconds
    reduction_cost: ReductionCosts
    effect_ledger: Ledger
