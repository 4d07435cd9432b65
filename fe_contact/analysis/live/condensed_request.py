"""The condensed bodies of a request, for other flanks and alignments without a further table."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fe_contact.analysis.live.condensed_contacts import CondensedContacts
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.effects import EFFECTS
from fe_contact.geometry import ParallelAxes

OF_BODIES = tuple(effect.name for effect in EFFECTS if effect.of_bodies)
"""Effects that change the finite-element meshes of the bodies."""


def condense(pair: ParallelAxes, acting: Checked, cache: Path | None) -> CondensedPair:
    """Choose model and mesh for a request, and condense both gears with them, coarse meshes too.

    Raises `MeshError`, `SolveError`: no acceptable mesh.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Of the bodies, with any flanks.
    acting : Checked
        The request of the same bodies in which every effect acts that may act later. It decides model and
        mesh, and its highest load the load patches.
    cache : Path, optional
        Directory of flank compliances.
    """
    choice = decide(acting, cache)
    request, choices = choice.checked.request, choice.checked.decision
    effects = {**acting.request.options.effects, **{name: choices[name] for name in OF_BODIES}}
    bound = replace(
        request,
        pair=pair,
        options=replace(acting.request.options, effects=effects),
        neglected={},
        turned_on={},
    )
    changes = request.center_distance_change
    nominal, coarse = (pair_contact(pair, choice.plan, cache, rough, changes) for rough in (False, True))
    return CondensedPair(
        checked_request(bound, check_size=False, neglect=False), CondensedContacts.of(nominal, coarse)
    )
