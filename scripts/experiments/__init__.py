"""Experiments: many independent cells, resumable, in parallel; and what a drive and its maps are made of."""
