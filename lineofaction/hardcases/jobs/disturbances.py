"""Jobs that lack memory, time or space, and jobs whose processes die."""

from __future__ import annotations

from collections.abc import Sequence

from lineofaction.hardcases.jobs.aftermath import LARGE, LONG, aftermath
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("service")

MEMORY_MB = 384
"""Memory limit in MB, between the needs of the small and of the large job."""

RECOVERY = (
    "nothing of it is left, and the jobs behind it end as they should, in their turn, with results that are "
    "those of an undisturbed service to the last bit."
)


@SCENES.add(
    "job_out_of_memory",
    "A three-dimensional analysis that needs three times the memory a worker may have: an allocation fails "
    "somewhere in numerical libraries.",
    f"The job fails at its first attempt, with the limit and what to try; {RECOVERY}",
)
def _out_of_memory() -> Sequence[Measured]:
    """Run the large job with little memory."""
    outcome = aftermath(LARGE, settle=lambda _seconds: {"memory_limit_mb": MEMORY_MB})
    job = outcome.job
    is_explained = f"{MEMORY_MB} MB (LOA_MEMORY_LIMIT_MB)" in job.message and "coarser level" in job.message
    return (
        Measured("failed at the first attempt", outcome.ended_as("failed", 1), minimum=1.0),
        Measured("names the limit and what to try", is_explained, minimum=1.0),
        *outcome.figures,
    )


@SCENES.add(
    "job_past_deadline",
    "A job that is inside compiled code when its deadline passes, and hears of nothing.",
    f"The job fails at its first attempt, with the deadline and what to try; {RECOVERY}",
)
def _past_the_deadline() -> Sequence[Measured]:
    """Run the large job with a deadline of a few times the duration of the small one."""
    allowed = []  # takes the deadline, which is known once the small job has run

    def settle(seconds: float) -> dict[str, float]:
        allowed.append(round(2.5 * seconds, 1))
        return {"deadline_s": allowed[0]}

    outcome = aftermath(LONG, settle=settle)
    job = outcome.job
    is_explained = f"The deadline of {allowed[0]:g} s (LOA_DEADLINE_S) passed" in job.message
    return (
        Measured("failed at the first attempt", outcome.ended_as("failed", 1), minimum=1.0),
        Measured(
            "names the deadline and what to try",
            is_explained and "coarser" in job.message,
            minimum=1.0,
        ),
        Measured("deadline, s", allowed[0]),
        *outcome.figures,
    )
