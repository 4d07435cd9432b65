"""The generated C header of an FMU: value references, start values, constants of the gear pair."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dynamics.engines.fmu.model_description import BOOLEAN, INTEGER, REAL, TABLE_FILE, Variable
from dynamics.engines.mesh_element import MeshElement


def _of_kind(variables: Sequence[Variable], kind: str) -> list[Variable]:
    """Return the variables of `kind` in the order of their value references."""
    return [variable for variable in variables if variable.kind == kind]


def c_header(element: MeshElement, variables: Sequence[Variable], guid: str, identity: str) -> str:
    """Return variables.h; numbers are written as hexadecimal floats, which C99 reads without rounding."""
    parts = [_kind(_of_kind(variables, kind), kind.upper()) for kind in (REAL, INTEGER, BOOLEAN)]
    names = ", ".join(f'"{variable.name}"' for variable in _of_kind(variables, REAL))
    macros = {
        "GUID": f'"{guid}"',
        "TABLE_FILE": f'"{TABLE_FILE}"',
        "TABLE_IDENTITY": f'"{identity}"',
        "DRIVER_TEETH": str(element.teeth[0]),
        "DRIVEN_TEETH": str(element.teeth[1]),
        "DRIVER_BASE_RADIUS": _exact(element.base_radius[0]),
        "DRIVEN_BASE_RADIUS": _exact(element.base_radius[1]),
        "BASE_PITCH": _exact(element.base_pitch),
        "TAN_BASE_HELIX_ANGLE": _exact(math.tan(element.base_helix_angle)),
    }
    lines = [f"#define {name} {value}" for name, value in macros.items()]
    return "\n".join(
        [
            "/* Generated with the model description. */",
            "#ifndef VARIABLES_H",
            "#define VARIABLES_H",
            *parts,
            f"static const char *const REAL_NAMES[] = {{{names}}};",
            *lines,
            "#endif",
            "",
        ]
    )


def _kind(variables: Sequence[Variable], kind: str) -> str:
    """Value references and start values of one kind; what can be set comes first."""
    settable = [variable for variable in variables if variable.start is not None]
    if list(variables[: len(settable)]) != settable:
        raise AssertionError("outputs come after what can be set")
    names = ", ".join([*(variable.name.upper() for variable in variables), f"{kind}_COUNT"])
    start = ", ".join(
        _exact(variable.start or 0.0) if kind == "REAL" else str(int(variable.start or 0))
        for variable in variables
    )
    return f"enum {{{names}, {kind}_SETTABLE = {len(settable)}}};\n#define {kind}_START_VALUES {{{start}}}"


def _exact(value: float) -> str:
    return float(value).hex()
