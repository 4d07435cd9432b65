"""Compiled loops: one process compiles for all, and inner loops become part of their callers."""

import gc
import os
import subprocess
import sys
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numba.core.codegen import JITCodeLibrary

from host import loops, shared_loops

LOOP = """
import sys
import numpy as np
from host.loops import njit

@njit(cache=True)
def middle_of(x):
    return np.median(np.sort(np.full(9, x)))


if __name__ == "__main__":
    print("ready", flush=True)
    sys.stdin.readline()
    middle_of(2.0)
    print(sum(middle_of.stats.cache_misses.values()), flush=True)
"""

READ = """
import numpy as np
from host.loops import njit
from numba.core.runtime.nrt import rtsys

@njit(cache=True)
def spectrum(x):
    return np.sin(np.outer(x, x)) @ np.sort(x)[::-1].copy()

@njit
def length(x):
    return np.sqrt(np.sum(x**2))

if __name__ == "__main__":
    x = np.arange(1.0, 4.0)
    result = spectrum(x)
    print(sum(spectrum.stats.cache_hits.values()), rtsys._init, result.tobytes().hex())
    print(length(x) == 14.0**0.5, rtsys._init)
"""


def test_a_loop_that_is_read_loads_nothing_of_the_compiler_which_later_ones_get(tmp_path):
    file = tmp_path / "loop.py"
    file.write_text(READ, encoding="utf-8")
    house = str(Path(loops.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": house, "NUMBA_CACHE_DIR": str(tmp_path / "kept")}
    compiled, read = (
        subprocess.run(
            [sys.executable, str(file)], env=environment, capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(2)
    )
    assert compiled[:2] == ["0", "True"]
    assert read[:2] == ["1", "False"]
    assert read[2:] == [compiled[2], "True", "True"]


def test_processes_that_need_a_loop_at_once_compile_it_once(tmp_path):
    file = tmp_path / "loop.py"
    file.write_text(LOOP, encoding="utf-8")
    house = str(Path(loops.__file__).parents[1])
    command = partial(
        subprocess.Popen,
        [sys.executable, str(file)],
        env={**os.environ, "PYTHONPATH": house, "NUMBA_CACHE_DIR": str(tmp_path / "kept")},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with ExitStack() as stack:
        children = [stack.enter_context(command()) for _ in range(3)]
        for child in children:
            assert child.stdout.readline() == "ready\n"
        for child in children:
            child.stdin.write("\n")
            child.stdin.flush()
        compiled = [int(child.communicate()[0]) for child in children]
    assert sorted(compiled) == [0, 0, 1]


def test_an_inner_loop_is_part_of_its_callers_and_python_may_call_it_too():
    @loops.inner(error_model="numpy")
    def reciprocal(x):
        return 1.0 / x

    @loops.inner()
    def twice(x):
        return 2.0 * reciprocal(x)

    @loops.njit
    def outer(x):
        return twice(x) + reciprocal(x)

    assert outer(0.0) == float("inf")
    assert twice(4.0) == reciprocal(2.0) == 0.5
    for loop in (reciprocal, twice):
        (linked,) = loop.overloads.values()
        assert linked.library.get_pointer_to_function(linked.fndesc.llvm_func_name) == 0
        assert not any("cpython" in each.name for each in linked.library.get_defined_functions())


def test_what_a_loop_takes_of_numba_becomes_part_of_it(monkeypatch):
    made: list[str] = []
    finalize = JITCodeLibrary._finalize_final_module

    def counted(library):
        made.append(library.name)
        finalize(library)

    monkeypatch.setattr(JITCodeLibrary, "_finalize_final_module", counted)

    @loops.njit
    def spread(values, count):
        spread = np.zeros((count, 2))
        spread[:, 0] = np.cumsum(np.repeat(values, 2))
        return spread

    assert spread(np.array([1.0, 2.0]), 4)[:, 0].tolist() == [1.0, 2.0, 4.0, 6.0]
    assert not [name for name in made if "impl" in name]
    with pytest.raises(ValueError, match="different size"):
        spread(np.array([1.0]), 4)


def test_the_collector_goes_on_after_compiling():
    with shared_loops._nothing_collected(), shared_loops._nothing_collected():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_numba_as_it_is_gives_the_same():
    code = """
import numba
from host import loops

@loops.inner(error_model="numpy")
def reciprocal(x):
    return 1.0 / x

@loops.njit(cache=True, error_model="numpy")
def outer(x):
    return reciprocal(x) + 1.0

print(loops.PLAIN, outer(0.0), outer(4.0), type(outer).__module__, numba.config.CPU_NAME)
"""
    environment = {**os.environ, "LOA_PLAIN_LOOPS": "1", "PYTHONPATH": str(Path(loops.__file__).parents[1])}
    command = [sys.executable, "-c", code]
    answer = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
    assert answer == "True inf 1.25 numba.core.registry None\n"
