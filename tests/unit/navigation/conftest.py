"""Some tests need numba, scipy or rosbags, which are not there for every machine."""

from importlib.util import find_spec

collect_ignore_glob: list[str] = []
if not all(find_spec(name) for name in ("numba", "scipy")):
    collect_ignore_glob = ["test_explore.py", "test_map_update.py", "test_recovery.py"]
if not find_spec("rosbags"):
    collect_ignore_glob = [*collect_ignore_glob, "test_bag_logs.py"]
