"""The report: one HTML page that needs no network, and PNG images, from STE databases and runs."""

from lineofaction.report.document.write import write_report

__all__ = ["write_report"]
