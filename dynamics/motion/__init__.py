"""States of an assembled system: its motion, what is observed of it, the balance of its forces."""
