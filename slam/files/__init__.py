"""Reading files with bounds on their size, and writing results that are whole or not there."""
