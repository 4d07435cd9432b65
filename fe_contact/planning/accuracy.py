"""What accuracy, time or model the caller asks for."""

from __future__ import annotations

from dataclasses import dataclass

from fe_contact.allowed_error import RELATIVE, AllowedError
from fe_contact.checks import integer, positive
from fe_contact.errors import InputError

LEVELS = ("draft", "standard", "fine")
RECEIPTS = ("full", "minimal")
MODELS = ("auto", "plane_strain", "plane_stress", "3d")


@dataclass(frozen=True)
class Accuracy:
    """What the caller asks for: a tolerance, a time budget, both, or a level; nothing means "standard".

    Attributes
    ----------
    tolerance : AllowedError, optional
        Of mean and peak-to-peak STE.
    time_budget : float, optional
        CPU seconds that the run may take. Beside a tolerance refinement ends where it would go beyond them.
    level : str, optional
        "draft", "standard" or "fine".
    model : str
        "auto", "plane_strain", "plane_stress" or "3d".
    positions : int, optional
        Fixed number of equally spaced positions; without it nodes are placed where the curve bends.
    receipt : str
        "full", or "minimal": nothing is solved for the sake of error estimates.
    """

    tolerance: AllowedError | None = None
    time_budget: float | None = None
    level: str | None = None
    model: str = "auto"
    positions: int | None = None
    receipt: str = "full"

    def __post_init__(self) -> None:
        wishes = [name for name in ("tolerance", "time_budget") if getattr(self, name) is not None]
        if wishes and self.level is not None:
            bound = f"left out when {wishes[0]} is given"
            raise InputError("level", self.level, bound, "A level is a mesh, whatever it costs.")
        if self.time_budget is not None:
            positive("time_budget", self.time_budget, "Seconds.")
        if self.level is not None and self.level not in LEVELS:
            raise InputError("level", self.level, f"one of {', '.join(LEVELS)}")
        if self.model not in MODELS:
            raise InputError("model", self.model, f"one of {', '.join(MODELS)}")
        if self.receipt not in RECEIPTS:
            raise InputError("receipt", self.receipt, f"one of {', '.join(RECEIPTS)}")
        if self.positions is not None:
            advice = "64 resolve a spur pair; leave it out for adaptive nodes."
            integer("positions", self.positions, 8, 4096, advice)

    @property
    def allowed(self) -> AllowedError:
        """What a run takes as small: the tolerance, without one a part of each quantity."""
        return self.tolerance or RELATIVE

    @property
    def refines(self) -> bool:
        """Whether a table is refined by its measured errors: those of a minimal receipt are not known."""
        return self.tolerance is not None and self.receipt == "full"
