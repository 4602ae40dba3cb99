"""A relightd of one's own, a client that costs little beside it (raw sockets, keep-alive), and the
terrain of terrain.cpp as files."""

import json
import os
import pathlib
import re
import select
import shutil
import socket
import subprocess
import tempfile
import time

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build/release/bin/relightd"
BOUNDARY = "relight-bench-boundary"


def touch(size):
    """Memory that nobody has used for long a virtual machine's host takes back, and gives again at
    some GB/s: touched just before, as here, it is at hand."""
    numpy.ones(size // 8)


class Server:
    """Starts the program on a free port with an empty store; both go with the `with` block."""

    def __init__(self, program, *flags):
        self.store = tempfile.mkdtemp(prefix="relight-bench-")
        self.log = open(os.path.join(self.store, "log"), "wb")
        self.process = subprocess.Popen([program, "--port", "0", "--store", self.store, *flags],
                                        stdout=subprocess.PIPE, stderr=self.log, text=True)
        ready, _, _ = select.select([self.process.stdout], [], [], 30)
        line = self.process.stdout.readline() if ready else ""
        found = re.fullmatch(r"relightd listening on http://([^:]+):(\d+)\n", line)
        if not found:
            self.process.kill()
            raise SystemExit(f"{program} did not say where it listens but {line!r}")
        self.address = (found[1], int(found[2]))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
        shutil.rmtree(self.store, ignore_errors=True)

    def peak_bytes(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
            return 1024 * int(re.search(r"^VmHWM:\s+(\d+)", status.read(), re.M)[1])

    def forget_peak(self):
        with open(f"/proc/{self.process.pid}/clear_refs", "w", encoding="ascii") as clear:
            clear.write("5")  # VmHWM starts again from now


class Answer:
    """`begun`: when the first piece of the body was there (time.perf_counter)."""

    def __init__(self, status, headers, size, body, begun):
        self.status, self.headers, self.size, self.body = status, headers, size, body
        self.begun = begun

    def json(self):
        return json.loads(self.body)

    def stages(self):
        """Server-Timing: {"parse": ms, …, "total": ms}; empty without."""
        return {name: float(ms) for name, ms in
                re.findall(r"(\w+);dur=([\d.]+)", self.headers.get("server-timing", ""))}

    def rays(self):
        return int(self.headers.get("relight-rays", 0))


class Connection:
    """One keep-alive connection. Of an answer's body only a short one (a description, a problem) is
    kept: the others are measured."""

    def __init__(self, server, timeout=1800):
        self.server, self.timeout, self.socket = server, timeout, None
        self.buffer = memoryview(bytearray(1 << 20))

    def close(self):
        if self.socket is not None:
            self.socket.close()
        self.socket = None

    def _open(self):
        self.socket = socket.create_connection(self.server.address, self.timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _more(self, ahead):
        more = self.socket.recv(1 << 16)
        if not more:
            raise ConnectionError("the server closed the connection within an answer")
        return ahead + more

    def _until(self, mark, ahead):
        """What comes before the mark, and what was read beyond it."""
        while mark not in ahead:
            ahead = self._more(ahead)
        return ahead.split(mark, 1)

    def _take(self, size, ahead):
        """The next `size` bytes if they are few, and what was read beyond them."""
        kept = b""
        if size < 1 << 16:
            while len(ahead) < size:
                ahead = self._more(ahead)
            kept = ahead[:size]
        left = size - min(size, len(ahead))
        while left > 0:
            got = self.socket.recv_into(self.buffer, min(left, len(self.buffer)), socket.MSG_WAITALL)
            if got == 0:
                raise ConnectionError("the server closed the connection within an answer")
            left -= got
        return kept, ahead[size:]

    def send(self, method, path, *pieces, headers=()):
        if self.socket is None:
            self._open()
        head = [f"{method} {path} HTTP/1.1", f"Host: {self.server.address[0]}",
                f"Content-Length: {sum(len(p) for p in pieces)}",
                *(f"{name}: {value}" for name, value in headers)]
        self.socket.sendall("\r\n".join([*head, "", ""]).encode())
        for piece in pieces:
            self.socket.sendall(piece)

    def receive(self):
        head, ahead = self._until(b"\r\n\r\n", b"")
        first, *lines = head.decode("latin-1").split("\r\n")
        headers = {name.strip().lower(): value.strip()
                   for name, value in (line.split(":", 1) for line in lines)}
        if headers.get("transfer-encoding") == "chunked":
            size, body, begun = 0, b"", None
            while True:
                line, ahead = self._until(b"\r\n", ahead)
                chunk = int(line.split(b";")[0], 16)
                if chunk == 0:
                    break
                kept, ahead = self._take(chunk, ahead)
                begun = begun or time.perf_counter()
                size += chunk
                body += kept
                _, ahead = self._until(b"\r\n", ahead)
            self._until(b"\r\n", ahead)
        else:
            size, begun = int(headers.get("content-length", 0)), time.perf_counter()
            body, _ = self._take(size, ahead)
        if headers.get("connection", "").lower() == "close":
            self.close()
        return Answer(int(first.split()[1]), headers, size, body, begun)

    def call(self, method, path, *pieces, headers=()):
        self.send(method, path, *pieces, headers=headers)
        return self.receive()

    def relight(self, request, query="", headers=()):
        answer = self.call("POST", "/v1/relight" + query, json.dumps(request).encode(),
                           headers=(("Content-Type", "application/json"), *headers))
        return answer

    def upload(self, file):
        answer = must(self.call("POST", "/v1/meshes?format=ply", file,
                                headers=(("Content-Type", "application/octet-stream"),)))
        return answer.json()["id"]


def must(answer):
    if answer.status >= 300:
        raise SystemExit(f"the server answered {answer.status}: {answer.body!r}")
    return answer


def point_light(x, y, flux=40.0):
    return {"type": "point", "position": [x, y, 0.35], "flux_w": flux}


def hills(x, y):
    """Places and unit normals (…, 6) of terrain.cpp's hills, float32."""
    h, along_x, along_y = numpy.zeros_like(x), numpy.zeros_like(x), numpy.zeros_like(x)
    size, frequency = 0.12, 4.0
    for layer in range(8):
        c, s = numpy.cos(2.4 * layer), numpy.sin(2.4 * layer)
        a, b = frequency * (c * x - s * y) + layer, frequency * (s * x + c * y)
        rise, fall = numpy.cos(a) * numpy.cos(b), numpy.sin(a) * numpy.sin(b)
        h += size * numpy.sin(a) * numpy.cos(b)
        along_x += size * frequency * (c * rise - s * fall)
        along_y -= size * frequency * (s * rise + c * fall)
        size *= 0.5
        frequency *= 1.9
    length = numpy.sqrt(1.0 + along_x ** 2 + along_y ** 2)
    return numpy.stack([x, y, h, -along_x / length, -along_y / length, 1.0 / length], axis=-1)


def ply(vertices, faces=True):
    """The terrain as binary PLY with normals, a bytearray; and where its first vertex begins."""
    side = round(vertices ** 0.5)
    triangles = 2 * (side - 1) ** 2 if faces else 0
    head = "ply\nformat binary_little_endian 1.0\n" + f"element vertex {side * side}\n"
    head += "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    if faces:
        head += f"element face {triangles}\nproperty list uchar int vertex_indices\n"
    head = (head + "end_header\n").encode()
    face = numpy.dtype([("n", "u1"), ("v", "<i4", 3)])
    file = bytearray(len(head) + 24 * side * side + face.itemsize * triangles)
    file[:len(head)] = head
    rows = numpy.frombuffer(file, "<f4", 6 * side * side, len(head)).reshape(side, side, 6)
    corners = numpy.frombuffer(file, face, triangles, len(head) + 24 * side * side)
    corners = corners.reshape(side - 1, side - 1, 2) if faces else None
    axis = numpy.linspace(-1.0, 1.0, side)
    block = max(1, (1 << 20) // side)  # rows at once: arrays of doubles stay small
    for begin in range(0, side, block):
        end = min(side, begin + block)
        rows[begin:end] = hills(*numpy.meshgrid(axis, axis[begin:end]))
        if not faces:
            continue
        end = min(side - 1, end)
        corner = numpy.arange(begin, end)[:, None] * side + numpy.arange(side - 1)[None, :]
        corners["n"][begin:end] = 3
        for half, steps in enumerate(((0, 1, side + 1), (0, side + 1, side))):
            for k, step in enumerate(steps):
                corners["v"][begin:end, :, half, k] = corner + step
    return file, len(head)


def multipart(request, file):
    """The pieces of a form of the mesh and its request."""
    def head(name, more=""):
        return (f'--{BOUNDARY}\r\nContent-Disposition: form-data; name="{name}"{more}\r\n\r\n').encode()
    return (head("mesh", '; filename="terrain.ply"'), file, b"\r\n" + head("request"),
            json.dumps(request).encode(), f"\r\n--{BOUNDARY}--\r\n".encode())


MULTIPART = (("Content-Type", f"multipart/form-data; boundary={BOUNDARY}"),)
