"""Options of a computation and of its run; light: neither mesher nor finite elements."""

from fe_contact.options.analysis_options import LEVELS, AnalysisOptions
from fe_contact.options.operating_point import OperatingPoint
from fe_contact.options.run import Run
from fe_contact.options.table_axes import Levels, TableAxes

__all__ = ["LEVELS", "AnalysisOptions", "Levels", "OperatingPoint", "Run", "TableAxes"]
