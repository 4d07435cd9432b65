"""Assessed designs on disk: a search that was killed, or may use more evaluations, continues."""

from __future__ import annotations

import contextlib
import hashlib
import os
import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from bounds import written
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.optimization import OptimizationRequest
from fe_contact.solver_version import SOLVER_VERSION
from fe_contact.ste.metadata import SCHEMA_VERSION, content_hash
from fe_contact.types import FloatArray

MAX_FILES = 200
"""Number of newest files that stay in the directory; each has about 0.1 MB for a thousand designs."""


_RECORD = struct.Struct("<ddQ")  # objective, violation, checksum


_POSITIONS = 8  # bytes of the digest of the positions
Figures = tuple[float, float]  # objective in m, violation


@dataclass(frozen=True)
class DesignMemory:
    """Objective in m and violation of designs of one problem; the keys are their values and the positions."""

    file: Path
    known: dict[bytes, Figures] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, directory: Path, request: OptimizationRequest, evaluator: Evaluator) -> DesignMemory:
        """Open the file of a problem; of a damaged file the records before the damage are read."""
        digest = hashlib.sha256()
        contact = evaluator.contact
        for body in contact.plane or ():
            digest.update(body.matrix.tobytes())
        for solid in contact.face or ():
            digest.update(solid.blocks.tobytes())
        content = {
            "pair": written(request.pair),
            "variables": [variable.name for variable in request.variables],
            "bodies": digest.hexdigest(),
            "effects": dict(evaluator.choices),
            "load": evaluator.load.tolist(),
            "misalignment": evaluator.misalignment.tolist(),
            "scatter": request.scatter.to_json(),
            "objective": request.objective.to_json(),
            "limits": request.limits.to_json(),
        }
        key = content_hash(content, SOLVER_VERSION, SCHEMA_VERSION)
        memory = cls(directory / f"designs-{key}.bin")
        with contextlib.suppress(OSError):
            directory.mkdir(parents=True, exist_ok=True)
            files = sorted(directory.glob("designs-*.bin"), key=lambda file: file.stat().st_mtime)
            for file in files[:-MAX_FILES]:
                file.unlink(missing_ok=True)
            memory._read(_POSITIONS + 8 * len(request.variables))
        return memory

    def find(self, values: FloatArray, position: FloatArray) -> Figures | None:
        """Return the stored evaluation of a design (d,) in m at some positions."""
        return self.known.get(_name(values, position))

    def add(self, values: FloatArray, position: FloatArray, figures: Figures) -> None:
        """Store a design; where the file cannot be written it stays in the memory of this process."""
        name = _name(values, position)
        self.known[name] = figures
        text = name + struct.pack("<dd", *figures)
        record = text + struct.pack("<Q", zlib.crc32(text))
        with contextlib.suppress(OSError), self.file.open("ab", buffering=0) as stream:
            stream.write(record)  # in one write: only the last record of a file can be incomplete

    def _read(self, name_size: int) -> None:
        """Read complete records, and cut off an incomplete one that a killed writer left."""
        size, text = name_size + _RECORD.size, self.file.read_bytes() if self.file.exists() else b""
        intact = 0
        for begin in range(0, len(text) - size + 1, size):
            record = text[begin : begin + size]
            objective, violation, checksum = _RECORD.unpack(record[name_size:])
            if zlib.crc32(record[: name_size + 16]) != checksum:
                break
            self.known[record[:name_size]] = objective, violation
            intact = begin + size
        if intact < len(text):
            os.truncate(self.file, intact)


def _name(values: FloatArray, position: FloatArray) -> bytes:
    return hashlib.sha256(position.tobytes()).digest()[:_POSITIONS] + np.asarray(values, "<f8").tobytes()
