"""A Zenoh router, for computers without a ROS installation that has one."""

import asyncio
from collections.abc import Callable
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.ros.zenoh.settings import ROUTER, ZenohOptions, load_zenoh, session_config, shown

DEFAULT: Final = ZenohOptions(mode="router", connect=(), listen=(ROUTER,))
"""A router for the programs of this computer."""


async def serve_router(
    options: ZenohOptions = DEFAULT, tell: Callable[[str], None] = lambda line: None
) -> None:
    """Run a router until cancelled; `tell` is given a line for a person once it runs.

    Args:
        options: Of mode `router`.
        tell: Takes a line for a person.

    Raises:
        ConfigError: a setting is wrong, or a port is taken.
    """
    load_zenoh()
    import zenoh

    config = session_config(options)
    try:
        session = await asyncio.to_thread(zenoh.open, config)
    except zenoh.ZError as error:
        ports = ", ".join(map(shown, options.listen))
        raise ConfigError(
            f"no router on {ports}: {reason(error)}; if another one runs there, that one will do"
        ) from None
    try:
        tell(f"Zenoh router on {', '.join(map(shown, options.listen))}")
        await asyncio.get_running_loop().create_future()
    finally:
        await asyncio.to_thread(session.close)


def reason(error: Exception) -> str:
    """Return the first sentence of an error of Zenoh, without places in its source."""
    return str(error).partition(" at /")[0].strip()
