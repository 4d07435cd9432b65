"""Export of a mesh element as an FMU file: its variables, model description, C header and binary."""

from __future__ import annotations

import hashlib
import re
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from uuid import UUID

import numpy as np

from dynamics.engines.fmu.compiler import binary_folder, compile_library, find_compiler
from dynamics.engines.fmu.header import c_header
from dynamics.engines.fmu.model_description import (
    BOOLEAN,
    INTEGER,
    REAL,
    TABLE_FILE,
    Variable,
    model_description,
)
from dynamics.engines.mesh_element import MeshElement
from dynamics.errors import InputError
from dynamics.meshes.mesh_table import FIELDS, MeshTable
from host.directories import atomic_file

MAGIC = b"LOAMESH1"
"""First bytes of the table's file: its format and version."""
_EARLIEST = (1980, 1, 1, 0, 0, 0)  # earliest time of a ZIP entry: equal exports give equal files
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_INTEGER_OUTPUTS = (
    Variable("contact_state", INTEGER, "output", "discrete", "0 apart, 1 driving, 2 coast flanks, 3 both"),
    Variable(
        "validity",
        INTEGER,
        "output",
        "discrete",
        "0 inside the table; plus 1 beyond its forces, 2 its misalignments, 4 its center distances",
    ),
)


def _input(name: str, unit: str, text: str, start: float = 0.0) -> Variable:
    return Variable(name, REAL, "input", "continuous", text, unit, start)


def _turns(name: str, text: str) -> Variable:
    return Variable(name, INTEGER, "input", "discrete", text, "", 0)


def _tunable(name: str, unit: str, text: str, start: float) -> Variable:
    return Variable(name, REAL, "parameter", "tunable", text, unit, float(start))


def _switch(name: str, text: str, start: bool) -> Variable:
    return Variable(name, BOOLEAN, "parameter", "fixed", text, "", start)


def _output(name: str, unit: str, text: str) -> Variable:
    return Variable(name, REAL, "output", "continuous", text, unit)


def _inputs(element: MeshElement) -> list[Variable]:
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


def _parameters(element: MeshElement) -> list[Variable]:
    """Return the variables that are set before a run, numbers also during it."""
    coast = element.coast
    # without a coast flank the values have no effect
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
    """
    target = Path(path)
    if target.suffix != ".fmu" or not target.parent.is_dir():
        raise InputError("path", str(path), "a file ending in .fmu in a folder that exists")
    if not _IDENTIFIER.fullmatch(name):
        raise InputError("name", name, "a C identifier: letters, digits and underscores")
    if binary:  # refused before the work is done
        find_compiler()
        if binary_folder() is None:
            remedy = "FMI 2.0 names no folder for its binaries."
            raise InputError("binary", True, "False on this machine", remedy)
    content = _content(element, name)
    if binary:
        content = {**content, **_binary(content, name)}
    _write(target, content)
    return target


def _content(element: MeshElement, name: str) -> dict[str, bytes]:
    """Return everything but the binary, by its path in the file."""
    # in each kind the settable variables first
    chosen = (*_inputs(element), *_parameters(element), *_REAL_OUTPUTS, *_INTEGER_OUTPUTS)
    table = _table_content(element.table)
    sources = {item.name: item.read_bytes() for item in files(__package__).joinpath("sources").iterdir()}
    compiled = sorted(file for file in sources if file.endswith(".c"))

    def described(guid: str) -> dict[str, bytes]:
        return {
            "modelDescription.xml": model_description(name, chosen, guid, compiled),
            "sources/variables.h": c_header(element, chosen, guid, _identity_of(table)).encode("ascii"),
        }

    content = {
        **{f"sources/{file}": text for file, text in sources.items() if file.endswith((".c", ".h"))},
        f"resources/{TABLE_FILE}": MAGIC + _identity_of(table).encode("ascii") + table,
    }
    # the identifier of the file is the hash of all members; those that state it are hashed with an empty one
    digest, members = hashlib.sha256(), {**content, **described("")}
    for member in sorted(members):
        digest.update(member.encode() + b"\0" + hashlib.sha256(members[member]).digest())
    return {**content, **described(f"{{{UUID(hex=digest.hexdigest()[:32])}}}")}


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
        compile_library(folder, sorted(file for file in sources if file.endswith(".c")), f"{name}{ending}")
        return {f"binaries/{platform}/{name}{ending}": (folder / f"{name}{ending}").read_bytes()}


def _write(target: Path, content: Mapping[str, bytes]) -> None:
    """Write the archive; no clock goes into it."""
    with atomic_file(target) as draft, zipfile.ZipFile(draft, "w", zipfile.ZIP_DEFLATED) as archive:
        for member in sorted(content):
            entry = zipfile.ZipInfo(member, _EARLIEST)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, content[member])
