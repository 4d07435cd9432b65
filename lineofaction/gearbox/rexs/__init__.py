"""REXS, the exchange format of gear-unit tools: read, checked, upgraded, in SI, written."""
