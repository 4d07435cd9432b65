"""Bands of the levels of a scene, and the changes of its figures that lower the largest level by 1 dB."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from dynamics.acoustics import Range
from dynamics.mechanism.kinematics import at_steady_speeds
from dynamics.noise import (
    DesignFigure,
    SceneSound,
    Sensitivity,
    SoundBand,
    SoundModel,
    band_about,
    sound_sensitivities,
)
from dynamics.scene import Scene
from dynamics.types import FloatArray
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.gear import has_extent
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.noise_ranges import NoiseRanges
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.studied import RANGES
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.noise import Inputs
from lineofaction.gearbox.studies.study.scenes import VariedScene, places_of

GEARS = ("pinion", "wheel")
AMOUNTS = ("tip_relief_um", "profile_crowning_um", "helix_crowning_um")
STEP = 2.0
"""Step of an amount of relief or crowning, um; about the tolerance of class 5."""


class KnownDamping(NamedTuple):
    """Source of the damping of housings, and the factors between which the true damping lies."""

    source: str
    factors: tuple[float, float]


GUESSED = KnownDamping("guessed", (0.4, 2.0))
"""Factors about ratios of 0.005: cast iron with bolted joints has 0.002 to 0.01."""
SPECIFIED = KnownDamping("stated", (0.7, 1.4))
"""Factors of one stated figure for all modes, whose damping differs by mode."""
MEASURED = KnownDamping("measured by mode", (0.85, 1.2))
"""Factors between one assembly and the next."""


def damping_of(scene: SceneInput, housings: Collection[str]) -> KnownDamping:
    """Return the least known damping of some housings of a scene; the usual one is a guess, stated or not."""
    known = [_known_damping(housing) for housing in scene.housings if housing.name in housings]
    return max(known, key=lambda damping: damping.factors[1])


def _known_damping(housing: HousingInput) -> KnownDamping:
    if housing.modal_damping:
        return MEASURED
    usual = HousingInput.model_fields["damping_ratio"].default
    if housing.loss_factor is not None or housing.damping_ratio != usual:
        return SPECIFIED
    return GUESSED


@dataclass(frozen=True)
class SoundUncertainty:
    """Bands of the levels by guessed figures, and the changes of the largest level by steps of figures."""

    damping: KnownDamping
    """Damping of the housings."""
    band: SoundBand | None
    """Band of the levels; None: not requested."""
    sensitivities: tuple[Sensitivity, ...]
    """Sensitivities of the largest level; empty: not requested."""
    omitted: Mapping[str, str]
    """Reasons why figures have no sensitivity, by name of the figure."""
    seconds: float | None
    """CPU time; None: nothing was requested."""


def uncertainty(subject: TabledScene, sound: SceneSound, inputs: Inputs, means: Means) -> SoundUncertainty:
    """Return bands and sensitivities of the sound of a scene, as the inputs request them."""
    radiation, speed = sound.radiation, sound.power.speed
    damping = damping_of(subject.inputs, radiation)
    band: SoundBand | None = None
    if inputs.housing_damping is not None:
        low, high = inputs.housing_damping
        damping = KnownDamping("range stated", (low, high))
    housings = {name: subject.housings[name] for name in radiation}
    model = SoundModel(subject.scene, housings, radiation)
    sensitivities: tuple[Sensitivity, ...] = ()
    omitted: dict[str, str] = {}
    began = cpu_seconds()
    with boundary_errors():
        if inputs.band:
            spans = spans_of(inputs.model_copy(update={"housing_damping": damping.factors}))
            order, power, error = sound.power.order, sound.power.orders, sound.error
            band = band_about(model, speed, inputs.orders, spans, order, power, error, means.report)
        if inputs.sensitivities:
            sensitivities, omitted = _sensitivities_of(subject, model, speed, inputs.orders, means)
    seconds = cpu_seconds() - began if inputs.band or inputs.sensitivities else None
    return SoundUncertainty(damping, band, sensitivities, omitted, seconds)


def spans_of(ranges: NoiseRanges) -> dict[str, Range]:
    """Return the ranges of factors, each about 1, by the name of the guessed figure."""
    factors = {name: getattr(ranges, name) for name in RANGES}
    return {name: Range(span[0], 1.0, span[1]) for name, span in factors.items() if span is not None}


def _sensitivities_of(
    subject: TabledScene, model: SoundModel, speed: FloatArray, orders: int, means: Means
) -> tuple[tuple[Sensitivity, ...], dict[str, str]]:
    """Return changes by steps of damping, stiffness and flanks, and reasons why others have none."""

    def scenes(flank: DesignFigure) -> Callable[[float], Scene]:
        varied = _flank_scenes(subject, flank.name, means.home)
        return lambda value: at_steady_speeds(varied.scene({flank.name: value}))

    flanks = _flank_figures(subject.inputs)
    return sound_sensitivities(model, speed, orders, flanks, scenes, means.report)


def _flank_figures(scene: SceneInput) -> Iterator[DesignFigure]:
    """Yield the figures of all meshes with a case; tip relief only where it has a length."""
    for mesh in scene.meshes:
        if mesh.case is None:
            continue
        for gear in GEARS:
            flank = getattr(mesh.case.pair, gear)
            for amount in AMOUNTS:
                if amount != "tip_relief_um" or has_extent(flank, "tip_relief"):
                    path = f"meshes.{mesh.name}.case.pair.{gear}.{amount}"
                    yield DesignFigure(path, "um", float(getattr(flank, amount)), STEP)


def _flank_scenes(subject: TabledScene, path: str, home: Path) -> VariedScene:
    """Return the scene by a figure of its flanks: its table is solved again on the same compliance."""
    places = {path: places_of(subject.inputs, "sensitivities", path)}
    return VariedScene(subject.inputs.model_dump_json(), subject.databases, places, str(home))
