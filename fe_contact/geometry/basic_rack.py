"""The basic rack tooth profile that generates a gear (ISO 53), in the normal plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import SiNote, at_most
from fe_contact.checks import positive, within
from fe_contact.errors import InfeasibleGeometry


@dataclass(frozen=True)
class BasicRack:
    """Standard basic rack tooth profile.

    Attributes
    ----------
    normal_module : float
        m_n in m.
    pressure_angle : float
        alpha_P in the normal plane, rad.
    addendum_coefficient, dedendum_coefficient : float
        h_aP / m_n and h_fP / m_n.
    root_radius_coefficient : float
        rho_fP / m_n: fillet radius of the rack, the tip rounding of the tool.

    Raises
    ------
    InfeasibleGeometry
        "root radius": the rounding does not fit between the two flanks of the tooth space.
    """

    normal_module: float
    pressure_angle: float = math.radians(20.0)
    addendum_coefficient: float = 1.0
    dedendum_coefficient: float = 1.25
    root_radius_coefficient: float = 0.38

    def __post_init__(self) -> None:
        positive("normal_module", self.normal_module, SiNote("In m: module 4 mm is 0.004."))
        low, high = math.radians(10.0), math.radians(35.0)
        within("normal_pressure_angle", self.pressure_angle, low, high, SiNote("In rad: 20 deg is 0.349."))
        within("addendum_coefficient", self.addendum_coefficient, 0.1, 3.0, "The usual value is 1.")
        within("dedendum_coefficient", self.dedendum_coefficient, 0.1, 4.0, "The usual value is 1.25.")
        within("root_radius_coefficient", self.root_radius_coefficient, 0.0, 2.0, "The usual value is 0.38.")
        self._refuse_large_root_radius()

    def _refuse_large_root_radius(self) -> None:
        """Refuse a rounding larger than the full fillet, and a tooth space without a root."""
        limit = self.full_fillet_coefficient
        if limit < 0.0:
            crossing = "smaller: the flanks of the rack's tooth space cross above its root"
            advice = "Lower the dedendum or the pressure angle."
            raise InfeasibleGeometry(
                "root radius", "dedendum_coefficient", self.dedendum_coefficient, crossing, advice
            )
        if self.root_radius_coefficient > limit + 1e-12:
            bound = at_most(limit, note=", the full fillet")
            advice = "Lower the root radius, the dedendum or the pressure angle."
            raise InfeasibleGeometry(
                "root radius", "root_radius_coefficient", self.root_radius_coefficient, bound, advice
            )

    @property
    def full_fillet_coefficient(self) -> float:
        """Largest rho_fP / m_n: one arc joins both flanks (negative: the flanks already cross)."""
        space = math.pi / 4.0 - self.dedendum_coefficient * math.tan(self.pressure_angle)
        return space * math.cos(self.pressure_angle) / (1.0 - math.sin(self.pressure_angle))

    @property
    def dedendum(self) -> float:
        """h_fP in m."""
        return self.dedendum_coefficient * self.normal_module

    @property
    def root_radius(self) -> float:
        """rho_fP in m."""
        return self.root_radius_coefficient * self.normal_module
