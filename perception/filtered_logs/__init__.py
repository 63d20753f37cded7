"""Logs and bags in, the same out with people taken out of the scans. `filter_log` in log.py is what others use."""
