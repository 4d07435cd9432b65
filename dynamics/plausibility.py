"""Checks of a scene: its run, bearings, meshes, bodies, and loads. Nothing is integrated."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bounds import Check, Checklist, Finding, engineering
from dynamics.bearings import Bushing, PlanetBearing
from dynamics.effects.ledger import mechanism_of
from dynamics.mechanism.mechanism import Mechanism
from dynamics.scene import Scene
from dynamics.shafts import Inertia, Shaft
from dynamics.types import FloatArray

_DENSITIES = "from foamed plastics to tungsten"
# name of the check, quantity, low and high bound, their unit, source of the bounds
_CHECKS = (
    Check("duration", "duration of the run", 1e-4, 300.0, "s", "run-ups take 1 to 120 s"),
    Check(
        "pitch_line_speed",
        "speed of the base circle of the fastest gear",
        None,
        300.0,
        "m/s",
        "ISO 6336-1: turbo gears reach 200 to 250 m/s",
    ),
    Check(
        "support_stiffness",
        "stiffness of a bearing that is not 0",
        5e5,
        1e12,
        "N/m",
        "rolling bearings: 1e7 to 1e10 N/m; soft mounts: 1e6 N/m",
    ),
    Check(
        "damping_ratio",
        "damping ratio of a bearing or a mesh",
        None,
        1.0,
        "1",
        "measured gear meshes and bearings: 0.02 to 0.2; 1 is critical",
    ),
    Check(
        "material_damping",
        "damping ratio of a shaft's material",
        None,
        0.2,
        "1",
        "steel: 0.0005 to 0.01; elastomers: 0.1",
    ),
    Check(
        "clearance",
        "radial clearance of a bearing that is not 0",
        0.1e-6,
        5e-3,
        "m",
        "ISO 5753-1: 1 µm to 1 mm",
    ),
    Check("backlash", "backlash of a mesh", 0.5e-6, 20e-3, "m", "DIN 3967: 10 µm to 3 mm"),
    Check(
        "friction",
        "coefficient of friction of the teeth",
        1e-3,
        0.5,
        "1",
        "ISO/TR 14179-1: lubricated teeth 0.02 to 0.1; dry steel 0.3",
    ),
    Check(
        "mesh_misalignment",
        "misalignment of a mesh that is not 0",
        0.1e-6,
        None,
        "m",
        "ISO 1328-1: class 1 allows about 1 µm",
    ),
    Check(
        "mesh_misalignment_over_face",
        "misalignment of a mesh over its face width",
        None,
        0.02,
        "1",
        "ISO 6336-1: mesh misalignments are below 0.002",
    ),
    Check(
        "shaft_slenderness",
        "length of a shaft over its largest diameter",
        0.05,
        200.0,
        "1",
        "shafts of gearboxes: 0.5 to 30",
    ),
    Check("shaft_density", "density of a shaft", 500.0, 20e3, "kg/m^3", _DENSITIES),
    Check(
        "shaft_modulus",
        "Young's modulus of a shaft",
        0.1e9,
        700e9,
        "Pa",
        "from elastomers (0.1 GPa) to tungsten carbide (690 GPa)",
    ),
    Check(
        "mass",
        "mass of a shaft with its gears that bearings carry",
        1e-6,
        None,
        "kg",
        "bodies have mass; without it their motion has no natural frequency",
    ),
    Check(
        "gear_inertia",
        "radius of gyration of a gear over its base radius",
        0.1,
        5.0,
        "1",
        "a disc has 0.7, a ring gear with its rim 1 to 1.5",
    ),
    Check(
        "shaft_inertia",
        "radius of gyration of a shaft over its length",
        None,
        20.0,
        "1",
        "the rotor of a wind turbine: 10",
    ),
    Check(
        "support",
        "bearings of a shaft that mesh forces push aside, in a scene that has bearings",
        None,
        None,
        "1",
        "a shaft without bearings is held rigidly: its forces go nowhere",
    ),
    Check(
        "mesh_load",
        "nominal mesh force over face width and module, of a mesh without a coast flank",
        0.05e6,
        None,
        "Pa",
        "ISO 6336-3: rated gears carry 30 to 150 N/mm^2",
    ),
    Check(
        "mesh_overload",
        "nominal mesh force over face width and module",
        None,
        1000e6,
        "Pa",
        "ISO 6336-3: practice is 30 to 300 N/mm^2",
    ),
)
CHECKS: dict[str, Check] = {check.name: check for check in _CHECKS}
"""All checks by name."""

assessed = Checklist(CHECKS).assessed
"""Function that yields a `Finding` where a value is beyond the bounds of a check, else nothing."""

ROLLING = (1e7, 1e10)
"""Usual stiffness of rolling bearings, N/m."""
USUAL_MISALIGNMENT = 0.002
"""Largest usual misalignment of a mesh over its face width, ISO 6336-1."""
NEGLIGIBLE_PUSH = 1e-6
"""Resultant of mesh forces over the sum of their amounts below which they cancel but for rounding."""
PRESSURE_ANGLE = math.radians(20.0)
"""Normal pressure angle of most gears, rad: a mesh does not state it, and its module follows from it."""
USUAL_LOAD = (20.0, 0.5)
"""Usual loads of teeth over the bounds of the checks "mesh_load" (1 MPa) and "mesh_overload" (500 MPa)."""


def scene_findings(scene: Scene) -> tuple[Finding, ...]:
    """Return the implausible values of a scene that can move.

    Raises `InputError`: the parts of the scene do not fit each other.
    """
    mechanism = mechanism_of(scene)
    return (
        *assessed("duration", "duration", scene.duration, "s", skip_zero=True),
        *_speeds(mechanism),
        *_bearings(scene),
        *_meshes(scene),
        *_bodies(mechanism),
        *_supports(mechanism),
        *_loads(mechanism),
    )


def _speeds(mechanism: Mechanism) -> Iterator[Finding]:
    """Check the fastest base circle that each drive or free rotation moves."""
    scene = mechanism.scene
    ratio = np.abs(mechanism.kinematics.float_ratio)  # (shafts, laws): speed of a shaft over that of a law
    radius = [
        max((g.base_radius for g in scene.gears if g.shaft == s.name), default=0.0) for s in scene.shafts
    ]
    for law, part in enumerate(scene.references):
        fastest = abs(part.speed.extreme)
        lever = float(np.max(ratio[:, law] * radius, initial=0.0))
        if law < len(scene.drives):  # laws are those of the drives, then those of the free rotations
            field = f"drives[{law}].speed"
        else:
            field = f"free_rotations[{law - len(scene.drives)}].initial_speed"
        reason = f"a gear turns at {fastest * lever:.3g} m/s"
        for finding in assessed("pitch_line_speed", field, fastest * lever, "rad/s", reason=reason):
            yield replace(finding, value=fastest, high=finding.high / lever)


def _bearings(scene: Scene) -> Iterator[Finding]:
    parts: list[tuple[str, Bushing | PlanetBearing]] = [
        *((f"bushings[{i}]", part) for i, part in enumerate(scene.bushings)),
        *((f"planet_bearings[{i}]", part) for i, part in enumerate(scene.planet_bearings)),
    ]
    paths = {part.name: path for path, part in parts}
    for path, part in parts:
        for name in ("radial_stiffness", "axial_stiffness"):
            value = float(getattr(part, name))
            for finding in assessed("support_stiffness", f"{path}.{name}", value, "N/m", skip_zero=True):
                yield replace(finding, low=ROLLING[0], high=ROLLING[1])
        yield from assessed("damping_ratio", f"{path}.damping_ratio", part.damping_ratio, "1")
    for law in scene.scene_bearing_laws:
        for item in law.plausible_values():
            path = f"{paths[law.bushing]}.{item.field}"
            yield from assessed(item.check, path, item.value, item.unit, skip_zero=item.skip_zero)


def _meshes(scene: Scene) -> Iterator[Finding]:
    for index, mesh in enumerate(scene.meshes):
        path = f"meshes[{index}]"
        yield from assessed("damping_ratio", f"{path}.damping_ratio", mesh.damping_ratio, "1")
        if mesh.coast is not None:
            yield from assessed("backlash", f"{path}.coast_flank.backlash", mesh.coast.backlash, "m")
        if mesh.friction is not None:
            yield from assessed("friction", f"{path}.friction", mesh.friction, "1")
        face = scene.gear(mesh.driver).face_width
        skew = mesh.misalignment
        text = f"a misalignment of {engineering(1e3 * abs(skew) / face, 2)} mrad"
        for check, scale in (("mesh_misalignment", 1.0), ("mesh_misalignment_over_face", face)):
            field = f"{path}.misalignment"
            for finding in assessed(check, field, skew, "m", scale=scale, reason=text, skip_zero=True):
                low = CHECKS["mesh_misalignment"].low or 0.0
                yield replace(finding, low=low, high=USUAL_MISALIGNMENT * face)


def _bodies(mechanism: Mechanism) -> Iterator[Finding]:
    for index, shaft in enumerate(mechanism.scene.shafts):
        yield from _shaft(f"shafts[{index}]", shaft)
    for index, gear in enumerate(mechanism.scene.gears):
        yield from _gyration("gear_inertia", f"gears[{index}]", gear.inertia, gear.base_radius)
    for index, rotor in enumerate(mechanism.rotors):
        if rotor.radial_stiffness or rotor.axial_stiffness:
            reason = "bearings carry a shaft and gears without mass"
            yield from assessed(
                "mass", f"shafts[{index}].inertia.mass", rotor.inertia.mass, "kg", reason=reason
            )


def _shaft(path: str, shaft: Shaft) -> Iterator[Finding]:
    if shaft.sections:
        widest = max(max(section.outer_diameters) for section in shaft.sections)
        reason = f"{shaft.length / widest:.3g} diameters long"
        yield from assessed(
            "shaft_slenderness", f"{path}.length", shaft.length, "m", scale=widest, reason=reason
        )
    for index, section in enumerate(shaft.sections):
        where = f"{path}.sections[{index}]"
        yield from assessed("shaft_density", f"{where}.density", section.density, "kg/m^3")
        yield from assessed("shaft_modulus", f"{where}.youngs_modulus", section.youngs_modulus, "Pa")
    yield from assessed("material_damping", f"{path}.damping_ratio", shaft.damping_ratio, "1")
    yield from _gyration("shaft_inertia", path, shaft.inertia, shaft.length)


def _gyration(check: str, path: str, inertia: Inertia, size: float) -> Iterator[Finding]:
    """Check the radius of gyration of a body that has mass and inertia, against a length of it (m)."""
    if inertia.mass <= 0.0 or inertia.polar <= 0.0:
        return
    radius, scale = math.sqrt(inertia.polar / inertia.mass), inertia.mass * size**2
    reason = f"a radius of gyration of {1e3 * radius:.3g} mm"
    for finding in assessed(check, f"{path}.inertia.polar", radius / size, "kg m^2", reason=reason):
        low, high = finding.low**2 * scale, finding.high**2 * scale
        yield replace(finding, value=inertia.polar, low=low, high=high)


def _supports(mechanism: Mechanism) -> Iterator[Finding]:
    """Check that something carries the shafts that mesh forces push aside, where there are bearings."""
    rotors = mechanism.rotors
    if "x" not in mechanism.additions.possible:  # no effect moves shafts sideways
        return
    if not any(rotor.radial_stiffness for rotor in rotors):
        return
    for index, rotor in enumerate(rotors):
        push, total = _push(mechanism, index)
        turns = mechanism.kinematics.sense[index] != 0
        if turns and not rotor.radial_stiffness and push > NEGLIGIBLE_PUSH * total:
            name, source = rotor.shaft.name, CHECKS["support"].source
            reason = f'nothing carries "{name}" under {push:.4g} N of its meshes: it is held rigidly'
            yield Finding("support", f"shafts[{index}]", 0.0, 0.0, math.inf, "1", reason, source)


def _push(mechanism: Mechanism, index: int) -> tuple[float, float]:
    """Return the resultant of the mesh forces across a shaft, and the sum of their amounts, N."""
    scene, total, sum_of_forces = mechanism.scene, np.zeros(2), 0.0
    for mesh, line, force in zip(scene.meshes, mechanism.lines, mechanism.nominal_force, strict=True):
        for name, sign in ((mesh.driver, -1.0), (mesh.driven, 1.0)):
            if scene.gear(name).shaft == scene.shafts[index].name:
                across: FloatArray = sign * float(force) * np.array(line.force[:2], dtype=float)
                total, sum_of_forces = total + across, sum_of_forces + float(np.hypot(*across))
    return float(np.hypot(*total)), sum_of_forces


def _loads(mechanism: Mechanism) -> Iterator[Finding]:
    """Check the nominal force of the meshes over face width and module; yield the first finding alone.

    The finding names the field of the largest load, since all forces scale with it.
    """
    scene = mechanism.scene
    if not scene.loads:
        return
    torques = [float(load.torque(0.0)) for load in scene.loads]  # at standstill
    largest = max(range(len(torques)), key=lambda index: abs(torques[index]))
    torque = torques[largest]
    for mesh, force in zip(scene.meshes, mechanism.nominal_force, strict=True):
        driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
        module = driver.base_pitch / (math.pi * math.cos(PRESSURE_ANGLE))
        intensity = float(force) / (min(driver.face_width, driven.face_width) * module)
        text = f'"{mesh.name}" carries {intensity / 1e6:.3g} N/mm^2 of load over face width and module'
        light = () if mesh.coast is not None else assessed("mesh_load", "", intensity, "Pa", skip_zero=True)
        for finding in (*light, *assessed("mesh_overload", "", intensity, "Pa")):
            low = USUAL_LOAD[0] * (CHECKS["mesh_load"].low or 0.0)
            high = USUAL_LOAD[1] * (CHECKS["mesh_overload"].high or 0.0)
            part = abs(torque) / intensity  # torque of the load per Pa
            yield replace(
                finding,
                field=f"loads[{largest}].torque",
                value=torque,
                unit="N m",
                reason=text,
                low=low * part,
                high=high * part,
            )
            return
