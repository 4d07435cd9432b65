"""Figures of the sound power of a scene."""

from __future__ import annotations

from lineofaction.gearbox.schemas.bearing_forces import BearingForces
from lineofaction.gearbox.schemas.figures import Figures, Json, Part
from lineofaction.gearbox.schemas.housing_costs import HousingCost, PredictedCost
from lineofaction.gearbox.studies.equilibrium import Equilibrium


class BearingSound(Part):
    """Levels by order, then by speed: by the force of a bearing alone, and of what is left without it."""

    alone_db_a: list[list[float]]
    without_db_a: list[list[float]]


class HousingSound(Part):
    """How a housing radiates: outer hull, radiation model, the models where it is loudest, and what it cost.

    Stated error and predicted cost are those of all models, computed or not.
    """

    radiation: str
    outer_area_m2: float
    inner_area_m2: float
    cap_area_m2: float
    panels: int
    resolved_hz: float
    valid_hz: float
    interpolation_error_db: float
    models_db: dict[str, float]
    model_error_db: dict[str, float]
    models_left_out: dict[str, str]
    models_cpu_seconds: dict[str, float]
    models_error_band_db: dict[str, tuple[float, float]]
    models_predicted: dict[str, PredictedCost]
    radiation_cost: HousingCost | None


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


class LoudPoint(Part):
    """An order at a speed at which it is louder than at the speeds beside it."""

    order: float
    speed_rpm: float
    frequency_hz: float
    level_db: float
    level_db_a: float
    radiation_efficiency: float
    housing: str
    mode: int
    natural_frequency_hz: float
    mode_share: float
    bearing: str
    bearing_alone_db_a: float
    without_bearing_db_a: float
    in_contact: bool
    regions: list[RegionSound]


class LevelBandFigures(Part):
    """A level, its band, and the deviations that make it by what is guessed."""

    level_db_a: float
    low_db_a: float
    high_db_a: float
    below_db: dict[str, float]
    above_db: dict[str, float]


class OrderBand(Part):
    """Bands of an order: of its largest level over the speeds, and of that at its loudest speed."""

    order: float
    largest: LevelBandFigures
    speed_rpm: float
    there: LevelBandFigures


class SoundBandFigures(Part):
    """Bands of levels: the largest total, orders, and the total by speed."""

    largest_total: LevelBandFigures
    orders: list[OrderBand]
    total_low_db_a: list[float]
    total_high_db_a: list[float]


class SensitivityFigures(Part):
    """What steps of a figure change of the largest level; None: without end."""

    figure: str
    unit: str
    value: float
    step: float
    change_db: float
    change_of_two_steps_db: float
    slope_db: float
    for_one_db_less: float | None
    linear_range: float | None
    linear: bool


class SoundOverTime(Part):
    """Sound power over a run, all that its bearing forces hold; third octaves by band, then by time."""

    time_s: list[float]
    speed_rpm: list[float]
    third_octave_hz: list[float]
    third_octave_db: list[list[float]]
    total_level_db: list[float]
    total_level_db_a: list[float]
    lowest_hz: float
    highest_hz: float


class NoiseFigures(Figures):
    """Sound power levels re 1 pW by order, then by speed; third octaves; the loudest points."""

    leading_shaft: str
    speed_rpm: list[float]
    order: list[float]
    frequency_hz: list[list[float]]
    level_db: list[list[float]]
    level_db_a: list[list[float]]
    total_level_db: list[float]
    total_level_db_a: list[float]
    third_octave_hz: list[float]
    third_octave_db: list[list[float]]
    radiation_efficiency: list[list[float]]
    bearings: dict[str, BearingSound]
    loudest: list[LoudPoint]
    housings: dict[str, HousingSound]
    natural_frequency_hz: list[float]
    parting_rpm: list[float]
    band: SoundBandFigures | None
    sensitivities: list[SensitivityFigures]
    sensitivities_left_out: dict[str, str]
    equilibrium: Equilibrium | None
    forces: BearingForces
    over_time: SoundOverTime | None
    cpu_seconds: dict[str, float]
    reduction_cost: dict[str, HousingCost]
    effect_ledger: Json


ANSWER = NoiseFigures
