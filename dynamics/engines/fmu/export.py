"""Entry point: from a mesh element to an FMU file."""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
import zipfile
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

from dynamics.engines.fmu.compiler import binary_folder, compile_library, find_compiler
from dynamics.engines.fmu.header import TABLE_FILE, header
from dynamics.engines.fmu.model_description import model_description
from dynamics.engines.fmu.table_resource import identity_of, table_content, table_file
from dynamics.engines.fmu.variables import variables
from dynamics.engines.mesh_element import MeshElement
from dynamics.errors import InputError

_EARLIEST = (1980, 1, 1, 0, 0, 0)
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def export_fmu(
    element: MeshElement, path: str | Path, *, name: str = "gear_mesh", binary: bool = True
) -> Path:
    """Write `element` as an FMU: FMI 2.0, co-simulation, the table inside.

    The file holds the C sources and, compiled now with the system's C compiler, the binary for this machine.
    The same element gives the same bytes with the same compiler.

    Parameters
    ----------
    element : MeshElement
    path : path
        Ends in ``.fmu``; appears whole or not at all.
    name : str
        Model name: a C identifier.
    binary : bool
        False: sources alone, without a compiler; the host builds them.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        If the path or the name cannot be used, there is no C compiler, or FMI 2.0 has no folder for this
        machine's binaries.
    CompilerError
        If the compiler refuses the sources.
    """
    target = Path(path)
    if target.suffix != ".fmu" or not target.parent.is_dir():
        raise InputError("path", str(path), "a file ending in .fmu in a folder that exists")
    if not _IDENTIFIER.fullmatch(name):
        raise InputError("name", name, "a C identifier: letters, digits and underscores")
    if binary:
        _check_machine()
    content = _content(element, name)
    if binary:
        content = {**content, **_binary(content, name)}
    _write(target, content)
    return target


def _check_machine() -> None:
    """Refuse before the work is done."""
    find_compiler()
    if binary_folder() is None:
        raise InputError("binary", True, "False on this machine", "FMI 2.0 names no folder for its binaries.")


def _content(element: MeshElement, name: str) -> dict[str, bytes]:
    """Return everything but the binary, by its path in the file."""
    chosen, table = variables(element), table_content(element.table)
    own = {item.name: item.read_bytes() for item in files(__package__).joinpath("sources").iterdir()}
    compiled = sorted(file for file in own if file.endswith(".c"))

    def described(guid: str) -> dict[str, bytes]:
        return {
            "modelDescription.xml": model_description(name, chosen, guid, compiled),
            "sources/variables.h": header(element, chosen, guid, identity_of(table)).encode("ascii"),
        }

    content = {
        **{f"sources/{file}": text for file, text in own.items() if file.endswith((".c", ".h"))},
        f"resources/{TABLE_FILE}": table_file(table),
    }
    return {**content, **described(_guid({**content, **described("")}))}


def _guid(content: Mapping[str, bytes]) -> str:
    """Return an identifier of everything in the file but itself."""
    digest = hashlib.sha256()
    for member in sorted(content):
        digest.update(member.encode() + b"\0" + hashlib.sha256(content[member]).digest())
    text = digest.hexdigest()
    return "{" + "-".join((text[:8], text[8:12], text[12:16], text[16:20], text[20:32])) + "}"


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
    """Write the archive beside its path and move it there; no clock goes into it."""
    with tempfile.NamedTemporaryFile(dir=target.parent, suffix=".fmu", delete=False) as scratch:
        temporary = Path(scratch.name)
    try:
        with zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
            for member in sorted(content):
                entry = zipfile.ZipInfo(member, _EARLIEST)
                entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
                archive.writestr(entry, content[member])
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


def _umask() -> int:
    """Return the mask for new files."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
