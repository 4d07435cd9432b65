"""The basic rack tooth profile that generates a gear (ISO 53), in the normal plane.

A declaration holds kind, unit, bounds, description and example of a field. Coefficients are lengths in normal
modules. The defaults of the fields are those of profile A of ISO 53.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import Declared, Kind, at_most, between, declared, described, required, up_to
from fe_contact.errors import InfeasibleGeometry, declared_fields

NORMAL_MODULE = Declared(Kind.LENGTH, "m", up_to(10.0), "Normal module m_n", 0.004)
PRESSURE_ANGLE = Declared(
    Kind.ANGLE,
    "rad",
    between(math.radians(10.0), math.radians(35.0)),
    "Normal pressure angle",
    math.radians(20.0),
)
ADDENDUM = Declared(
    Kind.RATIO, "", between(0.1, 3.0), "Addendum h_aP of the basic rack in normal modules", 1.0
)
DEDENDUM = Declared(
    Kind.RATIO, "", between(0.1, 4.0), "Dedendum h_fP of the basic rack in normal modules", 1.25
)
ROOT_RADIUS = Declared(
    Kind.RATIO,
    "",
    between(0.0, 2.0),
    "Root fillet radius rho_fP of the basic rack in normal modules; at most the full fillet",
    0.38,
)


@described
@dataclass(frozen=True)
class BasicRack:
    """Standard basic rack tooth profile; its root radius is the tip rounding of the tool.

    Raises `InputError`: a value out of its bounds; `InfeasibleGeometry` "root radius": the rounding does not
    fit between the two flanks of the tooth space.
    """

    normal_module: float = required(NORMAL_MODULE)
    normal_pressure_angle: float = declared(math.radians(20.0), PRESSURE_ANGLE)
    addendum_coefficient: float = declared(1.0, ADDENDUM)
    dedendum_coefficient: float = declared(1.25, DEDENDUM)
    root_radius_coefficient: float = declared(0.38, ROOT_RADIUS)

    def __post_init__(self) -> None:
        declared_fields(self)
        limit = self.full_fillet_coefficient
        if limit < 0.0:
            crossing = "smaller: the flanks of the rack's tooth space cross above its root"
            remedy = "Lower the dedendum or the pressure angle."
            dedendum = self.dedendum_coefficient
            raise InfeasibleGeometry("root radius", "dedendum_coefficient", dedendum, crossing, remedy)
        radius = self.root_radius_coefficient
        if radius > limit + 1e-12:  # the full fillet itself is allowed, to rounding
            bound = at_most(limit, note=", the full fillet")
            remedy = "Lower the root radius, the dedendum or the pressure angle."
            raise InfeasibleGeometry("root radius", "root_radius_coefficient", radius, bound, remedy)

    @property
    def full_fillet_coefficient(self) -> float:
        """Largest rho_fP / m_n, with which one arc joins both flanks; negative if the flanks cross.

        The arc touches the root line and both flanks. The flanks meet the root line at `half_space` from the
        middle of the tooth space: half_space = rho_fP / m_n (1 - sin alpha_n) / cos alpha_n.
        """
        angle = self.normal_pressure_angle
        half_space = math.pi / 4.0 - self.dedendum_coefficient * math.tan(angle)
        return half_space * math.cos(angle) / (1.0 - math.sin(angle))

    @property
    def dedendum(self) -> float:
        """h_fP in m."""
        return self.dedendum_coefficient * self.normal_module

    @property
    def root_radius(self) -> float:
        """rho_fP in m."""
        return self.root_radius_coefficient * self.normal_module
