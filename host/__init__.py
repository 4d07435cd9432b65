"""The host: functions that differ between operating systems, and optional packages that are installed.

Costs of processes, locks on files, limits, priorities and groups of processes; children that answer one
request; the directory of caches. A function that a system lacks raises `Unavailable`, a missing package
`MissingExtra`. The only package that imports `resource` and `fcntl`. It depends on psutil on Windows, on
nothing elsewhere. `host.loops` and its imports need numba; no module here loads them.
"""

from __future__ import annotations

import sys
from importlib import import_module

TYPE_CHECKING = False  # typing is not imported: a child of one request uses little else

if TYPE_CHECKING:
    from host.children.environment import ONE_THREAD as ONE_THREAD
    from host.children.environment import child_environment as child_environment
    from host.children.environment import keep_to_one_thread as keep_to_one_thread
    from host.children.json_child import ChildFailed as ChildFailed
    from host.children.json_child import ChildOutOfMemory as ChildOutOfMemory
    from host.children.json_child import ask_child as ask_child
    from host.confinement import confine as confine
    from host.confinement import excess as excess
    from host.confinement import limit_file_size as limit_file_size
    from host.confinement import limit_memory as limit_memory
    from host.confinement import missing_protections as missing_protections
    from host.confinement import prepare_confinement as prepare_confinement
    from host.directories import default_cache_directory as default_cache_directory
    from host.extras import MissingExtra as MissingExtra
    from host.extras import Unavailable as Unavailable
    from host.extras import missing_extra as missing_extra
    from host.extras import require as require
    from host.reading_limits import LOOK_S as LOOK_S
    from host.reading_limits import READING as READING
    from host.reading_limits import Limits as Limits
    from host.sessions import Ended as Ended
    from host.sessions import ending_signal as ending_signal
    from host.sessions import family_cpu_seconds as family_cpu_seconds
    from host.sessions import has_exited as has_exited
    from host.sessions import kill as kill
    from host.sessions import kill_group as kill_group
    from host.sessions import kill_process_group as kill_process_group
    from host.sessions import lead_session as lead_session
    from host.sessions import lower_priority as lower_priority
    from host.sessions import memory_figure as memory_figure
    from host.sessions import never_wait_at as never_wait_at
    from host.sessions import processes_in as processes_in
    from host.sessions import reap as reap
    from host.sessions import require_sessions as require_sessions
    from host.signals import end_after as end_after
    from host.signals import handlers_restored as handlers_restored

    if sys.platform == "win32":
        from host.windows import children_cpu_seconds as children_cpu_seconds
        from host.windows import children_peak_memory as children_peak_memory
        from host.windows import cpu_seconds as cpu_seconds
        from host.windows import keep_freed_memory as keep_freed_memory
        from host.windows import lock as lock
        from host.windows import max_open_files as max_open_files
        from host.windows import peak_memory as peak_memory
        from host.windows import physical_memory as physical_memory
    else:
        from host.posix import children_cpu_seconds as children_cpu_seconds
        from host.posix import children_peak_memory as children_peak_memory
        from host.posix import cpu_seconds as cpu_seconds
        from host.posix import keep_freed_memory as keep_freed_memory
        from host.posix import lock as lock
        from host.posix import max_open_files as max_open_files
        from host.posix import peak_memory as peak_memory
        from host.posix import physical_memory as physical_memory

HOMES = {
    "ChildFailed": "children.json_child",
    "ChildOutOfMemory": "children.json_child",
    "Ended": "sessions",
    "LOOK_S": "reading_limits",
    "Limits": "reading_limits",
    "MissingExtra": "extras",
    "ONE_THREAD": "children.environment",
    "READING": "reading_limits",
    "Unavailable": "extras",
    "ask_child": "children.json_child",
    "child_environment": "children.environment",
    "confine": "confinement",
    "default_cache_directory": "directories",
    "end_after": "signals",
    "ending_signal": "sessions",
    "excess": "confinement",
    "family_cpu_seconds": "sessions",
    "handlers_restored": "signals",
    "has_exited": "sessions",
    "keep_to_one_thread": "children.environment",
    "kill": "sessions",
    "kill_group": "sessions",
    "kill_process_group": "sessions",
    "lead_session": "sessions",
    "limit_file_size": "confinement",
    "limit_memory": "confinement",
    "lower_priority": "sessions",
    "memory_figure": "sessions",
    "missing_extra": "extras",
    "missing_protections": "confinement",
    "never_wait_at": "sessions",
    "prepare_confinement": "confinement",
    "processes_in": "sessions",
    "reap": "sessions",
    "require": "extras",
    "require_sessions": "sessions",
}
"""The module of each name, which is imported on first use: most processes use few."""

OF_SYSTEM = (
    "children_cpu_seconds",
    "children_peak_memory",
    "cpu_seconds",
    "keep_freed_memory",
    "lock",
    "max_open_files",
    "peak_memory",
    "physical_memory",
)
"""Names that `host.posix` and `host.windows` both have."""

__all__ = [
    "LOOK_S",
    "ONE_THREAD",
    "READING",
    "ChildFailed",
    "ChildOutOfMemory",
    "Ended",
    "Limits",
    "MissingExtra",
    "Unavailable",
    "ask_child",
    "child_environment",
    "children_cpu_seconds",
    "children_peak_memory",
    "confine",
    "cpu_seconds",
    "default_cache_directory",
    "end_after",
    "ending_signal",
    "excess",
    "family_cpu_seconds",
    "handlers_restored",
    "has_exited",
    "keep_freed_memory",
    "keep_to_one_thread",
    "kill",
    "kill_group",
    "kill_process_group",
    "lead_session",
    "limit_file_size",
    "limit_memory",
    "lock",
    "lower_priority",
    "max_open_files",
    "memory_figure",
    "missing_extra",
    "missing_protections",
    "never_wait_at",
    "peak_memory",
    "physical_memory",
    "prepare_confinement",
    "processes_in",
    "reap",
    "require",
    "require_sessions",
]


def __getattr__(name: str) -> object:
    """Import a name on first use."""
    home = _system() if name in OF_SYSTEM else HOMES.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{home}"), name)


def _system() -> str:
    """Return the module of this operating system: that of POSIX needs `fcntl` and `resource`."""
    from importlib.util import find_spec  # noqa: PLC0415 (few processes get here, and it brings a lot)

    if sys.platform == "win32" or find_spec("fcntl") is None or find_spec("resource") is None:
        return "windows"
    return "posix"
