"""The tables of a scene: cached under the hash of their inputs, computed here or by a service."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from fe_contact.errors import DatabaseError
from fe_contact.solver_version import SOLVER_VERSION, software_versions
from fe_contact.ste import SteDatabase
from fe_contact.ste.metadata import SCHEMA_VERSION, content_hash
from host.directories import cache_home
from lineofaction.cli.output import Report
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.convert.checked_case import CheckedCase, CheckedCases
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.mesh_tables import MeshTables, finished
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.tabled_scene import ComputedTables
from lineofaction.gearbox.tabled_scene import tabled_scene as scene_by_tables
from model_studies.cached_file import cached_in
from model_studies.workers import InProcess, Workers
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

    def find(self, case: Case) -> SteDatabase | None:
        """Return the table of a case, if it is here and undamaged."""
        try:
            return SteDatabase.from_netcdf(self.file(case))
        except DatabaseError:
            return None

    def table(self, case: Case) -> SteDatabase:
        """Return the table of a case; one that is computed is kept, unless points of it failed."""
        return cached_in(
            self.file(case),
            SteDatabase.from_netcdf,
            lambda: self.compute(case),
            SteDatabase.to_netcdf,
            DatabaseError,
            keeps=lambda table: not table.n_failed,
        )


def _analyzed(case: CheckedCase, report: Report, workers: Workers) -> SteDatabase:
    """Compute a table, which needs what reading one does not."""
    from lineofaction.cli.analyze import analyzed  # noqa: PLC0415 (start-up time)

    return analyzed(case, report, workers)


def tabled_scene(
    scene: SceneInput,
    folder: Path,
    service: str | None,
    report: Report,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> TabledScene:
    """Return the scene with its tables and with its cases written out; its files are relative to `folder`."""
    cases, source, run = CheckedCases(), None, finished

    with ExitStack() as stack:
        if service is not None:
            from dynamics.simulation import compile_ahead  # noqa: PLC0415 (start-up time)
            from lineofaction.client import JobState, LineOfActionClient  # noqa: PLC0415 (start-up time)
            from lineofaction.client.scene_calls import ServiceTables  # noqa: PLC0415 (start-up time)

            compiler = stack.enter_context(ThreadPoolExecutor(1))
            ahead = cache(partial(compiler.submit, compile_ahead))

            def watch(state: JobState) -> None:
                if state.stage:
                    report(state.stage, state.stage_progress / 100.0)
                if not state.ended:
                    ahead()

            client = stack.enter_context(LineOfActionClient(service, progress=watch))
            source, run = ServiceTables(client), client.driver.run
        cached = CachedTables(lambda case: _analyzed(cases.of(case), report, workers))
        tables = MeshTables(folder, source or ComputedTables(cached.table))

        def table_of(index: int, mesh: MeshInput) -> SteDatabase:
            return run(tables.of(index, mesh))

        find_cached = cached.find if source is None else lambda _: None
        return scene_by_tables(scene, folder, table_of, cache_home(), report, warn, cases, find_cached)
