"""The main computation, from a gear pair to its STE database, and the results on the flanks."""

import host.analysis  # noqa: F401 (says what to install)
