"""A pair whose bodies are condensed: other flanks, loads and alignments are a matter of contact alone.

The compliance of a gear depends on its macro geometry, not on its flank modifications, the load or the
alignment. With it in memory a new curve costs the gaps and the contact, no finite elements.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fe_contact.analysis.pair_contact import PairContact, bodies_are_kept, pair_contact
from fe_contact.analysis.position_nodes import unmeasured_nodes
from fe_contact.analysis.request import Checked, Request
from fe_contact.analysis.request_check import check_asked
from fe_contact.analysis.solved_table import assembled_table
from fe_contact.analysis.table_axes import axis, load_levels
from fe_contact.analysis.table_places import table_places
from fe_contact.effects import FaceLoadDistribution, FiniteWidth
from fe_contact.effects.bore_seat import BoreSeatElasticity
from fe_contact.effects.corner_contact import CornerContact
from fe_contact.effects.thin_rim import ThinRim
from fe_contact.errors import InputError
from fe_contact.geometry import FlankModification, ParallelAxes
from fe_contact.planning import Accuracy, make_plan
from fe_contact.planning.plan import LARGEST_SUPPORT
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.types import FloatArray

PLANE_POSITIONS, FACE_POSITIONS = 192, 64
"""Of a base pitch, equally spaced: the compliance at them is assembled once for all flanks. In the plane
handovers are steep, and positions cost little."""
MOST_ROWS, FEWEST_POSITIONS = 4096, 16
"""Of longer periods, which repeat the positions in every base pitch."""
OF_BODIES = (FaceLoadDistribution.name, FiniteWidth.name, ThinRim.name, BoreSeatElasticity.name)
"""Effects that decide which finite elements there are."""


@dataclass(frozen=True)
class CondensedPair:
    """Gears with their compliance, as a table had them.

    Attributes
    ----------
    checked : Checked
        What the table was asked, its model bound to the bodies it had.
    contact : PairContact
        At the nominal centre distance; keeps what was assembled for the positions.
    """

    checked: Checked
    contact: PairContact

    @property
    def largest_load(self) -> float:
        """Highest normal force in N for which the load patches were laid out."""
        return LARGEST_SUPPORT * float(self.checked.request.load[-1])

    def table(self, pair: ParallelAxes, torques: FloatArray, misalignment: float = 0.0) -> SteDatabase:
        """Solve the contact of the same bodies with other flanks.

        Parameters
        ----------
        pair : GearPair or InternalGearPair
            The same macro geometry with any flank modification.
        torques : ndarray, shape (F,)
            On the driving gear in N m, increasing, > 0.
        misalignment : float
            Growth of the gap over the common face width in the plane of action, m.

        Returns
        -------
        SteDatabase
            At equally spaced positions and the nominal centre distance; errors are not estimated, corner
            contact is on unless the table's case switched it off. It has no support loads, so no forces for
            dynamics. The receipt counts the points at which a contact strip outgrew its load patch.

        Raises
        ------
        InputError
            Other bodies, loads beyond those of the table, or flanks that its model cannot hold.
        """
        self._refuse_other_bodies(pair)
        load = self._levels(pair, torques)
        checked = self._checked(pair, load, misalignment)
        most = FACE_POSITIONS if checked.model.across_face else PLANE_POSITIONS
        count = int(np.clip(MOST_ROWS // checked.model.period, FEWEST_POSITIONS, most))
        nodes = unmeasured_nodes(count, load.size)
        plan = replace(self.contact.plan, load=load, positions=count)
        contact = replace(self.contact, pair=pair, plan=plan)
        places = table_places(checked.request.scene, checked.request.choices, contact)
        solved = [
            place.solve_pitches(nodes.position, load, np.arange(places.period)) for place in places.places
        ]
        beyond = sum(int(solution.beyond.sum()) for _, solution in solved)
        ledger = [{"name": entry.name, "on": entry.on} for entry in checked.ledger]
        table = assembled_table(checked.request, places, nodes, solved, [])
        receipt = {"beyond_load_patches": beyond, "plan": plan.to_json()}
        return replace(table, metadata=Metadata(effect_ledger=ledger, receipt=receipt))

    def _refuse_other_bodies(self, pair: ParallelAxes) -> None:
        """Refuse gears or a centre distance that this compliance is not of."""
        known = self.checked.request.pair
        if _plain(pair) != _plain(known):
            bound = "of the gears and the centre distance of the table, but for flank modifications"
            raise InputError("pair", "another", bound, "Analyse the other pair first.")

    def _levels(self, pair: ParallelAxes, torques: FloatArray) -> FloatArray:
        """Return the loads as normal forces; refuse what outgrows the load patches."""
        load = load_levels(pair, torques, None)
        if load[-1] > self.largest_load * (1.0 + 1e-9):
            most = float(pair.torque(np.array([self.largest_load]))[0])
            bound = f"at most {most:.6g}: {LARGEST_SUPPORT:g} times the highest load of the table"
            advice = "Analyse the case with a higher load."
            raise InputError(f"torques[{load.size - 1}]", float(torques[-1]), bound, advice)
        return load

    def _checked(self, pair: ParallelAxes, load: FloatArray, misalignment: float) -> Checked:
        """Compose the model of other flanks on the bodies there are."""
        request = self.checked.request
        asked = request.effects.get(CornerContact.name, "auto")
        # always on: what a tip edge does is then in every curve, and one compliance serves them all
        corners = "on" if asked == "auto" else asked
        return check_asked(
            replace(
                request,
                pair=pair,
                load=load,
                misalignment=axis("misalignments", [misalignment]),
                center_distance_change=np.zeros(1),
                effects={**request.effects, CornerContact.name: corners},
            ),
            whole_table=False,
            spare=False,
        )


def _plain(pair: Any) -> Any:
    """Return a pair, external or internal, without its flank modifications."""
    none = FlankModification()
    pinion, wheel = (replace(gear, modification=none) for gear in (pair.pinion, pair.wheel))
    return replace(pair, pinion=pinion, wheel=wheel)


def condensed_pair(
    pair: ParallelAxes, database: SteDatabase, effects: dict[str, str], cache: Path | None
) -> CondensedPair | None:
    """Fetch the compliance with which a table was computed; None if it is not in the cache.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Of the table's case.
    database : SteDatabase
        Its receipt and ledger say which bodies it had.
    effects : dict
        Choices of effects of the case.
    cache : Path, optional
        Directory of flank compliances.
    """
    receipt, ledger = database.metadata.receipt, database.metadata.effect_ledger
    choice, plane_stress = receipt["choice"], receipt["plan"]["model"] == "plane_stress"
    on = {entry["name"]: bool(entry["on"]) for entry in ledger if isinstance(entry, dict)}
    bodies = {name: "on" if on[name] else "off" for name in OF_BODIES}
    accuracy = Accuracy(
        None, None, choice["level"], "plane_stress" if plane_stress else "auto", None, "minimal"
    )
    request = Request(
        pair,
        np.asarray(database.force),
        accuracy,
        np.zeros(1),
        np.zeros(1),
        {**effects, **bodies},
        database.period if database.period > 1 else None,
    )
    checked = check_asked(request, whole_table=False, spare=False)
    plan = make_plan(pair, request.load, accuracy, checked.model, choice["level"], choice["slices"])
    if not bodies_are_kept(pair, plan, cache):
        return None
    return CondensedPair(checked, pair_contact(pair, plan, cache))
