"""Bearings of a scene file in SI: bushings, planet bearings, and what they do that is not linear."""

from __future__ import annotations

from collections.abc import Iterator

from bounds import inside
from dynamics.bearings import BallBearing, Bushing, CatalogLine, PlanetBearing, RollerBearing, RollingBearing
from dynamics.bearings.catalog import from_catalog
from dynamics.forces import RollingContact, SpringCurve
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.scene_bearings import RollingBearingInput
from lineofaction.gearbox.schemas.scene_bodies import BearingInput, BushingInput, PlanetBearingInput
from lineofaction.gearbox.units import MRAD, UM


def bushing_of(index: int, bushing: BushingInput) -> Bushing:
    """Return a bushing."""
    with named(f"bushings[{index}]"):
        return Bushing(
            name=bushing.name,
            shaft=bushing.shaft,
            stiffness=bushing.stiffness_matrix,
            damping=bushing.damping_matrix,
            preload=_preload(bushing),
            **in_si(Bushing, bushing),
        )


def _preload(bushing: BushingInput) -> tuple[float, ...] | None:
    """Force and moment on the shaft; None where neither is given."""
    if bushing.preload_force_n is None and bushing.preload_moment_n_m is None:
        return None
    return (*(bushing.preload_force_n or (0.0,) * 3), *(bushing.preload_moment_n_m or (0.0,) * 2))


def rolling_bearing_of(index: int, bearing: RollingBearingInput) -> RollingBearing:
    """Return a rolling bearing, its row as written or by its catalog line."""
    with named(f"rolling_bearings[{index}]"):
        own = in_si(RollingBearing, bearing)
        return RollingBearing(bearing.name, bearing.shaft, _row(bearing), **own)


def _row(bearing: RollingBearingInput) -> BallBearing | RollerBearing:
    if bearing.ball is not None:
        with inside("ball"):
            return BallBearing(**in_si(BallBearing, bearing.ball))
    if bearing.roller is not None:
        with inside("roller"):
            return RollerBearing(**in_si(RollerBearing, bearing.roller))
    assert bearing.catalog is not None  # the schema comes first
    with inside("catalog"):
        return from_catalog(**in_si(CatalogLine, bearing.catalog))


def rolling_contacts_of(scene: SceneInput) -> Iterator[RollingContact]:
    """Yield the rolling contacts of all bearings."""
    for field, bearing in _bearings(scene):
        law = bearing.rolling_contact
        if law is not None:
            with named(f"{field}.rolling_contact"):
                yield RollingContact(
                    bearing.name,
                    law.stiffness_n_per_m_n,
                    law.exponent,
                    law.radial_clearance_um * UM,
                    law.damping_n_s_per_m,
                    law.damping_ratio,
                )


def spring_curves_of(scene: SceneInput) -> Iterator[SpringCurve]:
    """Yield the curves of all bearings."""
    for field, bearing in _bearings(scene):
        for number, curve in enumerate(bearing.spring_curves):
            ways = tuple(value * UM for value in curve.displacement_um or ())
            ways = ways or tuple(value * MRAD for value in curve.tilt_mrad or ())
            with named(f"{field}.spring_curves[{number}]"):
                yield SpringCurve(
                    bearing.name, curve.direction, ways, tuple(curve.force_n or curve.moment_n_m or ())
                )


def planet_bearing_of(index: int, bearing: PlanetBearingInput) -> PlanetBearing:
    """Return a planet's bearing."""
    with named(f"planet_bearings[{index}]"):
        return PlanetBearing(
            name=bearing.name,
            shaft=bearing.shaft,
            carrier=bearing.carrier,
            stiffness=bearing.stiffness_matrix,
            damping=bearing.damping_matrix,
            **in_si(PlanetBearing, bearing),
        )


def _bearings(scene: SceneInput) -> Iterator[tuple[str, BearingInput]]:
    yield from ((f"bushings[{index}]", part) for index, part in enumerate(scene.bushings))
    yield from ((f"planet_bearings[{index}]", part) for index, part in enumerate(scene.planet_bearings))
