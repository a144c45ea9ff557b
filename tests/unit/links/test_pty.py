"""Pseudo terminals."""

import os

from pioneer3.links.serial import make_pty


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
