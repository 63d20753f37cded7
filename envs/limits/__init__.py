"""What the values of a configuration may be, checked at one place."""
