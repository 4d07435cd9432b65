"""What the host offers: what systems answer differently, and what is installed.

Costs of processes, locks on files, limits, priorities and groups of processes; children that answer one
request; the directory of caches. What a system does not offer raises `Unavailable`, what is not installed
`MissingExtra`. The only package that imports `resource` and `fcntl`. It depends on psutil on Windows, on
nothing elsewhere; `host.loops`, which nothing here loads, is of numba.
"""

from __future__ import annotations

import sys
from importlib.util import find_spec

from host.children.environment import ONE_THREAD, child_environment, keep_to_one_thread
from host.children.json_child import ChildFailed, ChildOutOfMemory, ask_child
from host.confinement import (
    LOOK_S,
    READING,
    Limits,
    confine,
    excess,
    limit_file_size,
    limit_memory,
    missing_protections,
    prepare_confinement,
)
from host.directories import default_cache_directory
from host.extras import MissingExtra, Unavailable, missing_extra, require
from host.sessions import (
    Ended,
    ending_signal,
    family_cpu_seconds,
    handlers_kept,
    has_exited,
    kill,
    kill_group,
    kill_own_group,
    lead_session,
    lower_priority,
    memory_figure,
    never_wait_at,
    processes_in,
    reap,
    require_sessions,
)

if sys.platform == "win32" or find_spec("fcntl") is None or find_spec("resource") is None:
    from host.windows import (
        children_cpu_seconds,
        children_peak_memory,
        cpu_seconds,
        end_after,
        keep_freed_memory,
        lock,
        most_open_files,
        peak_memory,
        physical_memory,
    )
else:
    from host.posix import (
        children_cpu_seconds,
        children_peak_memory,
        cpu_seconds,
        end_after,
        keep_freed_memory,
        lock,
        most_open_files,
        peak_memory,
        physical_memory,
    )

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
    "handlers_kept",
    "has_exited",
    "keep_freed_memory",
    "keep_to_one_thread",
    "kill",
    "kill_group",
    "kill_own_group",
    "lead_session",
    "limit_file_size",
    "limit_memory",
    "lock",
    "lower_priority",
    "memory_figure",
    "missing_extra",
    "missing_protections",
    "most_open_files",
    "never_wait_at",
    "peak_memory",
    "physical_memory",
    "prepare_confinement",
    "processes_in",
    "reap",
    "require",
    "require_sessions",
]
