"""The mesh force as an FMU: FMI 2.0, co-simulation."""

from dynamics.engines.fmu.export import CompilerError, export_fmu

__all__ = ["CompilerError", "export_fmu"]
