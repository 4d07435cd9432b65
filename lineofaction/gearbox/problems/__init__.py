"""The errors of the boundary, in one tree and one shape.

::

    ServiceError
    |- BadInput          the caller's: a list of faults (field, value, bound, suggestion)
    |- Unauthorised      no key, or an unknown one
    |  `- KeyExpired        one whose time is over
    |- MissingScope      the key may do other things
    |- NotFound          no such process, job, result
    |- ResultNotReady    the job has not ended
    |- StillRunning      the job did not end in the time it was waited for; it goes on
    |- JobFailed         the job ended without a result; says at what
    |- JobDismissed      the job was cancelled
    |- TooLarge          the request body is beyond the limit
    |- TooSlow           the request body does not come
    |- HeadTooLarge      the head of the request is beyond the limit
    |- Malformed         what came is no request
    |- NotForUs          the request names another machine
    |- UnsupportedMediaType, NotAcceptable   a body, or an answer, of a type that is not known here
    |- QueueFull         the queue is at its limit; try again later
    |- RateExceeded      the caller's key asks more often than it may; try again later
    |- TooManyHeld       the caller's key holds as many connections or streams as it may
    |- IssuerUnavailable the issuer of access tokens does not answer; try again later
    |- TooManyRequests   the server process is busy with others; try again later
    |- Superseded        a later question of the same caller took its place
    |- NotAnalyzed       nothing is kept to answer from; submit a job first
    |- LiveUnavailable   the live worker ended or took too long; try again
    |- DatabaseUnavailable  the database does not answer; try again later
    |  |- DatabaseDamaged    it answers, and has to be mended first
    |  |- NoSpace            its disk, or that of the results, is full
    |  `- OutOfFiles         the service may open no more files
    |- StoreUnavailable  the store of results does not answer; try again later
    |- DamagedFile       a file does not hold what its digest says
    |- Unreachable       no service at the address
    `- Unexpected        a defect; carries a reference number, never the text of the exception

Each carries the HTTP status, the problem type (RFC 9457) and the exit code of the command line.
"""

from __future__ import annotations

from lineofaction.gearbox.problems.busy import (
    IssuerUnavailable,
    LiveUnavailable,
    NotAnalyzed,
    QueueFull,
    RateExceeded,
    Superseded,
    TooManyHeld,
    TooManyRequests,
    TryLater,
)
from lineofaction.gearbox.problems.error import (
    EXIT_BAD_INPUT,
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    EXIT_UNEXPECTED,
    EXIT_UNREACHABLE,
    EXIT_WARNINGS,
    BadInput,
    Fault,
    ServiceError,
    Unexpected,
)
from lineofaction.gearbox.problems.no_result import (
    HeadTooLarge,
    JobDismissed,
    JobFailed,
    KeyExpired,
    Malformed,
    MissingScope,
    NoSuchJob,
    NoSuchProcess,
    NotAcceptable,
    NotForUs,
    NotFound,
    ResultNotReady,
    StillRunning,
    TooLarge,
    TooSlow,
    Unauthorised,
    UnsupportedMediaType,
)
from lineofaction.gearbox.problems.outages import (
    DamagedFile,
    DatabaseDamaged,
    DatabaseUnavailable,
    NoSpace,
    OutOfFiles,
    StoreUnavailable,
    Unreachable,
)

__all__ = [
    "EXIT_BAD_INPUT",
    "EXIT_FAILED",
    "EXIT_INTERRUPTED",
    "EXIT_UNEXPECTED",
    "EXIT_UNREACHABLE",
    "EXIT_WARNINGS",
    "BadInput",
    "DamagedFile",
    "DatabaseDamaged",
    "DatabaseUnavailable",
    "Fault",
    "HeadTooLarge",
    "IssuerUnavailable",
    "JobDismissed",
    "JobFailed",
    "KeyExpired",
    "LiveUnavailable",
    "Malformed",
    "MissingScope",
    "NoSpace",
    "NoSuchJob",
    "NoSuchProcess",
    "NotAcceptable",
    "NotAnalyzed",
    "NotForUs",
    "NotFound",
    "OutOfFiles",
    "QueueFull",
    "RateExceeded",
    "ResultNotReady",
    "ServiceError",
    "StillRunning",
    "StoreUnavailable",
    "Superseded",
    "TooLarge",
    "TooManyHeld",
    "TooManyRequests",
    "TooSlow",
    "TryLater",
    "Unauthorised",
    "Unexpected",
    "Unreachable",
    "UnsupportedMediaType",
]
