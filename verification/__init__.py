"""What results are held against: solvers and records for tests, benchmarks and pages, in no wheel."""
