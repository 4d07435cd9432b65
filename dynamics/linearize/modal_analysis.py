"""Modal analysis: natural modes about the loaded equilibrium, whirl modes over speed, critical speeds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bounds.brief import brief
from bounds.plottable import Plottable
from dynamics.assembly.assemble import System, assemble
from dynamics.checks import integer, positive
from dynamics.linearize.campbell import WhirlBranches, whirl_branches
from dynamics.linearize.critical_speeds import CriticalSpeeds, critical_speeds
from dynamics.linearize.flank_cycles import averaged, flank_cycles, resting
from dynamics.linearize.linear_system import LinearSystem, about_running, linearize, require_freedoms
from dynamics.linearize.mode_energy import freedom_parts, spring_parts
from dynamics.linearize.natural_modes import Modes, natural_modes
from dynamics.linearize.operating_speeds import checked_speeds, leading_law, mesh_frequencies
from dynamics.mechanism.shaft_axes import shaft_axes
from dynamics.results.array_file import ArrayFile, stored
from dynamics.results.run_checks import checked_ledger
from dynamics.types import ComplexArray, FloatArray, IntArray, Json
from host import cpu_seconds
from model_studies.record import under_key

MAX_ORDERS = 100  # largest multiple of a mesh frequency
LARGE = 1.0 / 3.0  # share of the energy from which a motion or a spring gives a mode its name
AT_REST = ("frequency", "damping_ratio", "shape", "strain_energy", "kinetic_energy")
"""Fields of `Modes` that an analysis keeps of the modes at rest."""


def resolved_to(system: System, speed: FloatArray, orders: int, highest: float | None) -> float:
    """Return the frequency to resolve, Hz: `highest`, else the highest of the orders at the highest speed."""
    if highest is not None:
        return positive("highest_frequency", highest)
    if system.scene.highest_frequency is not None:
        return system.scene.highest_frequency
    if speed.size and speed[-1] > 0.0:
        top = float(np.max(mesh_frequencies(system, speed[-1:]), initial=0.0))
    else:
        top = system.sampling.mesh_frequency
    return orders * top


@brief
@dataclass(frozen=True)
class ModalAnalysis(ArrayFile, Plottable):
    """Modes of a system about its static equilibrium; fields state unit, meaning and dimensions of arrays.

    n freedoms, p springs, m meshes, S speeds, A whirl modes, C crossings; S = A = C = 0 without speeds.
    Fields of modes at rest are those of `Modes`, fields over speed those of `WhirlBranches` (NaN where a mode
    does not oscillate), fields of crossings with orders those of `CriticalSpeeds`. Points of the axes of
    shafts (`ShaftAxes`): none in files of versions that did not keep them. Points of the surfaces of
    housings: none where no surface moves.
    """

    SCHEMA = "lineofaction modal analysis"

    freedom: tuple[str, ...]
    mesh: tuple[str, ...]
    shaft: tuple[str, ...]
    spring: tuple[str, ...]
    spring_part: tuple[str, ...]
    spring_kind: tuple[str, ...]
    """`spring`, `spring_part`, `spring_kind`: Name, the mesh, bearing, coupling or drive it belongs to, and
    which of these that is.
    """
    natural_frequency: FloatArray = field(
        metadata=stored("Hz", "undamped natural frequency at rest", "natural_mode")
    )
    natural_damping_ratio: FloatArray = field(
        metadata=stored("1", "modal damping ratio at rest", "natural_mode")
    )
    natural_shape: FloatArray = field(
        metadata=stored("m or rad", "mode shape of unit modal mass", "natural_mode", "freedom")
    )
    natural_strain_energy: FloatArray = field(
        metadata=stored("1", "share of the strain energy", "natural_mode", "spring")
    )
    natural_kinetic_energy: FloatArray = field(
        metadata=stored("1", "share of the kinetic energy", "natural_mode", "freedom")
    )
    speed: FloatArray = field(metadata=stored("rad s-1", "speed of the leading shaft", "speed"))
    mesh_frequency: FloatArray = field(metadata=stored("Hz", "mesh frequency", "mesh", "speed"))
    frequency: FloatArray = field(metadata=stored("Hz", "damped frequency of a whirl mode", "speed", "mode"))
    damping_ratio: FloatArray = field(metadata=stored("1", "damping ratio of a whirl mode", "speed", "mode"))
    whirl: FloatArray = field(
        metadata=stored("1", "-1 backward circular, 0 in a plane, 1 forward circular", "speed", "mode")
    )
    shape: ComplexArray = field(
        metadata=stored("m or rad", "mode shape, largest entry in meters 1", "speed", "mode", "freedom")
    )
    strain_energy: FloatArray = field(
        metadata=stored("1", "share of the strain energy", "speed", "mode", "spring")
    )
    kinetic_energy: FloatArray = field(
        metadata=stored("1", "share of the kinetic energy", "speed", "mode", "freedom")
    )
    critical_speed: FloatArray = field(metadata=stored("rad s-1", "speed of the leading shaft", "crossing"))
    critical_frequency: FloatArray = field(
        metadata=stored("Hz", "frequency of mode and mesh order", "crossing")
    )
    critical_damping_ratio: FloatArray = field(metadata=stored("1", "damping ratio of the mode", "crossing"))
    critical_mode: IntArray = field(metadata=stored("1", "mode, counted from 0", "crossing"))
    critical_mesh: IntArray = field(metadata=stored("1", "mesh, counted from 0", "crossing"))
    critical_order: IntArray = field(metadata=stored("1", "multiple of the mesh frequency", "crossing"))
    critical_residual: FloatArray = field(
        metadata=stored("Hz", "frequency of the mode less that of the order", "crossing")
    )
    metadata: Json = field(default_factory=dict, metadata=under_key("facts"))
    """Plain JSON: `leading_shaft`, `time`, `orders`, `equilibrium` (status, residual in N, mesh forces),
    `seconds` (CPU by stage), `effect_ledger`, `highest_frequency` (Hz, to which shafts that bend are
    resolved).
    """
    axis_shaft: IntArray = field(
        default_factory=lambda: np.empty(0, dtype=np.int64),
        metadata=stored("1", "shaft of a point of an axis, counted from 0", "axis_point"),
    )
    axis_position: FloatArray = field(
        default_factory=lambda: np.empty(0),
        metadata=stored("m", "along the shaft from its left end", "axis_point"),
    )
    axis_motion: FloatArray = field(
        default_factory=lambda: np.empty((0, 6, 0)),
        metadata=stored(
            "m or rad", "x, y, z, tilts and rotation there per freedom", "axis_point", "direction", "freedom"
        ),
    )
    surface_motion: NDArray[np.float32] = field(
        default_factory=lambda: np.empty((0, 3, 0), dtype=np.float32),
        metadata=stored("m", "x, y, z of a point per freedom", "surface_point", "axis", "freedom"),
    )

    def strain_shares(self, strain_energy: FloatArray) -> dict[str, float]:
        """Sum the shares (p,) of one mode over each mesh, bearing, coupling and drive, the largest first."""
        return _summed(self.spring_part, strain_energy)

    def kinetic_shares(self, kinetic_energy: FloatArray) -> dict[str, float]:
        """Sum the shares (n,) of one mode over the motions of each shaft ("output torsional")."""
        return _summed([" ".join(part) for part in freedom_parts(self.freedom)], kinetic_energy)

    def kind(self, strain_energy: FloatArray, kinetic_energy: FloatArray) -> str:
        """Return a mode in words: its motion, and the springs that hold it.

        "torsional on mesh", "lateral-torsional on bearing" ...: whatever has a third of the energy is named;
        "free" for a motion that nothing resists.
        """
        motion = _named(_summed([kind for _, kind in freedom_parts(self.freedom)], kinetic_energy), "-")
        energy = _summed(self.spring_kind, strain_energy)
        return f"{motion} on {_named(energy, ' and ')}" if sum(energy.values()) > 0.0 else f"{motion}, free"


def modal_analysis(
    system: System,
    speed: Sequence[float] | FloatArray = (),
    orders: int = 10,
    time: float = 0.0,
    progress: Callable[[float], None] | None = None,
    highest_frequency: float | None = None,
) -> ModalAnalysis:
    """Return the natural modes of `system` and, at the speeds given, its whirl modes and critical speeds.

    Every mesh has its tangent stiffness at the static mesh force, mean over the positions.

    Parameters
    ----------
    speed : (S,) sequence
        Speeds of the first drive or free rotation that turns, rad/s, increasing, >= 0; may be empty.
    orders : int
        Multiples of the mesh frequencies whose crossings with modes are found.
    time : float
        Time at which loads are evaluated, s.
    progress : callable, optional
        Called with the fraction done; an exception in it ends the analysis.
    highest_frequency : float, optional
        Frequency to which flexible shafts are resolved, Hz, independent of the scene's output. Left out: the
        highest of the `orders` at the highest of the speeds, or of the scene if no speed is given.

    Raises
    ------
    InputError
        If a value is out of range, nothing can vibrate, or nothing turns where speeds are given.
    SolveError
        If there is no static equilibrium, or one beyond the table (`STRAIGHT_ON`) that is not accepted.
    """
    integer("orders", orders, 1, MAX_ORDERS)
    require_freedoms(system)
    speeds = checked_speeds(np.asarray(speed, dtype=float), above_zero=False)
    began = cpu_seconds()
    highest = resolved_to(system, speeds, orders, highest_frequency)
    elastic = [rotor.elastic.highest for rotor in system.rotors if rotor.elastic is not None]
    if highest != 0.0 and any(frequency != highest for frequency in elastic):
        system = assemble(replace(system.scene, highest_frequency=highest))
    system = about_running(system)
    linear = linearize(system, time)
    ledger = checked_ledger(system, linear.equilibrium.mesh_force)
    at_rest = resting(system, linear, time)
    linear = averaged(system, linear, flank_cycles(system, linear, at_rest), at_rest)
    rest = natural_modes(linear)
    seconds = {"equilibrium_and_rest": cpu_seconds() - began}
    began = cpu_seconds()
    branches = whirl_branches(system, linear, speeds, progress)
    crossings = critical_speeds(system, linear, branches, orders)
    seconds["over_speed"] = cpu_seconds() - began
    metadata = _metadata(system, linear, time, orders, seconds, speeds.size > 0) | {"effect_ledger": ledger}
    metadata |= {"highest_frequency": highest} | system.corrections
    return _analysis(system, linear, rest, branches, crossings, metadata)


def _metadata(
    system: System, linear: LinearSystem, time: float, orders: int, seconds: Json, rotating: bool
) -> Json:
    scene, start = system.scene, linear.equilibrium
    return {
        "leading_shaft": scene.references[leading_law(system)].shaft if rotating else "",
        "time": time,
        "orders": orders,
        "equilibrium": {
            "status": start.status.name,
            "residual": start.residual,
            "mesh_force": {
                mesh.name: float(f) for mesh, f in zip(scene.meshes, start.mesh_force, strict=True)
            },
        },
        "seconds": seconds,
    }


def _analysis(
    system: System,
    linear: LinearSystem,
    rest: Modes,
    branches: WhirlBranches,
    crossings: CriticalSpeeds,
    metadata: Json,
) -> ModalAnalysis:
    parts = spring_parts(system, linear.spring)
    meshes = np.empty((len(system.scene.meshes), 0))
    axes = shaft_axes(system.scene, system.rotors)
    return ModalAnalysis(
        freedom=linear.freedom,
        mesh=tuple(mesh.name for mesh in system.scene.meshes),
        shaft=tuple(shaft.name for shaft in system.scene.shafts),
        spring=linear.spring,
        spring_part=tuple(part for part, _ in parts),
        spring_kind=tuple(kind for _, kind in parts),
        **{f"natural_{name}": getattr(rest, name) for name in AT_REST},
        mesh_frequency=mesh_frequencies(system, branches.speed) if branches.speed.size else meshes,
        **vars(branches),
        **{f"critical_{name}": values for name, values in vars(crossings).items()},
        metadata=metadata,
        axis_shaft=axes.shaft,
        axis_position=axes.position,
        axis_motion=system.freedoms.keep(axes.motion),
    )


def _named(shares: dict[str, float], between: str) -> str:
    """Join the names of the large shares, the largest first."""
    largest = next(iter(shares))
    return between.join([largest, *(name for name, s in shares.items() if name != largest and s > LARGE)])


def _summed(parts: Sequence[str], share: FloatArray) -> dict[str, float]:
    """Sum shares by part, the largest first."""
    total: dict[str, float] = {}
    for part, value in zip(parts, share, strict=True):
        total[part] = total.get(part, 0.0) + float(value)
    return dict(sorted(total.items(), key=lambda item: -item[1]))
