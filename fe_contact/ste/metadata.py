"""Metadata of an STE database: the geometry of its gear pair and its computation."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import MISSING, asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any

import rfc8785

from fe_contact.errors import DatabaseError, InputError
from fe_contact.types import Json

if TYPE_CHECKING:
    from fe_contact.geometry import ParallelAxes


SCHEMA_VERSION = 6
"""Version of the file layout. Older files lack the following:

- 1: the errors of the model;
- 1 and 2: the largest pressure without edges; theirs includes edge contact;
- 1 to 3: errors of orders that are no mesh orders;
- 1 to 4: bias apart from error for a load plane, and the error of interpolation in the bands between nodes;
- 1 to 5: the mark of requested alignments; all of theirs are requested.
"""


def content_hash(case: Json, solver_version: str, schema_version: int) -> str:
    """SHA-256, in hex, of the canonical JSON (RFC 8785) of the case with solver and schema version.

    Equal content gives equal hashes whatever the order of keys or the spelling of numbers (1, 1.0, 1e0).
    Raises `InputError`: the case is not JSON: a foreign type, NaN or infinity, or an integer beyond 2^53.
    """
    identity: Json = {"case": case, "solver_version": solver_version, "schema_version": schema_version}
    try:
        canonical = rfc8785.dumps(identity)
    except (rfc8785.CanonicalizationError, RecursionError) as error:
        raise InputError("case", type(case).__name__, f"plain JSON ({error})") from error
    return hashlib.sha256(canonical).hexdigest()


@dataclass(frozen=True)
class PairGeometry:
    """The closed-form geometry of a gear pair that a user of its table needs; SI units."""

    teeth: tuple[int, int]
    """Numbers of teeth, driving gear first; > 0 for a ring gear too."""
    base_radius: tuple[float, float]
    """r_b1, r_b2 in m, > 0 for a ring gear too."""
    base_pitch: float
    """Transverse base pitch p_bt in m."""
    base_helix_angle: float
    """beta_b in rad, >= 0."""
    center_distance: float
    """a in m."""
    working_pressure_angle: float
    """Transverse working pressure angle alpha_wt in rad."""
    face_width: float
    """Common face width in m."""
    helix_hand: int
    """Hand of gear 1: 1 right, -1 left, 0 spur. An external wheel has the opposite hand, a ring gear the
    same.
    """
    internal: bool = False
    """Whether gear 2 is a ring gear: a cos(alpha_wt) is then r_b2 - r_b1, else r_b1 + r_b2, and both gears
    turn the same way. STE stays r_b1 theta_1 - r_b2 theta_2, either angle counted as its gear is driven.
    """
    base_tooth_thickness: tuple[float, float] | None = None
    """s_bt1, s_bt2 in m, arcs of the base circles; a ring gear's may be < 0. None: not known."""

    @classmethod
    def of(cls, pair: ParallelAxes) -> PairGeometry:
        """Return the geometry of a gear pair."""
        hand = (pair.base_helix_angle > 0.0) - (pair.base_helix_angle < 0.0)
        return cls(
            teeth=(pair.pinion.teeth, pair.wheel.teeth),
            base_radius=(pair.pinion.base_radius, pair.wheel.base_radius),
            base_pitch=pair.base_pitch,
            base_helix_angle=abs(pair.base_helix_angle),
            center_distance=pair.center_distance,
            working_pressure_angle=pair.working_pressure_angle,
            face_width=pair.face_width,
            helix_hand=hand,
            internal=pair.internal,
            base_tooth_thickness=(pair.pinion.base_tooth_thickness, pair.wheel.base_tooth_thickness),
        )

    def __post_init__(self) -> None:
        object.__setattr__(self, "teeth", (int(self.teeth[0]), int(self.teeth[1])))
        object.__setattr__(self, "base_radius", (float(self.base_radius[0]), float(self.base_radius[1])))
        if self.base_tooth_thickness is not None:
            first, second = self.base_tooth_thickness
            object.__setattr__(self, "base_tooth_thickness", (float(first), float(second)))
            _require("base_tooth_thickness", first + second, math.isfinite, "finite")
        for name in ("base_pitch", "center_distance", "face_width"):
            _require(name, getattr(self, name), lambda value: value > 0.0, "above 0")
        for radius in self.base_radius:
            _require("base_radius", radius, lambda value: value > 0.0, "above 0")
        _require(
            "base_helix_angle",
            self.base_helix_angle,
            lambda angle: 0.0 <= angle < math.pi / 2,
            "in [0, pi/2)",
        )
        _require("helix_hand", self.helix_hand, lambda hand: hand in (-1, 0, 1), "-1, 0 or 1")
        _require("internal", self.internal, lambda value: isinstance(value, bool), "true or false")

    def normal_force(self, torque: float) -> float:
        """Total normal tooth force F_bn in N that carries `torque` in N m on gear 1."""
        return torque / (self.base_radius[0] * math.cos(self.base_helix_angle))

    def to_json(self) -> Json:
        """Plain JSON with the same names; `internal` is left out if False, unknown thicknesses too."""
        content = asdict(self)
        for name in ("internal", "base_tooth_thickness"):
            if not content[name]:
                del content[name]
        return content

    @classmethod
    def from_json(cls, content: Json) -> PairGeometry:
        """Read a record that `to_json` wrote; `DatabaseError` if a fact is missing or foreign."""
        try:
            return cls(**content)
        except (TypeError, ValueError, IndexError) as error:
            missing = sorted({fact.name for fact in fields(cls) if fact.default is MISSING} - set(content))
            text = f"without {', '.join(missing)}" if missing else "of other kinds"
            raise DatabaseError(f"the pair facts are not readable: {text}") from error


@dataclass(frozen=True)
class Metadata:
    """The computation of a database: plain JSON throughout, copied on construction."""

    case: Json = field(default_factory=dict)
    """The case with all defaults echoed."""
    effect_ledger: Json | list[Any] = field(default_factory=dict)
    """State of each registered effect: on or off, why, influence and cost."""
    receipt: Json = field(default_factory=dict)
    """Time and memory by stage, error estimate by source."""
    content_hash: str = ""
    """RFC 8785 hash of the validated input with the solver and schema version."""
    software_versions: dict[str, str] = field(default_factory=dict)
    """Version by package name."""
    schema_version: int = SCHEMA_VERSION
    """Version of the file layout."""
    warnings: list[Any] = field(default_factory=list)
    """Implausible values of the case or its results, with reasons; empty where there are none."""

    def __post_init__(self) -> None:
        for entry in fields(self):
            object.__setattr__(self, entry.name, _plain_json(entry.name, getattr(self, entry.name)))


def _plain_json(name: str, content: Any) -> Any:
    """Return a deep copy of `content` made of JSON types only."""
    try:
        return json.loads(json.dumps(content, allow_nan=False))
    except (TypeError, ValueError) as error:
        raise DatabaseError(f"metadata.{name} is not plain JSON: {error}") from error


def _require(name: str, value: Any, holds: Any, bound: str) -> None:
    """Raise `DatabaseError` unless the fact is a finite number that `holds`."""
    if not isinstance(value, int | float) or not math.isfinite(value) or not holds(value):
        raise DatabaseError(f"pair fact {name} = {value!r}: must be {bound}")
