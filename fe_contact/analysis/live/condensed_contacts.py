"""A pair on the discretization of its table and on rougher ones, for live answers with errors.

The compliance of the bodies is known; a live answer changes flanks, loads and alignments. The candidates of
contact and the compliance between them depend on bodies, center distance and positions alone, so every
discretization assembles them once and keeps them. Answers on the rougher discretizations give the errors of
discretization; these are solved at a sample of the table's positions, `sample.rows`.
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
    """One pair at one center distance, on the discretizations that an answer and its errors need."""

    fine: PairContact
    """The pair on the discretization of the table, which the answer itself is solved on."""
    plane: PairContact | None
    """The pair without the correction for the finite face width; None if there is no such correction."""
    sliced: PairContact | None
    """The pair in fewer slices over the face; None for a model in the plane."""
    coarse: PairContact | None
    """The pair on the coarse meshes; None if their compliance was not computed."""
    patched: PairContact
    """The pair without the correction for the finite face width, under the wider load patches of the coarse
    meshes.
    """

    @classmethod
    def of(cls, nominal: PairContact, coarse: PairContact | None) -> CondensedContacts:
        """Return the contacts of a pair; the coarse meshes alone are other bodies, and have to be given."""
        discretization = nominal.plan.discretization
        return cls(
            fine=replace(nominal, varied=True),  # flanks will vary, so tilts over the face are assembled too
            plane=nominal.in_plane_strain if discretization.corrected else None,
            sliced=nominal.in_slices(discretization.coarse_slices) if discretization.slices > 1 else None,
            coarse=coarse,
            patched=nominal.in_plane_strain.in_coarse_patches,
        )

    def with_flanks(self, pair: ParallelAxes) -> CondensedContacts:
        """Return the bodies with other flanks; they share the assembled compliance.

        Where flanks touch does not depend on the bodies. The contacts in the same slices share one record of
        it, which `touch` fills; other slices do not fit that record.
        """
        touches: dict[bytes, Touch] = {}

        def in_same_slices(contact: PairContact) -> PairContact:
            return replace(contact, pair=pair, touches=touches)

        return CondensedContacts(
            fine=in_same_slices(self.fine),
            plane=None if self.plane is None else in_same_slices(self.plane),
            sliced=None if self.sliced is None else replace(self.sliced, pair=pair),
            coarse=None if self.coarse is None else in_same_slices(self.coarse),
            patched=in_same_slices(self.patched),
        )

    def touch(self, model: ContactModel, sample: TableSample) -> None:
        """Record the touching points of the flanks at all positions of a table, and at those of the sample.

        Call it on the result of `with_flanks`: all its contacts in the same slices read this record.
        """
        nominal, positions = self.fine, sample.position[sample.rows]
        touch = with_gaps(nominal.pair, nominal.candidates(model, sample.position), model).touch
        # A record is found by the bytes of its positions.
        nominal.touches.update(
            {positions.tobytes(): touch.rows(sample.rows), sample.position.tobytes(): touch}
        )

    def keep(self, model: ContactModel, position: FloatArray, rows: IntArray) -> None:
        """Keep the fine compliance of the positions `rows` under a key of their own, if it is not yet kept.

        To solve these positions alone then assembles nothing. `position` are all positions of the table.
        """
        if self.fine.cached_problem(model, position[rows]) is None:
            self.fine.keep_rows(model, position, rows)

    def at_distance(self, change: float) -> CondensedContacts:
        """Return the bodies at a center distance larger by `change`, m, with nothing assembled yet.

        Assembled compliances (`_problems`) depend on the center distance, so they are not shared.
        """
        pair = self.fine.pair.at_center_distance(self.fine.pair.center_distance + change)
        nominal = replace(self.fine, pair=pair, _problems={})
        coarse = None if self.coarse is None else replace(self.coarse, pair=pair, _problems={})
        return CondensedContacts.of(nominal, coarse)

    def assemble(self, model: ContactModel, sample: TableSample) -> None:
        """Assemble missing compliances: of the fine pair at all positions, of others at the sample's."""
        candidates = self.fine.candidates(model, sample.position)
        self.fine.assemble(model, candidates)
        positions = sample.position[sample.rows]
        if self.plane is not None and self.plane.cached_problem(model, positions) is None:
            # Without the correction slices and patches are the same, and so are the candidates.
            self.plane.assemble(model, candidates.rows(sample.rows))
        for other in (self.sliced, self.coarse, self.patched):
            if other is not None:  # other slices or patches have candidates of their own
                other.assemble(model, other.candidates(model, positions))
