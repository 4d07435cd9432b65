"""What is kept of a job beside its inputs."""

from __future__ import annotations

from dataclasses import dataclass

from service.queue.delivery import AS_IT_IS, Delivery
from service.queue.differences import NOT_COMPARED, Differences
from service.queue.label import NO_LABEL, Label


@dataclass(frozen=True)
class Terms:
    """The terms of a job.

    Attributes
    ----------
    delivery : Delivery
        The form in which it shows its result.
    label : Label
    differences : Differences
        What sets it apart from the caller's job before it.
    priority : int
        Of its computation: the highest of the jobs that share it.
    max_cost_s : float or None
        CPU seconds that it may take; None: no limit.
    stated : str
        Its inputs as the caller stated them, JSON; empty: they are not kept.
    reuse : bool
        Whether an equal job of the caller's that is under way or done answers in its place.
    """

    delivery: Delivery = AS_IT_IS
    label: Label = NO_LABEL
    differences: Differences = NOT_COMPARED
    priority: int = 0
    max_cost_s: float | None = None
    stated: str = ""
    reuse: bool = False

    def columns(self) -> dict[str, str]:
        """Return the columns of a job that hold them; the others are its computation's."""
        said = {"delivery": str(self.delivery), "differences": str(self.differences), "stated": self.stated}
        return {**said, **self.label.columns()}


USUAL = Terms()
