"""States of an assembled system: its motion, the quantities observed on it, the balance of its forces."""
