"""The compiled worlds on a GPU: their own kernels, each thread a world."""
