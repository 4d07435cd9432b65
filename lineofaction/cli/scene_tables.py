"""The tables of a scene: from the cache of the user, computed here, or by a service."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import cache, partial
from pathlib import Path

from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from host.directories import cache_home
from lineofaction.cli import computed_tables
from lineofaction.cli.cached_tables import CachedTables
from lineofaction.cli.output import Report
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.checked_case import CheckedCases
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.mesh_tables import MeshTables, finished
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.tabled_scene import ComputedTables, SceneRuns
from lineofaction.gearbox.tabled_scene import tabled_scene as scene_by_tables
from model_studies.workers import InProcess, Workers


def tabled_scene(
    scene: SceneInput,
    folder: Path,
    service: str | None,
    report: Report,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> TabledScene:
    """Return the scene with its tables and with its cases written out; its files are relative to `folder`."""
    cases = CheckedCases()
    with ExitStack() as stack:
        if service is None:
            run = Run(workers, cache_home() / "compliance", report)
            runs = SceneRuns(scene, folder, cases, run, lambda case: CachedTables.file(case).is_file())
            cached = CachedTables(lambda case: computed_tables.computed_table(cases.of(case), runs.of(case)))
            tables, result_of = MeshTables(folder, ComputedTables(cached.table)), finished
            find_cached: Callable[[Case], SteDatabase | None] = cached.find
        else:
            from dynamics.simulation import compile_ahead  # noqa: PLC0415 (start-up time)
            from lineofaction.client import JobState, LineOfActionClient  # noqa: PLC0415 (start-up time)
            from lineofaction.client.scene_calls import ServiceTables  # noqa: PLC0415 (start-up time)

            compiler = stack.enter_context(ThreadPoolExecutor(1))
            compile_once = cache(partial(compiler.submit, compile_ahead))

            def watch(state: JobState) -> None:
                if state.stage:
                    report(state.stage, state.stage_progress / 100.0)
                if not state.ended:
                    compile_once()  # loops, while tables are computed

            client = stack.enter_context(LineOfActionClient(service, progress=watch))
            tables, result_of = MeshTables(folder, ServiceTables(client)), client.driver.run
            find_cached = lambda _: None  # noqa: E731 (the service has its own cache)

        def table_of(index: int, mesh: MeshInput) -> SteDatabase:
            return result_of(tables.of(index, mesh))

        return scene_by_tables(scene, folder, table_of, cache_home(), report, warn, cases, find_cached)
