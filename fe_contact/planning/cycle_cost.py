"""Size of a table over several base pitches, its cost, and the longest table that is allowed."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from bounds import at_most, engineering
from fe_contact.contact import ContactModel
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.cost_model import MAX_ROWS, contact_seconds, memory_of_contact
from fe_contact.planning.plan import Plan
from fe_contact.types import Json


@dataclass(frozen=True)
class CycleCost:
    """Size of a table and its cost."""

    pitches: int
    """Number of base pitches of the period."""
    positions: int
    """Positions in each base pitch; the least number where they are placed adaptively."""
    alignments: int
    """Misalignments x center distances."""
    cpu_seconds: float
    memory_bytes: float
    """`cpu_seconds`, `memory_bytes`: Predicted cost of the contact with its error estimate."""

    @property
    def rows(self) -> int:
        """Positions over the whole period, at all alignments."""
        return self.pitches * self.positions * self.alignments

    def to_json(self) -> Json:
        """Return plain JSON."""
        return asdict(self)

    @classmethod
    def of(
        cls, pair: ParallelAxes, plan: Plan, model: ContactModel, alignments: tuple[int, int]
    ) -> CycleCost:
        """Predict the cost of a table over the period of a model; parameters of `predict_run`."""
        seconds = sum(contact_seconds(pair, plan, model, alignments))
        memory = memory_of_contact(pair, plan, model.period, alignments)
        positions = plan.positions or plan.nodes.start
        return cls(model.period, positions, alignments[0] * alignments[1], seconds, memory)

    def refuse_too_long(self) -> None:
        """Refuse a table of more than `MAX_ROWS` rows, stating its cost and a remedy.

        Raises `InputError` of the field "pitches".
        """
        if self.rows <= MAX_ROWS:
            return
        longest = MAX_ROWS // (self.positions * self.alignments)
        note = f" with {self.positions} positions a pitch and {self.alignments} alignments"
        remedy = (
            f"The table would have {self.rows} rows, about "
            f"{engineering(self.cpu_seconds, 2)} CPU s and {engineering(1e-9 * self.memory_bytes, 2)} GB. "
            "Request fewer pitches (for example the teeth of one gear), positions or alignments, or give the "
            "deviations of one gear only."
        )
        raise InputError("pitches", self.pitches, at_most(longest, note=note), remedy)
