"""Commands that train the shipped models from simulated scans and frames."""
