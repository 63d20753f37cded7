import re
import tomllib
from pathlib import Path

import pytest
from tagalong.scripts import cli
from tagalong.scripts.commands import doctor
from tagalong.scripts.runs.diagnosis import CORE, EXTRAS, Check, check_drive, check_opengl

PROJECT = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text())["project"]


def names(requirements):
    return tuple(re.match(r"[\w.-]+", line)[0] for line in requirements)


def test_the_tables_are_those_of_pyproject():
    assert names(PROJECT["dependencies"]) == CORE
    assert {name: names(parts) for name, parts in PROJECT["optional-dependencies"].items()} == dict(EXTRAS)


def test_the_self_test_drives_and_maps():
    check = check_drive()
    assert check.works, check.note


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(doctor, "check_drive", lambda: Check("simulate and map", True, "0.9 s"))
    monkeypatch.setattr(doctor, "check_opengl", lambda: [Check("egl", False, "no driver")])


def test_what_is_missing_comes_with_its_remedy_and_is_no_failure(quick, monkeypatch, capsys):
    monkeypatch.setattr(doctor, "check_extras", lambda: [Check("ros", False, "rosbags, mcap"), Check("viz", True)])
    assert cli.main(["doctor"]) == 0
    out = capsys.readouterr().out
    assert re.search(r'ros +no +pip install "tagalong\[ros\]"', out)
    assert re.search(r"viz +yes\n", out)
    assert re.search(r"egl +no +no driver", out)
    assert "self-test: simulate and map: ok (0.9 s)" in out
    assert "numba" in out


def test_a_failed_self_test_and_a_missing_core_package_are_failures(quick, monkeypatch, capsys):
    monkeypatch.setattr(doctor, "installed_version", lambda name: None if name == "numba" else "1.0")
    assert cli.main(["doctor", "--no-opengl"]) == 1
    out = capsys.readouterr().out
    assert re.search(r"numba +MISSING", out)
    assert "OpenGL" not in out
    monkeypatch.undo()
    monkeypatch.setattr(doctor, "check_drive", lambda: Check("simulate and map", False, "off by 3 m"))
    assert cli.main(["doctor", "--no-opengl"]) == 1
    assert "FAILED (off by 3 m)" in capsys.readouterr().out


def test_a_back_end_that_does_not_exist_or_hangs_is_reported_in_one_line():
    unknown = check_opengl(["no-such-back-end"])[0]
    assert not unknown.works
    assert "no-such-back-end" in unknown.note
    assert check_opengl(["egl"], limit_s=0.0)[0] == Check("egl", False, "did not answer in time")


def test_each_gap_comes_with_what_to_do_about_it(quick, monkeypatch, capsys):
    monkeypatch.delenv("TAGALONG_DATA", raising=False)
    assert cli.main(["doctor"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"egl +no +no driver +install a driver or Mesa", out)
    assert re.search(r"recorded logs +no +set TAGALONG_DATA to a folder with recordings", out)
    monkeypatch.setattr(doctor, "check_opengl", lambda: [Check("egl", False, "no driver"), Check("osmesa", True)])
    monkeypatch.setattr(doctor, "installed_version", lambda name: None if name == "numba" else "1.0")
    monkeypatch.setenv("TAGALONG_DATA", "/nowhere")
    assert cli.main(["doctor"]) == 1
    out = capsys.readouterr().out
    assert re.search(r"egl +no +no driver +nothing: osmesa works", out)
    assert re.search(r"osmesa +yes +MUJOCO_GL=osmesa", out)
    assert re.search(r"numba +MISSING +pip install numba", out)
    assert "`tagalong data check` says what /nowhere lacks" in out
