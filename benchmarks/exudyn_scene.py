"""A scene of one spur pair rebuilt in Exudyn from bodies, springs and loads, the mesh as an element."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from dynamics.assembly.assemble import System, assemble
from dynamics.bearings import Bushing
from dynamics.engines.mesh_element import MeshElement, mesh_element
from dynamics.errors import InputError, SolveError
from dynamics.integrators import static_equilibrium
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.loads import TimeLaw
from dynamics.meshes.flank_force import FlankLaws, flank_force
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.technique import table_at
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, IntArray
from host import cpu_seconds

Drive = Callable[[float], tuple[float, float]]
"""Angle (rad) and speed (rad/s) of the driver about +z at a time."""

Force = Callable[[Any, float, int, Any, Any], FloatArray]
Jacobian = Callable[[Any, float, int, Any, Any, float, float], FloatArray]
PLANAR = ("x", "y", "rotation")
REBUILT = (
    *("shafts", "gears", "discs", "meshes", "drives", "bushings", "loads"),
    *("duration", "effects", "outputs", "integration", "on_violation", "quantity"),
)
SOLVERS = ("GeneralizedAlpha", "TrapezoidalIndex2", "RK44", "DOPRI5")


@dataclass(frozen=True)
class PlanarMesh:
    """A mesh between two bodies with the freedoms x, y and the rotation about +z."""

    element: MeshElement
    """Used at `misalignment` and `center_distance_change`."""
    direction: tuple[float, float]
    """Unit vector along which the driver pushes the driven gear."""
    sense: int
    """+1 or -1: in which the driver turns about +z."""
    internal: bool = False
    """One of the gears is a ring gear."""
    misalignment: float = 0.0
    center_distance_change: float = 0.0
    """`misalignment`, `center_distance_change`: Operating point of the table, m."""

    @property
    def gradient(self) -> FloatArray:
        """Derivative of the transmission error in (x, y, angle) of driver and driven gear, (6,)."""
        n, (r1, r2) = np.array(self.direction), self.element.base_radius
        driven = self.sense * (-r2 if self.internal else r2)
        return np.array([*n, self.sense * r1, *-n, driven])

    @property
    def turn(self) -> float:
        """Base pitches per radian of the driver about +z."""
        return self.sense * self.element.teeth[0] / (2.0 * np.pi)

    def laws(self) -> FlankLaws:
        """Return the force law for the compiled look-up."""
        table = table_at(self.element.table, self.misalignment, self.center_distance_change)
        damping, reach = np.array([self.element.damping]), np.array([self.element.reach])
        return by_address(FlankLaws(pack_tables([table]), damping, reach))


def add_gear_mesh(mbs: Any, mesh: PlanarMesh, nodes: tuple[Any, Any], drive: Drive | None = None) -> Any:
    """Add the mesh to an Exudyn system as an object on the nodes of two bodies.

    Raises `InputError`: exudyn is not installed.

    Parameters
    ----------
    nodes : (node index, node index)
        Of the driver and the driven gear: `NodeRigidBody2D`. With a `drive` the driver's is a `NodePoint2D`.
    drive : callable or None
        The driver's rotation, if it is imposed and no coordinate.

    Returns
    -------
    exudyn.ObjectIndex
        An `ObjectGenericODE2` without mass, with the force and its derivatives as user functions.
    """
    items = _exudyn().itemInterface
    force, jacobian = user_functions(mesh, drive)
    columns = 6 if drive is None else 5
    zero = np.zeros((columns, columns))
    return mbs.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=zero,
            stiffnessMatrix=zero,
            dampingMatrix=zero,
            forceVector=np.zeros(columns),
            forceUserFunction=force,
            jacobianUserFunction=jacobian,
        )
    )


def user_functions(mesh: PlanarMesh, drive: Drive | None = None) -> tuple[Force, Jacobian]:
    """Return the two functions of the mesh that Exudyn calls.

    Force: (system, t, item, q, v) to the generalized forces on the coordinates q, which are x, y, angle of
    the driver and of the driven gear, without the driver's angle if there is a `drive`. Jacobian: (system, t,
    item, q, v, a, b) to -a df/dq - b df/dv at constant position.
    """
    law, gradient = mesh.laws(), mesh.gradient if drive is None else np.delete(mesh.gradient, 2)
    facts = np.array([mesh.element.position_offset, mesh.turn, mesh.gradient[2]])
    imposed, values, hint = np.zeros(2), np.zeros(3), np.zeros(1, dtype=np.int64)
    outer = np.outer(gradient, gradient)

    def evaluate(t: float, q: Any, v: Any) -> None:
        coordinate, rate = np.asarray(q), np.asarray(v)
        if drive is not None:
            imposed[0], imposed[1] = drive(t)
        angle = coordinate[2] if drive is None else imposed[0]
        _evaluate(law, facts, gradient, angle, imposed, coordinate, rate, hint, values)

    def force(_mbs: Any, t: float, _item: int, q: Any, v: Any) -> FloatArray:
        evaluate(t, q, v)
        return np.asarray(-values[0] * gradient)

    def jacobian(_mbs: Any, t: float, _item: int, q: Any, v: Any, stiff: float, viscous: float) -> FloatArray:
        evaluate(t, q, v)
        return np.asarray((stiff * values[1] + viscous * values[2]) * outer)

    return force, jacobian


def _exudyn() -> Any:
    """Return the package; raises `InputError`: it is not installed."""
    try:
        import exudyn as package  # noqa: PLC0415 - no dependency
        import exudyn.itemInterface  # noqa: PLC0415
    except ImportError:
        raise InputError("exudyn", None, "installed", "Install it: pip install exudyn") from None
    return package


@compiled
def _evaluate(
    law: FlankLaws,
    facts: FloatArray,
    gradient: FloatArray,
    angle: float,
    imposed: FloatArray,
    coordinate: FloatArray,
    rate: FloatArray,
    hint: IntArray,
    values: FloatArray,
) -> None:
    """Write force, stiffness and viscosity into `values`; `imposed` is what the coordinates do not hold."""
    deflection, speed = facts[2] * imposed[0], facts[2] * imposed[1]
    for k in range(gradient.size):
        deflection += gradient[k] * coordinate[k]
        speed += gradient[k] * rate[k]
    x = facts[0] + facts[1] * angle
    force, _, tangent, viscous, interval = flank_force(law, 0, x, deflection, speed, hint[0])
    values[0], values[1], values[2], hint[0] = force, tangent, viscous, interval


@dataclass(frozen=True)
class _PlanarRun:
    """The result of a run in Exudyn."""

    time: FloatArray
    """Time, s. Shape (T,)."""
    dynamic_transmission_error: FloatArray
    """Dynamic transmission error, m. Shape (T,)."""
    cpu_seconds: float
    """CPU seconds of the time integration alone."""


def run_in_exudyn(scene: Scene, *, solver: str = "GeneralizedAlpha", step: float = 5e-6) -> _PlanarRun:
    """Run `scene` in Exudyn from its static equilibrium at constant speed.

    Raises `InputError`: exudyn is not installed, or the scene holds what is not rebuilt; `SolveError`: there
    is no equilibrium to start from, or Exudyn gives up.

    Parameters
    ----------
    scene : Scene
        One mesh of spur gears that move in their plane, a rigid drive of constant speed on the driver's
        shaft, isotropic bushings, constant loads.
    solver : str
        One of Exudyn's by its name there: `SOLVERS`.
    step : float
        Time step in s; fixed.

    Returns
    -------
    PlanarRun
        On the scene's output grid as far as whole steps meet it.
    """
    package = _exudyn()
    if solver not in SOLVERS:
        raise InputError("solver", solver, f"one of {', '.join(SOLVERS)}")
    system = assemble(scene)
    drive_speed = _check(system)
    start = static_equilibrium(system)
    if not start.status.usable:
        raise SolveError("no static equilibrium at t = 0")
    sense = system.kinematics.mesh_sense[0]
    mesh = _planar_mesh(system, sense)
    container = package.SystemContainer()
    mbs = container.AddSystem()
    nodes = _bodies(
        mbs, system, dict(zip(system.freedoms.name, start.displacement, strict=True)), drive_speed
    )
    add_gear_mesh(mbs, mesh, nodes, lambda t: (drive_speed * t, drive_speed))
    coordinates = package.OutputVariableType.Coordinates
    sensors = [
        mbs.AddSensor(
            package.itemInterface.SensorNode(
                nodeNumber=node, storeInternal=True, outputVariableType=coordinates
            )
        )
        for node in nodes
    ]
    mbs.Assemble()
    began = cpu_seconds()
    solved = mbs.SolveDynamic(
        _settings(package, system, step), solverType=getattr(package.DynamicSolverType, solver)
    )
    seconds = cpu_seconds() - began
    if not solved:
        raise SolveError(f"Exudyn's {solver} did not finish with steps of {step:g} s")
    return _observed(mesh, drive_speed, [mbs.GetSensorStoredData(sensor) for sensor in sensors], seconds)


def _check(system: System) -> float:
    """Refuse what is not rebuilt; return the drive's speed."""
    scene = system.scene
    if len(scene.meshes) != 1 or len(scene.shafts) != 2:
        raise InputError("meshes", len(scene.meshes), "one, of two shafts")
    beyond = [name for name in system.freedoms.name if name.rpartition(".")[2] not in PLANAR]
    if beyond:
        raise InputError("effects", beyond, "off", "Only motion in the plane is rebuilt.")
    if len(system.elements) != 1:
        bound = "1: the driving flank"
        raise InputError(
            "elements", len(system.elements), bound, "Leave out coast flanks and curved supports."
        )
    plain = (None, None, None)
    for bushing in scene.bushings:
        if (bushing.stiffness, bushing.damping, bushing.preload) != plain:
            raise InputError("bushings", bushing.name, "isotropic, without preload")
    for part in fields(scene):
        if part.name not in REBUILT and getattr(scene, part.name) != part.default:
            raise InputError(part.name, len(getattr(scene, part.name)), "left out")
    for index, load in enumerate(scene.loads):
        _constant_value(f"loads[{index}].torque", load.torque)
    drive = scene.drives[0]
    if not drive.rigid or drive.shaft != scene.gear(scene.meshes[0].driver).shaft:
        raise InputError("drives[0]", drive.name, "rigid, on the driver's shaft")
    return _constant_value("drives[0].speed", drive.speed)


def _constant_value(field: str, law: object) -> float:
    if not isinstance(law, TimeLaw) or len(set(law.value)) != 1:
        raise InputError(field, law, "constant")
    return float(law.value[0])


def _planar_mesh(system: System, sense: int) -> PlanarMesh:
    scene_mesh = system.scene.meshes[0]
    gears = [system.scene.gear(name) for name in (scene_mesh.driver, scene_mesh.driven)]
    return PlanarMesh(
        mesh_element(system.scene, scene_mesh.name),
        (float(system.lines[0].force[0]), float(system.lines[0].force[1])),
        sense,
        any(gear.internal for gear in gears),
        scene_mesh.misalignment,
        scene_mesh.center_distance_change,
    )


def _bodies(mbs: Any, system: System, start: dict[str, float], speed: float) -> tuple[Any, Any]:
    """Add both rotors, driver first, on their bushings and under their loads; return their nodes."""
    items, scene, mesh = _exudyn().itemInterface, system.scene, system.scene.meshes[0]
    ground = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=mbs.AddNode(items.NodePointGround())))
    nodes = []
    for side, gear in enumerate((mesh.driver, mesh.driven)):
        shaft = scene.shaft_index(scene.gear(gear).shaft)
        rotor, name = system.rotors[shaft], scene.shafts[shaft].name
        at = [start.get(f"{name}.{freedom}", 0.0) for freedom in PLANAR]
        shaft_speed = float(system.kinematics.ratio[shaft][0]) * speed
        if side == 0:
            node = mbs.AddNode(items.NodePoint2D(referenceCoordinates=[0.0, 0.0], initialCoordinates=at[:2]))
            mbs.AddObject(items.ObjectMassPoint2D(mass=rotor.inertia.mass, nodeNumber=node))
        else:
            node = mbs.AddNode(
                items.NodeRigidBody2D(initialCoordinates=at, initialVelocities=[0.0, 0.0, shaft_speed])
            )
            body = {"mass": rotor.inertia.mass, "inertia": rotor.inertia.polar, "nodeNumber": node}
            mbs.AddObject(items.ObjectRigidBody2D(**body))
            marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=2))
            torque = sum(load.torque.value[0] for load in scene.loads if load.shaft == name)
            mbs.AddLoad(
                items.LoadCoordinate(markerNumber=marker, load=-math.copysign(torque, shaft_speed * torque))
            )
        _add_bushings(mbs, [ground, mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node))], rotor.bushings)
        nodes.append(node)
    return nodes[0], nodes[1]


def _add_bushings(mbs: Any, markers: list[Any], bushings: tuple[Bushing, ...]) -> None:
    """Add springs and dampers from the ground to the axis, with the damping a run uses."""
    for bushing in bushings:
        mbs.AddObject(
            _exudyn().itemInterface.ObjectConnectorCartesianSpringDamper(
                markerNumbers=markers,
                stiffness=[bushing.radial_stiffness, bushing.radial_stiffness, 0.0],
                damping=[bushing.radial_damping, bushing.radial_damping, 0.0],
            )
        )


def _settings(package: Any, system: System, step: float) -> Any:
    """Return the settings of a run of fixed steps that keeps the output grid in memory."""
    settings = package.SimulationSettings()
    settings.timeIntegration.endTime = system.scene.duration
    settings.timeIntegration.numberOfSteps = math.ceil(system.scene.duration / step * (1.0 - 1e-9))
    settings.timeIntegration.automaticStepSize = False
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = 1.0 / system.sampling.rate
    return settings


def _observed(mesh: PlanarMesh, speed: float, stored: list[FloatArray], seconds: float) -> _PlanarRun:
    """Return the transmission error from the coordinates of both nodes."""
    driver, driven = (np.asarray(rows) for rows in stored)
    gradient, time = mesh.gradient, driver[:, 0]
    angle = gradient[2] * speed * time
    error = driver[:, 1:3] @ gradient[:2] + angle + driven[:, 1:4] @ gradient[3:]
    return _PlanarRun(time, error, seconds)
