"""The same server as tests/http starts, and the Python client on the path."""

import importlib.util
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "clients/python/src"))

_spec = importlib.util.spec_from_file_location("http_conftest", ROOT / "tests/http/conftest.py")
_http = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(_http)
server, start = _http.server, _http.start
