"""The own file of a robot is made, shown and checked from the command line."""

from pathlib import Path

import pytest

from pioneer3.cli.main import Exit, execute
from pioneer3.models.own import own_folder


def save(name: str, text: str) -> Path:
    path = own_folder() / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def failure(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """Return the words of a command that must fail for its user's fault."""
    assert execute(["robot", *words]) == Exit.USAGE
    return capsys.readouterr().err


@pytest.mark.parametrize("file", ["rosie.toml", "rosie.p"])
def test_a_file_of_only_what_differs_is_shown_and_edited(
    file: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = save(file, "max_speed = 0.4\n" if file.endswith("toml") else "MaxVelocity 400\n")
    monkeypatch.setenv("VISUAL", "true")
    assert execute(["robot", "show", "rosie"]) == Exit.OK
    assert execute(["robot", "edit", "rosie"]) == Exit.OK
    shown = capsys.readouterr().out
    assert shown.startswith(f"# {path}: what differs from the type that the robot says")
    assert "is right" in shown


def test_an_edited_file_that_is_wrong_is_told_with_its_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    save("rosie.toml", "\nmax_speed = 99")
    monkeypatch.setenv("VISUAL", "true")
    assert "rosie.toml:2: max_speed: 99 is out of range" in failure(capsys, "edit", "rosie")


def test_a_wrong_laser_is_told_where_its_file_is_shown(
    capsys: pytest.CaptureFixture[str],
) -> None:
    mounted = 'kind = "urg-04lx"\nx = 0\ny = 0\ntheta_deg = 0\n'
    save("rosie.toml", f'like = "p3at"\n[[lasers]]\nport = "ttyACM0"\n{mounted}')
    told = failure(capsys, "show", "rosie")
    assert (
        "rosie.toml:3: lasers[0].port: 'ttyACM0' names no port, did you mean /dev/ttyACM0?" in told
    )


@pytest.mark.parametrize("name", ["-rb", "-laserFlipped", "-rh", "-"])
def test_a_robot_may_be_called_as_an_option_is(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = save(f"{name}.toml", 'like = "p3at"')
    assert execute(["robot", "show", name]) == Exit.OK
    assert f"# {path}: " in capsys.readouterr().out


def test_a_file_of_aria_beside_ours_is_told_to_be_left_alone(
    capsys: pytest.CaptureFixture[str],
) -> None:
    save("rosie.toml", 'like = "p3at"')
    save("rosie.p", "")
    assert execute(["robot", "show", "rosie"]) == Exit.OK
    assert "; rosie.p beside it is not read\n" in capsys.readouterr().out


def test_a_robot_s_name_is_quoted_for_the_shell(capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(["robot", "init", "$(reboot) x", "--model", "p3at"]) == Exit.OK
    assert "pioneer3 robot edit '$(reboot) x'" in capsys.readouterr().out


def test_a_blank_is_no_editor(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = save("rosie.toml", "#!/bin/sh\nexit 9\n")
    path.chmod(0o700)
    monkeypatch.setenv("VISUAL", " ")
    monkeypatch.delenv("EDITOR", raising=False)
    assert f"no editor is named: set EDITOR, or open {path}" in failure(capsys, "edit", "rosie")


def test_a_new_file_is_not_made_like_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    told = failure(capsys, "init", "rosie", "--model", "/home/me/p2at.p")
    assert f"'/home/me/p2at.p': copy it to {own_folder()}" in told
    assert not own_folder().exists()


def test_a_new_file_does_not_hide_that_of_aria(capsys: pytest.CaptureFixture[str]) -> None:
    path = save("rosie.p", "")
    words = ["init", "rosie", "--model", "p3at"]
    assert f"{path}: is there already" in failure(capsys, *words)
    assert execute(["robot", *words, "--force"]) == Exit.OK
    assert path.with_suffix(".toml").exists()


def test_a_folder_that_cannot_be_made_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    own_folder().parent.mkdir(parents=True)
    own_folder().write_text("")
    told = failure(capsys, "init", "rosie", "--model", "p3at")
    assert "rosie.toml: cannot be written: Not a directory" in told
