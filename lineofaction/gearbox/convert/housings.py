"""Housings of a scene file in the terms of dynamics: by their matrices, or reduced from their solids."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dynamics.errors import InputError
from dynamics.joints import Housing
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.convert.solid_file import solid_file
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.scene_housings import HousingInput
from lineofaction.gearbox.units import MM
from model_studies.progress import Progress, silent

if TYPE_CHECKING:
    from dynamics.housings import ReducedHousing

FOLDER = "housings"
"""Of the cache: meshes and reductions."""

_MOTIONS = 5
"""Of a seat that a bearing holds."""
_ANY_STIFFNESS, _ANY_MASS = 1e8, 1.0
"""N/m, kg; checks that need no reduction do not read them."""


@dataclass(frozen=True)
class HousedScene:
    """A scene as written, and by name the reductions of its housings with a solid or a file of modes."""

    inputs: SceneInput
    housings: Mapping[str, ReducedHousing]


def reduced_in(scene: SceneInput, home: Path, progress: Progress = silent) -> dict[str, ReducedHousing]:
    """Return the reductions of the solids in a scene by name of the housing; `home` is the folder of caches.

    Raises as `lineofaction.gearbox.convert.solid_housings.reduced_housings`.
    """
    if not any(part.is_solid for part in scene.housings):
        return {}
    from lineofaction.gearbox.convert.solid_housings import reduced_housings  # noqa: PLC0415 (start-up time)

    return reduced_housings(scene, home / FOLDER, progress)


def _modes_in_files(scene: SceneInput, folder: Path) -> dict[str, ReducedHousing]:
    """Return the housings in files of modes, by name; `folder` is what the names of files are relative to."""
    files = {part.name: part.modes_file for part in scene.housings if part.modes_file is not None}
    if not files:
        return {}
    from dynamics.housings import ReducedHousing  # noqa: PLC0415 (start-up time)

    return {name: ReducedHousing.from_netcdf(folder / file) for name, file in files.items()}


def housings_in(
    scene: SceneInput, home: Path, folder: Path, progress: Progress = silent
) -> dict[str, ReducedHousing]:
    """Return the housings of a scene file by name: solids reduced, modes from their files."""
    return reduced_in(scene, home, progress) | _modes_in_files(scene, folder)


def housing_of(index: int, housing: HousingInput, reduced: ReducedHousing | None) -> Housing:
    """Return a housing, `reduced` if it is given by its solid."""
    if not housing.is_solid:
        return _of_matrices(index, housing)
    from dynamics.housings import scene_housing  # noqa: PLC0415 (start-up time)

    assert reduced is not None  # whoever makes the scene reduces them
    with named(f"housings[{index}]"):
        try:
            return scene_housing(reduced, housing.name, housing.bushings)
        except InputError as error:
            if error.field != "stiffness":
                raise
            advice = "Fix a foot, or give mounts on three feet that are not in line."
            bound = "such that they hold the housing in every direction"
            raise InputError("feet", [foot.name for foot in housing.feet], bound, advice) from None


def stand_in(index: int, housing: HousingInput) -> Housing:
    """Return a housing on matrices that stand in for those of a solid, whose file is looked into."""
    if not housing.is_solid:
        return _of_matrices(index, housing)
    try:
        solid_file(housing)
    except BadInput as error:
        raise error.within(f"housings[{index}]") from None
    unit = np.eye(_MOTIONS * len(housing.bushings))
    stiffness, mass = (tuple(map(tuple, (scale * unit).tolist())) for scale in (_ANY_STIFFNESS, _ANY_MASS))
    with named(f"housings[{index}]"):
        return Housing(housing.name, housing.bushings, stiffness, mass=mass)


def _of_matrices(index: int, housing: HousingInput) -> Housing:
    assert housing.stiffness_matrix is not None  # the schema comes first
    positions = housing.seat_positions_mm
    with named(f"housings[{index}]"):
        return Housing(
            name=housing.name,
            bushings=housing.bushings,
            stiffness=housing.stiffness_matrix,
            damping=housing.damping_matrix,
            mass=housing.mass_matrix,
            seat_positions=None if positions is None else tuple(_point(*at) for at in positions),
            **in_si(Housing, housing),
        )


def _point(x: float, y: float, z: float) -> tuple[float, float, float]:
    return x * MM, y * MM, z * MM
