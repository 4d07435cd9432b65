"""A tolerance, its floor, and the errors that a plan predicts beside it, in parts and in um."""

import dataclasses
import math

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import AllowedError, FlankModification, Gear, GearPair, Material, SteDatabase, analyze
from fe_contact.analysis.position_nodes import adaptive_nodes
from fe_contact.analysis.request.model_choice import TRIED_WORK, Decision, decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.run_plan import plan_run, predicted_designs
from fe_contact.geometry import InternalGearPair
from fe_contact.geometry.ring_gear import RingGear
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.cost_model import effort
from fe_contact.planning.discretization import SLICE_ORDER
from fe_contact.planning.plan import CLOSEST, FACE_NODES, FLOOR_SHARE, PLANE_NODES, POSITION_SHARE, NodeRule
from fe_contact.ste.curve_errors import METHOD, PLANE, SOURCES
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK

FACTOR = 3.0


def pair(
    helix: float = 0.0, width: float = 12e-3, material: Material | None = None, **modification
) -> GearPair:
    more = {} if material is None else {"material": material}
    modified = FlankModification(**modification)
    gear = Gear(20, 2e-3, width, 20e-3, helix_angle=helix, modification=modified, **more)
    mate = dataclasses.replace(gear, helix_angle=-helix, modification=FlankModification())
    return GearPair(gear, mate, 40e-3 / math.cos(helix))


def stated(table: SteDatabase) -> tuple[float, float, float]:
    """Largest relative error, and the largest of mean and peak-to-peak in m."""
    means, ripples = ([f(force=float(x)) for x in table.force] for f in (table.mean, table.peak_to_peak))
    relative = max(one.error / abs(one.value) for one in (*means, *ripples))
    return relative, max(one.error for one in means), max(one.error for one in ripples)


@pytest.mark.parametrize(
    "gears",
    [
        pair(),
        pair(tip_relief=8e-6, tip_relief_length=1e-3),
        pair(0.3),
        pair(0.3, tip_relief=6e-6, tip_relief_length=1e-3, helix_crowning=4e-6),
    ],
    ids=["spur", "relieved spur", "helical", "relieved and crowned helical"],
)
def test_a_draft_is_predicted_within_a_factor_3(gears, tmp_path):
    asked = {"torques": [15.0, 40.0], "level": "draft"}
    error = plan_run(gears, *table_request(**asked)).chosen.error
    predicted = error.total, error.mean, error.peak_to_peak
    for expected, measured in zip(predicted, stated(analyze(gears, **asked, cache=tmp_path)), strict=True):
        assert 1.0 / FACTOR < expected / measured < FACTOR


def test_errors_in_um_grow_with_the_load_where_those_in_parts_hardly_do():
    low, high = (
        plan_run(pair(0.15), TableAxes(torques=[torque]), AnalysisOptions(level="draft")).chosen.error
        for torque in (20.0, 80.0)
    )
    for name in ("mean", "peak_to_peak"):
        assert 2.0 < getattr(high, name) / getattr(low, name) < 6.0  # large displacements by the square
    assert 0.5 < high.total / low.total < 1.5


def test_finer_meshes_and_more_slices_err_less_and_by_their_order():
    levels = plan_run(pair(0.3), TableAxes(torques=[40.0]), AnalysisOptions(level="fine")).levels
    for name in ("mean", "peak_to_peak"):
        errors = [getattr(entry.error, name) for entry in levels]
        assert errors == sorted(errors, reverse=True)
    fine = decide(check_request(pair(0.3), TableAxes(torques=[40.0]), AnalysisOptions(level="fine")))
    few, many = (fine.refined("fine", n, fine.plan.nodes, "").mesh.option.error for n in (15, 23))
    assert few.slices / many.slices == pytest.approx((23 / 15) ** SLICE_ORDER)


def test_plane_strain_leaves_out_as_much_whoever_chose_it():
    named = plan_run(pair(), *table_request(torques=[40.0], level="draft", model="plane_strain")).chosen.error
    taken = decide(
        check_request(pair(), TableAxes(torques=[40.0]), AnalysisOptions(tolerance=AllowedError(0.06)))
    ).mesh.option.error
    assert named.bias == taken.bias is not None
    assert named.plane == pytest.approx(taken.plane, rel=1e-9)
    assert taken.reducible > taken.plane > 0.02
    assert named.reducible == named.numerical < 0.01  # no run of the request lowers it
    assert max(named.mean, named.peak_to_peak) < 0.01 * 10e-6  # and it is no error in um


def test_what_slices_cannot_tell_has_no_size():
    ring = RingGear(60, 2e-3, 12e-3, rim_diameter=0.144, tip_diameter=0.117)
    gears = InternalGearPair(Gear(20, 2e-3, 12e-3, 20e-3), ring, 40e-3)
    error = plan_run(gears, TableAxes(torques=[20.0]), AnalysisOptions(level="draft")).chosen.error
    assert (error.mean, error.peak_to_peak) == (None, None)
    assert 0.0 < error.total < 0.02
    assert error.to_json()["mean_m"] is None


def test_positions_follow_a_tolerance_that_is_smaller_than_usual():
    def search(tolerance, helix):
        bound = {} if helix else {"effects": {"finite_width": "on"}}
        return decide(
            check_request(pair(helix), *table_request(torques=[40.0], tolerance=tolerance, **bound))
        ).plan.nodes

    for helix, usual in ((0.0, PLANE_NODES), (0.3, FACE_NODES)):
        assert search(0.05, helix).tolerance == usual.tolerance
        tight = search(0.001, helix)
        assert tight.tolerance == pytest.approx(POSITION_SHARE * 0.001)
        assert tight.maximum > usual.maximum
        assert search(1e-4, helix).tolerance == pytest.approx(max(CLOSEST * usual.tolerance, 5e-5))


def test_what_costs_a_tenth_is_tried_first():
    """A run measures its errors: the corrected plane may do where only three dimensions are expected to."""
    allowed, narrow = 0.002, pair(width=2e-3)
    asked = check_request(narrow, *table_request(normal_forces=[100.0], tolerance=AllowedError(allowed, 0.0)))
    promised, tried = decide(asked), decide(asked, tried=True)
    assert promised.checked.model.across_face
    assert not tried.checked.model.across_face
    error = tried.mesh.option.error.reducible / allowed
    work = tried.mesh.option.effort / promised.mesh.option.effort
    assert error > 1.0
    assert work <= TRIED_WORK
    assert tried.mesh.met is promised.mesh.met
    assert "tried first" in tried.mesh.reason
    assert tried.behind is not None and tried.behind.mesh == promised.mesh
    assert promised.behind is None
    assert predicted_designs(asked, None).across_face, "designs are solved on the mesh that is promised"
    loose = check_request(pair(), TableAxes(torques=[40.0]), AnalysisOptions(tolerance=AllowedError(0.01)))
    assert decide(loose, tried=True).mesh == decide(loose).mesh
    assert decide(loose, tried=True).behind is None


TOLERANCES = np.geomspace(0.05, 5e-4, 14)


def usual_effort(decision: Decision) -> float:
    """Return the work of a mesh with the positions of a run without a tolerance."""
    nodes = FACE_NODES if decision.checked.model.across_face else PLANE_NODES
    plan, request = dataclasses.replace(decision.plan, nodes=nodes), decision.checked.request
    return effort(request.pair, plan, decision.checked.model, request.alignments)


@pytest.mark.law
@pytest.mark.parametrize("width", [2e-3, 12e-3])
@pytest.mark.parametrize("helix_deg", [0.0, 9.0, 25.0])
@pytest.mark.parametrize("relief", [0.0, 12e-6])
def test_a_looser_tolerance_is_never_expected_to_cost_more(width, helix_deg, relief):
    """All passes together; what is expected to miss the tolerance takes a tenth of the next at most."""
    helix, modification = (
        math.radians(helix_deg),
        FlankModification(tip_relief=relief, tip_relief_length=1e-3),
    )
    gears = [
        Gear(z, 2e-3, width, 1e-3 * z, helix_angle=hand * helix, modification=modification)
        for z, hand in ((22, 1), (47, -1))
    ]
    helical = GearPair(*gears, 0.069 / math.cos(helix))
    work = []
    for tolerance in TOLERANCES:
        axes, options = table_request(normal_forces=[80e3 * width], tolerance=AllowedError(tolerance, 0.0))
        decision = decide(check_request(helical, axes, options), tried=True)
        work.append(sum(made.mesh.option.effort for made in decision.passes))
        first, *others = (usual_effort(made) for made in decision.passes)
        assert all(first <= TRIED_WORK * other for other in others)
    assert np.all(np.diff(work) >= -1e-9 * np.array(work[1:]))


NM = 1e-9
VALUES = np.array([0.0, 30.0, -1999.0, 2001.0, 5000.0]) * NM


def quiet_pair() -> GearPair:
    """A crowned pair whose ripple is 1 % of its mean at the rated load."""
    lead = FlankModification(helix_crowning=4e-6)
    gear = Gear(20, 2e-3, 20e-3, 20e-3, helix_angle=0.45, modification=lead)
    mate = dataclasses.replace(gear, helix_angle=-0.45, modification=FlankModification())
    return GearPair(gear, mate, 40e-3 / np.cos(0.45))


def test_the_larger_of_the_part_and_the_floor_is_allowed():
    assert AllowedError().of(VALUES) / NM == pytest.approx([20.0, 20.0, 20.0, 20.01, 50.0])
    assert AllowedError(0.1, 50 * NM).of(VALUES) / NM == pytest.approx([50.0, 50.0, 199.9, 200.1, 500.0])
    assert AllowedError(0.01, 0.0).of(VALUES) / NM == pytest.approx([0.0, 0.3, 19.99, 20.01, 50.0])
    for allowed in (AllowedError(), AllowedError(0.2, 3e-7), AllowedError(0.01, 0.0)):
        assert allowed.of(VALUES) == pytest.approx(allowed.relative * allowed.scale(VALUES), rel=1e-15)

    def allowed(tolerance):
        return check_request(
            quiet_pair(), *table_request(torques=[20.0], tolerance=AllowedError.from_value(tolerance))
        ).request.options.allowed

    assert allowed(0.02) == AllowedError(0.02, 20 * NM)
    assert allowed(AllowedError(0.02, 0.0)) == AllowedError(0.02, 0.0)
    assert allowed(None) == AllowedError(0.01, 0.0)  # a level promises no floor


def test_a_floor_makes_a_quiet_pair_cheaper_and_more_so_the_higher_it_is():
    """The choice of mesh and slices weighs errors by it; a loud table does not see it."""
    pair = quiet_pair()

    def effort(floor, torque):
        asked = check_request(pair, *table_request(torques=[torque], tolerance=AllowedError(0.005, floor)))
        return decide(asked).mesh.option.effort

    quiet = [effort(floor * NM, 20.0) for floor in (0.0, 20.0, 200.0)]
    assert quiet[0] > quiet[1] >= quiet[2]
    assert effort(0.0, 20.0) == effort(1e-4 * NM, 20.0)


def test_positions_are_placed_by_the_floor_of_the_tolerance():
    """Small kinked curves need as many positions as large ones, and none below the floor."""

    def kinked(height):
        return lambda x: (height * np.abs((x[:, None] + 0.3) % 1.0 - 0.5))[None]

    rule = NodeRule(32, 0.002, 768, least_ripple=1e-6)
    large, small = (adaptive_nodes(rule, kinked(height)).position.size for height in (1e-4, 1e-8))
    assert adaptive_nodes(NodeRule(32, 0.002, 768), kinked(1e-8)).position.size == large
    assert large > small == 32
    asked = check_request(quiet_pair(), *table_request(torques=[20.0], tolerance=AllowedError(0.01, 30 * NM)))
    assert decide(asked).plan.nodes.least_ripple == pytest.approx(FLOOR_SHARE * 3e-6)
    assert (
        decide(
            check_request(quiet_pair(), TableAxes(torques=[20.0]), AnalysisOptions(level="draft"))
        ).plan.nodes.least_ripple
        == 0.0
    )


def test_positions_leave_the_same_part_of_a_floor_by_every_tolerance():
    """A looser tolerance with the same floor asks for no more positions of a quiet pair."""
    for usual in (PLANE_NODES, FACE_NODES):
        rules = [usual.for_tolerance(AllowedError(t, 20 * NM)) for t in (0.2, 0.03, 0.01, 3e-3, 1e-4)]
        left = [rule.tolerance * rule.least_ripple for rule in rules]
        assert left == pytest.approx([FLOOR_SHARE * POSITION_SHARE * 20 * NM] * 5)


def test_the_receipt_holds_the_measured_errors_against_it(tmp_path):
    """Met is what every stated error keeps, and not what was expected of the mesh."""
    spur = GearPair(*[Gear(20, 2e-3, 12e-3, 20e-3)] * 2, 40e-3)
    asked = {"torques": [5.0, 50.0], "model": "plane_strain", "positions": 16, "cache": tmp_path}

    def kept(allowed, **more):
        table = analyze(spur, tolerance=allowed, **asked, **more)
        receipt = table.metadata.receipt
        assert receipt["choice"]["met"] == receipt["tolerance"]["met"]
        return table, receipt["tolerance"]

    table, loose = kept(AllowedError(0.5, 0.0))
    asks = (table.mean, table.peak_to_peak)
    values = [[ask(torque=torque) for torque in asked["torques"]] for ask in asks]
    sizes = np.array([[estimate.value for estimate in row] for row in values])
    parts = dict(zip(SOURCES, table.curve_error[..., 0, 0][:, [MEAN, PEAK_TO_PEAK]] / sizes, strict=True))
    assert not parts[PLANE].any()  # the caller chose the plane, whose part is a bias
    whole = np.array([[estimate.error for estimate in row] for row in values]) / sizes
    at_nodes = np.sqrt(whole**2 - parts[METHOD] ** 2).max()
    assert loose["used_at_nodes"] == pytest.approx(at_nodes / 0.5, rel=1e-3)
    # of the loads between, an interval states its error at its lower end and of the lesser size at both
    between = (parts["force"] * sizes)[:, 0] / sizes.min(axis=1)
    assert between.max() > 0.1 * at_nodes
    assert loose["used"] == pytest.approx(np.hypot(at_nodes, between.max()) / 0.5, rel=1e-3)
    assert loose["lasting"] == pytest.approx(parts[METHOD].max(), rel=1e-3)
    assert (loose["relative"], loose["floor_m"], loose["met"]) == (0.5, 0.0, True)
    tight = AllowedError(1e-4, 0.0)
    assert kept(tight)[1]["met"] is False
    assert kept(AllowedError(1e-4, 1e-6))[1]["met"] is True
    unknown = {"used": None, "used_at_nodes": None, "met": None}
    assert kept(tight, receipt="minimal")[1] == {"relative": 1e-4, "floor_m": 0.0} | unknown
    level = analyze(spur, level="draft", **asked).metadata.receipt
    assert "tolerance" not in level
