"""Load patches over the face width."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.contact.face_patch import FaceGrid, FaceLoads, add_compliance, face_loads
from fe_contact.contact.patch import load_vector


def grid(profile: int = 6, layers: int = 4) -> FaceGrid:
    ends = np.array([0.0, *np.cumsum(np.linspace(1.0, 2.0, profile))])
    s = np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1])])) * 1e-3
    z = np.linspace(-1.0, 1.0, layers + 1) ** 3 * 0.3e-2 + np.linspace(-1.0, 1.0, layers + 1) * 0.7e-2
    planes, nodes = np.meshgrid(np.arange(2 * layers + 1), np.arange(2 * profile + 1), indexing="ij")
    freedom = np.where((planes % 2 == 1) & (nodes % 2 == 1), -1, 0)
    freedom[freedom == 0] = np.arange(np.count_nonzero(freedom == 0))
    return FaceGrid(s, z, freedom)


def coordinates(mesh: FaceGrid) -> np.ndarray:
    planes = np.sort(np.concatenate([mesh.z, 0.5 * (mesh.z[1:] + mesh.z[:-1])]))
    where = np.array([np.argwhere(mesh.freedom == k)[0] for k in range(mesh.freedom.max() + 1)])
    return np.column_stack([mesh.s[where[:, 1]], planes[where[:, 0]]])


def loads_of(mesh: FaceGrid, *patches: tuple[float, float, float, float, float]) -> FaceLoads:
    center, half_width, share, low, high = (np.array(column) for column in zip(*patches, strict=True))
    return face_loads(mesh, center[:, None], half_width[:, None], share[:, None], low, high)


def dense(mesh: FaceGrid, *patches: tuple[float, float, float, float, float]) -> np.ndarray:
    loads = loads_of(mesh, *patches)
    result = np.zeros((len(patches), mesh.freedom.max() + 1))
    for p in range(len(patches)):
        used = loads.used[p]
        np.add.at(result[p], loads.nodes[p, :used], loads.forces[p, :used])
    return result


PATCHES = [
    (4e-3, 1e-3, 0.0, -2e-3, 1e-3),
    (2.5e-3, 0.3e-3, 0.0, 0.1e-3, 0.2e-3),
    (8.5e-3, 0.5e-3, 0.7, -1e-2, 1e-2),
    (8.0e-3, 1.0e-3, 1.0, 3e-3, 1e-2),
]


@pytest.mark.parametrize("patch", PATCHES)
def test_resultant_and_moments(patch):
    """Quadratic shape functions carry constants, first moments and pure second moments exactly."""
    mesh = grid()
    center, a, share, low, high = patch
    force, (s, z) = dense(mesh, patch)[0], coordinates(mesh).T
    assert force.sum() == pytest.approx(1.0, abs=1e-12)
    assert force @ s == pytest.approx(center + 0.5 * share * a, rel=1e-12, abs=0.0)
    assert force @ z == pytest.approx(0.5 * (low + high), rel=1e-11, abs=1e-16)
    assert force @ z**2 == pytest.approx((high**3 - low**3) / (high - low) / 3.0, rel=1e-11, abs=0.0)
    variance = a**2 * (1.0 + share) / 4.0  # of the mixture about the patch's middle
    assert force @ (s - center) ** 2 == pytest.approx(variance, rel=1e-9, abs=0.0)


def test_a_box_over_the_whole_face_sums_to_the_plane_patch():
    mesh = grid()
    patch = (4e-3, 1e-3, 0.3, mesh.z[0], mesh.z[-1])
    plane = np.zeros(mesh.s.size)
    first, last = load_vector(mesh.s, *patch[:3], plane)
    plane[:first] = plane[last:] = 0.0
    force = dense(mesh, patch)[0]
    # on the corner profile nodes and mid-side nodes of linear functions of s both must agree
    assert force @ coordinates(mesh)[:, 0] == pytest.approx(plane @ mesh.s, rel=1e-13)
    assert force @ coordinates(mesh)[:, 0] ** 2 == pytest.approx(plane @ mesh.s**2, rel=1e-12)


def test_neighboring_boxes_add_up_to_one():
    mesh = grid()
    whole = dense(mesh, (4e-3, 1e-3, 0.0, -4e-3, 6e-3))[0]
    parts = dense(mesh, (4e-3, 1e-3, 0.0, -4e-3, -1e-3), (4e-3, 1e-3, 0.0, -1e-3, 6e-3))
    assert 0.3 * parts[0] + 0.7 * parts[1] == pytest.approx(whole, abs=1e-14)


def test_a_load_follows_its_contact_line():
    # three patches side by side, each a third of the range with its own place along the profile
    mesh = grid()
    centers, half, share = (
        np.array([[3e-3, 3.4e-3, 3.8e-3]]),
        np.full((1, 3), 1e-3),
        np.array([[0.0, 0.2, 0.4]]),
    )
    loads = face_loads(mesh, centers, half, share, np.array([-3e-3]), np.array([6e-3]))
    found = np.zeros(mesh.freedom.max() + 1)
    np.add.at(found, loads.nodes[0, : loads.used[0]], loads.forces[0, : loads.used[0]])
    bounds = ((-3e-3, 0.0), (0.0, 3e-3), (3e-3, 6e-3))
    parts = dense(mesh, *((centers[0, q], 1e-3, share[0, q], *bounds[q]) for q in range(3)))
    assert found == pytest.approx(parts.mean(axis=0), abs=1e-15)


@pytest.mark.parametrize("teeth", [[0, 0, 0, 0], [-1, -1, 0, 1], [2, 1, 0, -1]])
def test_compliance_is_the_double_product(teeth):
    mesh = grid()
    rng = np.random.default_rng(3)
    freedoms = mesh.freedom.max() + 1
    blocks = rng.normal(size=(3, freedoms, freedoms))
    blocks[0] += blocks[0].T
    loads = loads_of(mesh, *PATCHES)
    lever = np.array([1.0, 0.9, 1.0, 0.8])
    found = np.zeros((4, 4))
    add_compliance(blocks, np.array(teeth), loads, lever, found)
    force = dense(mesh, *PATCHES) * lever[:, None]
    for i in range(4):
        for j in range(4):
            apart = teeth[i] - teeth[j]
            block = np.zeros_like(blocks[0])
            if abs(apart) < 3:
                block = blocks[apart] if apart >= 0 else blocks[-apart].T
            assert found[i, j] == pytest.approx(force[i] @ block @ force[j], rel=1e-10, abs=1e-12)
