"""The plausibility checks of gear pairs and their results."""

from __future__ import annotations

from collections.abc import Sequence

from bounds import Check, Checklist, Finding

_PARTS = (
    Check(
        "module",
        "normal module",
        low=0.05e-3,
        high=0.1,
        unit="m",
        source="DIN 780-1 and ISO 54: 0.05 to 60 mm",
    ),
    Check(
        "face_width",
        "face width over normal module",
        low=1.0,
        high=100.0,
        unit="1",
        source="Niemann/Winter, Maschinenelemente 2: 6 to 40 in practice",
    ),
    Check(
        "bore",
        "bore over root diameter",
        low=0.005,
        high=None,
        unit="1",
        source="a bore that a drill can make; beyond the root is refused",
    ),
    Check(
        "pressure_angle",
        "normal pressure angle",
        low=0.2,
        high=0.56,
        unit="rad",
        source="ISO 53 and AGMA 1106: 14.5° to 30°",
    ),
    Check(
        "helix_angle",
        "helix angle where there is one",
        low=0.017,
        high=0.8,
        unit="rad",
        source="Niemann/Winter: 5 to 45 deg in practice",
    ),
    Check(
        "youngs_modulus",
        "Young's modulus",
        low=0.1e9,
        high=700e9,
        unit="Pa",
        source="from elastomers (0.1 GPa) to tungsten carbide (690 GPa)",
    ),
    Check(
        "density", "density", low=500.0, high=20e3, unit="kg/m^3", source="from foamed plastics to tungsten"
    ),
)
_DEVIATIONS = (
    Check(
        "relief_amount",
        "amount of a modification, allowance or pitch deviation that is not 0",
        low=0.1e-6,
        high=None,
        unit="m",
        source="ISO 1328-1: class 1 allows about 1 µm",
    ),
    Check(
        "relief_over_module",
        "amount of a modification or pitch deviation over normal module",
        low=None,
        high=0.1,
        unit="1",
        source="ISO 21771-1: reliefs are some hundredths of a module",
    ),
    Check(
        "relief_length",
        "length of a tip or root relief over normal module",
        low=0.01,
        high=None,
        unit="1",
        source="ISO 21771-1: it reaches from the tip towards the pitch circle",
    ),
    Check(
        "misalignment",
        "largest misalignment that is not 0",
        low=0.1e-6,
        high=None,
        unit="m",
        source="ISO 1328-1: class 1 allows about 1 µm",
    ),
    Check(
        "misalignment_over_face",
        "misalignment over face width",
        low=None,
        high=0.02,
        unit="1",
        source="ISO 6336-1: mesh misalignments are below 0.002",
    ),
    Check(
        "center_distance_change",
        "largest change of the center distance that is not 0",
        low=0.1e-6,
        high=None,
        unit="m",
        source="ISO 286-1: grades of center distances begin at 1 µm",
    ),
)
_SHAFTS = (
    Check(
        "shaft_slenderness",
        "distance between the bearings over diameter of the shaft",
        low=0.1,
        high=100.0,
        unit="1",
        source="shafts of gearboxes: 1 to 20",
    ),
    Check(
        "bearing_stiffness",
        "radial stiffness of a bearing under a bending shaft",
        low=1e6,
        high=2e10,
        unit="N/m",
        source="rolling bearings: 20 N/µm (miniature) to 10 000 N/µm (main bearings of wind turbines)",
    ),
)
_LOADS = (
    Check(
        "light_load",
        "largest load of the table over face width and module",
        low=0.05e6,
        high=None,
        unit="Pa",
        source="ISO 6336-3: rated gears carry 30 to 150 N/mm^2",
    ),
    Check(
        "line_load",
        "load over face width and module",
        low=None,
        high=1000e6,
        unit="Pa",
        source="ISO 6336-3: at 1000 N/mm^2 the nominal root stress is 2.5 GPa; practice is 30 to 300",
    ),
    Check(
        "hertz_pressure",
        "contact pressure (before a run: nominal at the pitch point)",
        low=None,
        high=2.6e9,
        unit="Pa",
        source="ISO 6336-5: case-hardened flanks endure 1.65 GPa; "
        "ISO 6336-2: 1.6 times that at rest; they yield",
    ),
    Check(
        "root_stress",
        "tooth-root stress (before a run: nominal, load at the highest point of single contact)",
        low=None,
        high=2e9,
        unit="Pa",
        source="ISO 6336-5: case-hardened steel bears 1 GPa in pulsation; 2 GPa is its tensile strength",
    ),
    Check(
        "transmission_error",
        "mean transmission error over normal module (before a run: from 14 N/(mm µm))",
        low=None,
        high=0.1,
        unit="1",
        source="ISO 6336-1: steel teeth deflect by 0.001 to 0.01 modules; linear elasticity ends here",
    ),
)
_MESH = (
    Check(
        "tip_clearance",
        "tip clearance over normal module",
        low=0.1,
        high=None,
        unit="1",
        source="ISO 53: the basic racks leave 0.25 to 0.4",
    ),
    Check(
        "tip_thickness",
        "normal tooth thickness at the tip over normal module",
        low=0.2,
        high=None,
        unit="1",
        source="Roloff/Matek, Maschinenelemente: 0.2, case-hardened teeth 0.4",
    ),
    Check(
        "contact_ratio",
        "transverse contact ratio",
        low=1.1,
        high=None,
        unit="1",
        source="Roloff/Matek, Maschinenelemente: above 1.1, if possible 1.25",
    ),
)
CHECKS: dict[str, Check] = {check.name: check for check in (*_PARTS, *_DEVIATIONS, *_SHAFTS, *_LOADS, *_MESH)}
"""All checks by name."""

assessed = Checklist(CHECKS).assessed
"""Function that compares values with the limits of checks; it returns the findings."""

SOLVED = ("hertz_pressure", "transmission_error")
"""Names of the checks that a solved table assesses by its results."""


def merged(requested: Sequence[Finding], solved: Sequence[Finding]) -> tuple[Finding, ...]:
    """Return the findings of a request and of its results: solved values replace estimated ones."""
    return (*(finding for finding in requested if finding.check not in SOLVED), *solved)


def unexpected(requested: Sequence[Finding], solved: Sequence[Finding]) -> tuple[Finding, ...]:
    """Return the findings of results that those of the request did not announce."""
    expected = {finding.check for finding in requested}
    return tuple(finding for finding in solved if finding.check not in expected)
