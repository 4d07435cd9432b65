"""One load and one alignment of a pair."""

from __future__ import annotations

from dataclasses import dataclass

from fe_contact.options.table_axes import TableAxes


@dataclass(frozen=True)
class OperatingPoint:
    """One load and one alignment of a pair, for results on flanks, roots and deformed gears.

    Attributes
    ----------
    torque, normal_force : float
        Torque on the driving gear in N m, or normal force F_bn in N; exactly one.
    misalignment, center_distance_change : float
        As the axes of a table, m.
    """

    torque: float | None = None
    normal_force: float | None = None
    misalignment: float = 0.0
    center_distance_change: float = 0.0

    @property
    def axes(self) -> TableAxes:
        """The axes of a table of this point alone."""
        return TableAxes(
            torques=None if self.torque is None else [self.torque],
            normal_forces=None if self.normal_force is None else [self.normal_force],
            misalignments=[self.misalignment],
            center_distance_changes=[self.center_distance_change],
        )
