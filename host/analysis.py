"""Imported by packages that compute: raises `MissingExtra` where the extra `analysis` is not installed."""

from host.extras import require

require("analysis")
