"""The C compiler of the system, which makes the binary of an FMU."""

from __future__ import annotations

import os
import platform
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from dynamics.errors import DynamicsError, InputError

COMPILERS = ("cc", "gcc", "clang")
# -ffp-contract=off: the same rounding as the compiled look-up; -s and no paths: the same bytes every time
FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-ffp-contract=off", "-Wall", "-Wextra", "-I.")
_FOLDERS = {("Linux", "x86_64"): ("linux64", ".so"), ("Darwin", "x86_64"): ("darwin64", ".dylib")}
_SECONDS = 120  # most seconds of a compiler run


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
    remedy = (
        "Install one (Debian: apt-get install gcc), name one in CC, or write the sources alone: "
        "export_fmu(..., binary=False)."
    )
    raise InputError("CC", " ".join(requested) or None, "a C compiler on the path", remedy)


def compile_library(folder: Path, sources: Sequence[str], library: str) -> None:
    """Compile `sources` in `folder` into the shared library of that name there."""
    strip = [] if platform.system() == "Darwin" else ["-s"]
    command = [*find_compiler(), *FLAGS, *strip, "-o", library, *sources, "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=_SECONDS, check=False)
    if done.returncode != 0:
        raise CompilerError(f"{shlex.join(command)} failed:\n{done.stderr.strip()}")
