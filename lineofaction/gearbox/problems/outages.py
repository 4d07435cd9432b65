"""Errors of parts that do not answer, or not as they should."""

from __future__ import annotations

from lineofaction.gearbox.problems.error import EXIT_FAILED, EXIT_UNREACHABLE, ServiceError


class DatabaseUnavailable(ServiceError):
    """The database of the service does not answer."""

    status = 503
    type = "urn:lineofaction:problem:database-unavailable"
    title = "The database cannot be reached"
    exit_code = EXIT_UNREACHABLE
    retry_after_s: int | None = 5


class DatabaseDamaged(DatabaseUnavailable):
    """The database answers, and cannot be used until somebody mends it."""

    type = "urn:lineofaction:problem:database-damaged"
    title = "The database cannot be used"
    exit_code = EXIT_FAILED
    retry_after_s = None


class NoSpace(DatabaseUnavailable):
    """The disk of the database or of the results is full."""

    type = "urn:lineofaction:problem:no-space"
    title = "There is no space left"
    exit_code = EXIT_FAILED
    retry_after_s = None


class OutOfFiles(DatabaseUnavailable):
    """The process of the service, or its machine, opens no more files."""

    type = "urn:lineofaction:problem:out-of-files"
    title = "Too many files are open"
    exit_code = EXIT_FAILED
    retry_after_s = 5


class StoreUnavailable(ServiceError):
    """The store of results does not answer."""

    status = 503
    type = "urn:lineofaction:problem:store-unavailable"
    title = "The store of results cannot be reached"
    exit_code = EXIT_UNREACHABLE
    retry_after_s = 5


class DamagedFile(ServiceError):
    """A stored file does not hold what its digest says."""

    status = 500
    type = "urn:lineofaction:problem:damaged-file"
    title = "A stored file is damaged"
    exit_code = EXIT_FAILED


class Unreachable(ServiceError):
    """No service answers at the address."""

    status = 503
    type = "urn:lineofaction:problem:unreachable"
    title = "The service cannot be reached"
    exit_code = EXIT_UNREACHABLE
