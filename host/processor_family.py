"""The family of processors that loops are compiled for, so that files made on one machine serve another.

numba compiles for the processor it runs on, by name, and its files serve that one alone. A family is a level
of x86-64 that compilers agree on: what it has, each of its processors has. On another architecture, or where
the environment names a processor (NUMBA_CPU_NAME, NUMBA_CPU_FEATURES), numba decides.
"""

# mypy: disable-error-code="no-untyped-call, attr-defined"
from __future__ import annotations

import os
import platform
from collections.abc import Mapping

import llvmlite.binding
from numba.core import config

_V3 = ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave")
_V4 = (*_V3, "avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl")
FAMILIES = {"x86-64-v4": _V4, "x86-64-v3": _V3}
"""Features of each family in LLVM's names, beyond the features that both have; the first match counts."""


def family_of(flags: Mapping[str, bool], machine: str) -> str | None:
    """Return the family of a processor with some features, None where there is none."""
    if machine.lower() not in {"x86_64", "amd64"}:
        return None
    return next((name for name, needs in FAMILIES.items() if all(flags.get(flag) for flag in needs)), None)


def compile_for_family() -> None:
    """Let numba compile for the family of this processor; before it compiles anything."""
    if "NUMBA_CPU_NAME" in os.environ or "NUMBA_CPU_FEATURES" in os.environ:
        return
    if family := family_of(llvmlite.binding.get_host_cpu_features(), platform.machine()):
        config.CPU_NAME = family
        config.CPU_FEATURES = ""  # those that the name implies
