"""Forces by time, speed and angle, fixed in space or turning: closed forms of linear systems."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dynamics import simulate
from dynamics.assembly.assemble import assemble
from dynamics.bearings import Bushing
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.joints import Coupling, ImposedRotation
from dynamics.linearize import forced_response
from dynamics.loads import AppliedForce, BySpeed, Orders, SpeedCurve, TimeLaw, Unbalance
from dynamics.periodic.period_map import periodic_problem
from dynamics.periodic.shooting import find_orbit
from dynamics.periodic.steady_states import motion
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import Inertia, Shaft

SPEED, POLAR, TORSION, DAMPING, TORQUE = 100.0, 0.3, 2e4, 40.0, 30.0
ORDER, AMPLITUDE, PHASE, MEAN = (2.0, 0.5), (1.0, 0.4), (0.3, -0.7), 0.25
MASS, STIFFNESS = 10.0, 2e6


def train(sense: float = 1.0) -> Scene:
    """Return a driven shaft and, behind a torsional spring, one with a torque of orders of its angle."""
    return Scene(
        shafts=(
            Shaft("motor", 0.2, (0.0, 0.0, 0.0), Inertia(1.0, 0.1, 0.1)),
            Shaft("load", 0.2, (0.0, 0.0, 0.2), Inertia(1.0, POLAR, 0.1)),
        ),
        gears=(),
        meshes=(),
        drives=(ImposedRotation("motor", "motor", TimeLaw.constant(sense * SPEED)),),
        couplings=(Coupling("spring", "motor", "load", TORSION, DAMPING, 0.2),),
        forces=(
            AppliedForce(
                "ripple",
                "load",
                0.1,
                moment=(0.0, 0.0, TORQUE),
                course=Orders("motor", ORDER, AMPLITUDE, PHASE, MEAN),
            ),
        ),
        duration=1.5,
        outputs=Outputs(displacements=True),
        integration=Integration(tolerance=1e-10),
    )


def twist(time: np.ndarray, sense: float = 1.0) -> np.ndarray:
    """Return the steady twist of the spring, rad."""
    whole = np.full(time.size, MEAN * TORQUE / TORSION)
    for order, amplitude, phase in zip(ORDER, AMPLITUDE, PHASE, strict=True):
        w = order * SPEED
        factor = TORQUE * amplitude / (TORSION - POLAR * w**2 + 1j * w * DAMPING)
        whole += np.real(factor * np.exp(1j * (w * time + sense * phase)))
    return whole


def rotor(*forces: AppliedForce, unbalances: tuple[Unbalance, ...] = ()) -> Scene:
    """Return a rotor in the middle of its bearings."""
    bearings = [
        Bushing(n, "rotor", z, 0.5 * STIFFNESS, damping_ratio=0.02) for n, z in (("a", 0.0), ("b", 0.4))
    ]
    return Scene(
        shafts=(Shaft("rotor", 0.4, (0.0, 0.0, 0.0), Inertia(MASS, 0.05, 0.4)),),
        gears=(),
        meshes=(),
        drives=(ImposedRotation("motor", "rotor", TimeLaw.constant(300.0)),),
        bushings=tuple(bearings),
        forces=forces,
        unbalances=unbalances,
        duration=0.2,
        outputs=Outputs(displacements=True),
    )


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_orders_of_torque_twist_a_train_in_response_steady_state_and_run(sense):
    """The angle counts about +z: turned the other way the phases lead instead of lagging."""
    system = assemble(train(sense))
    assert static_equilibrium(system).displacement == pytest.approx([MEAN * TORQUE / TORSION])
    response = forced_response(system, [SPEED], orders=3)
    time = np.linspace(0.0, 0.1, 40)
    waves = response.displacement[0, 0][:, None] * np.exp(1j * SPEED * response.order[:, None] * time)
    assert response.order.tolist() == [0.5, 2.0]
    assert MEAN * TORQUE / TORSION + np.sum(waves.real, axis=0) == pytest.approx(
        twist(time, sense), abs=1e-12
    )
    problem = periodic_problem(system, sense * SPEED, steps_per_cycle=120)
    path = motion(problem, find_orbit(problem, sense * SPEED))
    assert path.displacement[0] == pytest.approx(twist(path.time, sense), abs=2e-8)
    run = simulate(train(sense))
    late = (run.time > 1.2) & (run.time < 1.45)
    assert run.displacement[0, late] == pytest.approx(twist(run.time[late], sense), abs=2e-7)
    assert run.energy.relative < 1e-6


def test_a_turn_given_in_values_goes_through_them():
    values = np.array([3.0, -1.0, 2.0, 0.5, 0.0, 7.0, 1.0, 1.0])
    for count in (8, 7):
        course = Orders.table("rotor", values[:count].tolist())
        angle = 2.0 * math.pi * np.arange(count) / count
        assert course(angle) == pytest.approx(values[:count])
        assert course.turns == 1


def test_a_force_by_the_square_of_speed_that_turns_is_an_unbalance():
    """Along the axis parts add: they stand still."""
    turning = AppliedForce(
        "heavy spot",
        "rotor",
        0.2,
        force=(1e-3 * math.cos(0.3), 1e-3 * math.sin(0.3), 0.0),
        course=BySpeed(SpeedCurve((0.0,), ((0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 1.0, 0.0))), "rotor"),
        turns_with="rotor",
    )
    by_force = forced_response(assemble(rotor(turning)), [200.0, 500.0], orders=2)
    point = rotor(unbalances=(Unbalance("heavy spot", "rotor", 0.2, 1e-3, 0.3),))
    by_mass = forced_response(assemble(point), [200.0, 500.0], orders=2)
    assert by_force.displacement == pytest.approx(by_mass.displacement, rel=1e-12)
    runs = [simulate(scene).displacement for scene in (rotor(turning), point)]
    assert runs[0] == pytest.approx(runs[1], abs=1e-9)


def test_the_first_order_of_its_own_angle_stands_still_in_a_force_that_turns():
    """cos(a + p) (cos a, sin a) is (cos p, -sin p)/2, and a second order."""
    turning = AppliedForce(
        "rub",
        "rotor",
        0.2,
        (100.0, 0.0, 0.0),
        course=Orders("rotor", (1.0,), (1.0,), (0.4,)),
        turns_with="rotor",
    )
    system = assemble(rotor(turning))
    still = 50.0 / STIFFNESS * np.array([math.cos(0.4), -math.sin(0.4)])
    assert static_equilibrium(system).displacement == pytest.approx(still, rel=1e-9)
    assert forced_response(system, [300.0], orders=3).order.tolist() == [2.0]
    problem = periodic_problem(system, 300.0)
    path = motion(problem, find_orbit(problem, 300.0))
    assert np.mean(path.displacement, axis=1) == pytest.approx(still, rel=1e-6)


@pytest.mark.parametrize(
    "course",
    [
        lambda _: TimeLaw((0.0, 0.1), (0.0, 2.0), "smooth"),
        lambda name: BySpeed(SpeedCurve.table([0.0, 400.0], [0.0, 4.0]), name),
        lambda name: Orders(name, (3.0,), (0.5,), (1.0,), 1.5),
    ],
)
@pytest.mark.parametrize("turns_with", [None, "rotor"])
def test_work_is_accounted_for(course, turns_with):
    """Of a force and a moment of all directions, on a rotor that tilts and moves along its axis."""
    force = AppliedForce(
        "all",
        "rotor",
        0.3,
        (30.0, -20.0, 5.0),
        (2.0, 1.0, 3.0),
        course("rotor"),
        turns_with,
    )
    scene = rotor(force)
    held = tuple(replace(bushing, axial_stiffness=STIFFNESS) for bushing in scene.bushings)
    run = simulate(replace(scene, bushings=held))
    assert run.energy.relative < 1e-6
    assert run.energy.turnover > 1e-3


def test_a_force_by_time_starts_at_rest_under_its_first_value():
    step = AppliedForce("belt", "rotor", 0.2, (0.0, 500.0, 0.0), course=TimeLaw((0.0, 0.1), (1.0, 1.0)))
    run = simulate(rotor(step))
    assert run.displacement[1] == pytest.approx(np.full(run.time.size, 500.0 / STIFFNESS), rel=1e-9)


@pytest.mark.parametrize(
    ("order", "field"), [((0.0,), "order[0]"), ((math.pi,), "order[0]"), ((1.0, 2.0), "amplitude")]
)
def test_orders_that_never_repeat_are_refused(order, field):
    with pytest.raises(InputError) as refused:
        Orders("rotor", order, (1.0,), (0.0,))
    assert refused.value.field == field


def test_shafts_that_a_load_names_exist_and_turn():
    ripple = Orders("stator", (2.0,), (1.0,), (0.0,))
    for force, field in (
        (AppliedForce("f", "rotor", 0.1, (1.0, 0.0, 0.0), turns_with="stator"), "forces[0].turns_with"),
        (AppliedForce("f", "rotor", 0.1, (1.0, 0.0, 0.0), course=ripple), "forces[0].course.shaft"),
        (AppliedForce("f", "rotor", 0.5, (1.0, 0.0, 0.0)), "forces[0].position"),
    ):
        with pytest.raises(InputError) as refused:
            rotor(force)
        assert refused.value.field == field
