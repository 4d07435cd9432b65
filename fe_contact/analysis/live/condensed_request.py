"""The condensed bodies of a request: other flanks and alignments follow without a table of their own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fe_contact.analysis.live.condensed_contacts import CondensedContacts
from fe_contact.analysis.live.condensed_lookup import OF_BODIES
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_asked
from fe_contact.geometry import ParallelAxes


def condense(pair: ParallelAxes, acting: Checked, cache: Path | None) -> CondensedPair:
    """Choose model and mesh for a request, and condense both gears with them, coarse meshes too.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Of the bodies, with any flanks.
    acting : Checked
        The request of the same bodies in which everything acts that may act later: by it model and mesh are
        chosen, and the highest load decides the load patches.
    cache : Path, optional
        Directory of flank compliances.

    Raises
    ------
    MeshError, SolveError
        No acceptable mesh.
    """
    decided = decide(acting, cache)
    request, choices = decided.checked.request, decided.checked.decided
    effects = {**acting.request.options.effects, **{name: choices[name] for name in OF_BODIES}}
    bound = replace(
        request,
        pair=pair,
        options=replace(acting.request.options, effects=effects),
        neglected={},
        turned_on={},
    )
    changes = request.center_distance_change
    own, coarse = (pair_contact(pair, decided.plan, cache, rough, changes) for rough in (False, True))
    return CondensedPair(
        check_asked(bound, whole_table=False, spare=False), CondensedContacts.of(own, coarse)
    )
