"""The STE databases of a scene's meshes: from files, or from a source that holds and computes them."""

from __future__ import annotations

from collections.abc import Generator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypeVar

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.subjects import case_of_mesh

if TYPE_CHECKING:
    from fe_contact.ste import SteDatabase
    from lineofaction.gearbox.schemas import Case
    from lineofaction.gearbox.schemas.meshes import MeshInput

T = TypeVar("T")

Steps: TypeAlias = "Generator[Any, Any, T]"
"""Generator that yields requests to others and returns a result. A source of tables that holds all it needs
yields no request."""


class _TableSource(Protocol):
    """A source of STE databases, which stores and computes them."""

    def by_hash(self, key: str) -> Steps[SteDatabase]:
        """Return the database of a content hash."""

    def by_case(self, case: Case) -> Steps[SteDatabase]:
        """Return the database of a case."""


class MeshTables:
    """The databases of the meshes of one scene; equal cases are requested once.

    Parameters
    ----------
    folder : Path
        Folder to which the names of files in the scene are relative.
    source : object
        ``by_hash`` and ``by_case`` return databases.
    """

    def __init__(self, folder: Path, source: _TableSource) -> None:
        self._folder, self._source = folder, source
        self._known: list[tuple[Case, SteDatabase]] = []

    def of(self, index: int, mesh: MeshInput) -> Steps[SteDatabase]:
        """Return the database of a mesh, the `index`-th of its scene.

        Raises `BadInput` named by the field of the scene; `DatabaseError`: its file is no database.
        """
        field = f"meshes[{index}]"
        if mesh.database_file is not None:
            return self._in_file(f"{field}.database_file", mesh.database_file)
        case = case_of_mesh(mesh, field, self._folder)
        try:
            if case is not None:
                return (yield from self._of_case(case))
            assert mesh.database_hash is not None  # the schema has refused that
            return (yield from self._source.by_hash(mesh.database_hash))
        except BadInput as error:
            raise error.within(field if case is None else f"{field}.case") from None

    def _in_file(self, field: str, name: str) -> SteDatabase:
        file = self._folder / name
        if not file.is_file():
            remedy = "Check the path, or make one with: loa analyze"
            raise BadInput.of(field, str(file), "an STE database", remedy)
        from fe_contact.ste import SteDatabase  # noqa: PLC0415 (clients are light)

        return SteDatabase.from_netcdf(file)

    def _of_case(self, case: Case) -> Steps[SteDatabase]:
        cached_database = next((database for other, database in self._known if other == case), None)
        if cached_database is not None:
            return cached_database
        database = yield from self._source.by_case(case)
        self._known.append((case, database))
        return database


def finished(steps: Steps[T]) -> T:
    """Return the result of an operation that needs neither network nor clock."""
    try:
        action = next(steps)
    except StopIteration as end:
        result: T = end.value
        return result
    raise AssertionError(f"there is nobody to perform {action}")
