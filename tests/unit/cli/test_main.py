"""What an error means for the shell."""

import errno
import sys
from io import StringIO

import pytest

from pioneer3 import errors
from pioneer3.cli import main as command_line
from pioneer3.cli.main import Exit, execute, exit_code
from pioneer3.errors import PioneerError

CODES = {
    errors.ConfigError: 2,
    errors.MissingTypeError: 2,
    errors.CommandError: 2,
    errors.LinkError: 3,
    errors.PortNotFoundError: 3,
    errors.HostError: 3,
    errors.LoginError: 3,
    errors.NoRobotError: 3,
    errors.UnknownHostError: 3,
    errors.HungUpError: 3,
    errors.TurnedAwayError: 3,
    errors.PortPermissionError: 4,
    errors.FilePermissionError: 4,
    errors.PortBusyError: 1,
    errors.RecordingOverError: 3,
    errors.NoNodeError: 3,
    errors.MotionError: 1,
    errors.DeviceError: 1,
    errors.RemoteError: 1,
    errors.PioneerError: 1,
}


@pytest.mark.parametrize(("kind", "code"), [*CODES.items()])
def test_every_error_has_its_exit_code(kind: type[PioneerError], code: int) -> None:
    assert exit_code(kind("because")) == code


def test_no_error_is_forgotten() -> None:
    known = {
        kind
        for kind in vars(errors).values()
        if isinstance(kind, type) and issubclass(kind, PioneerError)
    }
    assert known == set(CODES)


def replace_app(monkeypatch: pytest.MonkeyPatch, ending: BaseException | int | None) -> None:
    """Make every command end like this."""

    def app(*_: object, **__: object) -> int | None:
        if isinstance(ending, BaseException):
            raise ending
        return ending

    monkeypatch.setattr(command_line, "app", app)


@pytest.mark.parametrize(
    ("ending", "code"),
    [
        (None, 0),
        (0, 0),
        (3, 3),
        (143, 143),
        (KeyboardInterrupt(), 130),
        (errors.PortBusyError("taken"), 1),
        (BrokenPipeError(), 0),
    ],
)
def test_the_end_of_a_command_is_the_exit_code(
    ending: BaseException | int | None, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdout", sys.stdout)  # put back what a broken pipe takes away
    replace_app(monkeypatch, ending)
    assert execute([]) == code


def test_an_error_is_told_in_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    replace_app(monkeypatch, errors.ConfigError("lab.map:4: LINES: expected numbers"))
    assert execute([]) == Exit.USAGE
    assert capsys.readouterr() == ("", "pioneer3: lab.map:4: LINES: expected numbers\n")


def test_a_bug_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    replace_app(monkeypatch, ZeroDivisionError())
    with pytest.raises(ZeroDivisionError):
        execute([])


@pytest.mark.parametrize(
    "line", ["rnu", "sim --prot 1", "sim -p", "sim extra", "drive --speed fast", "sim -p 1 -p 2"]
)
def test_wrong_usage_is_told_in_one_line_with_the_word_that_is_wrong(
    line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(line.split()) == Exit.USAGE
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("pioneer3: ")
    assert told.err.count("\n") == 1
    assert any(word in told.err for word in line.split()[-2:])


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("rnu", "run"),
        ("sim --prot 1", "--port"),
        ("info -p ttyUSB0", "/dev/ttyUSB0"),
        ("laser serial/by-id/usb-Hokuyo", "/dev/serial/by-id/usb-Hokuyo"),
        ("sim --fit camera=sonny", "sony"),
    ],
)
def test_a_typing_mistake_is_met_with_the_nearest_name(
    typed: str, meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    execute(typed.split())
    told = capsys.readouterr().err.lower().partition("did you mean ")[2]
    assert meant.lower() in told.split("?")[0]


def test_a_word_too_many_is_named_with_the_help_that_tells_the_others(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert execute(["laser", "/dev/ttyACM9", "show"]) == Exit.USAGE
    told = capsys.readouterr().err
    assert "'show': pioneer3 laser takes no further words; see: pioneer3 laser --help" in told


def test_a_full_disk_is_told_in_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    replace_app(monkeypatch, OSError(errno.ENOSPC, "No space left on device"))
    assert execute([]) == Exit.FAILED
    told = capsys.readouterr().err
    assert told.startswith("pioneer3: No space left on device: the output is not complete")
    assert told.count("\n") == 1


def test_output_that_was_kept_back_and_cannot_be_written_is_no_success(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Full(StringIO):
        def flush(self) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

    replace_app(monkeypatch, 0)
    monkeypatch.setattr(sys, "stdout", Full())
    with pytest.raises(SystemExit) as end:
        command_line.main([])
    assert end.value.code == Exit.FAILED
    assert "No space left on device" in capsys.readouterr().err
