"""From a mesh element to an FMU file: its variables, model description, C header and binary."""

from __future__ import annotations

import hashlib
import math
import os
import platform
import re
import shlex
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from xml.etree import ElementTree as Xml

import numpy as np

from dynamics.engines.mesh_element import MeshElement
from dynamics.errors import DynamicsError, InputError
from dynamics.meshes.mesh_table import FIELDS, MeshTable
from host.directories import whole_file

REAL, INTEGER, BOOLEAN = "Real", "Integer", "Boolean"
# exponents of the SI base units
_UNITS = {
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
}
_CAPABILITIES = (
    "canHandleVariableCommunicationStepSize",
    "canGetAndSetFMUstate",
    "canSerializeFMUstate",
    "canNotUseMemoryManagementFunctions",
)
COMPILERS = ("cc", "gcc", "clang")
# -ffp-contract=off: the same rounding as the compiled look-up; -s and no paths: the same bytes every time
FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-ffp-contract=off", "-Wall", "-Wextra", "-I.")
_FOLDERS = {("Linux", "x86_64"): ("linux64", ".so"), ("Darwin", "x86_64"): ("darwin64", ".dylib")}
_SECONDS = 120
TABLE_FILE = "mesh_force_table.bin"
MAGIC = b"LOAMESH1"
_EARLIEST = (1980, 1, 1, 0, 0, 0)
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


@dataclass(frozen=True)
class _Variable:
    """A variable by its name in the model description; its value reference is its index among its kind."""

    name: str
    kind: str
    causality: str
    variability: str
    text: str
    unit: str = ""
    start: float | None = None
    """None: an output, which follows from the others."""


def _of_kind(chosen: Sequence[_Variable], kind: str) -> list[_Variable]:
    """Return those of `kind` in the order of their value references."""
    return [variable for variable in chosen if variable.kind == kind]


def _input(name: str, unit: str, text: str, start: float = 0.0) -> _Variable:
    return _Variable(name, REAL, "input", "continuous", text, unit, start)


def _turns(name: str, text: str) -> _Variable:
    return _Variable(name, INTEGER, "input", "discrete", text, "", 0)


def _tunable(name: str, unit: str, text: str, start: float) -> _Variable:
    return _Variable(name, REAL, "parameter", "tunable", text, unit, float(start))


def _switch(name: str, text: str, start: bool) -> _Variable:
    return _Variable(name, BOOLEAN, "parameter", "fixed", text, "", start)


def _output(name: str, unit: str, text: str) -> _Variable:
    return _Variable(name, REAL, "output", "continuous", text, unit)


def _inputs(element: MeshElement) -> list[_Variable]:
    """Return the inputs; axes start at their knot nearest to zero."""
    return [
        _input("driver_angle", "rad", "Angle of the driver in the sense in which it drives"),
        _input("driven_angle", "rad", "Angle of the driven gear in the sense in which it is driven"),
        _input("driver_speed", "rad/s", "Rate of driver_angle"),
        _input("driven_speed", "rad/s", "Rate of driven_angle"),
        _input("displacement", "m", "Approach of the gears along the line of action by shafts that move"),
        _input("displacement_rate", "m/s", "Rate of displacement"),
        _input("coast_displacement", "m", "The same approach along the coast flank's line of action"),
        _input("coast_displacement_rate", "m/s", "Rate of coast_displacement"),
        _input(
            "misalignment", "m", "Position on the table's axis", _nearest_zero(element.table.misalignment)
        ),
        _input(
            "center_distance_change",
            "m",
            "Position on the table's axis",
            _nearest_zero(element.table.center_distance_change),
        ),
        _turns("driver_turns", "Whole revolutions in addition to driver_angle, exact for any number"),
        _turns("driven_turns", "Whole revolutions in addition to driven_angle"),
    ]


def _nearest_zero(knots: Sequence[float] | np.ndarray) -> float:
    array = np.atleast_1d(np.asarray(knots, dtype=float))
    return float(array[np.argmin(np.abs(array))])


def _parameters(element: MeshElement) -> list[_Variable]:
    """Return what is set before a run, numbers also during it."""
    coast = element.coast
    backlash, thickness = (0.0, 0.5) if coast is None else (coast.backlash, coast.thickness)
    along = "Backlash along the transverse line of action at zero displacements"
    share = "Tooth thickness of the driver over the pitch, on the operating pitch circle"
    touching = "True: the coast flanks touch where the backlash is used up"
    from_angles = "True: r_b1 driver_angle - r_b2 driven_angle + displacement; false: displacement is the dte"
    return [
        _tunable("damping", "N.s/m", "In full contact", element.damping),
        _tunable("damping_reach", "N", "Elastic force from which the damping acts in full", element.reach),
        _tunable("position_offset", "", "Position at zero angle in base pitches", element.position_offset),
        _tunable("backlash", "m", along, backlash),
        _tunable("tooth_thickness", "", share, thickness),
        _switch("coast_flank", touching, coast is not None),
        _switch("dte_from_angles", from_angles, True),
    ]


_REAL_OUTPUTS = (
    _output("mesh_force", "N", "Transverse force of the flanks along the line of action, damping included"),
    _output("elastic_force", "N", "Part of mesh_force from the table, without damping"),
    _output("driver_torque", "N.m", "Torque on the driver in its own sense: against its motion"),
    _output("driven_torque", "N.m", "Torque on the driven gear in its own sense: along its motion"),
    _output("driver_axial_force", "N", "Force on the driver along the axis about which it turns positively"),
    _output("dte", "m", "Dynamic transmission error; positive: the driven gear lags"),
    _output("dte_rate", "m/s", "Its rate"),
    _output("position", "", "Base pitches by the driver's angle, from 0 to the period of the table"),
    _output("stiffness", "N/m", "Derivative of mesh_force in the dte"),
    _output("viscosity", "N.s/m", "Derivative of mesh_force in dte_rate"),
    _output("coast_force", "N", "Transverse force of the coast flanks along theirs, damping included"),
    _output("coast_approach", "m", "Approach of the coast flanks; positive: the backlash is used up"),
    _output("coast_stiffness", "N/m", "Derivative of coast_force in coast_approach"),
    _output("coast_viscosity", "N.s/m", "Derivative of coast_force in its rate"),
)
_INTEGER_OUTPUTS = (
    _Variable("contact_state", INTEGER, "output", "discrete", "0 apart, 1 driving, 2 coast flanks, 3 both"),
    _Variable(
        "validity",
        INTEGER,
        "output",
        "discrete",
        "0 inside the table; plus 1 beyond its forces, 2 its misalignments, 4 its center distances",
    ),
)


def _model_description(name: str, chosen: Sequence[_Variable], guid: str, sources: Sequence[str]) -> bytes:
    """Return the XML; it holds no date, so that the same table gives the same file.

    `name` is a C identifier; `sources` are the C files to compile, in ``sources/``.
    """
    root = Xml.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=name,
        guid=guid,
        description="Gear mesh force from a static-transmission-error table",
        generationTool="lineofaction",
        variableNamingConvention="flat",
        numberOfEventIndicators="0",
    )
    simulated = {"modelIdentifier": name, **dict.fromkeys(_CAPABILITIES, "true")}
    files = Xml.SubElement(Xml.SubElement(root, "CoSimulation", simulated), "SourceFiles")
    for source in sources:
        Xml.SubElement(files, "File", name=source)
    definitions = Xml.SubElement(root, "UnitDefinitions")
    for unit_name, exponents in _UNITS.items():
        unit = Xml.SubElement(definitions, "Unit", name=unit_name)
        Xml.SubElement(unit, "BaseUnit", {base: str(power) for base, power in exponents.items()})
    _add_variables(root, chosen)
    _add_structure(root, chosen)
    Xml.indent(root)
    content: bytes = Xml.tostring(root, encoding="UTF-8", xml_declaration=True)
    return content + b"\n"


def _add_variables(root: Xml.Element, chosen: Sequence[_Variable]) -> None:
    section, count = Xml.SubElement(root, "ModelVariables"), dict.fromkeys((REAL, INTEGER, BOOLEAN), 0)
    for variable in chosen:
        entry = Xml.SubElement(
            section,
            "ScalarVariable",
            name=variable.name,
            valueReference=str(count[variable.kind]),
            description=variable.text,
            causality=variable.causality,
            variability=variable.variability,
        )
        count[variable.kind] += 1
        facts = {"unit": variable.unit} if variable.unit else {}
        if variable.start is not None:
            truth = "true" if variable.start else "false"
            facts["start"] = truth if variable.kind == BOOLEAN else repr(variable.start)
        Xml.SubElement(entry, variable.kind, facts)


def _add_structure(root: Xml.Element, chosen: Sequence[_Variable]) -> None:
    """Every output depends on every input, at once."""
    structure = Xml.SubElement(root, "ModelStructure")
    for section in ("Outputs", "InitialUnknowns"):
        listed = Xml.SubElement(structure, section)
        for index, variable in enumerate(chosen, start=1):
            if variable.causality == "output":
                Xml.SubElement(listed, "Unknown", index=str(index))


# The system's C compiler, which makes the FMU's binary.


class CompilerError(DynamicsError):
    """The C compiler refused the FMU's sources; its message is the text."""


def binary_folder() -> tuple[str, str] | None:
    """Return folder in ``binaries/`` and ending of this machine's binary; None where FMI 2.0 has none."""
    return _FOLDERS.get((platform.system(), platform.machine()))


def find_compiler() -> list[str]:
    """Return the command of the C compiler: ``CC`` from the environment, or the first of cc, gcc, clang.

    Raises `InputError`: there is none.
    """
    requested = shlex.split(os.environ.get("CC", ""))
    for command in [requested] if requested else [[name] for name in COMPILERS]:
        if shutil.which(command[0]) is not None:
            return command
    advice = (
        "Install one (Debian: apt-get install gcc), name one in CC, or write the sources alone: "
        "export_fmu(..., binary=False)."
    )
    raise InputError("CC", " ".join(requested) or None, "a C compiler on the path", advice)


def _compile_library(folder: Path, sources: Sequence[str], library: str) -> None:
    """Compile `sources` in `folder` into the shared library of that name there."""
    strip = [] if platform.system() == "Darwin" else ["-s"]
    command = [*find_compiler(), *FLAGS, *strip, "-o", library, *sources, "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=_SECONDS, check=False)
    if done.returncode != 0:
        raise CompilerError(f"{shlex.join(command)} failed:\n{done.stderr.strip()}")


# The generated C header: value references, start values and the facts of the pair.


def _header(element: MeshElement, chosen: Sequence[_Variable], guid: str, identity: str) -> str:
    """Return variables.h; numbers are written as hexadecimal floats, which C99 reads without rounding."""
    parts = [_kind(_of_kind(chosen, kind), kind.upper()) for kind in (REAL, INTEGER, BOOLEAN)]
    names = ", ".join(f'"{variable.name}"' for variable in _of_kind(chosen, REAL))
    facts = {
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
    lines = [f"#define {name} {value}" for name, value in facts.items()]
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


def _kind(chosen: Sequence[_Variable], kind: str) -> str:
    """Value references and start values of one kind; what can be set comes first."""
    settable = [variable for variable in chosen if variable.start is not None]
    if list(chosen[: len(settable)]) != settable:
        raise AssertionError("outputs come after what can be set")
    names = ", ".join([*(variable.name.upper() for variable in chosen), f"{kind}_COUNT"])
    start = ", ".join(
        _exact(variable.start or 0.0) if kind == "REAL" else str(int(variable.start or 0))
        for variable in chosen
    )
    return f"enum {{{names}, {kind}_SETTABLE = {len(settable)}}};\n#define {kind}_START_VALUES {{{start}}}"


def _exact(value: float) -> str:
    return float(value).hex()


# The mesh-force table as the FMU's resource: plain little-endian numbers.


def _table_content(table: MeshTable) -> bytes:
    """Return five sizes (M, D, P, L, period) and the arrays: axes, positions, levels, nodes.

    Nodes (M, D, P, L, 4) hold deflection, its slope, stiffness, its slope.
    """
    axes = [table.misalignment, table.center_distance_change, table.position, table.level]
    flat = [np.atleast_1d(np.asarray(axis, dtype="<f8")) for axis in axes]
    sizes = np.array([*(axis.size for axis in flat), table.period], dtype="<u8")
    nodes = np.stack([np.asarray(getattr(table, name), dtype="<f8") for name in FIELDS], axis=-1)
    return b"".join([sizes.tobytes(), *(axis.tobytes() for axis in flat), nodes.tobytes()])


def _identity_of(content: bytes) -> str:
    """Return 32 hexadecimal digits by which the unit knows its table."""
    return hashlib.sha256(content).hexdigest()[:32]


def export_fmu(
    element: MeshElement, path: str | Path, *, name: str = "gear_mesh", binary: bool = True
) -> Path:
    """Write `element` as an FMU: FMI 2.0, co-simulation, the table inside.

    The file holds the C sources and, compiled now with the system's C compiler, the binary for this machine.
    The same element gives the same bytes with the same compiler. Raises `InputError`: the path or the name
    cannot be used, there is no C compiler, or FMI 2.0 has no folder for this machine's binaries;
    `CompilerError`: the compiler refuses the sources.

    Parameters
    ----------
    path : path
        Ends in ``.fmu``; appears whole or not at all.
    name : str
        Model name: a C identifier.
    binary : bool
        False: sources alone, without a compiler; the host builds them.

    Returns
    -------
    Path
    """
    target = Path(path)
    if target.suffix != ".fmu" or not target.parent.is_dir():
        raise InputError("path", str(path), "a file ending in .fmu in a folder that exists")
    if not _IDENTIFIER.fullmatch(name):
        raise InputError("name", name, "a C identifier: letters, digits and underscores")
    if binary:  # refused before the work is done
        find_compiler()
        if binary_folder() is None:
            advice = "FMI 2.0 names no folder for its binaries."
            raise InputError("binary", True, "False on this machine", advice)
    content = _content(element, name)
    if binary:
        content = {**content, **_binary(content, name)}
    _write(target, content)
    return target


def _content(element: MeshElement, name: str) -> dict[str, bytes]:
    """Return everything but the binary, by its path in the file."""
    # of each kind those that can be set first
    chosen = (*_inputs(element), *_parameters(element), *_REAL_OUTPUTS, *_INTEGER_OUTPUTS)
    table = _table_content(element.table)
    own = {item.name: item.read_bytes() for item in files(__package__).joinpath("sources").iterdir()}
    compiled = sorted(file for file in own if file.endswith(".c"))

    def described(guid: str) -> dict[str, bytes]:
        return {
            "modelDescription.xml": _model_description(name, chosen, guid, compiled),
            "sources/variables.h": _header(element, chosen, guid, _identity_of(table)).encode("ascii"),
        }

    content = {
        **{f"sources/{file}": text for file, text in own.items() if file.endswith((".c", ".h"))},
        f"resources/{TABLE_FILE}": MAGIC + _identity_of(table).encode("ascii") + table,
    }
    digest, whole = hashlib.sha256(), {**content, **described("")}
    for member in sorted(whole):
        digest.update(member.encode() + b"\0" + hashlib.sha256(whole[member]).digest())
    text = digest.hexdigest()
    guid = "{" + "-".join((text[:8], text[8:12], text[12:16], text[16:20], text[20:32])) + "}"
    return {**content, **described(guid)}


def _binary(content: Mapping[str, bytes], name: str) -> dict[str, bytes]:
    """Compile the sources in a folder of their own."""
    target = binary_folder()
    if target is None:
        return {}
    platform, ending = target
    with tempfile.TemporaryDirectory(prefix="loa-fmu-") as scratch:
        folder = Path(scratch)
        sources = {Path(file).name: text for file, text in content.items() if file.startswith("sources/")}
        for file, text in sources.items():
            (folder / file).write_bytes(text)
        _compile_library(folder, sorted(file for file in sources if file.endswith(".c")), f"{name}{ending}")
        return {f"binaries/{platform}/{name}{ending}": (folder / f"{name}{ending}").read_bytes()}


def _write(target: Path, content: Mapping[str, bytes]) -> None:
    """Write the archive; no clock goes into it."""
    with whole_file(target) as draft, zipfile.ZipFile(draft, "w", zipfile.ZIP_DEFLATED) as archive:
        for member in sorted(content):
            entry = zipfile.ZipInfo(member, _EARLIEST)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, content[member])
