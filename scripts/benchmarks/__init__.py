"""Committed benchmarks: each prints a table and writes JSON with the hardware noted."""
