"""Reduction of the housings of a scene that are given by their solids."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from dynamics.bearings.matrix import Matrix
from dynamics.errors import DynamicsError, InputError
from dynamics.housings import (
    Bore,
    BoundedPlane,
    Box,
    Foot,
    Group,
    Material,
    MaterialDamping,
    MeshedHousing,
    ModalDamping,
    Mount,
    Plane,
    ReducedHousing,
    Ring,
    SeatBore,
    TetrahedralMesh,
    meshed_step,
    read_mesh,
    reduced_housing,
)
from dynamics.work_cost import announce
from lineofaction.gearbox.convert.boundary_errors import named
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.convert.housings import solid_file
from lineofaction.gearbox.convert.placement import Placement
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.schemas.bearings import BushingInput, RollingBearingInput
from lineofaction.gearbox.schemas.housing_solid import HousingFootInput, HousingSeatInput
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import MM
from model_studies.progress import Progress, by_cost, silent

STAGE = "housing"
_MESHED = 0.3
"""Usual share of the mesh in the time of a housing."""
Vector = tuple[float, float, float]
_NAMES = {
    re.compile(r"^(seats\[\d+\])\.bore\.(\w+)"): r"\1.bore_\2",
    re.compile(r"^(feet\[\d+\])\.face\.(\w+)"): r"\1.\2",
    re.compile(r"^mesh_file\.size$"): "mesh_file.size_mm",
}


def reduced_housings(
    scene: SceneInput, cache: Path | None, progress: Progress = silent
) -> dict[str, ReducedHousing]:
    """Mesh and reduce the housings of a scene that are given by their solids, or take them from the cache.

    Raises `BadInput`: a file is no solid, a bore, foot or point is not there, or the reduction costs too
    much; `JobFailed`: the mesher failed, or the modes do not converge.

    Parameters
    ----------
    cache : Path or None
        Directory of kept meshes and reductions.
    progress : callable
        Called as progress("housing", fraction). Before a costly reduction the text also has its cost.

    Returns
    -------
    dict of str to ReducedHousing
        By name of the housing.
    """
    solid = [(index, part) for index, part in enumerate(scene.housings) if part.is_solid]
    parts = by_cost(lambda fraction: progress(STAGE, fraction), {part.name: 1.0 for _, part in solid})
    reduced = {}
    for index, part in solid:
        with _named(f"housings[{index}]", part):
            mesh = _mesh(part, cache)
            parts(part.name, _MESHED)
            reduced[part.name] = reduced_housing(
                _meshed_housing(part, scene, mesh),
                cache,
                expected=partial(announce, progress, STAGE, part.name),
            )
            parts(part.name, 1.0)
    return reduced


@contextmanager
def _named(field: str, housing: HousingInput) -> Iterator[None]:
    """Turn errors of dynamics into the boundary's, by the fields of a housing."""
    with named(field):
        try:
            yield
        except BadInput as error:
            raise error.within(field) from None
        except InputError as error:
            field_name = _scene_name(error.field, housing)
            raise InputError(field_name, error.value, error.bound, error.suggestion) from None
        except DynamicsError as error:
            raise JobFailed(f'housing "{housing.name}": {error}') from error


def _scene_name(field: str, housing: HousingInput) -> str:
    """Return the scene file's name of a field of `dynamics.housings`, but for its unit."""
    for pattern, scene_name in _NAMES.items():
        field = pattern.sub(scene_name, field)
    names = {f"points.{point.name}": f"points[{i}].position" for i, point in enumerate(housing.points)}
    names |= {f"feet.{foot.name}": f"feet[{i}]" for i, foot in enumerate(housing.feet)}
    names |= {f"seats.{seat.bearing}": f"seats[{i}]" for i, seat in enumerate(housing.seats)}
    source = "step_file" if housing.step_file is not None else "mesh_file"
    return re.sub(r"^mesh_file", source, names.get(field, field))


def _mesh(housing: HousingInput, cache: Path | None) -> TetrahedralMesh:
    """Return the mesh of a solid where it stands in the scene."""
    field, suffix, data = solid_file(housing)
    with TemporaryDirectory() as folder:
        file = Path(folder) / f"housing{suffix}"
        file.write_bytes(data)
        try:
            if field == "step_file":
                size = housing.element_size_mm
                return _placed_mesh(housing, meshed_step(file, None if size is None else size * MM, cache))
            return _placed_mesh(housing, read_mesh(file, str(housing.mesh_unit)))
        except InputError as error:
            if error.value != file.name:
                raise
            content = housing.step_file or housing.mesh_file
            assert content is not None
            raise InputError(error.field, content.name, error.bound, error.suggestion) from None


def _placed_mesh(housing: HousingInput, mesh: TetrahedralMesh) -> TetrahedralMesh:
    """Turn and move a mesh from the frame of its file into that of the scene."""
    if housing.origin_mm is None and housing.x_axis is None and housing.z_axis is None:
        return mesh
    placement = Placement.of(housing.file_x_axis, housing.file_z_axis, housing.origin_mm or (0.0, 0.0, 0.0))
    return replace(mesh, points=placement.points(mesh.points))


def _meshed_housing(housing: HousingInput, scene: SceneInput, mesh: TetrahedralMesh) -> MeshedHousing:
    loss, ratios = housing.loss_factor, housing.modal_damping or (housing.damping_ratio,)
    assert housing.material is not None  # the schema has refused that
    return MeshedHousing(
        mesh,
        Material(**in_si(Material, housing.material)),
        tuple(_seat(seat, scene) for seat in housing.seats),
        tuple(_foot(foot) for foot in housing.feet),
        {point.name: _si(point.position_mm) for point in housing.points},
        housing.modes,
        ModalDamping(ratios) if loss is None else MaterialDamping(loss),
    )


def _seat(seat: HousingSeatInput, scene: SceneInput) -> SeatBore:
    """Return the bore of a seat, about the axis of its bearing and where that is."""
    parts: tuple[BushingInput | RollingBearingInput, ...] = (*scene.bushings, *scene.rolling_bearings)
    bearing = next(part for part in parts if part.name == seat.bearing)
    x, y, z = next(shaft.origin_mm for shaft in scene.shafts if shaft.name == bearing.shaft)
    middle = _si((x, y, z + bearing.position_mm))
    bore = Bore(middle, (0.0, 0.0, 1.0), seat.bore_diameter_mm * MM, seat.bore_length_mm * MM)
    return SeatBore(seat.bearing, bore, Ring(seat.ring))


def _foot(foot: HousingFootInput) -> Foot:
    stiffness, damping = foot.mount_stiffness_n_per_m, foot.mount_damping_n_s_per_m
    mount = None
    if stiffness is not None:
        mount = Mount(_diagonal(stiffness), None if damping is None else _diagonal(damping))
    return Foot(foot.name, _face(foot), mount)


def _face(foot: HousingFootInput) -> Plane | Box | BoundedPlane | Group:
    if foot.group is not None:
        return Group(foot.group)
    plane = box = None
    if foot.point_mm is not None and foot.normal is not None:
        plane = Plane(_si(foot.point_mm), _vector(foot.normal))
    if foot.low_mm is not None and foot.high_mm is not None:
        box = Box(_si(foot.low_mm), _si(foot.high_mm))
        return box if plane is None else BoundedPlane(plane, box)
    assert plane is not None  # the schema has refused that
    return plane


def _si(point: tuple[float, ...]) -> Vector:
    return _vector(tuple(value * MM for value in point))


def _vector(values: tuple[float, ...]) -> Vector:
    x, y, z = values
    return x, y, z


def _diagonal(values: tuple[float, ...]) -> Matrix:
    return tuple(tuple(row) for row in np.diag(values).tolist())
