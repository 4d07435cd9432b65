"""Studies of micro-geometry: many designs of one pair on one compliance."""

import host.analysis  # noqa: F401 (says what to install)
