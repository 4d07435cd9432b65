"""Result of a change of flanks: levels before and after the change, over one sample of pairs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from bounds.brief import brief
from bounds.types import Json
from fe_contact.types import FloatArray
from model_studies import in_unit
from model_studies.result_record import ResultRecord
from model_studies.spread import quantiles, rank_correlation

ALL = "all"
"""Name of the line that sums all orders of the mesh; other flanks leave other orders as they are."""
LOW, MEDIAN, HIGH = 0.05, 0.5, 0.95
"""Quantiles of the band of a level."""
AUDIBLE = 0.5
"""Least change of a level that counts, dB: hardly anybody hears less."""


@dataclass(frozen=True)
class DesignLevels:
    """Levels of a design under L load cases in K lines, nominal and of N pairs within tolerances, dB."""

    nominal: FloatArray = field(metadata=in_unit("dB", "load_case", "line"))
    """Levels with the nominal flanks. Shape (L, K)."""
    pairs: FloatArray = field(metadata=in_unit("dB", "pair", "load_case", "line"))
    """Levels of the pairs. Shape (N, L, K)."""
    parting: FloatArray = field(metadata=in_unit("1", "load_case"))
    """Largest share of the static mesh force by which flanks part at a speed, 0: they do not. Shape (L,)."""
    error: FloatArray = field(metadata=in_unit("dB", "side", "load_case", "line"))
    """Errors of the levels below and above, from the table of the nominal design; NaN: not known. Shape (2,
    L, K).
    """

    def quantiles(self) -> FloatArray:
        """Return the band (3, L, K) in which 90 % of the pairs lie, and its median, dB; with the errors."""
        return _banded(self.pairs, *self.error)


def _banded(levels: FloatArray, below: FloatArray, above: FloatArray) -> FloatArray:
    """Return the quantiles `LOW`, `MEDIAN` and `HIGH` (3, ...) of pairs (N, ...), errors (...) in the ends.

    The spread of the pairs and the errors of the table are independent: they add up in squares.
    """
    low, median, high = quantiles(levels, (LOW, MEDIAN, HIGH))
    below, above = np.nan_to_num(below), np.nan_to_num(above)
    return np.stack([median - np.hypot(median - low, below), median, median + np.hypot(high - median, above)])


@brief
@dataclass(frozen=True)
class FlankChange(ResultRecord):
    """Levels of N pairs with the flanks before and after a change, pair by pair with the same deviations."""

    mesh: str
    quantity: str
    unit: str
    over_speeds: str
    """`mesh`, `quantity`, `unit`, `over_speeds`: Words for the compared figure; the unit with its reference.
    """
    lines: tuple[str, ...]
    """Names of the lines: `ALL` orders of the mesh together, then each order."""
    torque: FloatArray = field(metadata=in_unit("n_m", "load_case"))
    """Torque on the driving gear of the mesh, N m. Shape (L,)."""
    speed: FloatArray = field(metadata=in_unit("rad s-1", "speed"))
    """Speed of the leading shaft, rad/s. Shape (S,)."""
    names: tuple[str, ...]
    """Names of the deviations: "misalignment" and ``gear.quantity``."""
    deviation: FloatArray = field(metadata=in_unit("m", "pair", "deviating"))
    """Deviations of the pairs, m. Shape (N, d)."""
    before: DesignLevels
    after: DesignLevels
    requirement: float | None
    """Highest level of all orders of the mesh that `HIGH` of the pairs may have, dB."""
    cost: Json
    """CPU seconds by stage."""

    @property
    def nominal_change(self) -> FloatArray:
        """The change of level with nominal flanks (L, K), dB; > 0: louder."""
        return np.asarray(self.after.nominal - self.before.nominal)

    @property
    def change(self) -> FloatArray:
        """The change of level of each pair (N, L, K), dB; > 0: louder."""
        return np.asarray(self.after.pairs - self.before.pairs)

    @cached_property
    def change_quantiles(self) -> FloatArray:
        """The band of the change and its median (3, L, K), dB.

        The errors of both tables count as independent; flanks that change nothing err alike.
        """
        differ = np.any(self.change != 0.0, axis=0)
        before, after = self.before.error, self.after.error
        return _banded(self.change, *(differ * np.hypot(after, before[::-1])))

    @property
    def louder_share(self) -> FloatArray:
        """Share of the pairs that get louder (L, K)."""
        return np.asarray(np.mean(self.change > 0.0, axis=0))

    @property
    def influence(self) -> FloatArray:
        """Rank correlation (2, d, L) of each deviation with the change and the level after it, all orders."""
        of_change, of_level = self.change[:, :, 0], self.after.pairs[:, :, 0]
        return np.stack([rank_correlation(self.deviation, response) for response in (of_change, of_level)])

    @property
    def met(self) -> bool | None:
        """Whether the requirement is met; None where there is none."""
        if self.requirement is None:
            return None
        return bool(np.all(self.after.quantiles()[2, :, 0] <= self.requirement))

    def verdict(self) -> str:
        """Return a sentence on the change of all orders of the mesh together."""
        low, median, high = self.change_quantiles[:, :, 0]
        at = int(np.argmax(median))
        band = f"{median[at]:+.1f} dB ({low[at]:+.1f} to {high[at]:+.1f} dB) at {self.torque[at]:.4g} N m"
        if np.all(np.abs(self.change_quantiles[:, :, 0]) < AUDIBLE):
            verdict = "No change"
        elif np.all(high < 0.0):
            verdict = "Quieter under every load case"
        elif np.any(low > 0.0):
            verdict = "Louder"
        else:
            verdict = "Quieter or louder, by the pair"
        return f"{verdict}: {band}, {100.0 * self.louder_share[at, 0]:.0f} % of the pairs get louder."

    def required(self) -> str:
        """Return a sentence on whether the requirement is met; empty without a requirement."""
        if self.requirement is None:
            return ""
        high = self.after.quantiles()[2, :, 0]
        at = int(np.argmax(high))
        met, share = "met" if self.met else "not met", 100.0 * HIGH
        return (
            f"Requirement {self.requirement:.4g} {self.unit}: {met}, {share:.0f} % of the pairs are below "
            f"{high[at]:.1f} dB at {self.torque[at]:.4g} N m."
        )

    def louder(self) -> Iterator[str]:
        """Yield the orders that get louder as designed, the one that gains most power first."""
        change = self.nominal_change
        gain = 10.0 ** (0.1 * self.after.nominal) - 10.0 ** (0.1 * self.before.nominal)
        for flat in np.argsort(-gain, axis=None, kind="stable").tolist():
            load, line = np.unravel_index(flat, change.shape)
            if change[load, line] >= AUDIBLE and self.lines[line] != ALL:
                low, _, high = self.change_quantiles[:, load, line]
                yield (
                    f"order {self.lines[line]} at {self.torque[load]:.4g} N m: {change[load, line]:+.1f} dB "
                    f"({low:+.1f} to {high:+.1f} dB), to {self.after.nominal[load, line]:.1f} dB"
                )

    def partings(self) -> Iterator[str]:
        """Yield sentences on load cases in which flanks part, so that no linear response holds."""
        for name, design in (("before", self.before), ("after", self.after)):
            for load in np.flatnonzero(design.parting > 0.0).tolist():
                torque = f"{self.torque[load]:.4g} N m"
                yield f"{name} the change flanks would part at {torque}: no linear level holds"
