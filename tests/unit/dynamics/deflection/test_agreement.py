"""Bodies and tables agree: the last tables are exact where the meshes run."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from sliced_face import sliced_database
from two_stage_scenes import two_stages

from dynamics.deflection import Deflection, deflect
from dynamics.deflection.agreement import CLOSEST, PASSES, TOLERANCE, _with_knots, in_agreement
from dynamics.settings.load_case import LoadCase

CASES = (LoadCase("drive"), LoadCase("less", factor=0.4), LoadCase("coast", direction="coast"))
POSITIONS = 3


@dataclass
class SlicedContact:
    """The contact of a mesh in closed form; it remembers its knots."""

    knots: list[list[float]] = field(default_factory=list)

    def table(self, misalignments: list[float]) -> Any:
        self.knots.append(list(misalignments))
        forces = (300.0, 1000.0, 3000.0, 9000.0)
        return sliced_database(tuple(misalignments), positions=6, forces=forces).force_table()


def agreed(scene: Any, cases: tuple[LoadCase, ...] = CASES) -> tuple[Any, dict[str, SlicedContact]]:
    contacts: Any = {mesh.name: SlicedContact() for mesh in scene.meshes}
    first = deflect(scene, cases, POSITIONS)
    return in_agreement(scene, cases, POSITIONS, contacts, first), contacts


def misalignments(deflection: Deflection, mesh: int) -> list[float]:
    return [case.meshes[mesh].misalignment for case in deflection.cases]


def test_every_mesh_runs_at_a_knot_of_its_table():
    scene = two_stages()
    result, contacts = agreed(scene)
    assert result.reached and result.change <= TOLERANCE and result.passes < PASSES
    for k, mesh in enumerate(scene.meshes):
        last = np.array(contacts[mesh.name].knots[-1])
        for m in misalignments(result.deflection, k):
            assert np.min(np.abs(last - m)) <= TOLERANCE * max(abs(m), 1e-6)


def test_a_load_case_alone_runs_as_among_others():
    """Its tables are about its own misalignment and reach to that of the scene, where rest begins."""
    alone, _ = agreed(two_stages(), CASES[:1])
    among, _ = agreed(two_stages())
    assert alone.reached
    for k in range(2):
        expected = pytest.approx(misalignments(among.deflection, k)[0], rel=2e-4)
        assert misalignments(alone.deflection, k)[0] == expected


def test_it_is_the_balance_on_a_fine_table():
    scene = two_stages()
    result, _ = agreed(scene)
    low = min(min(misalignments(result.deflection, k)) for k in range(2)) - 1e-6
    high = max(max(misalignments(result.deflection, k)) for k in range(2)) + 1e-6
    table = SlicedContact().table(list(np.linspace(low, high, 41)))
    fine = replace(scene, meshes=tuple(replace(mesh, table=table) for mesh in scene.meshes))
    expected = deflect(fine, CASES, POSITIONS)
    for k in range(2):
        assert misalignments(result.deflection, k) == pytest.approx(misalignments(expected, k), rel=2e-4)


def test_without_contact_over_the_face_there_is_nothing_to_agree():
    first = deflect(two_stages(), CASES, POSITIONS)
    result = in_agreement(two_stages(), CASES, POSITIONS, {}, first)
    assert (result.deflection, result.passes, result.change) == (first, 1, 0.0)


def test_a_closer_knot_takes_the_place_of_the_one_before():
    near = 0.5 * CLOSEST
    assert _with_knots([0.0, 1e-6], [1e-6 + near, 2e-6]) == [0.0, 1e-6 + near, 2e-6]
