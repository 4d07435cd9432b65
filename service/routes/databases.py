"""The list of STE databases."""

from __future__ import annotations

from fastapi import APIRouter, Request

from lineofaction.gearbox.loading import LOADING
from lineofaction.gearbox.schemas.result_kinds import RESULTS
from service.access import Scope
from service.routes.context import Ctx
from service.routes.cursor import Cursor, Limit, mark_of, page_links
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import DatabaseEntry, DatabaseList
from service.store import IndexLine, Mark, ResultStore
from service.store.files import WrongContent

router = APIRouter(tags=["results"], route_class=ScopedRoute)
_PATH = "/v1/databases"


@router.get("/databases", summary="STE databases")
@needs(Scope.READ)
def list_databases(request: Request, context: Ctx, limit: Limit = 20, cursor: Cursor = None) -> DatabaseList:
    """List stored databases with their cases, the newest first."""
    page = context.store.page("database", limit + 1, mark_of(cursor))
    shown = page[:limit]
    last = shown[-1][0] if len(page) > limit else None
    entries = [_entry(context.store, mark, line) for mark, line in shown]
    return DatabaseList(databases=entries, links=page_links(request, _PATH, last))


def _entry(store: ResultStore, mark: Mark, line: IndexLine) -> DatabaseEntry:
    """Return what the list tells of a database, which is not thereby used; of a damaged file its name."""
    with LOADING:
        from lineofaction.gearbox.convert.database_case import case_of_file  # noqa: PLC0415 (start-up time)

    try:
        case = case_of_file(store.files.local(line.file, line.sha256))
    except (FileNotFoundError, WrongContent):
        case = None
    return DatabaseEntry(
        hash=line.key, href=f"{RESULTS}/{line.key}", created=mark.created, size=line.size, case=case
    )
