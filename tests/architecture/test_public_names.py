import subprocess
import sys

import pioneer3

PUBLIC = [
    "BlockingLaser",
    "BlockingRobot",
    "CommandError",
    "ConfigError",
    "DeviceError",
    "LinkError",
    "MotionError",
    "NoRobotError",
    "PioneerError",
    "PortBusyError",
    "PortNotFoundError",
    "PortPermissionError",
    "Pose2",
    "Robot",
    "RobotModel",
    "Scan",
    "Snapshot",
    "Twist2",
    "connect",
    "connect_async",
    "connect_laser",
    "connect_laser_async",
    "load_model",
    "log",
]
HEAVY = ["asyncio", "numpy", "rich", "serialx", "starlette", "uvicorn", "msgspec", "cyclopts"]


def test_the_public_names_are_these() -> None:
    assert pioneer3.__all__ == PUBLIC
    assert all(getattr(pioneer3, name).__name__.rpartition(".")[2] == name for name in PUBLIC)
    assert set(PUBLIC) <= set(dir(pioneer3))


def loaded_after(statement: str) -> set[str]:
    code = f"import sys; {statement}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_importing_the_package_loads_nothing_heavy() -> None:
    assert loaded_after("import pioneer3").isdisjoint(HEAVY)


def test_a_program_that_connects_loads_no_numpy_before_it_needs_arrays() -> None:
    connected = (
        "import pioneer3.navigation.connect, pioneer3.navigation.simulator, pioneer3.log.mcap"
    )
    assert loaded_after(connected).isdisjoint({"numpy", "pioneer3.maps", "pioneer3.sim.worldfile"})


def test_the_door_to_logs_loads_nothing_heavy_before_it_is_opened() -> None:
    assert loaded_after("import pioneer3; pioneer3.log").isdisjoint([*HEAVY, "mcap", "zstandard"])


def test_a_command_handles_ctrl_c_before_it_imports_any_other_module() -> None:
    own = loaded_after("import pioneer3.__main__") - loaded_after("pass")
    assert own == {"pioneer3", "pioneer3.__main__"}


def test_the_help_needs_neither_numpy_nor_a_web_server_nor_an_event_loop() -> None:
    heavy = {"numpy", "serialx", "starlette", "uvicorn", "asyncio", "rich.markdown"}
    assert loaded_after("import pioneer3.cli.main").isdisjoint(heavy)


def test_the_protocol_needs_neither_numpy_nor_an_event_loop() -> None:
    statement = "import pioneer3.arcos.host, pioneer3.arcos.device"
    assert loaded_after(statement).isdisjoint({*HEAVY} - {"msgspec"})  # it makes the messages
