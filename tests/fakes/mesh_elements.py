"""Gear meshes by themselves, for the tests of other engines."""

from geared_scenes import BASE_RADIUS, square_wave_table

from dynamics.engines import MeshElement


def helical_element() -> MeshElement:
    """A 20/30 helical pair on the table of a spur one: unequal radii, damping, an offset."""
    return MeshElement(
        square_wave_table(),
        (20, 30),
        (BASE_RADIUS, 1.5 * BASE_RADIUS),
        base_helix_angle=0.2,
        damping=2000.0,
        damping_reach=133.0,
        position_offset=0.3,
    )
