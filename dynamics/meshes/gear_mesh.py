"""A gear mesh: two gears, the table of their contact, and how it is used."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.checks import finite, not_negative, one_of, positive
from dynamics.meshes.coast_flank import CoastFlank
from dynamics.meshes.mesh_table import MeshTable, check_table

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
