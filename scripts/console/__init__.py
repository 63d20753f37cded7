"""What a command line is made of: kinds of numbers, sub-commands, tables, locks of folders, and how a command ends."""
