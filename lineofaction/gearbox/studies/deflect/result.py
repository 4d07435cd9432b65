"""The result of a deflection: the bodies, the meshes on their flanks, and the outline of the gearbox."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bounds.brief import brief
from bounds.types import FloatArray, IntArray, Json
from dynamics.deflection import Deflection
from dynamics.effects.ledger import mechanism_of
from dynamics.scene import Scene
from dynamics.shafts import Shaft
from model_studies import in_unit
from model_studies.record import under_key
from model_studies.result_record import ResultRecord

HARMONICS = 5
RIGID_DIAMETER = 0.08
"""Diameter over length with which a shaft without sections is drawn."""


@dataclass(frozen=True)
class MeshFlanks:
    """A mesh on its flanks under a load case, at the alignment of the deflected shafts."""

    mesh: str
    case: str
    torque: float = field(metadata=in_unit("n_m"))
    """Torque on the pinion, N m."""
    mean: float = field(metadata=in_unit("m"))
    """`mean`, `peak_to_peak`: Static transmission error, m."""
    mean_error: float = field(metadata=in_unit("m"))
    """`mean_error`, `peak_to_peak_error`, `harmonics_error`: Estimated errors of these, m; NaN: not
    estimated.
    """
    peak_to_peak: float = field(metadata=in_unit("m"))
    peak_to_peak_error: float = field(metadata=in_unit("m"))
    harmonics: FloatArray = field(metadata=in_unit("m", "harmonic"))
    """Amplitudes, m. Shape (5,)."""
    harmonics_error: FloatArray = field(metadata=in_unit("m", "harmonic"))
    face_load_factor: float
    """K_Hbeta over the cycle; NaN in the plane."""
    load_arm_difference: float = field(metadata=in_unit("m"))
    """Arm of the load on the flanks less the arm in the table by which the shafts were deflected, m; NaN in
    the plane.
    """
    largest_pressure: float = field(metadata=in_unit("pa"))
    """Largest pressure on the flanks, Pa."""
    face_position: FloatArray = field(metadata=in_unit("m", "along_face"))
    face_load: FloatArray = field(metadata=in_unit("n_per_m", "along_face"))
    """`face_position`, `face_load`: Positions along the face from the pinion's mid-face, m, and mean load
    over the cycle there, N/m. Shape (41,) each.
    """
    roll_length: FloatArray = field(metadata=in_unit("m", "along_profile"))
    """Roll length of the pinion, m. Shape (40,)."""
    pattern: FloatArray = field(metadata=in_unit("pa", "along_profile", "along_face"))
    """Contact pattern: largest pressure over the cycle, Pa. Shape (40, 41)."""


@dataclass(frozen=True)
class Outline:
    """The gearbox to scale, m: s shafts, c pieces of them, g gears, b bearings."""

    shafts: tuple[str, ...]
    gears: tuple[str, ...]
    bearings: tuple[str, ...]
    origin: FloatArray = field(metadata=in_unit("m", "shaft", "axis"))
    """Left ends of the shafts' axes. Shape (s, 3)."""
    length: FloatArray = field(metadata=in_unit("m", "shaft"))
    """Length of each shaft. Shape (s,)."""
    piece_shaft: IntArray = field(metadata={"dimensions": ("piece",)})
    """Index of the shaft of each piece. Shape (c,)."""
    piece: FloatArray = field(metadata=in_unit("m", "piece", "measure"))
    """Start of a piece along the shaft, its length, its diameters at the left and the right end. Shape (c,
    4)."""
    gear_shaft: IntArray = field(metadata={"dimensions": ("gear",)})
    gear: FloatArray = field(metadata=in_unit("m", "gear", "size"))
    """Position of mid-face along the shaft, face width, operating pitch diameter. Shape (g, 3)."""
    bearing_shaft: IntArray = field(metadata={"dimensions": ("bearing",)})
    bearing: FloatArray = field(metadata=in_unit("m", "bearing"))
    """Position of a bearing along its shaft. Shape (b,)."""

    @staticmethod
    def of(scene: Scene) -> Outline:
        """Return the outline of a scene; bearings are bearings to the ground and planet bearings."""
        index = {shaft.name: k for k, shaft in enumerate(scene.shafts)}
        supports = (*scene.ground_bearings, *scene.planet_bearings)
        pieces = [(k, *piece) for k, shaft in enumerate(scene.shafts) for piece in _pieces(shaft)]
        diameter = _pitch_diameters(scene)
        return Outline(
            shafts=tuple(shaft.name for shaft in scene.shafts),
            gears=tuple(gear.name for gear in scene.gears),
            bearings=tuple(part.name for part in supports),
            origin=np.array([shaft.origin for shaft in scene.shafts], dtype=float).reshape(-1, 3),
            length=np.array([shaft.length for shaft in scene.shafts]),
            piece_shaft=np.array([piece[0] for piece in pieces], dtype=np.int64),
            piece=np.array([piece[1:] for piece in pieces], dtype=float).reshape(-1, 4),
            gear_shaft=np.array([index[gear.shaft] for gear in scene.gears], dtype=np.int64),
            gear=np.array([(g.position, g.face_width, diameter[g.name]) for g in scene.gears]).reshape(-1, 3),
            bearing_shaft=np.array([index[part.shaft] for part in supports], dtype=np.int64),
            bearing=np.array([part.position for part in supports]),
        )


@brief
@dataclass(frozen=True)
class GearboxDeflection(ResultRecord):
    """The deflection of a gearbox and the results of its meshes at the deflected alignment."""

    deflection: Deflection
    flanks: tuple[MeshFlanks, ...]
    """Results on the flanks by load case, then by mesh; meshes in closed form have none."""
    passes: int
    """Number of passes of tables and deflections until they agreed."""
    change: float
    """Relative change of the misalignments by the last pass."""
    agreed: bool
    outline: Outline
    cases: Json
    """The cases of the meshes as they were written, by mesh."""
    seconds: float
    """CPU time, including the tables and housings that were made for the study."""
    scene: Json = field(default_factory=dict)
    """The scene as it was written, without the cases; empty in files of versions that did not keep it."""
    metadata: Json = field(default_factory=dict, metadata=under_key("facts"))
    """Facts, among them the bodies of the picture; empty in files of versions that did not store them."""


def _pieces(shaft: Shaft) -> list[tuple[float, float, float, float]]:
    """Return start, length and both diameters of the pieces of a shaft, m."""
    if not shaft.sections:
        return [(0.0, shaft.length, RIGID_DIAMETER * shaft.length, RIGID_DIAMETER * shaft.length)]
    pieces, start = [], 0.0
    for section in shaft.sections:
        end = section.end_outer_diameter or section.outer_diameter
        pieces.append((start, section.length, section.outer_diameter, end))
        start += section.length
    return pieces


def _pitch_diameters(scene: Scene) -> dict[str, float]:
    """Return the operating pitch diameter of every gear in its first mesh, else its base diameter, m."""
    diameter = {gear.name: 2.0 * gear.base_radius for gear in scene.gears}
    seen: set[str] = set()
    for mesh, line in zip(scene.meshes, mechanism_of(scene).lines, strict=True):
        for name in {mesh.driver, mesh.driven} - seen:
            diameter[name] = 2.0 * scene.gear(name).base_radius / float(np.cos(line.working_pressure_angle))
            seen.add(name)
    return diameter
