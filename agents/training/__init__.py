"""How followers are learned: demonstrations, imitation, reinforcement, export. Needs the extra `learn`.

    make_preset(name, algorithm)                        settings to begin with, to be changed by `dataclasses.replace`:
                                                        CurriculumConfig, ImitationConfig, ReinforcementConfig
    TrainingRun(RunConfig(preset=..., name=...), folder, print).train()
                                                        trains; made again on the same folder, it goes on

All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .curriculum import CurriculumConfig
    from .presets import ImitationConfig, ReinforcementConfig, make_preset
    from .run import RunConfig, TrainingRun

__all__ = [
    "CurriculumConfig",
    "ImitationConfig",
    "ReinforcementConfig",
    "RunConfig",
    "TrainingRun",
    "make_preset",
]

_HOME = {
    "CurriculumConfig": "curriculum",
    "ImitationConfig": "presets",
    "ReinforcementConfig": "presets",
    "RunConfig": "run",
    "TrainingRun": "run",
    "make_preset": "presets",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
