"""Figures of a report, and the page and images that hold them."""

import host.analysis  # noqa: F401 (says what to install)
