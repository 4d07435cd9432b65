"""Influence of an effect: change of the results at the nominal load if the effect is neglected."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import engineering
from fe_contact.types import Json
from model_studies.ablation import TRIFLE

RIPPLE_FLOOR = 20e-9
"""Least peak-to-peak STE whose relative change is stated, m. Meshes and springs leave smaller ripples
uncertain.
"""


_UM = 1e6


_NOTHING = 5e-5  # um and %, well below what two digits of any change that counts can show


@dataclass(frozen=True)
class Influence:
    """Change by leaving an effect out: without it less with it."""

    torque: float
    """Torque on the driving gear, N m."""
    misalignment: float
    """Misalignment of the figures, m."""
    mean: float
    peak_to_peak: float
    """`mean`, `peak_to_peak`: Change of the static transmission error, m."""
    full_mean: float
    full_peak_to_peak: float
    """`full_mean`, `full_peak_to_peak`: The static transmission error with the effect, m."""

    @property
    def relative_mean(self) -> float:
        """Change of the mean over the mean with the effect."""
        return self.mean / self.full_mean

    @property
    def relative_peak_to_peak(self) -> float | None:
        """Change of peak-to-peak over that with the effect; None where that is below `RIPPLE_FLOOR`."""
        quiet = self.full_peak_to_peak < RIPPLE_FLOOR
        return None if quiet else self.peak_to_peak / self.full_peak_to_peak

    @property
    def trifle(self) -> bool:
        """Whether both changes are below `TRIFLE`, or that of a vanishing ripple below `RIPPLE_FLOOR`."""
        ripple = self.relative_peak_to_peak
        small = abs(self.peak_to_peak) < RIPPLE_FLOOR if ripple is None else abs(ripple) < TRIFLE
        return small and abs(self.relative_mean) < TRIFLE

    @property
    def text(self) -> str:
        """Both changes in um and %."""
        ripple = self.relative_peak_to_peak
        share = f"of less than {_UM * RIPPLE_FLOOR:g} µm" if ripple is None else f"{signed(100 * ripple)} %"
        return (
            f"mean {signed(_UM * self.mean)} µm ({signed(100 * self.relative_mean)} %), "
            f"peak-to-peak {signed(_UM * self.peak_to_peak)} µm ({share})"
        )

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "torque_n_m": self.torque,
            "misalignment_m": self.misalignment,
            "mean_m": self.mean,
            "peak_to_peak_m": self.peak_to_peak,
            "whole_mean_m": self.full_mean,
            "whole_peak_to_peak_m": self.full_peak_to_peak,
            "relative_mean": self.relative_mean,
            "relative_peak_to_peak": self.relative_peak_to_peak,
            "trifle": self.trifle,
            "words": self.text,
        }


def signed(value: float) -> str:
    """Write a change with its sign in two digits, whole numbers from 100 on."""
    if abs(value) < _NOTHING:
        return "0"
    return f"{value:+.0f}" if abs(value) >= 99.5 else engineering(value, 2, "+")
