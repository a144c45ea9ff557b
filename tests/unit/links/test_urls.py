"""What a person may write for a port."""

from pathlib import Path
from typing import Any

import pytest

from pioneer3.errors import ConfigError
from pioneer3.links.urls import split_host, split_url


@pytest.mark.parametrize(
    ("url", "scheme", "rest"),
    [
        ("/dev/ttyUSB0", "serial", "/dev/ttyUSB0"),
        ("./robot", "serial", "robot"),
        ("serial:/dev/ttyS0", "serial", "/dev/ttyS0"),
        ("serial:///dev/ttyS0", "serial", "/dev/ttyS0"),
        ("serial:robot", "serial", "robot"),
        ("replay:a.txt", "replay", "a.txt"),
        ("replay:///tmp/a.txt", "replay", "/tmp/a.txt"),
        ("tcp://robot:8101", "tcp", "//robot:8101"),
        ("localhost:8101", "tcp", "//localhost:8101"),
        ("192.168.0.160:8101", "tcp", "//192.168.0.160:8101"),
        ("[::1]:8101", "tcp", "//[::1]:8101"),
        ("localhost", "tcp", "//localhost"),
        ("192.168.0.160", "tcp", "//192.168.0.160"),
        ("[::1]", "tcp", "//[::1]"),
        ("COM3", "serial", "COM3"),
        ("~/robot", "serial", str(Path("~/robot").expanduser())),
        ("replay:~/a", "replay", str(Path("~/a").expanduser())),
    ],
)
def test_the_scheme_and_the_rest(url: str, scheme: str, rest: str) -> None:
    assert split_url(url) == (scheme, rest)


@pytest.mark.parametrize(
    "url", ["", "robot", "serial:", "serial://", "replay:/", "ftp://x", ":x", "robot:", "robot:x"]
)
def test_what_names_no_port_lists_the_forms(url: str) -> None:
    with pytest.raises(ConfigError, match="use one of: /dev/ttyUSB0, COM3, localhost:8101, tcp:"):
        split_url(url)


@pytest.mark.parametrize("url", [None, 8101, b"/dev/ttyUSB0"])
def test_what_is_no_text_is_refused(url: Any) -> None:
    with pytest.raises(ConfigError, match="a port is written as text"):
        split_url(url)


@pytest.mark.parametrize(
    ("url", "host", "port"),
    [
        ("tcp://robot:4001", "robot", 4001),
        ("tcp://robot", "robot", 8101),
        ("tcp:robot:4001", "robot", 4001),
        ("tcp://10.0.0.1:1/", "10.0.0.1", 1),
        ("tcp://[::1]:65535", "::1", 65535),
    ],
)
def test_host_and_port(url: str, host: str, port: int) -> None:
    assert split_host(url) == (host, port)


@pytest.mark.parametrize("url", ["tcp:", "tcp://:1", "tcp://h:0", "tcp://h:65536", "tcp://h:x"])
def test_what_is_no_address_shows_the_form(url: str) -> None:
    with pytest.raises(ConfigError, match="expected tcp://HOST:PORT, such as tcp://localhost:8101"):
        split_host(url)
