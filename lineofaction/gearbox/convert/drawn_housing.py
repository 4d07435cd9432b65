"""The surface of a scene's housings where they stand, as a picture draws it before anything is computed."""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from dynamics.errors import InputError
from dynamics.types import FloatArray, IntArray
from lineofaction.gearbox.convert.boundary_errors import named
from lineofaction.gearbox.convert.housings import solid_file
from lineofaction.gearbox.convert.placement import Placement
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.units import MM

Json = dict[str, Any]


def drawn_housings(inputs: Json, folder: Path, announce: Callable[[str], None]) -> Json:
    """Return ``{"surface": {...}}`` of ``{"housings": [...]}``; its value is None if no housing has a file.

    Work of a confined process that answers once. `announce`: gets the field of each file before it is read,
    which may end the process. Raises `BadInput`: a file is no solid, or damaged.
    """
    from dynamics.housings.drawn_surface import MAX_TRIANGLES  # noqa: PLC0415 (start-up time)

    housings = [validated(HousingInput, housing) for housing in inputs["housings"]]
    solid = [(index, housing) for index, housing in enumerate(housings) if housing.is_solid]
    points, facets = np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    for index, housing in solid:
        announce(f"housings[{index}].{'step_file' if housing.step_file else 'mesh_file'}")
        part_points, part_facets = _drawn(index, housing, folder, MAX_TRIANGLES // len(solid))
        points, facets = np.vstack([points, part_points]), np.vstack([facets, part_facets + len(points)])
    return {"surface": packed_surface(points, facets) if solid else None}


def _drawn(index: int, housing: HousingInput, folder: Path, limit: int) -> tuple[FloatArray, IntArray]:
    """Return points in the scene, m, and facets of a housing given by its solid."""
    from dynamics.housings.drawn_surface import drawn_mesh, drawn_step  # noqa: PLC0415 (start-up time)

    part = f"housings[{index}]"
    try:
        field, suffix, data = solid_file(housing)
    except BadInput as error:
        raise error.within(part) from None
    file = folder / f"housing_{index}{suffix}"
    file.write_bytes(data)
    with named(part):
        try:
            of_step = field == "step_file"
            surface = drawn_step(file, limit) if of_step else drawn_mesh(file, str(housing.mesh_unit), limit)
        except InputError as error:
            content = housing.step_file or housing.mesh_file
            assert content is not None  # the schema has refused that
            field_name = f"{error.field}_mm" if error.field.endswith((".size", ".place")) else error.field
            value = content.name if error.value == file.name else error.value
            raise InputError(field_name, value, error.bound, error.suggestion) from None
    placement = Placement.of(housing.file_x_axis, housing.file_z_axis, housing.origin_mm or (0.0, 0.0, 0.0))
    return placement.points(surface.points), surface.facets


def packed_surface(points: FloatArray, facets: IntArray) -> Json:
    """Return nodes (m), their normals and facets as the page takes them: 32 bits each, in Base64."""
    from dynamics.housings.drawn_surface import node_normals  # noqa: PLC0415 (start-up time)

    return {
        "place_mm": packed(points / MM),
        "normal": packed(node_normals(points, facets)),
        "facets": base64.b64encode(facets.astype("<u4").tobytes()).decode(),
    }


def packed(values: FloatArray) -> str:
    """Return 32-bit floats, little-endian, in Base64."""
    return base64.b64encode(values.astype("<f4").tobytes()).decode()
