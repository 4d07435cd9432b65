"""The scenes of a study: the scene file with other numbers, and tables of other flanks on one compliance."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from dynamics.scene import Scene
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.condensed_request import condensed_pair
from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.housings import reduced_in
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.problems import BadInput, ServiceError
from lineofaction.gearbox.schemas.faults import faults_of
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.study.paths import Place, mesh_of_case, with_value
from model_studies import LeftOut

if TYPE_CHECKING:
    from dynamics.housings import ReducedHousing

Json = dict[str, Any]
Key = tuple[tuple[str, float], ...]
SolidKey = tuple[tuple[BoundaryModel, ...], ...]


@dataclass(frozen=True)
class VariedScene:
    """A scene whose numbers are replaced; `dynamics.study.Scenes`.

    Attributes
    ----------
    written : str
        The scene as JSON, its cases written out.
    databases : mapping of str to SteDatabase
        By name of the mesh.
    places : mapping
        Of every factor, where it stands in the scene.
    home : str
        Folder of the caches.
    """

    written: str
    databases: Mapping[str, SteDatabase]
    places: Mapping[str, tuple[Place, ...]]
    home: str

    def scene(self, values: Mapping[str, float]) -> Scene:
        """Return the scene at values of the factors; raises `LeftOut` where there is none."""
        try:
            inputs = self.inputs(values)
            databases = self._databases_of(inputs, self.expensive(values))
            return dynamic_scene(inputs, databases, self._reduced(inputs))
        except (ServiceError, FeContactError) as error:
            raise LeftOut(str(error)) from error

    def expensive(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return the values of factors that change flanks, and so tables."""
        return {name: values[name] for name in self._of_flanks}

    def inputs(self, values: Mapping[str, float]) -> SceneInput:
        """Return the scene file at values of the factors; raises `BadInput`."""
        table = copy.deepcopy(self._table)
        for name, value in values.items():
            for place in self.places[name]:
                with_value(table, place, value)
        return scene_of_json(table)

    @cached_property
    def _tables(self) -> dict[Key, Mapping[str, SteDatabase]]:
        """The tables made last, by the values of the flanks."""
        return {}

    @cached_property
    def _housings(self) -> dict[SolidKey, Mapping[str, ReducedHousing]]:
        """The housings reduced last, by what decides them."""
        return {}

    def _reduced(self, inputs: SceneInput) -> Mapping[str, ReducedHousing]:
        """Return the reductions of the solids; those made last are kept."""
        key = inputs.housings, inputs.shafts, inputs.bushings, inputs.rolling_bearings
        if key not in self._housings:
            self._housings.clear()
            self._housings[key] = reduced_in(inputs, Path(self.home))
        return self._housings[key]

    @cached_property
    def _table(self) -> Json:
        return dict(json.loads(self.written))

    @cached_property
    def _of_flanks(self) -> tuple[str, ...]:
        return tuple(name for name, at in self.places.items() if any(mesh_of_case(p) is not None for p in at))

    @cached_property
    def _condensed(self) -> dict[str, CondensedPair]:
        """Gears with their compliance, of the meshes whose flanks change."""
        inputs = scene_of_json(self._table)
        changed = {mesh_of_case(place) for name in self._of_flanks for place in self.places[name]}
        return {mesh.name: self._bodies(mesh) for k, mesh in enumerate(inputs.meshes) if k in changed}

    def _bodies(self, mesh: Any) -> CondensedPair:
        """Fetch or compute the compliance of a mesh."""
        pair, effects = gear_pair(mesh.case), dict(mesh.case.effects)
        cache = Path(self.home) / "compliance"
        found = condensed_pair(pair, self.databases[mesh.name], effects, cache, compute=True)
        assert found is not None
        return found

    def _databases_of(self, inputs: SceneInput, values: Mapping[str, float]) -> Mapping[str, SteDatabase]:
        """Return the tables at values of the flanks; those made last are kept."""
        key = tuple(values.items())
        if not key:
            return self.databases
        if key not in self._tables:
            self._tables.clear()
            self._tables[key] = {**self.databases, **self._other_flanks(inputs)}
        return self._tables[key]

    def _other_flanks(self, inputs: SceneInput) -> dict[str, SteDatabase]:
        """Solve the contact of other flanks at all loads of the tables, support loads too."""
        tables = {}
        for mesh in inputs.meshes:
            if mesh.name not in self._condensed:
                continue
            known, bodies = self.databases[mesh.name], self._condensed[mesh.name]
            assert mesh.case is not None
            pair = gear_pair(mesh.case)
            force = np.union1d(known.force, known.support_force)
            torques = np.asarray(pair.torque(force[force <= bodies.largest_load * (1.0 + 1e-9)]))
            at = float(known.misalignment[0]), float(known.center_distance_change[0])
            tables[mesh.name] = bodies.table(pair, torques, *at)
        return tables


def scene_of_json(table: Json) -> SceneInput:
    """Return the scene in plain JSON; raises `BadInput`."""
    try:
        # strict models take JSON's lists for tuples only from text
        return SceneInput.model_validate_json(json.dumps(table))
    except ValidationError as error:
        raise BadInput(faults_of(error, SceneInput)) from None
