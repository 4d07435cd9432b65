"""Traces: where a request came from (W3C Trace Context), and spans by OpenTelemetry where it is installed."""
