"""The work of the commands, without their options: a drive mapped, localized, followed or judged, and its files."""
