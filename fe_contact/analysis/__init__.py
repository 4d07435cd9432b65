"""The main flow: gear pair in, STE database out; and what happens on its flanks."""

import host.analysis  # noqa: F401 (says what to install)
