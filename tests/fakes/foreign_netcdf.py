"""HDF5 files that reach out of themselves: made of a good file, one of its variables struck."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

SECRET = b"canary-7f3c9e51"
Strike = Callable[[Any, str, Path], None]
"""Replaces a variable of an open file, which then leads to the canary."""


def write_canary(folder: Path) -> Path:
    """Write the file that nobody may read, and HDF5 files that lead to it; return the first."""
    canary = folder / "canary.txt"
    canary.write_bytes(SECRET * 4096)
    with h5py.File(folder / "canary.h5", "w") as file:
        file["values"] = np.frombuffer(SECRET * 8, dtype="S8")
        file.create_dataset("outside", (8,), "S8", external=[(str(canary), 0, 64)])
    return canary


def struck(file: Path, variable: str, strike: Strike, canary: Path) -> bytes:
    with h5py.File(file, "r+") as content:
        strike(content, variable, canary)
    return file.read_bytes()


def _external_storage(content: Any, name: str, canary: Path) -> None:
    kind = content[name].dtype
    del content[name]
    content.create_dataset(name, (8,), kind, external=[(str(canary), 0, 8 * kind.itemsize)])


def _external_text(content: Any, name: str, canary: Path) -> None:
    del content[name]
    content.create_dataset(name, (8,), "S8", external=[(str(canary), 0, 64)])


def _virtual(dataset: str, entries: int | None) -> Strike:
    def strike(content: Any, name: str, canary: Path) -> None:
        del content[name]
        layout = h5py.VirtualLayout((8,), "S8", maxshape=(entries,))
        source = h5py.VirtualSource(str(canary.with_suffix(".h5")), dataset, shape=(8,), maxshape=(entries,))
        part = slice(0, h5py.h5s.UNLIMITED if entries is None else 8)
        layout[part] = source[part]
        content.create_virtual_dataset(name, layout)

    return strike


def _external_link(content: Any, name: str, canary: Path) -> None:
    del content[name]
    content[name] = h5py.ExternalLink(str(canary.with_suffix(".h5")), "values")


def _soft_link(content: Any, name: str, canary: Path) -> None:
    _external_link(content, name, canary)
    content[f"{name}_too"] = h5py.SoftLink(f"/{name}")


def _linked_group(content: Any, _name: str, canary: Path) -> None:
    content["folder"] = h5py.ExternalLink(str(canary.with_suffix(".h5")), "/")


def _cycle(content: Any, _name: str, _canary: Path) -> None:
    content.create_group("a")
    content["a/b"] = content["/"]


def _type(content: Any, _name: str, _canary: Path) -> None:
    content["kind"] = np.dtype("f8")


def _filter(number: int) -> Strike:
    """A filter that a plug-in would have, and one that HDF5 has and the program does not use."""

    def strike(content: Any, name: str, _canary: Path) -> None:
        del content[name]
        made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        made.set_chunk((8,))
        made.set_filter(number, h5py.h5z.FLAG_OPTIONAL, ())
        space = h5py.h5s.create_simple((8,))
        h5py.h5d.create(content.id, name.encode(), h5py.h5t.IEEE_F64LE, space, made)

    return strike


def _twice_packed(content: Any, name: str, _canary: Path) -> None:
    del content[name]
    made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    made.set_chunk((1 << 16,))
    made.set_deflate(9)
    made.set_filter(h5py.h5z.FILTER_DEFLATE, h5py.h5z.FLAG_OPTIONAL, (9,))
    space = h5py.h5s.create_simple((1 << 20,))
    h5py.Dataset(h5py.h5d.create(content.id, name.encode(), h5py.h5t.IEEE_F64LE, space, made))[...] = 0.0


def _region(content: Any, name: str, _canary: Path) -> None:
    content.attrs["where"] = content[name].regionref[...]


def _references(content: Any, name: str, _canary: Path) -> None:
    reference = content[name].ref
    del content[name]
    content.create_dataset(name, data=np.full(8, reference, dtype=object), dtype=h5py.ref_dtype)


def _huge(content: Any, name: str, _canary: Path) -> None:
    del content[name]
    content.create_dataset(name, (1 << 40,), "f8", chunks=(1 << 16,), compression="gzip")


def _huge_chunk(content: Any, name: str, _canary: Path) -> None:
    del content[name]
    content.create_dataset(name, (1,), "f8", maxshape=(None,), chunks=(1 << 28,), compression="gzip")


def _many_attributes(content: Any, _name: str, _canary: Path) -> None:
    for number in range(300):
        content.attrs[f"number_{number}"] = number


def _one_text_for_all(content: Any, name: str, _canary: Path) -> None:
    """Many texts that all lie in one place: a petabyte to read, of a file of a megabyte."""
    del content[name]
    texts = content.create_dataset(name, (4096,), h5py.string_dtype())
    texts[...] = ["x" * (1 << 20)] + [""] * 4095
    at = texts.id.get_offset()
    content.flush()
    file = Path(content.filename)
    with file.open("r+b") as stream:
        stream.seek(at)
        entry = stream.read(16)
        stream.seek(at)
        stream.write(entry * 4096)


STRIKES: dict[str, Strike] = {
    "external storage": _external_storage,
    "external storage of texts": _external_text,
    "virtual": _virtual("values", 8),
    "virtual without end": _virtual("values", None),
    "virtual of external storage": _virtual("outside", 8),
    "external link": _external_link,
    "soft link": _soft_link,
    "external link to a group": _linked_group,
    "cycle of groups": _cycle,
    "type": _type,
    "filter of a plug-in": _filter(32001),
    "filter of other programs": _filter(h5py.h5z.FILTER_NBIT),
    "packed twice": _twice_packed,
    "reference to a region": _region,
    "references": _references,
    "huge": _huge,
    "huge chunk": _huge_chunk,
    "many attributes": _many_attributes,
    "one text for all": _one_text_for_all,
}
"""What is done to a variable, by its name."""
