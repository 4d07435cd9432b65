"""A gear mesh: two gears, the table of their contact, how it is used; the coast flank behind a backlash."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.checks import finite, not_negative, one_of, positive
from dynamics.meshes.mesh_table import DERIVATIVES, LEVERS, MeshTable, check_table
from dynamics.meshes.technique import PlainTable
from dynamics.types import FloatArray

# The coast flank: the other side of the teeth, which touches when backlash is used up.
#
# Turned by pi about the line of centers, a pair that is pushed on its coast flanks looks like the same pair
# driven in the other sense: hands stay, and the force law is the driving flank's as long as teeth are alike
# on both sides. What changes is the position: the driver's coast flank passes the pitch point when the driver
# has turned on by its tooth's thickness from where the drive flank passed. With x the position of the driving
# flank and c that thickness over the pitch, both on the operating pitch circle, the coast flank is at c - x.


@dataclass(frozen=True)
class CoastFlank:
    """Contact on the coast flanks.

    Attributes
    ----------
    backlash : float
        m, >= 0, along the transverse line of action (an arc of the base circles), at the scene's center
        distance; 0 is that of nominal gears.
    thickness : float
        Thickness of the driver's teeth over the pitch, both on the operating pitch circle.
    table : MeshTable or None
        Of the pair driven on its coast flanks, positions counted in the driver's sense then, 0 where the
        reference pair touches at the pitch point, faces seen from the other end. None: that of the driving
        flank, which assumes symmetric teeth, modifications included.
    """

    backlash: float
    thickness: float = 0.5
    table: MeshTable | None = None

    def __post_init__(self) -> None:
        not_negative("backlash", self.backlash)
        finite("thickness", self.thickness)
        if self.table is not None:
            check_table("table", self.table)


def mirrored(table: MeshTable, thickness: float) -> PlainTable:
    """Return `table` with its positions x replaced by thickness - x, at the same forces and deflections."""
    position = np.mod(thickness - table.position, float(table.period))
    position[position >= table.period] = 0.0  # a tiny negative one rounds up to a whole period
    order = np.argsort(position)

    def turned(values: FloatArray) -> FloatArray:
        return np.ascontiguousarray(np.take(values, order, axis=-2))

    return PlainTable(
        position[order],
        table.level,
        table.misalignment,
        table.center_distance_change,
        turned(table.deflection),
        -turned(table.deflection_slope),
        turned(table.stiffness),
        -turned(table.stiffness_slope),
        table.period,
        **{name: turned(values) for name in LEVERS if (values := getattr(table, name, None)) is not None},
        **{
            name: np.array([1.0, -1.0]).reshape(2, 1, 1, 1, 1) * turned(values)
            for name in DERIVATIVES
            if (values := getattr(table, name, None)) is not None
        },
    )


# The mesh.


DEFAULT_DAMPING_RATIO = 0.05
TECHNIQUES = ("constant_torque", "variable_torque")


@dataclass(frozen=True)
class GearMesh:
    """The force between two gears, from a mesh-force table.

    Attributes
    ----------
    name : str
        Unique among the meshes.
    driver, driven : str
        The gears. The force of `driver` acts in the sense in which its shaft turns.
    table : MeshTable
        Position counted by the driver's angle.
    technique : str
        ``"variable_torque"``: force F(position, DTE) from the table. ``"constant_torque"``:
        F = k(position) DTE with k = nominal force / STE(position), the secant stiffness at that force.
    damping : float or None
        N s/m along the line of action, in contact only and never in tension. None: ``2 damping_ratio sqrt(k
        m)`` with k the mean tangent stiffness at the nominal force and 1/m the sum of base_radius^2 / (polar
        inertia) over the shafts that are free to turn.
    damping_ratio : float
        Used where `damping` is None.
    nominal_force : float or None
        Transverse mesh force F_bt in N for the secant, the damping and the static reference curve. None: the
        force that carries the load at t = 0.
    position_offset : float
        Position in base pitches at t = 0.
    misalignment, center_distance_change : float
        m; where the table has such axes, the constant operating point at which it is used.
    coast : CoastFlank or None
        The coast flank, for the effect ``"backlash"``. None: only the driving flank carries force.
    friction : float or None
        Coefficient of sliding friction, for the effect ``"friction"``. None: none.
    bent_shafts : bool
        Whether the table includes the bending of the gears' shafts; they are then rigid here.
    """

    name: str
    driver: str
    driven: str
    table: MeshTable
    technique: str = "variable_torque"
    damping: float | None = None
    damping_ratio: float = DEFAULT_DAMPING_RATIO
    nominal_force: float | None = None
    position_offset: float = 0.0
    misalignment: float = 0.0
    center_distance_change: float = 0.0
    coast: CoastFlank | None = None
    friction: float | None = None
    bent_shafts: bool = False

    def __post_init__(self) -> None:
        check_table("table", self.table)
        one_of("technique", self.technique, TECHNIQUES)
        if self.damping is not None:
            not_negative("damping", self.damping)
        if self.nominal_force is not None:
            positive("nominal_force", self.nominal_force)
        not_negative("damping_ratio", self.damping_ratio)
        if self.friction is not None:
            positive("friction", self.friction)
        for name in ("position_offset", "misalignment", "center_distance_change"):
            finite(name, getattr(self, name))
