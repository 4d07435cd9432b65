"""Tables of cases in the user's cache, under the hash of all that decides them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from fe_contact.errors import DatabaseError
from fe_contact.solver_version import SOLVER_VERSION, software_versions
from fe_contact.ste import SteDatabase
from fe_contact.ste.metadata import SCHEMA_VERSION, content_hash
from host.directories import cache_home
from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.schemas import Case
from model_studies.cached_file import keep_cached, read_cached
from service.version import program_tag


@dataclass(frozen=True)
class CachedTables:
    """Tables of cases, from the cache of earlier runs or computed now."""

    compute: Callable[[Case], SteDatabase]

    @staticmethod
    def file(case: Case) -> Path:
        """Return the path of the table of a case in the cache, present or not."""
        content = {"case": case_json(case), "program": program_tag(), "packages": software_versions()}
        return cache_home() / "tables" / f"{content_hash(content, SOLVER_VERSION, SCHEMA_VERSION)}.nc"

    @classmethod
    def find(cls, case: Case) -> SteDatabase | None:
        """Return the table of a case, None if it is absent or damaged."""
        return read_cached(cls.file(case), SteDatabase.from_netcdf, DatabaseError)

    def table(self, case: Case) -> SteDatabase:
        """Return the table of a case; one that is computed is kept, unless points of it failed."""
        file = self.file(case)
        cached = read_cached(file, SteDatabase.from_netcdf, DatabaseError)
        if cached is not None:
            return cached
        table = self.compute(case)
        if not table.n_failed:
            keep_cached(table, file, SteDatabase.to_netcdf)
        return table
