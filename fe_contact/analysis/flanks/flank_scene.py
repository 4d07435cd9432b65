"""The scene of flank results: the load, the alignment, and the marks on both flanks."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from fe_contact.errors import DatabaseError
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import PairGeometry
from fe_contact.types import Json

Both = tuple[float, float]


@dataclass(frozen=True)
class FlankScene:
    """One load and one alignment of one pair. Roll lengths are of (pinion, wheel), each on its own flank."""

    normal_force: float
    torque: float
    """`normal_force`, `torque`: F_bn in N and the torque on the driving gear in N m."""
    misalignment: float
    center_distance_change: float
    """`misalignment`, `center_distance_change`: Alignment of the gears, m."""
    start_of_active_profile: Both
    pitch_point: Both
    tip: Both
    """`start_of_active_profile`, `pitch_point`, `tip`: Roll lengths where the mating tip meets the flank, at
    the pitch point and at the own tip, m.
    """
    path_of_contact: tuple[float, float, float, float, float]
    """Points A, B, C, D, E as roll lengths of the driving gear, m."""
    common_face: Both
    """Ends of the common face, as distances from the pinion's mid-face, m."""
    geometry: PairGeometry

    def to_json(self) -> Json:
        """Return plain JSON with the same names, but for `facts`: the geometry."""
        plain = asdict(self)
        return plain | {"facts": plain.pop("geometry")}

    @classmethod
    def from_json(cls, content: Json) -> FlankScene:
        """Read back what `to_json` wrote; `DatabaseError` if it is something else."""
        try:
            plain: Json = {name: tuple(v) if isinstance(v, list) else v for name, v in content.items()}
            plain["geometry"] = PairGeometry.from_json(plain.pop("facts"))
            return cls(**plain)
        except (TypeError, ValueError, KeyError, AttributeError) as error:
            raise DatabaseError("the scene of the flank results is not readable") from error


def flank_scene(
    pair: ParallelAxes, normal_force: float, misalignment: float = 0.0, center_distance_change: float = 0.0
) -> FlankScene:
    """Describe a pair that stands at its changed center distance, under a normal force in N."""
    path = pair.path_of_contact
    start, pitch, end = (
        (rolled, float(pair.roll_lengths(pair.position(rolled))[1]))
        for rolled in (path.start, path.pitch_point, path.end)
    )
    return FlankScene(
        normal_force=float(normal_force),
        torque=float(pair.torque(normal_force)),
        misalignment=float(misalignment),
        center_distance_change=float(center_distance_change),
        start_of_active_profile=(start[0], end[1]),
        pitch_point=pitch,
        tip=(pair.pinion.tip_roll_length, pair.wheel.tip_roll_length),
        path_of_contact=path.points,
        common_face=pair.common_face,
        geometry=PairGeometry.of(pair),
    )
