"""A small HTTP client for tests: standard library and numpy only."""

import http.client
import io
import json
import re
import struct
import zlib

import numpy

BOUNDARY = "relight-test-boundary"


class Reply:
    def __init__(self, response, body):
        self.status, self.headers, self.body = response.status, response.headers, body

    def json(self):
        return json.loads(self.body)

    def problem(self):
        """(code, pointer) of a refusal, whose form is checked on the way."""
        assert self.status >= 400, self.body[:300]
        assert self.headers["Content-Type"] == "application/problem+json"
        problem = self.json()
        assert problem["status"] == self.status
        assert problem["type"] == "/problems/" + problem["code"]
        assert problem["title"] and problem["detail"]
        assert "/home" not in problem["detail"] and "/tmp" not in problem["detail"]
        return problem["code"], problem.get("pointer")


def call(server, method, path, body=None, headers=None, timeout=120):
    connection = http.client.HTTPConnection(server.host, server.port, timeout=timeout)
    try:
        connection.request(method, path, body, headers or {})
        response = connection.getresponse()
        return Reply(response, response.read())
    finally:
        connection.close()


def upload(server, data, query="", content_type="application/octet-stream"):
    return call(server, "POST", "/v1/meshes" + query, data, {"Content-Type": content_type})


def relight(server, request, headers=None):
    body = request if isinstance(request, (bytes, str)) else json.dumps(request)
    return call(server, "POST", "/v1/relight", body, {"Content-Type": "application/json", **(headers or {})})


def multipart(server, parts, headers=None):
    """parts: (name, filename or None, bytes)"""
    body = b""
    for name, filename, data in parts:
        body += f'--{BOUNDARY}\r\nContent-Disposition: form-data; name="{name}"'.encode()
        body += f'; filename="{filename}"'.encode() if filename else b""
        body += b"\r\n\r\n" + data + b"\r\n"
    body += f"--{BOUNDARY}--\r\n".encode()
    kind = f"multipart/form-data; boundary={BOUNDARY}"
    return call(server, "POST", "/v1/relight", body, {"Content-Type": kind, **(headers or {})})


PLY_TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4",
             "float": "<f4", "double": "<f8", "int8": "i1", "uint8": "u1", "int32": "<i4",
             "uint32": "<u4", "float32": "<f4", "float64": "<f8"}


def read_ply(data):
    """Vertex properties by name, triangles; binary little-endian or ascii, as the server writes it."""
    head, body = data.split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    binary = "format binary_little_endian 1.0" in lines
    count = {m[1]: int(m[2]) for m in (re.match(r"element (\w+) (\d+)", line) for line in lines) if m}
    begin = next(i for i, line in enumerate(lines) if line.startswith("element vertex"))
    names = []
    for line in lines[begin + 1:]:
        if not line.startswith("property"):
            break
        names.append((line.split()[2], PLY_TYPES[line.split()[1]]))
    if binary:
        vertices = numpy.frombuffer(body, numpy.dtype(names), count["vertex"])
        rest = body[vertices.nbytes:]
        faces = []
        for _ in range(count.get("face", 0)):
            corners = rest[0]
            faces.append(list(struct.unpack_from(f"<{corners}i", rest, 1)))
            rest = rest[1 + 4 * corners:]
        return {name: vertices[name] for name, _ in names}, faces
    rows = body.decode().splitlines()
    table = [row.split() for row in rows[:count["vertex"]]]
    columns = {name: numpy.array([float(row[i]) for row in table]) for i, (name, _) in enumerate(names)}
    return columns, [[int(x) for x in row.split()[1:]] for row in rows[count["vertex"]:]]


def rgb(columns, name):
    return numpy.stack([columns[f"{name}_{band}"] for band in "rgb"], axis=1)


def read_npz(data):
    return numpy.load(io.BytesIO(data))


def read_png(data):
    """Pixels (height, width, bands) of an 8-bit RGB or RGBA PNG without interlace."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        chunk = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color, _, _, interlace = struct.unpack(">IIBBBBB", chunk)
            assert depth == 8 and interlace == 0
            bands = {2: 3, 6: 4}[color]
        packed += chunk if kind == b"IDAT" else b""
        at += 12 + size
    raw = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + width * bands)
    image = numpy.zeros((height, width * bands), numpy.uint8)
    for y in range(height):
        line, above = raw[y, 1:].astype(int), image[y - 1].astype(int) if y else numpy.zeros(width * bands, int)
        kind = raw[y, 0]
        if kind == 0:
            image[y] = line
        elif kind == 2:
            image[y] = (line + above) & 255
        else:
            out = [0] * bands
            for x in range(width * bands):
                left, corner = out[x], int(above[x - bands]) if x >= bands else 0
                if kind == 1:
                    guess = left
                elif kind == 3:
                    guess = (left + int(above[x])) // 2
                else:
                    p = left + int(above[x]) - corner
                    guess = min((left, int(above[x]), corner), key=lambda q: abs(p - q))
                out.append((int(line[x]) + guess) & 255)
            image[y] = out[bands:]
    return image.reshape(height, width, bands)
