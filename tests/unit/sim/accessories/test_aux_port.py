from math import inf

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.sim.accessories.aux_port import BUFFER, SimulatedAuxPort
from tests.unit.sim.accessories.carrier import answers


class Echo:
    """A device that says what it hears, half a second later."""

    def __init__(self) -> None:
        self.heard: list[tuple[float, bytes]] = []

    @property
    def due(self) -> float:
        return min((when + 0.5 for when, _ in self.heard), default=inf)

    def receive(self, data: bytes, now: float) -> None:
        self.heard.append((now, data))

    def transmit(self, now: float) -> bytes:
        said = b"".join(data for when, data in self.heard if when + 0.5 <= now)
        self.heard = [(when, data) for when, data in self.heard if when + 0.5 > now]
        return said


PORTS: list[tuple[int, int, type[Command], type[Command]]] = [
    (1, 0xB0, commands.Tty2, commands.GetAux),
    (2, 0xB8, commands.Tty3, commands.GetAux2),
    (3, 0xC8, commands.Tty4, commands.GetAux3),
]


@pytest.mark.parametrize(("port", "number", "tty", "getaux"), PORTS)
def test_each_port_has_its_commands_and_its_report(
    port: int, number: int, tty: type[Command], getaux: type[Command]
) -> None:
    aux = SimulatedAuxPort(port, Echo())
    for other, _, its_tty, its_getaux in PORTS:
        assert aux.obey(its_tty(b"abc"), 0.0) == (other == port)
        assert aux.obey(its_getaux(2), 0.0) == (other == port)
    assert list(answers(aux, 0.4)) == []
    assert list(answers(aux, 0.5)) == [reports.SerialAux(number, b"ab")]
    assert list(answers(aux, 0.6)) == []


def test_a_request_waits_until_all_its_bytes_are_there() -> None:
    aux = SimulatedAuxPort(1)
    aux.obey(commands.GetAux(4), 0.0)
    aux.deliver(b"abc")
    assert list(answers(aux)) == []
    aux.deliver(b"def")
    assert list(answers(aux)) == [reports.SerialAux(0xB0, b"abcd")]
    aux.obey(commands.GetAux(2), 0.0)
    assert list(answers(aux)) == [reports.SerialAux(0xB0, b"ef")]


def test_zero_forgets_bytes_and_request() -> None:
    aux = SimulatedAuxPort(1)
    aux.deliver(b"abc")
    aux.obey(commands.GetAux(5), 0.0)
    aux.obey(commands.GetAux(0), 0.0)
    aux.deliver(b"defgh")
    assert list(answers(aux)) == []
    aux.obey(commands.GetAux(3), 0.0)
    assert list(answers(aux)) == [reports.SerialAux(0xB0, b"def")]


def test_zero_forgets_what_the_device_has_said_too() -> None:
    aux = SimulatedAuxPort(1, Echo())
    aux.obey(commands.Tty2(b"old"), 0.0)
    aux.obey(commands.GetAux(0), 1.0)
    aux.obey(commands.GetAux(1), 1.0)
    assert list(answers(aux, 2.0)) == []


def test_a_new_request_takes_the_place_of_a_waiting_one() -> None:
    aux = SimulatedAuxPort(1)
    aux.obey(commands.GetAux(6), 0.0)
    aux.obey(commands.GetAux(2), 0.0)
    aux.deliver(b"abcdefgh")
    assert list(answers(aux)) == [reports.SerialAux(0xB0, b"ab")]


def test_two_requests_for_what_is_there_are_both_answered() -> None:
    aux = SimulatedAuxPort(1)
    aux.deliver(b"abcdef")
    aux.obey(commands.GetAux(2), 0.0)
    aux.obey(commands.GetAux(3), 0.0)
    assert [r.data for r in answers(aux) if isinstance(r, reports.SerialAux)] == [b"ab", b"cde"]


def test_more_than_a_packet_is_not_to_be_had() -> None:
    aux = SimulatedAuxPort(1)
    aux.deliver(bytes(BUFFER))
    aux.obey(commands.GetAux(201), 0.0)
    assert list(answers(aux)) == []
    aux.obey(commands.GetAux(200), 0.0)
    assert len(answers(aux)) == 1


def test_a_full_buffer_loses_what_comes_last() -> None:
    aux = SimulatedAuxPort(1)
    aux.deliver(b"a" * BUFFER)
    aux.deliver(b"b")
    aux.obey(commands.GetAux(200), 0.0)
    aux.obey(commands.GetAux(BUFFER - 200), 0.0)
    assert b"b" not in b"".join(r.data for r in answers(aux) if isinstance(r, reports.SerialAux))


def test_without_a_device_bytes_are_lost() -> None:
    aux = SimulatedAuxPort(1)
    assert aux.obey(commands.Tty2(b"abc"), 0.0)
    aux.obey(commands.GetAux(1), 0.0)
    assert list(answers(aux, 9.0)) == []


def test_the_end_of_the_session_forgets_everything() -> None:
    aux = SimulatedAuxPort(1)
    aux.deliver(b"abc")
    aux.obey(commands.GetAux(2), 0.0)
    aux.obey(commands.GetAux(2), 0.0)
    aux.hang_up()
    aux.deliver(b"xyz")
    assert list(answers(aux)) == []


def test_it_is_due_when_the_device_says_what_somebody_waits_for() -> None:
    aux = SimulatedAuxPort(1, Echo())
    aux.obey(commands.Tty2(b"abc"), 1.0)
    assert aux.due == inf
    aux.obey(commands.GetAux(3), 1.0)
    assert aux.due == 1.5
    assert list(answers(aux, aux.due)) == [reports.SerialAux(0xB0, b"abc")]
    assert aux.due == inf


def test_it_is_due_at_once_when_bytes_came_in_that_somebody_waits_for() -> None:
    aux = SimulatedAuxPort(1)
    aux.obey(commands.GetAux(2), 0.0)
    aux.deliver(b"a")
    assert aux.due == inf
    aux.deliver(b"b")
    assert aux.due == -inf
