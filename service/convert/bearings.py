"""Bearings of a scene file in SI: bushings, planet bearings, and what they do that is not linear."""

from __future__ import annotations

from collections.abc import Iterator

from dynamics.forces import RollingContact, SpringCurve
from dynamics.joints import Bushing, PlanetBearing
from service.convert.errors import named
from service.schemas.scene import SceneInput
from service.schemas.scene_bodies import BearingInput, BushingInput, PlanetBearingInput
from service.units import MM, MRAD, UM


def bushing_of(index: int, given: BushingInput) -> Bushing:
    """Return a bushing."""
    with named(f"bushings[{index}]"):
        return Bushing(
            name=given.name,
            shaft=given.shaft,
            position=given.position_mm * MM,
            radial_stiffness=given.radial_stiffness_n_per_m,
            axial_stiffness=given.axial_stiffness_n_per_m,
            radial_damping=given.radial_damping_n_s_per_m,
            axial_damping=given.axial_damping_n_s_per_m,
            damping_ratio=given.damping_ratio,
            stiffness=given.stiffness_matrix,
            damping=given.damping_matrix,
            preload=_preload(given),
        )


def _preload(given: BushingInput) -> tuple[float, ...] | None:
    """Force and moment on the shaft; None where neither is given."""
    if given.preload_force_n is None and given.preload_moment_n_m is None:
        return None
    return (*(given.preload_force_n or (0.0,) * 3), *(given.preload_moment_n_m or (0.0,) * 2))


def rolling_contacts_of(scene: SceneInput) -> Iterator[RollingContact]:
    """Yield the rolling contacts of all bearings."""
    for field, bearing in _bearings(scene):
        given = bearing.rolling_contact
        if given is not None:
            with named(f"{field}.rolling_contact"):
                yield RollingContact(
                    bearing.name,
                    given.stiffness_n_per_m_n,
                    given.exponent,
                    given.radial_clearance_um * UM,
                    given.damping_n_s_per_m,
                    given.damping_ratio,
                )


def spring_curves_of(scene: SceneInput) -> Iterator[SpringCurve]:
    """Yield the curves of all bearings."""
    for field, bearing in _bearings(scene):
        for place, given in enumerate(bearing.spring_curves):
            ways = tuple(value * UM for value in given.displacement_um or ())
            ways = ways or tuple(value * MRAD for value in given.tilt_mrad or ())
            with named(f"{field}.spring_curves[{place}]"):
                yield SpringCurve(
                    bearing.name, given.direction, ways, tuple(given.force_n or given.moment_n_m or ())
                )


def planet_bearing_of(index: int, given: PlanetBearingInput) -> PlanetBearing:
    """Return a planet's bearing."""
    with named(f"planet_bearings[{index}]"):
        return PlanetBearing(
            name=given.name,
            shaft=given.shaft,
            carrier=given.carrier,
            position=given.position_mm * MM,
            radial_stiffness=given.radial_stiffness_n_per_m,
            axial_stiffness=given.axial_stiffness_n_per_m,
            radial_damping=given.radial_damping_n_s_per_m,
            axial_damping=given.axial_damping_n_s_per_m,
            damping_ratio=given.damping_ratio,
            radial_error=given.radial_error_um * UM,
            tangential_error=given.tangential_error_um * UM,
            stiffness=given.stiffness_matrix,
            damping=given.damping_matrix,
        )


def _bearings(scene: SceneInput) -> Iterator[tuple[str, BearingInput]]:
    """Yield all bearings with their fields."""
    yield from ((f"bushings[{index}]", part) for index, part in enumerate(scene.bushings))
    yield from ((f"planet_bearings[{index}]", part) for index, part in enumerate(scene.planet_bearings))
