"""The public recordings that figures rest on: which they are, where they come from, and whether a folder holds them."""
