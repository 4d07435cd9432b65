"""Operating points of a table over misalignment and center distance: one contact problem per point."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.contact import ContactModel, ContactProblem, ContactSolution, Start
from fe_contact.effects import ContactScene, acting, compose, contributed
from fe_contact.types import FloatArray, IntArray
from model_studies.workers import InProcess, Workers


class Derived(Protocol):
    """Rule that gives the base pitches of a long period by derivatives about some of them."""

    def on(self, point: OperatingPoint, position: FloatArray, load: FloatArray) -> FloatArray:
        """Return transmission error and load arm (T P, L, 2) in m at positions (P,) and loads (L,).

        The `point` may have other bodies, slices or patches than those of the table.
        """


@dataclass(frozen=True)
class OperatingPoint:
    """One misalignment at one change of the center distance; all its pitches are solved or `derived`."""

    contact: PairContact
    model: ContactModel
    derived: Derived | None = None

    def solve(
        self,
        position: FloatArray,
        load: FloatArray,
        pitch: IntArray | None = None,
        start: Start | None = None,
    ) -> tuple[ContactProblem, ContactSolution]:
        """Solve positions (P,) at normal forces (L,) in N; `pitch` and `start` as in `PairContact.solve`."""
        return self.contact.solve(self.model, position, load, pitch, start)

    def solve_pitches(
        self, position: FloatArray, load: FloatArray, pitches: IntArray, start: Start | None = None
    ) -> tuple[ContactProblem, ContactSolution]:
        """Solve positions (P,) in each of the base pitches (T,), pitch by pitch: T P rows."""
        if self.model.period == 1:
            return self.solve(position, load, start=start)
        return self.solve(position, load, np.repeat(pitches, position.size), start)


@dataclass(frozen=True)
class OperatingPoints:
    """All operating points of the table, center distance running fastest."""

    shape: tuple[int, int]
    """Numbers of misalignments and center distances."""
    places: tuple[OperatingPoint, ...]
    """Operating points, those of one center distance one after the other. They share its compliance."""
    nominal: PairContact
    """The pair at its nominal center distance, which may be no operating point of the table."""
    workers: Workers = InProcess()  # noqa: RUF009 (frozen)
    """Workers that solve the operating points."""

    @property
    def period(self) -> int:
        """Whole base pitches after which every operating point repeats."""
        return self.places[0].model.period

    @property
    def assessed(self) -> tuple[OperatingPoint, ...]:
        """First, middle and last operating point: by them the positions of the table are chosen."""
        return tuple(self.places[i] for i in self.assessed_indices)

    @property
    def assessed_indices(self) -> tuple[int, ...]:
        """Indices of the assessed operating points among all."""
        last = len(self.places) - 1
        return tuple(sorted({0, last // 2, last}))

    @property
    def in_plane_strain(self) -> OperatingPoints:
        """The same operating points without the correction for the finite width."""
        return self._with_contacts(lambda contact: contact.in_plane_strain)

    @property
    def in_coarse_patches(self) -> OperatingPoints:
        """The same operating points under the load patches of the coarse meshes."""
        return self._with_contacts(lambda contact: contact.in_coarse_patches)

    def on_bodies(self, nominal: PairContact) -> OperatingPoints:
        """Return the operating points over other compliances of the gears, those of `nominal`."""
        points = self._with_contacts(lambda contact: replace(nominal, pair=contact.pair, _problems={}))
        return replace(points, nominal=nominal)

    def on(self, contact: PairContact) -> OperatingPoints:
        """Return the operating points, which are of one center distance, with another contact."""
        return self._with_contacts(lambda _contact: contact)

    def in_slices(self, count: int) -> OperatingPoints:
        """Return the operating points in another number of slices."""
        return self._with_contacts(lambda contact: contact.in_slices(count))

    def _with_contacts(self, change: Callable[[PairContact], PairContact]) -> OperatingPoints:
        """Return the operating points with other contacts; one center distance has one compliance."""
        contacts = {id(point.contact): change(point.contact) for point in self.places}
        points = tuple(replace(point, contact=contacts[id(point.contact)]) for point in self.places)
        return replace(self, places=points)

    def gathered(self, values: list[NDArray[Any]]) -> NDArray[Any]:
        """Stack arrays (P, L, ...) of all operating points into (P, L, M, D, ...)."""
        stacked = np.stack(values, axis=2)
        return stacked.reshape(*stacked.shape[:2], *self.shape, *stacked.shape[3:])


def operating_points(
    scene: ContactScene,
    choices: Mapping[str, str],
    nominal: PairContact,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> OperatingPoints:
    """Return the operating points of a scene.

    Parameters
    ----------
    scene : ContactScene
        Scene with the axes of a table.
    choices : mapping
        Effect name to "on", "off" or "auto".
    nominal : PairContact
        The pair at its nominal center distance.
    workers : Workers
        Workers that solve the operating points.
    """
    _, ledger = compose(scene, choices)
    on = acting(ledger)
    contacts = list(_contacts(nominal, scene.center_distance_change))
    points = []
    for misalignment in scene.misalignment:
        for contact in contacts:
            local_scene = replace(
                scene,
                pair=contact.pair,  # at its center distance
                misalignment=np.array([misalignment]),
                center_distance_change=np.zeros(1),
            )
            points.append(OperatingPoint(contact, contributed(local_scene, on)))
    return OperatingPoints((scene.misalignment.size, len(contacts)), tuple(points), nominal, workers)


def _contacts(nominal: PairContact, changes: FloatArray) -> Iterator[PairContact]:
    """Yield the pair at each center distance: other contact, same gears, same compliance."""
    for change in changes:
        if change == 0.0:
            yield nominal
        else:
            distance = nominal.pair.center_distance + float(change)
            yield replace(nominal, pair=nominal.pair.at_center_distance(distance), _problems={})
