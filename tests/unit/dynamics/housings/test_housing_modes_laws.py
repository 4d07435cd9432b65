"""Reduced housings against closed forms and the whole mesh: frequencies, statics, response, damping."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp
from lattice_meshes import box, tube
from scipy.sparse.linalg import ArpackNoConvergence, eigsh, spsolve
from skfem import Basis, BilinearForm, ElementTetP2, ElementVector, MeshTet2
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity
from surface_motions import normal_displacement

from dynamics.errors import InputError, SolveError
from dynamics.housings import (
    Bore,
    Box,
    Foot,
    Material,
    MeshedHousing,
    ModalDamping,
    Mount,
    Plane,
    ReducedHousing,
    Ring,
    SeatBore,
    receptance,
)
from dynamics.housings import free_modes as free_modes_module
from dynamics.housings.assembled_housing import (
    AssembledHousing,
    _independent_freedoms,
    assemble,
    mass_and_stiffness,
)
from dynamics.housings.free_modes import ModeStatus, free_modes
from dynamics.housings.reduction import reduce_housing
from dynamics.housings.rigid_body import rigid_body
from dynamics.housings.supports import mean_motion

STEEL = Material(210e9, 0.3, 7850.0)
WITHOUT_CONTRACTION = replace(STEEL, poissons_ratio=0.0)
SPEED = math.sqrt(210e9 / 7850.0)
OUTER, BORE, LENGTH = 0.12, 0.08, 0.1
FIXED = Foot("base", Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)))
SEAT = SeatBore("seat", Bore((0.0, 0.0, LENGTH / 2.0), (0.0, 0.0, 1.0), BORE, LENGTH))
UPPER = SeatBore("upper", Bore((0.0, 0.0, 0.075), (0.0, 0.0, 1.0), BORE, 0.05))


def housing(**changes) -> MeshedHousing:
    tubular = MeshedHousing(tube(OUTER, BORE, LENGTH, (12, 1, 2)), STEEL, (UPPER,), (FIXED,), modes=20)
    return replace(tubular, **changes)


@cache
def reduced(**changes) -> ReducedHousing:
    return reduce_housing(housing(**changes))


def loose_frequencies(mesh, material, modes) -> np.ndarray:
    """Elastic frequencies of a free body without bores."""
    freedoms = _independent_freedoms(mesh.points, ())
    nodal, stiffness = mass_and_stiffness(mesh, material)
    mass = sp.csr_array(sp.kron(nodal, sp.eye_array(3)))
    none, force = sp.csr_array(mass.shape), sp.csr_array(sp.eye_array(mass.shape[0], format="csr")[:1])
    rigid = freedoms.rigid(mesh.points, mesh.points.mean(axis=0))
    body = rigid_body(mesh.points, nodal)
    whole = AssembledHousing(freedoms, mass, stiffness, (none, none), force, (), rigid, body)
    modes = free_modes(whole, modes)
    assert modes.rigid_ratio < 1e-3
    return modes.frequency


def relative(found, expected) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def nearest(frequencies: np.ndarray, expected: float) -> float:
    return float(np.abs(frequencies / expected - 1.0).min())


def test_mass_and_stiffness_equal_the_vector_element_of_scikit_fem():
    mesh = tube(OUTER, BORE, LENGTH, (6, 1, 2))
    basis = Basis(MeshTet2(mesh.points.T, mesh.tetrahedra.T), ElementVector(ElementTetP2()), intorder=4)
    number = np.empty(mesh.freedoms, dtype=int)
    number[(3 * mesh.tetrahedra[:, :, None] + np.arange(3)).reshape(-1, 30).T] = basis.element_dofs
    nodal, stiffness = mass_and_stiffness(mesh, STEEL)
    mass = STEEL.density * BilinearForm(lambda u, v, _: dot(u, v)).assemble(basis)[number][:, number]
    assert abs(sp.kron(nodal, sp.eye_array(3)) - mass).max() < 1e-12 * abs(mass).max()
    expected = linear_elasticity(*STEEL.lame).assemble(basis)[number][:, number]
    assert abs(stiffness - expected).max() < 1e-12 * abs(expected).max()


def test_a_clamped_tube_without_contraction_stretches_at_a_quarter_wave():
    assert nearest(reduced(material=WITHOUT_CONTRACTION).frequency, SPEED / (4.0 * LENGTH)) < 5e-3


def test_a_free_tube_twists_at_half_a_wave_and_has_six_rigid_motions():
    free = reduced(feet=())
    assert nearest(free.frequency, math.sqrt(STEEL.lame[1] / STEEL.density) / (2.0 * LENGTH)) < 5e-3
    assert np.count_nonzero(free.frequency == 0.0) == 6
    assert 0.0 <= free.checks.rigid_frequency < 1e-3
    assert free.checks.solve < 1e-9


def test_frequencies_converge_with_the_fourth_power_of_the_size():
    """Of quadratic elements; from above."""
    wave = SPEED / (4.0 * 0.4)
    feet, material = (FIXED,), WITHOUT_CONTRACTION
    errors = []
    for cells in (1, 2, 4):
        mesh = tube(0.06, 0.03, 0.4, (8, 1, cells))
        seat = replace(SEAT, bore=Bore((0.0, 0.0, 0.2), (0.0, 0.0, 1.0), 0.03, 0.4))
        found = reduce_housing(MeshedHousing(mesh, material, (seat,), feet, modes=12)).frequency
        errors.append(float((found / wave - 1.0)[np.abs(found / wave - 1.0).argmin()]))
    assert errors[0] > errors[1] > errors[2] > 0.0
    assert math.log2(errors[1] / errors[2]) > 3.5


def test_a_slender_cantilever_bends_as_a_beam():
    outer, bore, length = 0.03, 0.02, 0.8
    mesh = tube(outer, bore, length, (8, 1, 36))
    seat = SeatBore("tip", Bore((0.0, 0.0, length / 2.0), (0.0, 0.0, 1.0), bore, length))
    found = reduce_housing(MeshedHousing(mesh, WITHOUT_CONTRACTION, (seat,), (FIXED,), modes=4)).frequency
    gyration = math.sqrt(outer**2 + bore**2) / 4.0
    expected = 1.875104**2 / (2.0 * math.pi) * SPEED * gyration / length**2
    assert found[:2] == pytest.approx(expected, rel=5e-3)


def test_a_free_square_plate_vibrates_as_published():
    """13.468, 19.596, 24.271: thin plate, Poisson's ratio 0.3 (Leissa, NASA SP-160, table 4.79)."""
    side, thickness = 0.5, 0.005
    plate = box((side, side, thickness), (16, 16, 1))
    found = loose_frequencies(plate, STEEL, 3)
    bending = STEEL.youngs_modulus * thickness**2 / (12.0 * STEEL.density * (1.0 - 0.3**2))
    assert found * 2.0 * math.pi * side**2 / math.sqrt(bending) == pytest.approx(
        [13.468, 19.596, 24.271], rel=5e-3
    )


def test_a_free_box_without_contraction_stretches_at_half_a_wave():
    found = loose_frequencies(box((0.3, 0.2, 0.1), (4, 3, 2)), WITHOUT_CONTRACTION, 12)
    assert nearest(found, SPEED / 0.6) < 5e-3


@pytest.mark.parametrize(
    "seat", [UPPER, SEAT, replace(UPPER, ring=Ring.RIGID)], ids=["upper", "whole bore", "rigid ring"]
)
def test_static_deflection_of_a_seat_is_that_of_the_whole_mesh(seat):
    chosen = (replace(seat, motions=6),)
    whole = assemble(housing(seats=chosen))
    direct = whole.seats @ spsolve(sp.csc_array(whole.stiffness), whole.seats.T.toarray())
    found = receptance(reduced(seats=chosen), np.zeros(1))[0, :6].real
    assert relative(found, direct) < 1e-9


def test_response_of_seats_and_surface_is_that_of_the_whole_mesh_with_the_residual_alone():
    whole, small, loss = assemble(housing()), reduced(), 1e-7
    small = replace(small, damping=loss * small.stiffness)
    frequencies = np.linspace(0.1, 0.7, 12) * small.frequency[-1]
    nodes = np.unique(housing().mesh.surface)
    rows = (3 * nodes[:, None] + np.arange(3)).ravel()
    with_residual, without = (receptance(small, frequencies, residual=on) for on in (True, False))
    off = {True: [], False: []}
    surface = []
    for number, frequency in enumerate(frequencies):
        omega = 2.0 * math.pi * frequency
        dynamic = whole.stiffness * (1.0 + 1j * omega * loss) - omega**2 * whole.mass
        motion = spsolve(sp.csc_array(dynamic), whole.seats.T.toarray().astype(complex))
        seat = whole.seats @ motion
        for on, found in ((True, with_residual), (False, without)):
            off[on].append(np.linalg.norm(found[number, :5] - seat) / np.linalg.norm(seat))
        exact = whole.freedoms.motion[rows] @ motion
        found = (small.surface.motion @ with_residual[number]).reshape(len(rows), -1)
        surface.append(np.linalg.norm(found - exact) / np.linalg.norm(exact))
    assert max(off[True]) < 0.01
    assert max(surface) < 0.01
    assert max(off[False]) > 0.05


def test_a_free_housing_responds_as_the_whole_mesh():
    whole, small = assemble(housing(feet=())), reduced(feet=(), damping=ModalDamping((0.0,)))
    frequencies = np.array([0.3, 0.7]) * small.frequency[-1]
    found = receptance(small, frequencies)
    for frequency, response in zip(frequencies, found, strict=True):
        dynamic = whole.stiffness - (2.0 * math.pi * frequency) ** 2 * whole.mass
        exact = whole.seats @ spsolve(sp.csc_array(dynamic), whole.seats.T.toarray())
        assert np.linalg.norm(response[:5] - exact) < 0.01 * np.linalg.norm(exact)


def test_matrices_are_symmetric_and_responses_reciprocal():
    """Between all motions of two seats, at a resonance too."""
    lower = SeatBore("lower", Bore((0.0, 0.0, 0.025), (0.0, 0.0, 1.0), BORE, 0.05), motions=3)
    two = reduced(seats=(UPPER, lower), feet=())
    found = receptance(two, np.array([500.0, two.frequency[7]]))[:, :8]
    assert relative(found, found.transpose(0, 2, 1)) < 1e-9
    for matrix in (two.mass, two.stiffness, two.damping):
        assert np.array_equal(matrix, matrix.T)


def test_mass_center_and_inertia_are_those_of_a_hollow_cylinder():
    body = reduce_housing(housing(mesh=tube(OUTER, BORE, LENGTH, (24, 1, 2)))).body
    squares = (OUTER**2 + BORE**2) / 4.0
    mass = math.pi / 4.0 * (OUTER**2 - BORE**2) * LENGTH * STEEL.density
    across = mass * (3.0 * squares + LENGTH**2) / 12.0
    assert body.mass == pytest.approx(mass, rel=1e-5)
    assert body.center == pytest.approx([0.0, 0.0, LENGTH / 2.0], abs=1e-9)
    assert body.inertia == pytest.approx(np.diag([across, across, mass * squares / 2.0]), rel=2e-5, abs=1e-9)


@pytest.mark.parametrize("ring", list(Ring))
def test_seats_and_surface_follow_a_rigid_motion(ring):
    """The mass of the coordinates that move the seats as one body is that of the body."""
    free = reduced(feet=(), seats=(replace(UPPER, ring=ring, motions=6),))
    assert free.checks.seat_rigid < 1e-12
    rigid = np.eye(len(free.mass))[:, :6]
    assert free.stiffness[:, :6] == pytest.approx(
        np.zeros((len(free.mass), 6)), abs=1e-7 * free.stiffness.max()
    )
    assert rigid.T @ free.mass @ rigid == pytest.approx(about_seat(free), rel=1e-9, abs=1e-9 * free.body.mass)
    arm = free.surface.points - free.seats[0].position
    turned = free.surface.motion[:, :, 5]
    assert turned == pytest.approx(np.cross([0.0, 0.0, 1.0], arm), abs=1e-8 * OUTER)


def about_seat(free: ReducedHousing) -> np.ndarray:
    """Mass matrix of a rigid body for motions of its seat, whose axes are those of the mesh."""
    offset = free.body.center - free.seats[0].position
    skew = np.cross(np.eye(3), offset)  # rows: axis x offset
    coupling = free.body.mass * skew
    square = offset @ offset * np.eye(3) - np.outer(offset, offset)
    inertia = free.body.inertia + free.body.mass * square
    return np.block([[free.body.mass * np.eye(3), coupling.T], [coupling, inertia]])


def test_the_motion_of_a_seat_is_weighted_by_area():
    """u_x = z^2 over a bore of length l and radius r about c, on layers of unequal length.

    x = c^2 + l^2/12, tilt_y = 2 c (l^2/12)/(l^2/12 + r^2/2): the wall neither moves along z nor shears.
    """
    mesh = tube(OUTER, BORE, LENGTH, (8, 1, 2))
    level = np.interp(mesh.points[:, 2], [0.0, LENGTH / 2.0, LENGTH], [0.0, LENGTH / 5.0, LENGTH])
    uneven = replace(mesh, points=np.column_stack([mesh.points[:, :2], level]))
    field = np.zeros((len(level), 3))
    field[:, 0] = level**2
    found = mean_motion(uneven, SEAT.bore, np.array(SEAT.bore.position)) @ field.ravel()
    middle, spread = LENGTH / 2.0, LENGTH**2 / 12.0
    tilt = 2.0 * middle * spread / (spread + BORE**2 / 8.0)
    assert found == pytest.approx([middle**2 + spread, 0.0, 0.0, 0.0, tilt, 0.0], rel=1e-3, abs=1e-12)


@pytest.mark.parametrize(("low", "high"), [(0.1, 0.5), (0.15, 0.95), (0.3, 0.6)])
def test_a_seat_ends_where_its_length_says_and_not_with_an_element(low, high):
    """The law of the whole bore on a part of it, which cuts two layers of elements."""
    mesh = tube(OUTER, BORE, LENGTH, (8, 1, 4))
    field = np.zeros((len(mesh.points), 3))
    field[:, 0] = mesh.points[:, 2] ** 2
    middle, length = 0.5 * (low + high) * LENGTH, (high - low) * LENGTH
    x, y, _ = SEAT.bore.position
    part = replace(SEAT.bore, position=(x, y, middle), length=length)
    found = mean_motion(mesh, part, np.array(part.position)) @ field.ravel()
    spread = length**2 / 12.0
    tilt = 2.0 * middle * spread / (spread + BORE**2 / 8.0)
    assert found == pytest.approx([middle**2 + spread, 0.0, 0.0, 0.0, tilt, 0.0], rel=1e-3, abs=1e-12)
    along = mesh.points[part.nodes(mesh), 2]
    assert along.min() >= low * LENGTH - 0.01 * BORE and along.max() <= high * LENGTH + 0.01 * BORE


def test_a_rigid_ring_is_stiffer():
    soft, stiff = (
        receptance(reduced(seats=(replace(UPPER, ring=r),)), np.zeros(1))[0, :5].real for r in Ring
    )
    assert np.linalg.eigvalsh(soft - stiff)[0] > -1e-9 * np.abs(soft).max()
    assert stiff[0, 0] < 0.99 * soft[0, 0]


def spring(stiffness: float) -> Mount:
    return Mount(tuple(map(tuple, np.diag(3 * [stiffness] + 3 * [stiffness * OUTER**2]).tolist())))


def test_stiff_mounts_are_a_fixed_foot_and_soft_ones_carry_a_rigid_body():
    stiff = reduced(feet=(replace(FIXED, mount=spring(1e14)),))
    assert stiff.frequency[:6] == pytest.approx(reduced().frequency[:6], rel=1e-3)
    soft = reduced(feet=(replace(FIXED, mount=spring(1e5)),))
    assert nearest(soft.frequency, math.sqrt(1e5 / soft.body.mass) / (2.0 * math.pi)) < 1e-3
    assert nearest(soft.frequency, reduced(feet=()).frequency[6]) > 1e-3  # its foot is rigid


def test_mounts_that_hold_one_direction_leave_five_rigid_motions():
    vertical = Mount(((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1e6)))
    assert np.count_nonzero(reduced(feet=(replace(FIXED, mount=vertical),)).frequency == 0.0) == 5


def test_material_loses_half_its_factor_and_nothing_in_mounts():
    assert reduced().damping_ratio == pytest.approx(0.005)
    free = reduced(feet=())
    assert free.damping_ratio[:6] == pytest.approx(0.0)
    assert free.damping_ratio[6:] == pytest.approx(0.005)
    soft = reduced(feet=(replace(FIXED, mount=spring(1e5)),))
    assert soft.damping_ratio[:6].max() < 1e-3 * soft.damping_ratio[-1]


def test_damping_by_mode_is_what_the_reduced_matrices_have():
    small = reduced(damping=ModalDamping((0.01, 0.02)))
    circular, shape = small.modes
    damping = shape.T @ small.damping @ shape
    expected = np.diag(2.0 * np.append([0.01], np.full(len(circular) - 1, 0.02)) * circular)
    assert relative(damping, expected) < 1e-9


def test_named_points_move_as_the_surface_and_normals_point_outward():
    place = (OUTER / 2.0, 0.0, LENGTH)
    small = reduced(feet=(), points=Points({"top": place}))
    (point,) = small.points
    assert point.position == pytest.approx(place)
    number = int(np.linalg.norm(small.surface.points - np.array(place), axis=1).argmin())
    assert np.array_equal(point.motion, small.surface.motion[number])
    normal, area = normal_displacement(small.surface)
    assert area.sum() == pytest.approx(
        math.pi * (OUTER + BORE) * LENGTH + math.pi / 2 * (OUTER**2 - BORE**2), rel=1e-3
    )
    assert area @ normal[:, 2] == pytest.approx(0.0, abs=1e-9)  # a closed surface that moves along z
    top = small.surface.points[small.surface.triangles][..., 2].min(axis=1) > LENGTH - 1e-9
    assert normal[top, 2] == pytest.approx(1.0, abs=1e-7)


class Points(dict):
    """Points, as a key of the cache."""

    def __hash__(self) -> int:
        return hash(tuple(self.items()))


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"seats": ()}, "seats"),
        ({"seats": (UPPER, UPPER)}, "seats[1].name"),
        ({"seats": (UPPER, replace(UPPER, name="same"))}, "seats"),
        ({"seats": (replace(UPPER, bore=replace(UPPER.bore, diameter=0.09)),)}, "seats[0].bore.diameter"),
        # a wall that faces outward
        ({"seats": (replace(UPPER, bore=replace(UPPER.bore, diameter=OUTER)),)}, "seats[0].bore.diameter"),
        (
            {"seats": (replace(UPPER, bore=replace(UPPER.bore, position=(0.01, 0.0, 0.075))),)},
            "seats[0].bore.diameter",
        ),
        ({"feet": (Foot("base", Plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))),)}, "feet[0].face.point"),
        ({"feet": (Foot("base", Box((1.0, 1.0, 1.0), (2.0, 2.0, 2.0))),)}, "feet[0].face.low"),
        ({"feet": (FIXED, replace(FIXED, name="again"))}, "feet.again"),
        ({"points": {"far": (1.0, 0.0, 0.0)}}, "points.far"),
        ({"modes": 100000}, "modes"),
        ({"modes": 600}, "modes"),
    ],
)
def test_what_is_not_on_the_mesh_is_refused_by_name(changes, field):
    with pytest.raises(InputError) as caught:
        reduce_housing(housing(**changes))
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("status", "complaint"),
    [(ModeStatus.ITERATION_LIMIT, "19 of 20 modes"), (ModeStatus.ILL_CONDITIONED, "1.0e-03, above 1e-06")],
)
def test_modes_that_did_not_converge_are_an_error_with_their_residual(status, complaint, monkeypatch):
    """As the solver reports them: deflections by a wrong factor, and a search that ended early."""

    def ended_early(matrix, count, *args, **options):
        square, shape = eigsh(matrix, count, *args, **options)
        raise ArpackNoConvergence("%s", square[:-1], shape[:, :-1])

    if status is ModeStatus.ITERATION_LIMIT:
        monkeypatch.setattr("scipy.sparse.linalg.eigsh", ended_early)
    else:
        exact = free_modes_module._deflections
        monkeypatch.setattr(free_modes_module, "_deflections", lambda *a: (exact(*a)[0], 1e-3))
    assert free_modes(assemble(housing()), 20).status is status
    with pytest.raises(SolveError, match=complaint):
        reduce_housing(housing())
