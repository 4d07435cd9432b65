"""The surface of a housing by the freedoms of a system: what it does in a mode is what its reduction says."""

import numpy as np
import pytest
from housed_tubes import OFF, mount_of, subject_of, tube_on
from scipy.spatial import cKDTree

from dynamics.assembly.assemble import assemble
from dynamics.housings import receptance
from dynamics.housings.rigid_body import rigid_motions
from dynamics.mechanism.bodies import modal_housing
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.studies import unit_bodies
from lineofaction.gearbox.studies.bodies import HOUSING, Hull
from lineofaction.gearbox.studies.unit_bodies import bodies_of, surface_motion


def amplitudes_move(subject: TabledScene) -> tuple[Hull, np.ndarray]:
    """Return the drawn surface and how it moves per amplitude of the housing, (p, 3, m)."""
    freedom = assemble(subject.scene).freedoms.name
    (written,) = (part for part in bodies_of(subject) if part["kind"] == HOUSING)
    motion = surface_motion(subject, freedom)
    of_housing = [name.startswith("case.") for name in freedom]
    assert not np.any(motion[..., ~np.array(of_housing)]), "shafts move no wall by themselves"
    return Hull.of(written), motion[..., of_housing].astype(float)


@pytest.fixture(scope="module")
def mounted():
    return tube_on(mount_of(2e8))


@pytest.mark.law
@pytest.mark.parametrize("maximum", [2000, 60])
def test_the_surface_by_its_amplitudes_is_that_of_the_reduction(mounted, maximum, monkeypatch):
    """Under forces on the seats, static and beyond the first mode; also where few points are drawn."""
    monkeypatch.setattr(unit_bodies, "MAX_FACETS", maximum)
    subject = subject_of(mounted)
    hull, moved = amplitudes_move(subject)
    assert len(hull.facets) <= maximum
    surface, modal = mounted.surface, modal_housing(subject.scene.housings[0])
    distance, node = cKDTree(surface.points).query(hull.points)
    assert distance.max() < 1e-7, "points that are drawn are points of the mesh"
    over = np.diag([1.0] * 5 + [1.0, -1.0, -1.0, 1.0, -1.0])  # its y and z are turned over
    hertz = [0.0, 1.3 * modal.frequency[0]]
    for frequency, wanted in zip(hertz, receptance(mounted, hertz), strict=True):
        omega = 2.0 * np.pi * frequency
        dynamic = np.diag(modal.stiffness - omega**2) + 1j * omega * modal.damping
        amplitude = np.linalg.solve(dynamic, modal.shape.reshape(10, -1).T)
        expected = surface.motion[node] @ wanted[:, :10] @ over
        scale = np.abs(expected).max(axis=(0, 1))
        np.testing.assert_allclose(moved @ amplitude / scale, expected / scale, atol=2e-6)


@pytest.mark.law
def test_a_housing_on_soft_mounts_moves_rigidly_and_a_bolted_one_bends():
    """Six motions on soft mounts are those of a rigid body; in others walls bend; a bolted foot stands."""
    bent = {}
    for name, mount in {"soft": mount_of(1e4), "bolted": None}.items():
        hull, moved = amplitudes_move(subject_of(tube_on(mount)))
        rigid = rigid_motions(hull.points, hull.points.mean(axis=0)) * [1.0, 1.0, 1.0, 10.0, 10.0, 10.0]
        motion = moved.reshape(len(rigid), -1)
        left = motion - rigid @ np.linalg.lstsq(rigid, motion, rcond=None)[0]
        bent[name] = np.linalg.norm(left, axis=0) / np.linalg.norm(motion, axis=0)
        foot = np.abs(hull.points[:, 2]) < 1e-9
        stands = np.abs(moved[foot]).max() / np.abs(moved).max()
        assert np.count_nonzero(foot) > 8
        assert (stands < 1e-6) == (mount is None), stands
    assert bent["soft"][:6].max() < 1e-3
    assert bent["soft"][6:12].min() > 0.3
    assert bent["bolted"][:6].min() > 0.1


@pytest.mark.law
def test_a_housing_whose_modes_are_neglected_has_no_motion(mounted):
    subject = subject_of(mounted, OFF)
    assert surface_motion(subject, assemble(subject.scene).freedoms.name).shape == (0, 3, 0)
