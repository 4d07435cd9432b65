"""Options of every analysis: accuracy, model, effects, receipt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace

from fe_contact.allowed_error import RELATIVE, AllowedError
from fe_contact.checks import integer, positive
from fe_contact.errors import InputError
from fe_contact.types import Json

LEVELS = ("draft", "standard", "fine")
CHOICES = {
    "level": (None, *LEVELS),
    "model": ("auto", "plane_strain", "plane_stress", "3d"),
    "receipt": ("full", "minimal"),
    "on_violation": ("repeat", "fail", "report"),
}


@dataclass(frozen=True)
class AnalysisOptions:
    """Accuracy, model and effects of an analysis: a tolerance, a time budget, both, or a level.

    None of them means the level "standard".

    Attributes
    ----------
    tolerance : AllowedError, optional
        Of mean and peak-to-peak STE. A table is refined by its measured errors until it meets the tolerance,
        in at most four passes: `receipt["passes"]`; `receipt["tolerance"]` says whether it is met, or why
        not.
    time_budget : float, optional
        CPU seconds that the run may take. With a tolerance, refinement ends before it would exceed them.
    level : str, optional
        "draft", "standard" or "fine".
    model : str
        "auto" (three dimensions where the scene acts across the face, else plane strain corrected for the
        finite face width), "plane_strain", "plane_stress" or "3d".
    positions : int, optional
        Of a table: equally spaced positions in a base pitch; default: nodes placed so that interpolation
        keeps 0.2 % of peak-to-peak.
    effects : mapping
        Effect name to "on", "off" or "auto"; effects that are not named are "auto".
    receipt : str
        Of a table: "full" measures its errors by source; "minimal" does not estimate them: they are NaN, and
        the receipt says so.
    on_violation : str
        What to do if the solution violates an assumption (`receipt["assumptions"]`): "repeat" enables the
        automatic effect that is needed and solves again, "fail" raises, "report" reports it.

    Raises
    ------
    InputError
        A value that cannot be used, by field name, or a level together with a tolerance or a time budget.
    """

    tolerance: AllowedError | None = None
    time_budget: float | None = None
    level: str | None = None
    model: str = "auto"
    positions: int | None = None
    effects: Mapping[str, str] = field(default_factory=dict)
    receipt: str = "full"
    on_violation: str = "repeat"

    def __post_init__(self) -> None:
        wishes = [name for name in ("tolerance", "time_budget") if getattr(self, name) is not None]
        if wishes and self.level is not None:
            bound = f"left out when {wishes[0]} is given"
            raise InputError("level", self.level, bound, "A level is a mesh, regardless of cost.")
        if self.time_budget is not None:
            positive("time_budget", self.time_budget, "Seconds.")
        for name, choices in CHOICES.items():
            if (value := getattr(self, name)) not in choices:
                raise InputError(name, value, f"one of {', '.join(filter(None, choices))}")
        if self.positions is not None:
            advice = "64 resolve a spur pair; leave it out for adaptive nodes."
            integer("positions", self.positions, 8, 4096, advice)

    @property
    def allowed(self) -> AllowedError:
        """Error that counts as small: the tolerance, or a part of each quantity without one."""
        return self.tolerance or RELATIVE

    @property
    def refines(self) -> bool:
        """Whether a table is refined by its measured errors: those of a minimal receipt are not known."""
        return self.tolerance is not None and self.receipt == "full"

    def at_level(self, level: str) -> AnalysisOptions:
        """Return the same with a level of mesh in place of a tolerance or a time."""
        return replace(self, tolerance=None, time_budget=None, level=level)

    def to_json(self) -> Json:
        """Return plain JSON as a request echoes it."""
        names = "time_budget", "level", "model", "positions", "receipt"
        accuracy: Json = {name: getattr(self, name) for name in names}
        accuracy["tolerance"] = None if self.tolerance is None else asdict(self.tolerance)
        effects = dict(sorted(self.effects.items()))
        return {"accuracy": accuracy, "effects": effects, "on_violation": self.on_violation}
