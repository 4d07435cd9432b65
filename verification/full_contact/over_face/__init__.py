"""Full contact over the face of spur pairs: the plane mesh of a position, extruded in layers."""
