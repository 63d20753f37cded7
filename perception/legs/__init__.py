"""Clusters of a scan, their features, and the random forest that tells legs from other things."""
