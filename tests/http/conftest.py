"""Starts the server under test: the program named by RELIGHTD, by default the release build."""

import os
import pathlib
import re
import select
import signal
import subprocess
import time

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("RELIGHTD", str(ROOT / "build/release/bin/relightd"))


class Server:
    """A running server: where it listens, and what the kernel says of its process."""

    def __init__(self, store, *flags, log=None):
        self.process = subprocess.Popen(
            [PROGRAM, "--port", "0", "--store", str(store), *flags],
            stdout=subprocess.PIPE, stderr=log, text=True)
        self.pid = self.process.pid
        ready, _, _ = select.select([self.process.stdout], [], [], 30)
        line = self.process.stdout.readline() if ready else ""
        found = re.fullmatch(r"relightd listening on http://([^:]+):(\d+)\n", line)
        if not found:
            self.process.kill()
            raise AssertionError(f"{PROGRAM} did not say where it listens but {line!r}")
        self.host, self.port = found[1], int(found[2])

    def _status(self, key):
        with open(f"/proc/{self.pid}/status", encoding="ascii") as status:
            return int(re.search(rf"^{key}:\s+(\d+)", status.read(), re.M)[1])

    def rss_bytes(self):
        return 1024 * self._status("VmRSS")

    def forget_peak(self):
        with open(f"/proc/{self.pid}/clear_refs", "w", encoding="ascii") as clear:
            clear.write("5")  # VmHWM starts again from now

    def peak_bytes(self):
        return 1024 * self._status("VmHWM")

    def threads(self):
        return self._status("Threads")

    def is_sanitized(self):
        with open(f"/proc/{self.pid}/maps", encoding="utf-8") as maps:
            return re.search(r"lib[at]san", maps.read()) is not None

    def alive(self):
        return self.process.poll() is None

    def stop(self):
        """SIGTERM; the exit status."""
        self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(timeout=40)
        finally:
            self.process.kill()
            self.process.stdout.close()


def settles(condition, seconds=10.0):
    """Whether the condition comes true within the time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def running(store, *flags):
    """A server for the length of a fixture: alive at its end, and gone at SIGTERM with 0."""
    server = Server(store, *flags)
    yield server
    assert server.alive(), f"the server died with {server.process.returncode}"
    assert server.stop() == 0


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """The server with the limits it has by default."""
    yield from running(tmp_path_factory.mktemp("store"))


@pytest.fixture
def start(tmp_path):
    """start(*flags): one more server, for this test alone."""
    begun = []

    def begin(*flags):
        fixture = running(tmp_path / str(len(begun)), *flags)
        begun.append(fixture)
        return next(fixture)

    yield begin
    for fixture in begun:
        next(fixture, None)
