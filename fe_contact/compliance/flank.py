"""Compliance of the flanks of one gear: what the contact analysis needs of its finite elements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

from fe_contact.compliance.rounding import LARGEST_ROUNDING
from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class ComplianceChecks:
    """Breaches of the laws of a finite-element compliance. All are relative except the last.

    Attributes
    ----------
    residual : float
        Norm of f - K u over that of f, on every free freedom of the uncondensed mesh, under uniform pressure
        on tooth 0.
    reciprocity : float
        Largest |S - S'| over the largest |S|, before S is made exactly symmetric.
    bore_moment : float
        Moment of the reactions on the bore against base radius times flank force.
    energy : float
        Largest difference among u' K u, f' u and q' S q.
    least_eigenvalue : float
        Of S, 1/Pa; above 0.
    residual_rounding, energy_rounding : float
        What rounding alone may leave of `residual` and `energy` (`fe_contact.compliance.rounding`).
    """

    residual: float
    reciprocity: float
    bore_moment: float
    energy: float
    least_eigenvalue: float
    residual_rounding: float
    energy_rounding: float

    @property
    def limits(self) -> dict[str, float]:
        """Largest value of each law; residual and energy may be what rounding can make of them, no more.

        Measured they are below 0.15 of that, from solid gears to discs of a hundredth of a module.
        """
        return {
            "residual": self.residual_rounding,
            "reciprocity": 1e-10,
            "bore_moment": 1e-6,
            "energy": self.energy_rounding,
        }


@dataclass(frozen=True)
class FlankCompliance:
    """Flank displacement per flank force of one gear, bore clamped.

    Attributes
    ----------
    s : (k,) array
        Flank coordinate of the nodes, m, the same for all teeth; quadratic elements with nodes 2e, 2e+1,
        2e+2, the middle one at the exact middle, so that s is linear within an element.
    teeth : (t,) int array
        Consecutive tooth numbers, centered on 0; tooth j is turned by j pitches counter-clockwise from
        tooth 0.
    matrix : (t k, t k) array
        Inward displacement along the flank normal at node a per inward consistent nodal force along the
        flank normal at node b and per unit face width, m / (N/m). Row n k + a is node a of tooth
        ``teeth[n]``. Symmetric positive definite.
    s_form, s_tip : float
        Flank coordinate of form point and tip edge, m; ``s[-1] == s_tip``.
    contact_modulus : float
        E / (1 - nu^2) in plane strain, E in plane stress, Pa: the modulus of the half plane.
    checks : ComplianceChecks
        Laws kept.
    unknowns, condensed_unknowns : int
        Free freedoms of the mesh, and of the system left after condensing its tooth sectors.
    seconds : dict
        CPU seconds by stage, children included.
    solver : str
        Name of the sparse solver.
    from_cache : bool
        Whether it was read from disk; `seconds` are then those of the computation.
    """

    s: FloatArray
    teeth: IntArray
    matrix: FloatArray
    s_form: float
    s_tip: float
    contact_modulus: float
    checks: ComplianceChecks
    unknowns: int
    condensed_unknowns: int
    seconds: dict[str, float]
    solver: str
    from_cache: bool = False

    def block(self, tooth: int, other: int) -> FloatArray:
        """Return the (k, k) compliance of flank `tooth` under forces on flank `other`, both tooth numbers."""
        k, first = len(self.s), int(self.teeth[0])
        rows, columns = (tooth - first) * k, (other - first) * k
        if not (tooth in self.teeth and other in self.teeth):
            raise KeyError((tooth, other))
        return self.matrix[rows : rows + k, columns : columns + k]


class HasChecks(Protocol):
    """Any compliance, of the transverse section or over the face."""

    @property
    def checks(self) -> ComplianceChecks:
        """Laws kept."""


Checked = TypeVar("Checked", bound=HasChecks)


def refuse_broken_laws(compliance: Checked) -> Checked:
    """Return a compliance whose checks keep their limits.

    Raises
    ------
    SolveError
        Naming the check, its value and the limit; ``partial`` is the compliance.
    """
    checks = compliance.checks
    if not checks.energy_rounding <= LARGEST_ROUNDING:
        text = (
            f"flank compliance: rounding may change it by {checks.energy_rounding:.3g}, which exceeds "
            f"{LARGEST_ROUNDING:g}: the body moves far more than it is strained, as a thin plate does. "
            "Widen the face or the bore, or thicken the web."
        )
        raise SolveError(text, compliance)
    for name, limit in checks.limits.items():
        value = getattr(checks, name)
        if not value <= limit:
            raise SolveError(f"flank compliance: {name} {value:.3g} exceeds {limit:.3g}", compliance)
    if not checks.least_eigenvalue > 0.0:
        text = f"flank compliance: least eigenvalue {checks.least_eigenvalue:.3g} is not positive"
        raise SolveError(text, compliance)
    return compliance
