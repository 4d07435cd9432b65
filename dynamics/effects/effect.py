"""What an effect of the multibody model is: which freedoms it adds, and when a rotor calls for them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from dynamics.bodies import ElasticShaft

FREEDOMS = ("x", "y", "z", "tilt_x", "tilt_y", "rotation")


@dataclass(frozen=True)
class MeshOnRotor:
    """A mesh as its rotor feels it.

    Attributes
    ----------
    force : float
        Nominal transverse mesh force, N.
    lever : float
        Axial distance from the rotor's center of mass, m.
    axial : float
        Axial over transverse force, tan(base helix angle), >= 0.
    radius : float
        Operating pitch radius, m: the axial force's lever across the shaft.
    direction : (float, float)
        Unit vector across the axis of the force on the rotor, along x and y.
    """

    force: float
    lever: float
    axial: float
    radius: float
    direction: tuple[float, float] = (1.0, 0.0)


@dataclass(frozen=True)
class RotorRotation:
    """Rotation of a rotor, and its share in the natural frequencies.

    Attributes
    ----------
    tilt_share : float
        I_p w/(2 sqrt(I_t k_t)) at the largest speed w of the run.
    frame_share : float
        Largest W/omega of all members of its rotating frame: its speed over their lateral natural frequency.
    framed, free : bool
        Whether it is described in a rotating frame; whether free rotations turn it.
    """

    tilt_share: float = 0.0
    frame_share: float = 0.0
    framed: bool = False
    free: bool = False


@dataclass(frozen=True)
class BendingShaft:
    """What a shaft does beside its motion as a rigid body under the nominal forces.

    Attributes
    ----------
    refusal : str
        Why it is rigid; empty: it can bend.
    elastic : ElasticShaft or None
        Its elastic coordinates; None: it is rigid.
    moved : float
        Largest displacement at a mesh along the line of action that its elasticity adds, m.
    share : float
        That over what the mesh itself yields.
    misaligned : float
        Largest misalignment that it adds, over the face, m.
    """

    refusal: str = "the shaft has no sections: its elasticity is not known"
    elastic: ElasticShaft | None = None
    moved: float = 0.0
    share: float = 0.0
    misaligned: float = 0.0


@dataclass(frozen=True)
class SupportedRotor:
    """What effects decide on: stiffness of a rotor's supports, and the meshes it carries.

    Attributes
    ----------
    name : str
        The shaft's.
    length : float
        m.
    radial_stiffness, axial_stiffness, tilt_stiffness : float
        Of all its bushings together, N/m and N m/rad; 0: held rigidly, because nothing else holds it.
    elastic_lever : float
        Axial distance from the center of mass to the bushings' elastic center, m.
    meshes : tuple of MeshOnRotor
    nonlinear : tuple of float
        For each law of its bearings that is not linear, what its tangent misses of the displacement, m.
    rotation : RotorRotation
    bending : BendingShaft
    """

    name: str
    length: float
    radial_stiffness: float
    axial_stiffness: float
    tilt_stiffness: float
    elastic_lever: float
    meshes: tuple[MeshOnRotor, ...]
    nonlinear: tuple[float, ...] = ()
    rotation: RotorRotation = RotorRotation()
    bending: BendingShaft = BendingShaft()

    @property
    def pushed(self) -> float:
        """Resultant across the axis of all nominal mesh forces, N: around a sun they cancel."""
        along_x, along_y = (sum(mesh.force * mesh.direction[k] for mesh in self.meshes) for k in (0, 1))
        return math.hypot(along_x, along_y)


@dataclass(frozen=True)
class MeshAxes:
    """What a mesh's table says beyond position and deflection, and what of it the scene can move.

    Attributes
    ----------
    variable : bool
        Whether the mesh uses its table as it is (variable-torque technique).
    derivatives : bool
        Whether the table has derivatives along its axes.
    misalignments, center_distances : int
        Knots of the table.
    tilts, moves_apart : bool
        Whether freedoms change misalignment and center distance.
    misaligned, apart : float
        Change of the mean transmission error as the nominal force tilts the shafts and moves them apart, m.
    lever : float or None
        Largest offset of the load's centroid from mid-face over the face width; None: not known.
    moment : float or None
        Displacement along the line of action at the centroid that this lever's moment makes, m.
    friction : float or None
        Coefficient of friction; None: not given.
    slides : bool
        Whether the table says where along the path of contact the load slides.
    slowed : float
        Change of the transmission error that the largest friction torque makes, m.
    """

    variable: bool
    derivatives: bool
    misalignments: int
    center_distances: int
    tilts: bool
    moves_apart: bool
    misaligned: float
    apart: float
    lever: float | None
    moment: float | None
    friction: float | None
    slides: bool
    slowed: float

    def not_read(self) -> str | None:
        """Why the table cannot be read along its axes as bodies move; None where it can."""
        if not self.variable:
            return "the constant-torque technique has one stiffness per position"
        return None if self.derivatives else "the table has no derivatives along its axes"


@dataclass(frozen=True)
class LoadedMesh:
    """What effects of a mesh decide on.

    Attributes
    ----------
    name : str
        The mesh's.
    least_force : float
        Least over the run of the force that balances loads and imposed accelerations, N; < 0: the coast
        flank's.
    force_swing : float
        Half the peak-to-peak transmission error times stiffness, amplified as in resonance, N.
    backlash : float or None
        m, along the line of action; None: no coast flank given.
    axes : MeshAxes
    """

    name: str
    least_force: float
    force_swing: float
    backlash: float | None
    axes: MeshAxes


@dataclass(frozen=True)
class Verdict:
    """Whether a rotor or a mesh calls for an effect.

    Attributes
    ----------
    on : bool
    possible : bool
        False: the scene has no such freedom or data, and requesting it changes nothing.
    reason : str
        In words.
    influence : float
        Static displacement along the line of action that the effect adds at the nominal force, m.
    """

    on: bool
    possible: bool
    reason: str
    influence: float


class Effect(Protocol):
    """One optional piece of physics of a rotor: freedoms."""

    @property
    def name(self) -> str:
        """What a scene calls it."""
        ...

    @property
    def adds(self) -> tuple[str, ...]:
        """Names of the freedoms it gives a rotor."""
        ...

    @property
    def cost(self) -> str:
        """What it costs, in words."""
        ...

    def called_for(self, rotor: SupportedRotor) -> Verdict:
        """Decide for one rotor."""
        ...


class MeshEffect(Protocol):
    """One optional piece of physics of a mesh: how its force acts."""

    @property
    def name(self) -> str:
        """What a scene calls it."""
        ...

    @property
    def cost(self) -> str:
        """What it costs, in words."""
        ...

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Decide for one mesh."""
        ...
