"""Full contact over the face of spur pairs: the plane mesh of a position, extruded in layers."""

from fe_contact.full_contact.over_face.solve import solve_full_contact_over_face

__all__ = ["solve_full_contact_over_face"]
