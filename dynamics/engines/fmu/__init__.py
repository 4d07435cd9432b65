"""The mesh force as an FMU: FMI 2.0, co-simulation."""

from dynamics.engines.fmu.compiler import CompilerError
from dynamics.engines.fmu.export import export_fmu

__all__ = ["CompilerError", "export_fmu"]
