"""A gear mesh: two gears, the table of their contact, how it is used; the coast flank behind a backlash."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, one_of, up_to
from dynamics.checks import declared_fields, finite, not_negative
from dynamics.meshes.mesh_table import MeshTable, check_table

DEFAULT_DAMPING_RATIO = 0.05  # damping ratio of a mesh where a scene states none
TECHNIQUES = ("constant_torque", "variable_torque")
_TECHNIQUE = Declared(Kind.CHOICE, "", one_of(TECHNIQUES), "Technique of the mesh force", "variable_torque")
_DAMPING = Declared(
    Kind.DAMPING, "N s/m", between(0.0, 1e12), "Mesh damping in {unit}; left out: from damping_ratio", 1e3
)
_DAMPING_RATIO = Declared(Kind.RATIO, "", between(0.0, 10.0), "Damping ratio of the mesh", 0.05)
_NOMINAL = "Nominal transverse mesh force in {unit}; left out: from the loads"
_NOMINAL_FORCE = Declared(Kind.LOAD, "N", up_to(1e9), _NOMINAL, 2660.0)
_POSITION = "Position in base pitches at the start; left out: from the geometry of the train"
_OFFSET = Declared(Kind.RATIO, "", between(-1e6, 1e6), _POSITION, 0.0)
_MISALIGNMENT = Declared(Kind.LENGTH, "m", between(-0.01, 0.01), "Misalignment in {unit}", 0.0, written="µm")
_CHANGE = Declared(Kind.LENGTH, "m", between(-0.1, 0.1), "Change of the center distance in {unit}", 0.0)
_SLIDING = "Coefficient of sliding friction of the teeth; left out: none"
_FRICTION = Declared(Kind.RATIO, "", up_to(1.0), _SLIDING, 0.05)


@dataclass(frozen=True)
class CoastFlank:
    """Contact on the coast flanks."""

    backlash: float
    """Backlash along the transverse line of action (an arc of the base circles) at the scene's center
    distance, m, >= 0; 0 is that of nominal gears.
    """
    thickness: float = 0.5
    """Thickness of the driver's teeth over the pitch, both on the operating pitch circle."""
    table: MeshTable | None = None
    """Table of the pair driven on its coast flanks. Positions count in the sense in which the driver then
    turns and are 0 where the reference pair touches at the pitch point; faces are seen from the other end.
    None: the table of the driving flank, which assumes symmetric teeth and modifications.
    """

    def __post_init__(self) -> None:
        not_negative("backlash", self.backlash)
        finite("thickness", self.thickness)
        if self.table is not None:
            check_table(self.table, "table")


@described
@dataclass(frozen=True)
class GearMesh:
    """The force between two gears, from a mesh-force table.

    Its `name` is unique among the meshes. The force of `driver` acts in the sense in which its shaft turns;
    positions in `table` are counted by the driver's angle. The technique ``"variable_torque"`` takes the
    force F(position, DTE) from the table, ``"constant_torque"`` F = k(position) DTE with
    k = nominal force / STE(position), the secant stiffness at that force.

    Damping acts along the line of action, in contact only and never in tension. Left out it is
    ``2 damping_ratio sqrt(k m)`` with k the mean tangent stiffness at the nominal force and 1/m the sum of
    base_radius^2 / (polar inertia) over the shafts that are free to turn. The nominal force F_bt is that of
    the secant, the damping and the static reference curve; left out, the one that carries the load at t = 0.
    `position_offset` left out follows from the geometry of the train, of which the first mesh starts at 0.
    Where the table has axes of misalignment and change of center distance, these are the constant operating
    point at which it is used. The effect ``"backlash"`` needs `coast`, without which only the driving flank
    carries force; `friction` is for the effect of that name. With `bent_shafts` the table includes the
    bending of the gears' shafts; they are then rigid here.
    """

    name: str
    driver: str
    driven: str
    table: MeshTable
    technique: str = declared("variable_torque", _TECHNIQUE)
    damping: float | None = declared(None, _DAMPING)
    damping_ratio: float = declared(DEFAULT_DAMPING_RATIO, _DAMPING_RATIO)
    nominal_force: float | None = declared(None, _NOMINAL_FORCE)
    position_offset: float | None = declared(None, _OFFSET)
    misalignment: float = declared(0.0, _MISALIGNMENT)
    center_distance_change: float = declared(0.0, _CHANGE)
    coast: CoastFlank | None = None
    friction: float | None = declared(None, _FRICTION)
    bent_shafts: bool = False

    def __post_init__(self) -> None:
        check_table(self.table, "table")
        declared_fields(self)
