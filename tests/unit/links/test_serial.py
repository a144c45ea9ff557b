"""What a person hears when a serial port does not open, and the speeds that are remembered."""

import errno
import os
from pathlib import Path

import pytest

from pioneer3.errors import LinkError, PortBusyError, PortNotFoundError, PortPermissionError
from pioneer3.links.serial import (
    explain_open_error,
    how_to_get_permission,
    make_pty,
    remember_speed,
    remembered_speed,
    state_file,
)


@pytest.mark.parametrize(
    ("error", "kind", "says"),
    [
        (OSError(errno.ENOENT, "x"), PortNotFoundError, "no such port; is the cable plugged in"),
        (OSError(errno.ENODEV, "x"), PortNotFoundError, "no such port"),
        (OSError(errno.EACCES, "x"), PortPermissionError, "permission denied; "),
        (OSError(errno.EBUSY, "x"), PortBusyError, "busy; another program has it open"),
        (OSError(errno.EAGAIN, "x"), PortBusyError, "busy"),
        (OSError(errno.ENOTTY, "x"), LinkError, "not a serial port"),
        (OSError(errno.EIO, "Input/output error"), LinkError, "Input/output error"),
        (ValueError("odd"), LinkError, "odd"),
    ],
)
def test_an_error_says_what_to_do(error: Exception, kind: type[LinkError], says: str) -> None:
    explained = explain_open_error("/dev/null", error)
    assert type(explained) is kind
    assert str(explained).startswith("/dev/null: ")
    assert says in str(explained)
    assert "\n" not in str(explained)


def test_a_port_that_is_gone_is_not_found_whatever_the_error() -> None:
    explained = explain_open_error("/dev/ttyNONE", ValueError("odd"))
    assert type(explained) is PortNotFoundError


def test_a_file_is_no_serial_port(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    explained = explain_open_error(str(tmp_path / "file"), ValueError("odd"))
    assert "not a serial port" in str(explained)


def test_who_may_open_a_serial_port_is_named() -> None:
    assert "usermod -aG dialout " in how_to_get_permission("/dev/ttyNONE")


def test_speeds_are_remembered_per_port_and_replaced() -> None:
    assert remembered_speed("/dev/a") is None
    remember_speed("/dev/a", 38400)
    remember_speed("/dev/b with blanks", 115200)
    remember_speed("/dev/a", 57600)
    remember_speed("/dev/a", 57600)
    assert remembered_speed("/dev/a") == 57600
    assert remembered_speed("/dev/b with blanks") == 115200
    assert len(state_file().read_text().splitlines()) == 2


@pytest.mark.parametrize("text", ["", "garbage", "/dev/a", "/dev/a fast", "/dev/a 12345", "\xff"])
def test_a_spoilt_memory_is_no_memory(text: str) -> None:
    state_file().parent.mkdir(parents=True)
    state_file().write_text(text, "latin-1")
    assert remembered_speed("/dev/a") is None
    remember_speed("/dev/a", 38400)


def test_the_state_is_kept_where_users_keep_state(tmp_path: Path) -> None:
    assert state_file({"XDG_STATE_HOME": str(tmp_path)}) == tmp_path / "pioneer3/speeds"
    for relative in ({}, {"XDG_STATE_HOME": ""}, {"XDG_STATE_HOME": "state"}):
        assert state_file(relative) == Path.home() / ".local/state/pioneer3/speeds"


def test_a_pseudo_terminal_passes_every_byte_as_it_is() -> None:
    pair = make_pty()
    host = os.open(pair.path, os.O_RDWR | os.O_NOCTTY)
    try:
        every = bytes(range(256))
        os.write(host, every)
        assert os.read(pair.master, 1000) == every
        os.write(pair.master, every)
        assert os.read(host, 1000) == every
    finally:
        for end in (host, pair.master, pair.slave):
            os.close(end)
