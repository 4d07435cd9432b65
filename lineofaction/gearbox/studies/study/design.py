"""The design of a study, from its file."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from dynamics.study import Design, Factor, Levels, Listed, Normal, Uniform
from fe_contact.microgeometry.tolerances import PROCESS_SPREAD, iso1328_tolerances
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.study import FactorInput, Inputs
from lineofaction.gearbox.studies.study.scenes import Location
from lineofaction.gearbox.units import UM


def design_of(scene: SceneInput, inputs: Inputs, places: Mapping[str, tuple[Location, ...]]) -> Design:
    """Return the design; raises `BadInput`, `DynamicsError`."""
    factors = {f.path: _factor(k, f, scene, places[f.path]) for k, f in enumerate(inputs.factors)}
    return Design(factors, inputs.samples, inputs.seed)


def _factor(index: int, factor: FactorInput, scene: SceneInput, places: tuple[Location, ...]) -> Factor:
    if factor.levels is not None:
        return Levels(tuple(factor.levels))
    if factor.values is not None:
        return Listed(tuple(factor.values))
    if factor.uniform is not None:
        return Uniform(factor.uniform.low, factor.uniform.high)
    if factor.normal is not None:
        normal = factor.normal
        low = -np.inf if normal.low is None else normal.low
        high = np.inf if normal.high is None else normal.high
        return Normal(normal.mean, normal.standard_deviation, low, high)
    return _by_class(index, factor, scene, places)


def _by_class(index: int, factor: FactorInput, scene: SceneInput, places: tuple[Location, ...]) -> Normal:
    """Return the distribution within a class of ISO 1328 about the designed value, um."""
    limits = set()
    for location in places:  # ("meshes", index, "case", "pair", gear, field)
        case = scene.meshes[int(location[1])].case
        assert case is not None and factor.iso1328_class is not None
        gear, name = str(location[4]), str(location[5])
        half_widths = iso1328_tolerances(gear_pair(case), factor.iso1328_class).modification
        designed = float(getattr(getattr(case.pair, gear), name))
        limits.add((designed, half_widths[f"{gear}.{name.removesuffix('_um')}"]))
    if len(limits) > 1:
        bound, remedy = "a path to gears with the same tolerance", "Give each gear a factor of its own."
        raise BadInput.of(f"factors[{index}].path", factor.path, bound, remedy)
    ((design, half_width_m),) = limits
    half_width = half_width_m / UM
    return Normal(design, half_width / PROCESS_SPREAD, design - half_width, design + half_width)
