"""Motions of a unit by a stored result, for the page: a list of the motions, and one at even stations."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from dynamics.vibration import SurfaceShape
from lineofaction.gearbox.convert.drawn_housing import packed, packed_surface
from lineofaction.gearbox.problems import BadInput, DamagedFile, NotFound
from lineofaction.gearbox.registry import study_of
from lineofaction.gearbox.studies.motion import OfferedMotion, UnitMotion
from lineofaction.gearbox.units import MM
from lineofaction.report.document import of_the_store, read_stored

STATIONS = 33
"""Number of stations along a shaft."""
MAX_FACETS = 60_000
"""Most facets of a surface; a surface with more is drawn by the corners of its triangles."""
VELOCITY_REFERENCE = 5e-8
"""Velocity of 0 dB, m/s, root mean square: 1 pW/m^2 of plane waves where rho c is 400 N s/m^3."""
QUIETEST = 1e-8  # least velocity over the reference
_LENGTHS = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], dtype=bool)


def stored_motion(inputs: Json) -> Json:
    """Return ``{"groups": [...], "motion": {...}}`` of a stored result; work of the live worker.

    ``{"kind": ..., "file": ..., "number": n or None}``; None: what there is to choose from, and no motion.

    Raises `NotFound`: results of that kind hold no motions, or this one none; `BadInput`: no such number.
    """
    with of_the_store():
        study = study_of(inputs["kind"])
        result = None if study is None else read_stored(study, Path(inputs["file"]))
        offered = [] if study is None else list(study.run.motions(result))
        if not offered:
            raise NotFound(
                "The result holds no motion of a unit. Compute it again if an older version made it."
            )
        number = inputs["number"]
        if number is not None and number >= len(offered):
            raise BadInput.of("number", number, f"below {len(offered)}, the number of motions")
        motion = None if number is None else motion_json(offered[number].made())
        return {"groups": _groups(offered), "motion": motion}


def _groups(motions: list[OfferedMotion]) -> list[Json]:
    groups: dict[str, list[str]] = {}
    for one in motions:
        groups.setdefault(one.group, []).append(one.name)
    return [{"name": group, "motions": names} for group, names in groups.items()]


def motion_json(motion: UnitMotion) -> Json:
    """Return a motion in mm and rad; raises `DamagedFile`: a value is not finite."""
    shafts = []
    for name, (along, displacement) in motion.at_stations(STATIONS).items():
        in_mm = np.where(_LENGTHS, displacement / MM, displacement)
        if not np.all(np.isfinite(in_mm)):
            raise DamagedFile(f"The stored motion of {name} has values that are not finite.")
        shafts.append(
            {
                "name": name,
                "position_mm": [float(along[0] / MM), float(along[-1] / MM)],
                "real": _rounded(in_mm.real),
                "imaginary": _rounded(in_mm.imag),
            }
        )
    surface = None if motion.surface is None else _surface_json(motion.surface, motion.is_velocity)
    return {"oscillates": motion.oscillates, "shafts": shafts, "surface": surface}


def _surface_json(surface: SurfaceShape, is_velocity: bool) -> Json:
    """Return nodes and facets of a surface with its motion; a large one by its corners alone."""
    from dynamics.housings.drawn_surface import node_normals  # noqa: PLC0415 (start-up time)

    facets = surface.facets if len(surface.facets) <= MAX_FACETS else surface.triangles[:, :3]
    used, facets = np.unique(facets, return_inverse=True)
    points, motion, facets = surface.points[used], surface.motion[used], facets.reshape(-1, 3)
    if not (np.all(np.isfinite(points)) and np.all(np.isfinite(motion))):
        raise DamagedFile("The stored motion of the surface has values that are not finite.")
    amplitude = np.abs(np.sum(motion * node_normals(points, facets), axis=1))
    largest = float(np.max(amplitude, initial=0.0)) or 1.0
    size = amplitude / (np.sqrt(2.0) * VELOCITY_REFERENCE if is_velocity else largest)
    level = {
        "level_db": packed(20.0 * np.log10(np.maximum(size, QUIETEST))),
        "level_re": "50 nm/s" if is_velocity else "the largest",
    }
    parts = {"real": packed(motion.real / MM), "imaginary": packed(motion.imag / MM)}
    return packed_surface(points, facets) | parts | level


def _rounded(values: Any) -> list[list[float]]:
    """Return rows with six digits of each, as many as a picture shows."""
    return [[float(f"{value:.6g}") for value in row] for row in values.tolist()]
