"""Pictures for people: maps, overlays, scans and videos."""
