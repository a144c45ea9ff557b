from pathlib import Path

import pytest

from pioneer3.fleet.ssh_settings import SshSettings, parsed, settings_for


def test_what_ssh_says_is_understood() -> None:
    said = (
        "host p3at-1\nport 2222\nproxyjump me@gate:22\nhostkeyalias robots\nidentityfile ~/.ssh/a\n"
    )
    assert parsed(said) == SshSettings(
        port=2222, jump="me@gate:22", alias="robots", keys=(Path.home() / ".ssh/a",)
    )


def test_none_and_nothing_are_the_usual_way() -> None:
    assert parsed("") == SshSettings()
    assert parsed("proxyjump a@[10.0.0.1]:2222,gate\n").jump == "a@10.0.0.1:2222,gate"
    assert parsed("port 22\nproxyjump none\nhostkeyalias none\n") == SshSettings()


def test_host_keys_are_known_by_alias_or_by_name_and_port() -> None:
    assert SshSettings().names_of("a", "a", "10.0.0.1") == ("a", "10.0.0.1")
    assert SshSettings(port=2222).names_of("a", "10.0.0.1") == ("[a]:2222", "[10.0.0.1]:2222")
    assert SshSettings(port=2222, alias="robots").names_of("a", "10.0.0.1") == ("robots",)


async def test_without_a_file_nothing_is_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("PATH", "/nowhere")
    assert await settings_for("p3at-1") == SshSettings()
