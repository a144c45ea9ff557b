"""Configuration files of Zenoh: the file wins, and secrets are private."""

import json
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.ros.zenoh.config_file import read_config
from pioneer3.ros.zenoh.settings import ZenohOptions, session_config

JSON5 = r"""
// as in the documentation of Zenoh: http://zenoh.io
{
  /* {mode: "client"} */
  mode: 'peer',
  "connect": { endpoints: ["tls/robot:7447#connect_private_key_file=k\x65y.pem;a=b",], },
  listen: { timeout_ms: +0x10, exit_on_failure: null, keep: true/* all */,
    note: "it's \"{\" // no comment" },
}
"""


def written(folder: Path, text: str, name: str = "session.json5") -> Path:
    file = folder / name
    file.write_text(text)
    file.chmod(0o644)
    return file


def test_json5_is_read(tmp_path: Path) -> None:
    found = read_config(written(tmp_path, JSON5))
    assert found.content == {
        "mode": "peer",
        "connect": {"endpoints": ["tls/robot:7447#connect_private_key_file=key.pem;a=b"]},
        "listen": {
            "timeout_ms": "+0x10",
            "exit_on_failure": None,
            "keep": True,
            "note": 'it\'s "{" // no comment',
        },
    }
    assert found.secret_files == (Path("key.pem"),)
    assert found.has("connect/endpoints")
    assert not found.has("listen/endpoints")
    assert not found.has("listen/exit_on_failure")
    assert not found.has("mode/endpoints")


@pytest.mark.parametrize("text", ['{mode: "peer', "{mode: peer", "", "[" * 50_000])
def test_other_texts_are_refused(text: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"."):
        read_config(written(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (
            '{mode: "peer", connect: {endpoints: []}, listen: {endpoints: []},'
            " scouting: {multicast: {enabled: true}}}",
            "session.json5",
        ),
        (
            "mode: peer\nconnect: {endpoints: []}\nlisten: {endpoints: []}\n"
            "scouting: {multicast: {enabled: true}}\n",
            "session.yaml",
        ),
    ],
)
def test_settings_of_the_file_win_where_they_are_zenohs_defaults(
    text: str, name: str, tmp_path: Path
) -> None:
    config = session_config(ZenohOptions(config=written(tmp_path, text, name)))
    assert json.loads(config.get_json("connect/endpoints")) == []
    assert json.loads(config.get_json("listen/endpoints")) == []
    assert json.loads(config.get_json("scouting/multicast/enabled")) is True
    assert json.loads(config.get_json("timestamping/enabled")) is True


@pytest.mark.parametrize(
    "text",
    [
        '{transport: {link: {tls: {listen_private_key: "KEY"}}}}',
        '{transport: {link: {tls: {connect_private_key: "KEY"}}}}',
        '{transport: {auth: {usrpwd: {dictionary_file: "KEY"}}}}',
        '{connect: {endpoints: ["tls/robot:7447#connect_private_key_file=KEY"]}}',
    ],
)
def test_a_file_with_a_secret_that_others_may_read_is_refused(text: str, tmp_path: Path) -> None:
    key = written(tmp_path, "user:password", "key.pem")
    file = written(tmp_path, text.replace("KEY", str(key)))
    with pytest.raises(ConfigError, match=r"key\.pem holds a secret"):
        session_config(ZenohOptions(config=file))
    key.chmod(0o600)
    session_config(ZenohOptions(config=file))


def test_a_file_with_a_secret_in_it_is_private(tmp_path: Path) -> None:
    file = written(tmp_path, '{transport: {link: {tls: {listen_private_key_base64: "QQ=="}}}}')
    with pytest.raises(ConfigError, match=r"session\.json5 holds a secret"):
        session_config(ZenohOptions(config=file))
    file.chmod(0o600)
    session_config(ZenohOptions(config=file))
