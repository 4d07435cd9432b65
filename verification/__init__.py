"""References for results: solvers and records for tests, benchmarks and pages, in no wheel."""
