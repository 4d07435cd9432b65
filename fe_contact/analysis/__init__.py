"""The main flow: gear pair in, STE database out."""

from fe_contact.analysis.analyze import analyze

__all__ = ["analyze"]
