"""The path of contact and its points A to E (ISO 21771-1, clause 5.3)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PathOfContact:
    """Points of the path of contact, as roll lengths on the driving gear in m."""

    start: float
    """A: the driven gear's tip meets the driving gear's flank."""
    pitch_point: float
    """C."""
    end: float
    """E: the driving gear's tip leaves."""
    base_pitch: float
    """Transverse base pitch, m."""

    @property
    def inner_single_contact(self) -> float:
        """B: one base pitch before E (start of single contact if the contact ratio is between 1 and 2)."""
        return self.end - self.base_pitch

    @property
    def outer_single_contact(self) -> float:
        """D: one base pitch after A (end of single contact if the contact ratio is between 1 and 2)."""
        return self.start + self.base_pitch

    @property
    def length(self) -> float:
        """Length g_alpha of the path of contact, m."""
        return self.end - self.start

    @property
    def points(self) -> tuple[float, float, float, float, float]:
        """A, B, C, D, E."""
        return (self.start, self.inner_single_contact, self.pitch_point, self.outer_single_contact, self.end)
