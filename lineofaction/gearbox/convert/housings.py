"""Housings of a scene file as those of dynamics: by their matrices, or reduced from their solids.

Measured housings have no counterpart in dynamics, because they do not act back on the shafts; they are
checked here.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dynamics.errors import InputError
from dynamics.identity_cache import identity_cached
from dynamics.joints import Housing
from dynamics.mesh_content import check_mesh_content
from dynamics.solid_housing import MESH_SUFFIXES, STEP_SUFFIXES
from lineofaction.gearbox.convert.boundary_errors import named
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.bearings import BushingInput, RollingBearingInput
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.signals.endings import UNIVERSAL
from model_studies.progress import Progress, silent

if TYPE_CHECKING:
    from dynamics.housings import ReducedHousing

STEP_BEGINS = b"ISO-10303-21"
FOLDER = "housings"
"""Folder of the cache that holds meshes and reductions of housings."""
_MOTIONS = 5
"""Motions of a seat that a bearing couples to the shaft: three displacements and two tilts."""
ANY_STIFFNESS, _ANY_MASS = 1e8, 1.0
"""Stiffness and mass, N/m and kg, for checks that need no reduction and no table and do not read them."""
_NUMBERED = re.compile(r"^housings\[(\d+)\]")


def solid_file(housing: HousingInput) -> tuple[str, str, bytes]:
    """Return the field of the file of a solid, the ending of its name, and its content.

    Raises `BadInput`: another kind of file, damaged content, or a mesh that refers to further files, which
    the scene does not contain.
    """
    field, suffixes = ("step_file", STEP_SUFFIXES) if housing.step_file else ("mesh_file", MESH_SUFFIXES)
    content = housing.step_file or housing.mesh_file
    assert content is not None  # the schema comes first
    suffix, data = _unpacked(field, content, suffixes)
    if field == "step_file" and not data.lstrip().startswith(STEP_BEGINS):
        bound = f"a STEP file, which begins with {STEP_BEGINS.decode()}"
        raise BadInput.of(field, content.name, bound, "Export the solid as STEP (AP 214, AP 242).")
    if field == "mesh_file":
        try:
            check_mesh_content(content.name, data)
        except InputError as error:
            raise BadInput.of(field, content.name, str(error.bound), str(error.suggestion)) from None
    return field, suffix, data


def response_content(housing: HousingInput) -> tuple[str, bytes]:
    """Return the ending of a measured housing's file name, and the content of the file.

    Raises `BadInput`: another kind of file, or damaged content.
    """
    assert housing.frf_file is not None  # the schema comes first
    return _unpacked("frf_file", housing.frf_file, UNIVERSAL)


def _unpacked(field: str, file: FileContentInput, suffixes: Sequence[str]) -> tuple[str, bytes]:
    suffix = Path(file.name).suffix.lower()
    if suffix not in suffixes:
        raise BadInput.of(f"{field}.name", file.name, f"a name that ends in {', '.join(suffixes)}")
    try:
        return suffix, file.unpacked()
    except ValueError as error:
        length = f"{len(file.content)} characters"
        raise BadInput.of(f"{field}.content", length, str(error), "The client packs files.") from None


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


def housings_in(
    scene: SceneInput, home: Path, folder: Path, progress: Progress = silent
) -> dict[str, ReducedHousing]:
    """Return the reduced housings of a scene by name, of solids and of files of modes in `folder`."""
    reduced = reduced_in(scene, home, progress)
    files = {part.name: part.modes_file for part in scene.housings if part.modes_file is not None}
    if not files:
        return reduced
    from dynamics.housings import ReducedHousing  # noqa: PLC0415 (start-up time)

    return reduced | {name: ReducedHousing.from_netcdf(folder / file) for name, file in files.items()}


def check_measured(scene: SceneInput) -> None:
    """Check measured housings before their files are read.

    Raises `BadInput`: a file is of another kind or damaged, or a seat is that of a shaft in a turning frame.
    """
    shafts = {shaft.name: shaft for shaft in scene.shafts}
    bearings: tuple[BushingInput | RollingBearingInput, ...] = (*scene.bushings, *scene.rolling_bearings)
    shaft_of = {part.name: part.shaft for part in bearings}
    for index, housing in enumerate(scene.housings):
        if not housing.is_measured:
            continue
        try:
            response_content(housing)
        except BadInput as error:
            raise error.within(f"housings[{index}]") from None
        for number, seat in enumerate(housing.seat_nodes):
            if shafts[shaft_of[seat.bearing]].frame is not None:
                field = f"housings[{index}].seat_nodes[{number}].bearing"
                bound = "a bearing of a shaft described in the fixed frame"
                raise BadInput.of(field, seat.bearing, bound, "A planetary set's frame turns.")


@contextmanager
def numbered_as_written(housings: Sequence[HousingInput]) -> Iterator[None]:
    """Replace the numbers of housings in errors of dynamics by those in the file.

    The numbers differ because dynamics has no measured housings.
    """
    numbers = [index for index, part in enumerate(housings) if not part.is_measured]
    try:
        yield
    except InputError as error:
        field = _NUMBERED.sub(lambda match: f"housings[{numbers[int(match[1])]}]", error.field)
        raise InputError(field, error.value, error.bound, error.suggestion) from None


@identity_cached
def housings_of(pairs: tuple[tuple[HousingInput, ReducedHousing | None], ...]) -> tuple[Housing, ...]:
    """Return the housings of dynamics, without measured ones.

    A pair is a housing of the file and the reduction of its solid, or None. Scenes with the same pairs share
    the result.
    """
    return tuple(_housing_of(index, *pair) for index, pair in enumerate(pairs) if not pair[0].is_measured)


def _housing_of(index: int, housing: HousingInput, reduced: ReducedHousing | None) -> Housing:
    if not housing.is_solid:
        return _of_matrices(index, housing)
    from dynamics.housings import scene_housing  # noqa: PLC0415 (start-up time)

    assert reduced is not None  # callers reduce all solids first
    with named(f"housings[{index}]"):
        try:
            return scene_housing(reduced, housing.name, housing.bushings)
        except InputError as error:
            if error.field != "stiffness":
                raise
            # a singular stiffness matrix of a solid comes from its feet
            remedy = "Fix a foot, or give mounts on three feet that are not in line."
            bound = "such that they hold the housing in every direction"
            raise InputError("feet", [foot.name for foot in housing.feet], bound, remedy) from None


def placeholder(index: int, housing: HousingInput) -> Housing:
    """Return a housing; a solid is not reduced, but gets placeholders for its matrices.

    Raises `BadInput`: the file of the solid cannot be read.
    """
    if not housing.is_solid:
        return _of_matrices(index, housing)
    try:
        solid_file(housing)
    except BadInput as error:
        raise error.within(f"housings[{index}]") from None
    unit = np.eye(_MOTIONS * len(housing.bushings))
    stiffness = tuple(map(tuple, (ANY_STIFFNESS * unit).tolist()))
    mass = tuple(map(tuple, (_ANY_MASS * unit).tolist()))
    with named(f"housings[{index}]"):
        return Housing(housing.name, housing.bushings, stiffness, mass=mass)


def _of_matrices(index: int, housing: HousingInput) -> Housing:
    with named(f"housings[{index}]"):
        return Housing(**in_si(Housing, housing))
