"""Compiled functions: their compiler, tuples handed over by address, the state that laws share."""

import host.analysis  # noqa: F401 (says what to install)
