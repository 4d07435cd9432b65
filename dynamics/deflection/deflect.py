"""Static deflection of a scene under load cases."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from bounds import inside
from dynamics.assembly.assemble import assemble
from dynamics.checks import distinct, integer
from dynamics.deflection.bearing_load import BearingLoad, bearing_loads
from dynamics.deflection.bearing_strain import bearing_strain
from dynamics.deflection.case_forces import ForceUnderCase, as_records
from dynamics.deflection.loaded_scene import leader_of, leading_torque, loaded_scene
from dynamics.deflection.mesh_alignment import MeshAlignment, mesh_alignment
from dynamics.deflection.mesh_cycle import cycle_times
from dynamics.deflection.rest import rest_over
from dynamics.deflection.shaft_line import ShaftLines, shaft_lines
from dynamics.scene.scene import Scene
from dynamics.settings.load_case import LoadCase, check_forces
from model_studies import Record, in_unit

MOST_POSITIONS = 512


@dataclass(frozen=True)
class CaseDeflection(Record):
    """The deflection of a scene under a load case.

    Attributes
    ----------
    name, direction : str
        Of the load case.
    share : float
        Of the duration, relative to the other cases.
    speed, torque : float
        Of the leading shaft, rad/s and N m, both > 0.
    status : str
        Of the search for the rest positions, the worst of the cycle: "converged", "iteration_limit",
        "unbalanced". Only a converged case has figures to rely on.
    residual : float
        Largest unbalanced force over the largest mesh force.
    meshes : tuple of MeshAlignment
    bearings : tuple of BearingLoad
    shafts : ShaftLines
    forces : tuple of ForceUnderCase
        Of the scene; none in files of versions that did not keep them.
    """

    name: str
    direction: str
    share: float
    speed: float = field(metadata=in_unit("rad_s"))
    torque: float = field(metadata=in_unit("n_m"))
    status: str
    residual: float
    meshes: tuple[MeshAlignment, ...]
    bearings: tuple[BearingLoad, ...]
    shafts: ShaftLines
    forces: tuple[ForceUnderCase, ...] = ()


@dataclass(frozen=True)
class Deflection(Record):
    """The deflection of a scene under all its load cases.

    Attributes
    ----------
    leading_shaft : str
    cases : tuple of CaseDeflection
    """

    leading_shaft: str
    cases: tuple[CaseDeflection, ...]

    @property
    def converged(self) -> bool:
        """Whether all cases were found."""
        return all(case.status == "converged" for case in self.cases)


def deflect(
    scene: Scene,
    cases: Sequence[LoadCase] = (LoadCase("load"),),
    positions: int = 16,
    progress: Callable[[float], None] | None = None,
) -> Deflection:
    """Return where the bodies of `scene` rest under each load case, mean over the mesh cycle.

    All effects of the scene that act at rest are on unless it switches them off: freedoms, elastic shafts,
    laws of bearings, and where tables have what it takes, the misalignment and the center distance at which
    they are read and the centroid at which they press. Mesh and bodies are in balance at once.

    Parameters
    ----------
    scene : Scene
    cases : sequence of LoadCase
        Their names differ. Default: the scene's own loads at t = 0.
    positions : int
        Least number of positions of the mesh cycle, see `cycle_times`.
    progress : callable, optional
        Called with the fraction done.

    Raises
    ------
    InputError
        By field name: a case that the scene cannot have, meshes that it does not press, no common period.
    """
    distinct("load_cases", [case.name for case in cases])
    check_forces(cases, [force.name for force in scene.forces])
    integer("positions", positions, 1, MOST_POSITIONS)
    deflections = []
    for number, case in enumerate(cases):
        with inside(f"load_cases[{number}]"):
            loaded = loaded_scene(scene, case)
        deflections.append(_deflected(loaded, case, positions))
        if progress is not None:
            progress((number + 1) / len(cases))
    return Deflection(leader_of(scene).shaft, tuple(deflections))


def _deflected(loaded: Scene, case: LoadCase, positions: int) -> CaseDeflection:
    """Return the deflection of a scene under the loads of one case."""
    system = assemble(loaded)
    rest = rest_over(system, cycle_times(system, positions))
    motion = rest.motion.mean(axis=0)
    strain = bearing_strain(system, motion, rest.element.mean(axis=0))
    leader = leader_of(loaded)
    speed = abs(leader.speed)
    return CaseDeflection(
        case.name,
        case.direction,
        case.share,
        speed,
        sum(leading_torque(loaded, leader, speed)),
        rest.status.name.lower(),
        rest.residual,
        tuple(mesh_alignment(system, k, rest, strain) for k in range(len(loaded.meshes))),
        bearing_loads(system, rest, strain),
        shaft_lines(system, motion),
        as_records(loaded.forces),
    )
