"""Resources that a worker used: time, CPU time, memory."""

from __future__ import annotations

from dataclasses import dataclass

from host import peak_memory

BYTES_PER_MB = float(1 << 20)


@dataclass(frozen=True)
class Usage:
    """Resources that a worker used from its start to its end.

    Attributes
    ----------
    seconds : float
        Elapsed.
    cpu_s : float
        CPU time of the process and of what it has waited for, s.
    peak_mb : float
        Most resident memory, MB: as the process itself reported with its outcome; of one that did not, at
        least that of the process that started it, whose memory the system counts until the program is loaded.
    """

    seconds: float
    cpu_s: float
    peak_mb: float

    def as_json(self) -> dict[str, float]:
        """Return it rounded, for a line of the log."""
        return {
            "seconds": round(self.seconds, 3),
            "cpu_s": round(self.cpu_s, 3),
            "peak_mb": round(self.peak_mb, 1),
        }


def own_peak_mb() -> float:
    """Return the most resident memory this process has had, MB."""
    return peak_memory() / BYTES_PER_MB
