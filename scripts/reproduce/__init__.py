"""Experiments of the papers, each one command: cells that can be resumed, results.json, figures, report.html."""
