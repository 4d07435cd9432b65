"""The ring gear of a case as an elastic ring on its support, under the planets of its stage."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bounds.brief import brief
from bounds.types import Json
from dynamics.elastic_ring.annulus import Annulus
from dynamics.elastic_ring.load_sharing import LoadShares, load_shares
from dynamics.elastic_ring.ring_compliance import HeldRing, Port
from dynamics.elastic_ring.ring_modes import ring_modes
from dynamics.elastic_ring.ring_support import RingSupport
from dynamics.elastic_ring.side_lines import side_lines
from dynamics.errors import InputError
from dynamics.types import FloatArray
from fe_contact.geometry import ParallelAxes, RingGear
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.plan import costs_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.computation import CaseStudy, Means, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.elastic_ring import ElasticRingFigures, Inputs
from lineofaction.gearbox.tabled_scene import checked_table
from lineofaction.gearbox.units import UM
from model_studies import in_unit
from model_studies.result_record import ResultRecord

POSITIONS = 48
"""Positions of the carrier over the way from one lug to the next."""
MODES = 12
"""Number of modes."""
_REACH = 3
"""Side lines on either side, over the larger of the numbers of planets and lugs."""
_SECONDS = 0.4
"""CPU seconds of the ring beside those of the table."""
TEETH = 0.12
"""Height in modules by which the teeth stiffen the rim: 0.115 to 0.128 on rims of 3 to 13 modules against
plane elements with teeth, under 2, 4 and 8 waves.
"""
MODEL_ERROR = 0.15
"""Error of the deflection of the ring over it: -0.03 to +0.15 in twelve meshes of six rings on lugs of 1.6 to
4 degrees, against plane elements with teeth, less the same elements held all around. It is largest at wide
lugs on thin rims.
"""
SECANT = 0.1
"""Error of an uneven share over what is uneven: meshes stiffen with load, and have one stiffness here."""
MODE_ERROR = 0.02
"""Error of a natural frequency over it, against plane elements with teeth on rims of 3 to 13 modules."""
LEFT_OUT = (
    "bending of the ring out of its plane, and its motion in a run",
    "the width of a lug along the ring, which stiffens its support",
    "the housing that holds the support, which is rigid",
)


@brief
@dataclass(frozen=True)
class ElasticRing(ResultRecord):
    """Deflection of an elastic ring gear under the planets of its stage, in SI units."""

    torque: FloatArray = field(metadata=in_unit("n_m", "load"))
    """Torque on each planet, (loads,), N m."""
    force: FloatArray = field(metadata=in_unit("n", "load"))
    """Force of each planet along the line of action in the transverse plane, (loads,), N."""
    table_deflection: FloatArray = field(metadata=in_unit("m", "load"))
    """Mean transmission error of the table, whose ring is held all around, (loads,), m."""
    table_deflection_error: FloatArray = field(metadata=in_unit("m", "load"))
    angle: FloatArray = field(metadata=in_unit("rad", "position"))
    """Angle of the first planet from the first lug, (positions,), rad."""
    ring_deflection: FloatArray = field(metadata=in_unit("m", "load", "position"))
    """Displacement of the ring along the line of action of the first planet, (loads, positions), m, under
    planets that carry alike, beyond that of a ring held all around, which the table has."""
    ring_deflection_error: FloatArray = field(metadata=in_unit("m", "load", "position"))
    share: FloatArray = field(metadata=in_unit("1", "load", "planet"))
    """Loads of the planets over their mean where one of them is largest, (loads, planets)."""
    share_error: FloatArray = field(metadata=in_unit("1", "load"))
    """Error of the largest share, (loads,): by that of the deflection of the ring, and by `SECANT`."""
    rigid_share: FloatArray = field(metadata=in_unit("1", "load", "planet"))
    """The same on a rigid ring."""
    mode_frequency: FloatArray = field(metadata=in_unit("hz", "mode"))
    mode_waves: FloatArray = field(metadata=in_unit("1", "mode"))
    """Number of waves around the ring, (modes,)."""
    mode_share: FloatArray = field(metadata=in_unit("1", "mode"))
    """Share of the kinetic energy in this number of waves, (modes,)."""
    line_order: FloatArray = field(metadata=in_unit("1", "line"))
    """Orders of the carrier's rotation, (lines,)."""
    line_radial: FloatArray = field(metadata=in_unit("1", "line"))
    line_tangential: FloatArray = field(metadata=in_unit("1", "line"))
    """`line_radial`, `line_tangential`: Amplitude of the force of a lug over that of each mesh, (lines,)."""
    height: float = field(metadata=in_unit("m"))
    """Radial height of the ring below the teeth, m."""
    series_error: float
    """Deflection that the harmonics left out change, over it."""
    receipt: Json
    warnings: list[Json]


class _Stage(NamedTuple):
    """A ring on its support, and the line of action of a planet in it."""

    held: HeldRing
    mesh: Port
    teeth: int

    @classmethod
    def of(cls, pair: ParallelAxes, inputs: Inputs) -> _Stage:
        """Return the stage; raises `BadInput`: no ring gear, planets that collide, a ring that is free."""
        gear = pair.wheel
        if not isinstance(gear, RingGear):
            raise BadInput.of(
                "pair.wheel.internal", False, "true: a ring gear", "Give the case of a planet in its ring."
            )
        between = 2.0 * pair.center_distance * math.sin(math.pi / inputs.planets)
        if inputs.planets > 1 and between <= 2.0 * pair.pinion.tip_radius:
            raise BadInput.of(
                "planets",
                inputs.planets,
                f"at most {_most(pair)}: the tips of more meet",
                "State fewer planets.",
            )
        ring = rim_of(gear)
        pressure_angle = pair.working_pressure_angle
        radius = gear.base_radius / math.cos(pressure_angle)
        mesh = Port(np.zeros(1), radius, math.sin(pressure_angle), math.cos(pressure_angle))
        try:
            return cls(HeldRing(ring, _support(inputs)), mesh, gear.teeth)
        except InputError as refused:
            raise BadInput.of(
                "lug_tangential_n_per_m",
                inputs.lug_tangential_n_per_m,
                "part of a support that holds the ring against rotation and displacement",
                "State lugs with both stiffnesses, or those of a fit.",
            ) from refused

    def compliance(self, angles: FloatArray, planets: int) -> FloatArray:
        """Return what the ring adds between the meshes of all planets, (angles, planets, planets), m/N."""
        spaced = 2.0 * np.pi * np.arange(planets) / planets
        return np.array([self.held.added_compliance(self.mesh.at(angle + spaced)) for angle in angles])


def rim_of(gear: RingGear) -> Annulus:
    """Return the rim of a ring gear, stiffened by its teeth and with their mass."""
    material, stiffening = gear.material, TEETH * gear.normal_module
    return Annulus(
        gear.root_radius - stiffening,
        0.5 * gear.rim_diameter,
        gear.face_width,
        material.youngs_modulus,
        material.poissons_ratio,
        material.density,
        # teeth and spaces have one half each, of which the stiffening layer is a part
        max(gear.root_radius - gear.tip_radius - 2.0 * stiffening, 0.0),
    )


def _most(pair: ParallelAxes) -> int:
    """Return how many planets fit into a ring at equal angles."""
    return int(math.pi / math.asin(min(pair.pinion.tip_radius / pair.center_distance, 1.0)) * (1.0 - 1e-12))


def _support(inputs: Inputs) -> RingSupport:
    return RingSupport(
        inputs.lugs,
        0.0,  # angles count from the first lug
        inputs.lug_radial_n_per_m,
        inputs.lug_tangential_n_per_m,
        inputs.fit_radial_n_per_m,
        inputs.fit_tangential_n_per_m,
    )


class _ElasticRingStudy(CaseStudy[Inputs, ElasticRingFigures, ElasticRing]):
    inputs, answer, file = Inputs, ElasticRingFigures, record_file(("elastic ring", ElasticRing))

    def check(self, case: CheckedCase, inputs: Inputs) -> None:
        """Refuse a pair without a ring gear, a ring that is free, and errors of other planets."""
        if inputs.pin_error_um and len(inputs.pin_error_um) != inputs.planets:
            bound = f"a list of {inputs.planets}, one for each planet"
            raise BadInput.of("pin_error_um", list(inputs.pin_error_um), bound, "Or leave it out.")
        _ = _Stage.of(case.pair, inputs)

    def predicted(self, case: CheckedCase, _inputs: Inputs, cache: Path | None) -> StudyCost:
        """Return the cost of the table and of the ring."""
        passes = costs_of(case, cache)
        table = Work("table", sum(part.cpu_seconds for part in passes), stage="analysis")
        memory = max(part.memory_bytes for part in passes)
        return StudyCost((table, Work("ring", _SECONDS, stage="ring")), memory)

    def compute(self, case: CheckedCase, inputs: Inputs, means: Means) -> ElasticRing:
        """Return deflections and shares at all loads of the case, at its first alignment."""
        stage = _Stage.of(case.pair, inputs)
        refines = case.case.accuracy.tolerance is not None
        run = means.analysis.reporting(partial(means.report, "analysis"), refines=refines)
        with boundary_errors():
            database = checked_table(case, run)
            means.report("ring", 0.0)
            return _solved(stage, case.pair, database, inputs)

    def _derived(self, ring: ElasticRing) -> Json:
        return {
            "load_cases": [_load_case(ring, load) for load in range(ring.torque.size)],
            "modes": [
                {
                    "frequency": frequency,
                    "frequency_error": MODE_ERROR * frequency,
                    "waves": int(waves),
                    "share": float(share),
                }
                for frequency, waves, share in zip(
                    ring.mode_frequency, ring.mode_waves, ring.mode_share, strict=True
                )
            ],
            "side_lines": [
                {"order": int(order), "radial_n": float(radial), "tangential_n": float(tangential)}
                for order, radial, tangential in zip(
                    ring.line_order, ring.line_radial, ring.line_tangential, strict=True
                )
            ],
            "left_out": list(LEFT_OUT),
        }

    def warnings(self, ring: ElasticRing) -> list[Json]:
        return ring.warnings


def _solved(stage: _Stage, pair: ParallelAxes, database: SteDatabase, inputs: Inputs) -> ElasticRing:
    torque = np.asarray(database.torque, dtype=float)
    force = torque / pair.pinion.base_radius
    means = [database.mean(torque=float(value)) for value in torque]
    deflection = np.array([mean.value for mean in means])
    angle = np.linspace(0.0, 2.0 * np.pi / max(inputs.lugs, 1), POSITIONS, endpoint=False)
    compliance = stage.compliance(angle, inputs.planets)
    alike = compliance[:, 0, :].sum(axis=1)
    error = math.hypot(MODEL_ERROR, series := stage.held.remainder(stage.mesh))
    shares, softer, rigid = (
        [_largest_shares(of_ring, inputs, *at).share for at in zip(force, deflection, strict=True)]
        for of_ring in (compliance, (1.0 + error) * compliance, 0.0 * compliance[:1])
    )
    largest = np.max(shares, axis=1)
    modes = ring_modes(stage.held.ring, stage.held.support, MODES)
    reach = _REACH * max(inputs.planets, inputs.lugs)
    lines = side_lines(stage.held, stage.mesh, stage.teeth, inputs.planets, reach)
    radial, tangential = _by_direction(lines.amplitude, stage.held.support)
    return ElasticRing(
        torque=torque,
        force=force,
        table_deflection=deflection,
        table_deflection_error=np.array([mean.error for mean in means]),
        angle=angle,
        ring_deflection=force[:, None] * alike,
        ring_deflection_error=error * force[:, None] * np.abs(alike),
        share=np.array(shares),
        share_error=np.hypot(np.max(softer, axis=1) - largest, SECANT * (largest - 1.0)),
        rigid_share=np.array(rigid),
        mode_frequency=modes.frequency,
        mode_waves=modes.harmonic.astype(float),
        mode_share=modes.share,
        line_order=lines.order.astype(float),
        line_radial=radial,
        line_tangential=tangential,
        height=stage.held.ring.height,
        series_error=series,
        receipt=database.metadata.receipt,
        warnings=list(database.metadata.warnings),
    )


def _largest_shares(compliance: FloatArray, inputs: Inputs, force: float, deflection: float) -> LoadShares:
    """Return the shares at the position where a planet carries most."""
    planets = inputs.planets
    mesh = force / deflection
    way = mesh if inputs.way_stiffness_n_per_m is None else inputs.way_stiffness_n_per_m
    stiffness = np.full(planets, 1.0 / (1.0 / mesh + 1.0 / way))
    late = UM * np.array(inputs.pin_error_um or [0.0] * planets)
    spaced = 2.0 * np.pi * np.arange(planets) / planets
    found = [
        load_shares(stiffness, between, late, planets * force, spaced, floats=inputs.sun_floats)
        for between in compliance
    ]
    return max(found, key=lambda shares: shares.share.max())


def _by_direction(amplitude: FloatArray, support: RingSupport) -> tuple[FloatArray, FloatArray]:
    """Return radial and tangential lines, zero in a direction in which lugs slide."""
    rows, count = iter(amplitude), amplitude.shape[1]
    stiffness = (support.lug_radial, support.lug_tangential) if support.lugs else (0.0, 0.0)
    radial, tangential = (next(rows) if spring > 0.0 else np.zeros(count) for spring in stiffness)
    return radial, tangential


def _load_case(ring: ElasticRing, load: int) -> Json:
    over = ring.ring_deflection[load]
    return {
        "torque": ring.torque[load],
        "force": ring.force[load],
        "table_deflection": ring.table_deflection[load],
        "table_deflection_error": ring.table_deflection_error[load],
        "ring_deflection": over.mean(),
        "ring_deflection_error": ring.ring_deflection_error[load].mean(),
        "ring_ripple": over.max() - over.min(),
        "ring_ripple_error": ring.ring_deflection_error[load].max(),
        "share": ring.share[load].tolist(),
        "largest_share_error": float(ring.share_error[load]),
        "share_on_rigid_ring": ring.rigid_share[load].tolist(),
    }


RUN = _ElasticRingStudy()
