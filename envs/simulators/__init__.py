"""The choice between the simulators that step many environments."""
