"""Going aside and exploring need numba and scipy, which are not there for every machine."""

from importlib.util import find_spec

if not all(find_spec(name) for name in ("numba", "scipy")):
    collect_ignore_glob = ["test_explore.py", "test_going_aside.py"]
