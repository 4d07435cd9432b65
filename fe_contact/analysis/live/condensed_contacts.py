"""A pair on the discretization of its table and on rougher ones, each with what it assembled kept.

Flanks, loads and alignments change from question to question; bodies and positions do not, so that the
compliance between the candidates is assembled once on every discretization.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from fe_contact.analysis.estimates.assessed_table import TableSample
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.contact import ContactModel
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.plan import LARGEST_SUPPORT, Plan, wanted_patch

# The error of load patches wider than the contact strips, because the mesh asks for it.
#
# A patch spreads the load of a strip over more of the flank than it has, which shows where the gap changes
# within it: at the knee of a relief above all. Coarse meshes do not tell, as they carry the same patches;
# patches wider still do. Their error is of second order in the width.

WIDER = 1.25
"""Width over that of the run at which the change is measured."""
SEEN = 0.7
"""Of what second order leaves over that change, the part that is counted: the strips are not as narrow as a
point. With it stated errors cover 95 % of the first harmonics of live answers (docs/accuracy.md)."""


def _left_by_patches(pair: ParallelAxes, plan: Plan) -> float:
    """Return the error left over the change to patches `WIDER` times as wide.

    Against patches as wide as the strips of the largest load ask for; 0 where the run has those.
    """
    half_width = wanted_patch(pair, LARGEST_SUPPORT * float(plan.load[-1]))
    if plan.patch.half_width <= half_width:
        return 0.0
    return SEEN * (1.0 - (half_width / plan.patch.half_width) ** 2) / (WIDER**2 - 1.0)


@dataclass(frozen=True)
class CondensedContacts:
    """One pair at one center distance.

    Attributes
    ----------
    own : PairContact
        As the table had it.
    plane : PairContact or None
        Without the correction for a finite width; None if there is none.
    sliced : PairContact or None
        In half the slices; None in the plane.
    coarse : PairContact or None
        On the coarse meshes; None if their compliance is not at hand.
    patched : PairContact or None
        Under wider load patches; None where the patches are as narrow as they need be.
    left_by_patches : float
        Error left over the change to those.
    """

    own: PairContact
    plane: PairContact | None
    sliced: PairContact | None
    coarse: PairContact | None
    patched: PairContact | None
    left_by_patches: float

    @classmethod
    def of(cls, own: PairContact, coarse: PairContact | None) -> CondensedContacts:
        """Take the rougher discretizations that need no other bodies from the pair itself."""
        made = own.plan.discretization
        part = _left_by_patches(own.pair, own.plan)
        return cls(
            own,
            own.in_plane_strain if made.corrected else None,
            own.in_slices(made.coarse_slices) if made.slices > 1 else None,
            coarse,
            own.in_patches(WIDER) if part else None,
            part,
        )

    def with_flanks(self, pair: ParallelAxes) -> CondensedContacts:
        """Return the same bodies with other flanks; what is assembled is shared."""

        def there(contact: PairContact | None) -> PairContact | None:
            return None if contact is None else replace(contact, pair=pair)

        return CondensedContacts(
            replace(self.own, pair=pair),
            there(self.plane),
            there(self.sliced),
            there(self.coarse),
            there(self.patched),
            self.left_by_patches,
        )

    def apart(self, change: float) -> CondensedContacts:
        """Return the same bodies at a distance larger by `change` in m; nothing is assembled there yet."""
        pair = self.own.pair.at_center_distance(self.own.pair.center_distance + change)
        own = replace(self.own, pair=pair, _problems={})
        coarse = None if self.coarse is None else replace(self.coarse, pair=pair, _problems={})
        return CondensedContacts.of(own, coarse)

    def assemble(self, model: ContactModel, sample: TableSample) -> None:
        """Assemble what is not kept yet: all positions of a table, and those that are solved again."""
        everywhere = self.own.candidates(model, sample.position)
        self.own.assemble(model, everywhere)
        candidates = everywhere.rows(sample.rows)
        for rougher in (self.plane, self.coarse):
            if rougher is not None:
                rougher.assemble(model, candidates)
        for other in (self.sliced, self.patched):
            if other is not None:
                other.assemble(model, other.candidates(model, candidates.position))
