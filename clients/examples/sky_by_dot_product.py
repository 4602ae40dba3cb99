#!/usr/bin/env python3
"""Any HDR sky on a mesh by a dot product: one request for the transfer, then no server at all.

    python3 clients/examples/sky_by_dot_product.py mesh.ply sky.hdr [http://127.0.0.1:8080]

The answer's `sh` holds, for each vertex, how much of each of nine spherical harmonics reaches it past
the mesh itself. A sky written in the same nine numbers then lights the mesh by E = sh @ L: turned,
dimmed or swapped in microseconds. Nine numbers hold a sky's soft part; a small bright sun is smeared,
so its light is better a light of its own. The last lines say how far that is from tracing the image.
"""

import math
import pathlib
import sys
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python/src"))
from relight import Client, environment_light  # noqa: E402


def read_hdr(path):
    """(height, width, 3) linear radiance of a run-length encoded or flat Radiance file."""
    data = pathlib.Path(path).read_bytes()
    head, _, rest = data.partition(b"\n\n")
    size, _, body = rest.partition(b"\n")
    _, height, _, width = size.split()
    height, width = int(height), int(width)
    if body[:2] != b"\x02\x02":
        rgbe = numpy.frombuffer(body, numpy.uint8, height * width * 4).reshape(height, width, 4)
    else:
        rgbe, at = numpy.zeros((height, width, 4), numpy.uint8), 0
        for y in range(height):
            at += 4
            for band in range(4):
                x = 0
                while x < width:
                    count = body[at]
                    if count > 128:
                        rgbe[y, x:x + count - 128, band] = body[at + 1]
                        at, x = at + 2, x + count - 128
                    else:
                        rgbe[y, x:x + count, band] = numpy.frombuffer(body, numpy.uint8, count, at + 1)
                        at, x = at + 1 + count, x + count
    scale = numpy.ldexp(1.0, rgbe[..., 3].astype(int) - 136) * (rgbe[..., 3] > 0)
    return rgbe[..., :3] * scale[..., None]


def harmonics(x, y, z):
    """The nine real spherical harmonics up to degree 2, in the order of the answer's `sh`."""
    one = numpy.ones_like(x)
    return numpy.stack([0.282094792 * one, 0.488602512 * y, 0.488602512 * z, 0.488602512 * x,
                        1.092548431 * x * y, 1.092548431 * y * z, 0.315391565 * (3 * z * z - 1),
                        1.092548431 * x * z, 0.546274215 * (x * x - y * y)])


def project(sky, rotation_deg=0.0):
    """The sky's nine coefficients a band: integrals of L Y over the sphere (9, 3)."""
    height, width, _ = sky.shape
    theta = (numpy.arange(height) + 0.5) * math.pi / height
    phi = ((numpy.arange(width) + 0.5) / width - 0.5) * 2 * math.pi - math.radians(rotation_deg)
    edges = numpy.cos(numpy.arange(height + 1) * math.pi / height)
    omega = (edges[:-1] - edges[1:]) * 2 * math.pi / width
    sine = numpy.sin(theta)[:, None]
    up = numpy.broadcast_to(numpy.cos(theta)[:, None], (height, width))
    Y = harmonics(sine * numpy.cos(phi), up, sine * numpy.sin(phi))
    return numpy.einsum("khw,hwc,h->kc", Y, sky, omega)


def main(mesh, image, server="http://127.0.0.1:8080"):
    with Client(server, timeout=600) as client:
        stored = client.upload(mesh)
        transfer = client.relight(stored, lights=[], transport={"samples": 256},
                                  output={"format": "npz", "quantities": ["sh"]}).arrays()["sh"]
        sky = read_hdr(image)
        begin = time.perf_counter()
        for turn in range(0, 360, 45):
            E = transfer @ project(sky, turn)
            print(f"sky turned by {turn:3d} degrees: mean E {E.mean(axis=0).round(4)}")
        print(f"eight skies on {len(transfer)} vertices: {1e3 * (time.perf_counter() - begin):.0f} ms, no request")
        E = transfer @ project(sky, 90)
        light = environment_light(client.store_environment(image)["id"], rotation_deg=90)
        traced = client.relight(stored, lights=[light], transport={"samples": 1024},
                                output={"format": "npz", "quantities": ["irradiance"]}).arrays()["irradiance"]
        error = numpy.sqrt(numpy.mean((E - traced) ** 2)) / traced.mean()
        print(f"against the traced image: rms difference {100 * error:.1f} % of the mean")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:4])
