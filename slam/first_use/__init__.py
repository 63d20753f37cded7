"""The first use on a machine: what is compiled, and by whom."""
