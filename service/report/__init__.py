"""The report: one HTML page that needs no network, and PNG images, from STE databases and runs."""

from service.report.write import write_report

__all__ = ["write_report"]
