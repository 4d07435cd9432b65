"""A pair on the discretization of its table and on rougher ones, each with what it assembled kept.

Flanks, loads and alignments change from question to question; bodies and positions do not, so that the
compliance between the candidates is assembled once on every discretization.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from fe_contact.analysis.estimates.table_sample import TableSample
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.contact import ContactModel, with_gaps
from fe_contact.contact.plain_touch import Touch
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class CondensedContacts:
    """One pair at one center distance."""

    fine: PairContact
    """As the table had it."""
    plane: PairContact | None
    """Without the correction for a finite width; None if there is none."""
    sliced: PairContact | None
    """In half the slices; None in the plane."""
    coarse: PairContact | None
    """On the coarse meshes; None if their compliance is not at hand."""
    patched: PairContact
    """Without the correction, under the load patches of the coarse meshes."""

    @classmethod
    def of(cls, nominal: PairContact, coarse: PairContact | None) -> CondensedContacts:
        """Take the rougher discretizations that need no other bodies from the pair itself."""
        made = nominal.plan.discretization
        return cls(
            replace(nominal, varied=True),
            nominal.in_plane_strain if made.corrected else None,
            nominal.in_slices(made.coarse_slices) if made.slices > 1 else None,
            coarse,
            nominal.in_plane_strain.in_coarse_patches,
        )

    def with_flanks(self, pair: ParallelAxes) -> CondensedContacts:
        """Return the same bodies with other flanks; what is assembled is shared.

        In the same slices the flanks touch alike on all bodies: it is found once.
        """
        touches: dict[bytes, Touch] = {}

        def alike(contact: PairContact) -> PairContact:
            return replace(contact, pair=pair, touches=touches)

        return CondensedContacts(
            alike(self.fine),
            self.plane and alike(self.plane),
            self.sliced and replace(self.sliced, pair=pair),
            self.coarse and alike(self.coarse),
            alike(self.patched),
        )

    def touch(self, model: ContactModel, sample: TableSample) -> None:
        """Find where the flanks touch at all positions of a table: for all bodies in the same slices."""
        nominal, positions = self.fine, sample.position[sample.rows]
        touch = with_gaps(nominal.pair, nominal.candidates(model, sample.position), model).touch
        nominal.touches.update(
            {positions.tobytes(): touch.rows(sample.rows), sample.position.tobytes(): touch}
        )

    def keep(self, model: ContactModel, position: FloatArray, rows: IntArray) -> None:
        """Keep the compliance of some of the positions that are assembled by itself."""
        if self.fine.cached_problem(model, position[rows]) is None:
            self.fine.keep_rows(model, position, rows)

    def at_distance(self, change: float) -> CondensedContacts:
        """Return the same bodies at a distance larger by `change` in m; nothing is assembled there yet."""
        pair = self.fine.pair.at_center_distance(self.fine.pair.center_distance + change)
        nominal = replace(self.fine, pair=pair, _problems={})
        coarse = None if self.coarse is None else replace(self.coarse, pair=pair, _problems={})
        return CondensedContacts.of(nominal, coarse)

    def assemble(self, model: ContactModel, sample: TableSample) -> None:
        """Assemble what is not kept yet: all positions of a table, and those that are solved again."""
        everywhere = self.fine.candidates(model, sample.position)
        self.fine.assemble(model, everywhere)
        positions = sample.position[sample.rows]
        if self.plane is not None and self.plane.cached_problem(model, positions) is None:
            self.plane.assemble(model, everywhere.rows(sample.rows))
        for other in (self.sliced, self.coarse, self.patched):
            if other is not None:
                other.assemble(model, other.candidates(model, positions))
