"""Rungs of the ladders of cases and of scenes, by name."""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.accuracy.registry import FIDELITIES as SCENE_FIDELITIES
from fe_contact.analysis.accuracy_study import FIDELITIES
from service.problems import BadInput

LEAST = 2


def rungs_asked(names: Sequence[str] | None, *, of_scene: bool) -> list[str]:
    """Return the rungs that a ladder is asked for, once each, in its order.

    Raises
    ------
    BadInput
        A name that no rung of a case, or of a scene, has; or fewer than two rungs.
    """
    known = [rung.name for rung in (SCENE_FIDELITIES if of_scene else FIDELITIES)]
    for name in names or ():
        if name not in known:
            raise BadInput.of("rungs", name, f"among {', '.join(known)}", "Or leave it out: all are run.")
    asked = [name for name in known if names is None or name in names]
    if len(asked) < LEAST:
        raise BadInput.of("rungs", asked, "at least two rungs", "An error needs two to compare.")
    return asked
