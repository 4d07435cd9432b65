"""Results that are records: what their files hold is an xarray dataset too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bounds.plottable import Plottable
from model_studies.record_file import record_content

if TYPE_CHECKING:
    import xarray


class ResultRecord(Plottable):
    """A result whose fields are its file, as `record_file` writes it."""

    def to_xarray(self) -> xarray.Dataset:
        """Return the numbers with names and units, as the file has them; the rest is an attribute."""
        return record_content(self, type(self).__name__).to_xarray()
