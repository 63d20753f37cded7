"""The door of the followers: what one of its modules may not be called."""

import subprocess
import sys


def test_a_name_of_the_door_is_not_hidden_by_a_module_of_that_name():
    asked = "from tagalong.agents import following_tour as tour; tour.__call__"
    code = f"import tagalong.agents.tour, tagalong.agents.roster; {asked}"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
