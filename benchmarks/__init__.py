"""Measurements of `plcopen_sfc` against other libraries, as ratios from one run: ``python -m benchmarks.run``."""
