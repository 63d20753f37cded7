"""Supervised worker processes and threads; no result depends on how many there are."""
