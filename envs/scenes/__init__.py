"""The buildings."""
