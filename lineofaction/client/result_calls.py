"""Calls on stored results: files, figures, and answers that the service computes from them.

Calls are operations and listings of `lineofaction.client.surface`: `Steps` are those to one result, `Items`
those that yield several.
"""

from __future__ import annotations

import base64
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

from lineofaction.client.cache import FIGURES
from lineofaction.client.job_calls import pages
from lineofaction.client.offers import ANALYZE, libraries
from lineofaction.client.steps import Items, Steps
from lineofaction.client.surface import Session, Surface, listing, operation
from lineofaction.gearbox import schemas
from lineofaction.gearbox.problems import DamagedFile, NotFound
from lineofaction.gearbox.registry import JSON, NETCDF, RESULT_KINDS, RESULTS, SUFFIX, figures_model

if TYPE_CHECKING:
    import xarray

    from fe_contact.ste import SteDatabase
    from lineofaction.client.report import Report
    from lineofaction.gearbox.schemas.figures import Figures
    from service.schemas.answers import DatabaseEntry, MotionBody

Column = float | Collection[float]
"""One value for all points, or a list or one-dimensional array with one for each."""


class LiveOptions(TypedDict, total=False):
    """Options of `ste` by the names of a case file; the case supplies the options that are left out."""

    misalignment_um: float
    center_distance_change_mm: float
    """`misalignment_um`, `center_distance_change_mm`: Default: 0."""
    pinion: Mapping[str, Any]
    wheel: Mapping[str, Any]
    """`pinion`, `wheel`: Flank modifications of a gear (``tip_relief_um`` ...)."""
    derivatives: bool
    """Whether the answer also has the derivatives of each curve by its flanks, the misalignment and the
    torque."""
    flanks: bool
    """Whether the answer also has pressure over the driving gear's flank, load over the face, K_Hbeta."""
    passage: bool
    """Whether the answer also has the loads and pressures of a pair of teeth on its way through the mesh."""
    tolerance_class: int
    """Class of ISO 1328-1:2013 within which pairs are drawn at one torque, for the member `band` of the
    answer. Every answer solves some of the pairs; repeat the request until the member `solved`, their number,
    equals the member `of`, the number of all pairs.
    """
    preview: bool
    """Whether the answer has every other position only and no errors, at a half to a third of the cost."""
    condense: bool
    """Whether the compliance is computed first if the service has none in its cache."""
    caller: str | None
    """Name of the caller: a later request replaces its waiting one (`Superseded`)."""


class ResultCalls(Surface):
    """Stored results by their content hashes; a cached one needs no service."""

    @listing
    def databases(self, *, limit: int | None = None) -> Items[DatabaseEntry]:
        """Yield the stored STE databases with their cases, the newest first, at most `limit`."""
        from service.schemas.answers import DatabaseEntry  # noqa: PLC0415 (start-up time)

        yield from pages(
            self.session.exchange, "/v1/databases", "databases", DatabaseEntry.model_validate, {}, limit
        )

    @operation
    def fetch(self, key: str) -> Steps[SteDatabase]:
        """Return the STE database of a content hash."""
        file = yield from ResultCalls.fetch_file(self, key)
        database: SteDatabase = ANALYZE.read(file)
        return database

    @operation
    def fetch_dataset(self, key: str, kind: str = "database") -> Steps[xarray.Dataset]:
        """Return a netCDF result as an xarray Dataset in memory, with units and names (SI).

        Parameters
        ----------
        key : str
            Content hash of the result.
        kind : str
            A name of `lineofaction.gearbox.registry.RESULT_KINDS`.
        """
        file = yield from ResultCalls.fetch_file(self, key, kind)
        with libraries():
            from model_studies.netcdf import read_dataset  # noqa: PLC0415 (keeps the client light)

            return read_dataset(file)

    @operation
    def fetch_file(self, key: str, kind: str = "database") -> Steps[Path]:
        """Return the netCDF file of a result, from the disk cache or the service.

        The file belongs to the cache: read it, or copy it.

        Raises
        ------
        NotFound
            The service has no such result.
        DamagedFile
            What arrived is not what was sent.
        BadInput
            The cache cannot be written.
        """
        file, _ = yield from ResultCalls.fetch_result(self, key, kind)
        return file

    @operation
    def fetch_figures(self, key: str, kind: str) -> Steps[Figures]:
        """Return the figures of a result, which its verb prints by ``--json``; as `fetch_file`."""
        file, _ = yield from _fetched(self.session, key, (kind,), JSON)
        return figures_model(kind).model_validate_json(file.read_bytes())

    @operation
    def fetch_result(self, key: str, *kinds: str) -> Steps[tuple[Path, str]]:
        """Return the file of a result of one of some kinds, default all, and its kind; as `fetch_file`."""
        return _fetched(self.session, key, kinds or RESULT_KINDS, NETCDF)

    @operation
    def report(self, key: str, *, against: str | None = None) -> Steps[Report]:
        """Return the report on a result: main results, figures for plotly.js, tables; notebooks show it.

        Parameters
        ----------
        key : str
            Content hash of the result.
        against : str, optional
            Another result of the same kind, table or run: the report then compares both.
        """
        from lineofaction.client.report import Report  # noqa: PLC0415 (start-up time)

        parameters = {} if against is None else {"against": against}
        path = f"{RESULTS}/{key}/figures"
        return self.session.exchange.read(Report.model_validate, "GET", path, params=parameters)

    @operation
    def sound(
        self,
        key: str,
        *,
        quantity: str = "",
        bearing: str = "",
        mesh: str = "",
        direction: str = "",
        against: str | None = None,
    ) -> Steps[bytes]:
        """Return a run as a WAV file, as ``loa listen`` writes it; it states quantity and full scale.

        Raises `BadInput`: the run does not hold that, it is silent, or longer than five minutes; `NotFound`,
        `QueueFull`, `LiveUnavailable`, `Unreachable`, `ServiceError`.

        Parameters
        ----------
        key : str
            Content hash of the run.
        quantity, bearing, mesh, direction : str
            Choices as by the options of ``loa listen``; empty: the defaults of these options.
        against : str, optional
            Another run, whose sound is then on the same full scale.
        """
        named = {"quantity": quantity, "bearing": bearing, "mesh": mesh, "direction": direction}
        parameters = {name: value for name, value in (named | {"against": against or ""}).items() if value}
        path = f"{RESULTS}/{key}/sound"
        answer = yield from self.session.exchange.request("GET", path, params=parameters)
        return answer.content

    @operation
    def motion(self, key: str, number: int | None = None) -> Steps[MotionBody]:
        """Return the names of the motions that a result has, and the motion of a number, counted from 0.

        Motions are modes of a scene, deflections under its load cases, and velocities of a housing. A motion
        has the displacements of each shaft along its axis and of the nodes of the housing's surface. Raises
        `BadInput`: no such motion, or a result without any; `NotFound`, `QueueFull`, `LiveUnavailable`,
        `Unreachable`, `ServiceError`.
        """
        from service.schemas.answers import MotionBody  # noqa: PLC0415 (start-up time)

        parameters = {} if number is None else {"number": number}
        path = f"{RESULTS}/{key}/motion"
        return self.session.exchange.read(MotionBody.model_validate, "GET", path, params=parameters)

    @operation
    def query(
        self,
        key: str,
        position: Column,
        deflection_um: Column,
        *,
        misalignment_um: Column = 0.0,
        center_distance_change_mm: Column = 0.0,
    ) -> Steps[schemas.QueryOutput]:
        """Return force, tangent stiffness and validity of a stored database at many points.

        Every column (a list, an array) has a value for each point, or one for all. Nothing is rounded. Raises
        `BadInput`: columns of different lengths, too many points, a value that is not finite or out of
        bounds; `NotFound`, `Unreachable`, `ServiceError`.
        """
        from lineofaction.gearbox.schemas.query import QueryInput  # noqa: PLC0415 (start-up time)

        columns = {
            "position": position,
            "deflection_um": deflection_um,
            "misalignment_um": misalignment_um,
            "center_distance_change_mm": center_distance_change_mm,
        }
        lists = {
            name: [column] if isinstance(column, int | float) else column for name, column in columns.items()
        }
        numbers = {name: [float(value) for value in values] for name, values in lists.items()}
        points = schemas.validated(QueryInput, numbers).model_dump(mode="json")
        reader, path = schemas.QueryOutput.model_validate, f"/v1/databases/{key}/query"
        return (yield from self.session.exchange.read(reader, "POST", path, json=points))

    @operation
    def ste(
        self, key: str, torque_n_m: Sequence[float], **options: Unpack[LiveOptions]
    ) -> Steps[schemas.LiveOutput]:
        """Return curves of the gears of a stored database with other flanks, loads and alignment, at once.

        Parameters
        ----------
        key : str
            Content hash of the database.
        torque_n_m : sequence of float
            Torques in increasing order, at most twice the highest of the case.
        **options
            See `LiveOptions`.

        Returns
        -------
        LiveOutput
            ``curves`` with mean, peak-to-peak and harmonics, each with its error; assumptions; cost.

        Raises
        ------
        BadInput
            A value is refused; the error names the field of the request.
        NotAnalyzed
            The compliance is not in the cache of the service: repeat with `condense`.
        NotFound, QueueFull, Superseded, LiveUnavailable, Unreachable, ServiceError
        """
        pinion, wheel = dict(options.get("pinion") or {}), dict(options.get("wheel") or {})
        question = {**options, "torque_n_m": list(torque_n_m), "pinion": pinion, "wheel": wheel}
        reader, path = schemas.LiveOutput.model_validate, f"/v1/databases/{key}/ste"
        return (yield from self.session.exchange.read(reader, "POST", path, json=question))


def _fetched(session: Session, key: str, kinds: Sequence[str], form: str) -> Steps[tuple[Path, str]]:
    suffix = FIGURES if form == JSON else SUFFIX
    for kind in kinds:
        cached = session.cache.get(kind, key, suffix)
        if cached is not None:
            return cached, kind
    with session.cache.incoming() as file:
        digest, headers = yield from session.exchange.download(f"{RESULTS}/{key}", form, file)
        kind = headers.get("result-kind", kinds[0])
        if kind not in kinds:
            raise NotFound(f"Result {key!r} is no {kinds[0]}, but of the kind {kind}.")
        coded = base64.b64encode(bytes.fromhex(digest)).decode()
        if headers.get("content-digest") != f"sha-256=:{coded}:":
            raise DamagedFile(f"The file of {kind} {key} was damaged in transfer. Fetch it again.")
        return session.cache.keep(kind, key, file, digest, suffix), kind
