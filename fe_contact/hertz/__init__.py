"""Analytic contact of elastic half-planes: pure functions of load, curvature and modulus."""

from fe_contact.hertz.edge_contact import edge_contact_length, edge_half_width, wedge_softness
from fe_contact.hertz.line_contact import (
    contact_modulus,
    half_width,
    line_load_at_half_width,
    local_approach,
    peak_pressure,
    relative_radius,
    two_cylinder_approach,
)

__all__ = [
    "contact_modulus",
    "edge_contact_length",
    "edge_half_width",
    "half_width",
    "line_load_at_half_width",
    "local_approach",
    "peak_pressure",
    "relative_radius",
    "two_cylinder_approach",
    "wedge_softness",
]
