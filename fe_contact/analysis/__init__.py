"""The main flow: gear pair in, STE database out."""

from fe_contact.analysis.analyze import analyze
from fe_contact.analysis.request import check_request

__all__ = ["analyze", "check_request"]
