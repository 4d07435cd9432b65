"""Machine code of modules, kept in memory and, for other processes, beside that of the ordinary loops."""

from __future__ import annotations

from collections import OrderedDict
from contextlib import suppress
from ctypes import CFUNCTYPE, c_double, c_int64, c_void_p
from hashlib import sha256
from pathlib import Path
from tempfile import NamedTemporaryFile
from threading import Lock
from typing import Any

import llvmlite.binding as llvm

from dynamics.structure_code.module import Module

MAX_IN_MEMORY, MAX_IN_FILES = 32, 256  # most structures whose code stays in memory, and in files
SUFFIX = ".structure"
_DIGEST_BYTES = 32
"""Bytes of the SHA-256 with which a file begins."""


class MachineCode:
    """Machine code ready to run; it stays as long as this object."""

    def __init__(self, code: bytes) -> None:
        empty = llvm.parse_assembly("")
        empty.triple = llvm.get_process_triple()
        self._engine = llvm.create_mcjit_compiler(empty, _machine())
        self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()

    def call(self, name: str, *arguments: Any) -> int:
        """Call a function without the interpreter's lock; its arguments are floats, and tuples by address."""
        kinds = [c_double if isinstance(argument, float) else c_void_p for argument in arguments]
        function = CFUNCTYPE(c_int64, *kinds)(self._engine.get_function_address(name))
        passed = (argument if isinstance(argument, float) else argument._address for argument in arguments)
        return int(function(*passed))


def _machine() -> Any:
    """Return a target for this machine's processor; each engine needs a target of its own."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    processor = {"cpu": llvm.get_host_cpu_name(), "features": llvm.get_host_cpu_features().flatten()}
    return llvm.Target.from_default_triple().create_target_machine(opt=3, jit=True, **processor)


def compiled(module: Module) -> bytes:
    """Return the machine code of a module.

    Loops are vectorized, single scalars are not: gathering few of them costs more than vectors save.
    """
    parsed, target = llvm.parse_assembly(str(module.module)), _machine()
    parsed.triple, parsed.data_layout = llvm.get_process_triple(), str(target.target_data)
    parsed.verify()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization, options.slp_vectorization = True, False
    builder = llvm.create_pass_builder(target, options)
    builder.getModulePassManager().run(parsed, builder)
    return bytes(target.emit_object(parsed))


class CodeStore:
    """Code by structure: in memory, and in files of `folder` with a digest of their content.

    An empty file says that the structure has been run. Code whose file cannot be read or written is made
    anew.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._lock = folder, Lock()
        self._loaded: OrderedDict[str, MachineCode] = OrderedDict()

    def get(self, key: str) -> MachineCode | None:
        """Return the code of a structure, or None if there is none."""
        with self._lock:
            if key in self._loaded:
                self._loaded.move_to_end(key)
                return self._loaded[key]
        with suppress(OSError):
            content = self._file(key).read_bytes()
            digest, code = content[:_DIGEST_BYTES], content[_DIGEST_BYTES:]
            if code and sha256(code).digest() == digest:
                return self._hold(key, MachineCode(code))
        return None

    def seen(self, key: str) -> bool:
        """Return whether a process has run the structure."""
        return self._file(key).exists()

    def note(self, key: str) -> None:
        """Note that a process has run the structure."""
        if not self.seen(key):
            self._write(key, b"")

    def add(self, key: str, module: Module) -> MachineCode:
        """Make the code of a structure."""
        code = compiled(module)
        self._write(key, sha256(code).digest() + code)
        return self._hold(key, MachineCode(code))

    def _hold(self, key: str, code: MachineCode) -> MachineCode:
        with self._lock:
            self._loaded[key] = code
            while len(self._loaded) > MAX_IN_MEMORY:
                self._loaded.popitem(last=False)
        return code

    def _file(self, key: str) -> Path:
        return self._folder / (key + SUFFIX)

    def _write(self, key: str, content: bytes) -> None:
        with suppress(OSError):
            with NamedTemporaryFile(dir=self._folder, delete=False) as new:
                new.write(content)
            Path(new.name).replace(self._file(key))
            files = sorted(self._folder.glob("*" + SUFFIX), key=lambda file: file.stat().st_mtime)
            for old in files[:-MAX_IN_FILES]:
                old.unlink()
