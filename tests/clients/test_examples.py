"""The curl examples and the C++ client against the real server."""

import json
import math
import os
import pathlib
import struct
import subprocess
import zlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "clients/examples").glob("[0-9]*.sh"))
PREVIEW = os.environ.get("RELIGHT_PREVIEW", str(ROOT / "build/release/bin/relight-preview"))
SPOT = ROOT / "tests/data/meshes/spot.ply"


def png_pixels(data):
    """(width, height, the set of RGB colours) of an 8-bit RGB or RGBA PNG."""
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    width, height, depth, kind = struct.unpack_from(">IIBB", data, 16)
    assert depth == 8 and kind in (2, 6)
    channels = 3 if kind == 2 else 4
    at, packed = 8, b""
    while at < len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        packed += data[at + 8:at + 8 + length] if name == b"IDAT" else b""
        at += 12 + length
    rows, stride = zlib.decompress(packed), channels * width
    above, colors = bytearray(stride), set()
    for y in range(height):
        filtering, row = rows[y * (stride + 1)], bytearray(rows[y * (stride + 1) + 1:][:stride])
        for x in range(stride):
            left = row[x - channels] if x >= channels else 0
            corner = above[x - channels] if x >= channels else 0
            up = above[x]
            paeth = min((left, up, corner), key=lambda v: abs(left + up - corner - v))
            row[x] = (row[x] + (0, left, up, (left + up) // 2, paeth)[filtering]) & 255
        colors.update(bytes(row[i:i + 3]) for i in range(0, stride, channels))
        above = row
    return width, height, colors


def test_the_readme_shows_the_examples_as_they_are():
    readme = (ROOT / "clients/examples/README.md").read_text()
    assert len(EXAMPLES) == 7
    for example in EXAMPLES:
        command = example.read_text()
        assert command.count("\n") == 1, "a one-liner"
        assert command in readme


def test_the_examples_run_as_written(server):
    out = ROOT / "build/examples"
    for old in out.glob("*"):
        old.unlink()
    done = subprocess.run(
        [ROOT / "clients/examples/run", f"http://{server.host}:{server.port}"],
        cwd="/", capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert '"vertices":2930' in done.stdout.replace(" ", "")
    assert b"property uchar red" in (out / "lit.ply").read_bytes()[:2000]
    numbers = json.loads((out / "numbers.json").read_text())
    assert numbers["units"]["irradiance"] == "lx"
    assert set(numbers["visibility"]["sun"]) == {0, 1}
    brightest = max(rgb[0] for rgb in numbers["irradiance"])
    assert 0.95 * 80000 < brightest <= 80000  # some vertex of a cow faces the sun
    glb = (out / "lit.glb").read_bytes()
    assert glb.startswith(b"glTF") and b'"COLOR_0"' in glb and b'"_IRRADIANCE"' in glb
    for picture in ("spot.png", "cat.png", "scan.png"):
        width, height, colors = png_pixels((out / picture).read_bytes())
        assert (width, height) == (800, 600)
        assert len(colors) > 50, f"{picture} shows nothing"


@pytest.mark.skipif("RELIGHT_PREVIEW" not in os.environ and not os.path.exists(PREVIEW),
                    reason="the C++ clients are not built")
class TestPreviewClient:
    @staticmethod
    def run(server, *arguments):
        environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
        return subprocess.run(
            [PREVIEW, "--server", f"http://{server.host}:{server.port}", *map(str, arguments)],
            env=environment, capture_output=True, text=True, timeout=120)

    def test_it_writes_a_picture_of_the_lit_mesh_without_a_display(self, server, tmp_path):
        # Unlit, the mesh is black; lit along the view, its brightest colour is what the formula says:
        # sRGB of L = albedo / pi * E.
        scene = tmp_path / "scene.json"
        scene.write_text(json.dumps({
            "lights": [{"type": "directional", "direction": [0, 0, 1], "irradiance_w_m2": 1}],
            "material": {"model": "lambert", "albedo": [0.8, 0.4, 0.2]},
            "camera": {"eye": [0, 0, -4], "target": [0, 0, 0], "fov_y_deg": 30}}))
        out = tmp_path / "lit.png"
        done = self.run(server, SPOT, "--request", scene, "--png", out, "--size", "160x120")
        assert done.returncode == 0, done.stderr
        width, height, colors = png_pixels(out.read_bytes())
        assert (width, height) == (160, 120)

        def code(linear):
            return 255 * (1.055 * linear ** (1 / 2.4) - 0.055)

        for band, albedo in enumerate((0.8, 0.4, 0.2)):
            brightest = max(color[band] for color in colors)
            assert brightest == pytest.approx(code(albedo / math.pi), abs=3)

    def test_it_shows_a_cloud_too(self, server, tmp_path):
        cloud = ROOT / "tests/data/clouds/point_cloud_test_pos_norm.ply"
        out = tmp_path / "cloud.png"
        done = self.run(server, cloud, "--png", out, "--size", "80x60")
        assert done.returncode == 0, done.stderr
        assert len(png_pixels(out.read_bytes())[2]) > 1

    def test_it_tells_a_refusal_in_a_line_and_fails(self, server, tmp_path):
        broken = ROOT / "tests/data/broken/a_ply_index_out_of_range.ply"
        done = self.run(server, broken, "--png", tmp_path / "x.png")
        assert done.returncode == 1
        assert "index_out_of_range" in done.stderr
        assert len(done.stderr.splitlines()) == 1

    def test_without_a_display_a_window_is_refused_with_the_way_out(self, server):
        done = self.run(server, SPOT)
        assert done.returncode == 1
        assert "--png" in done.stderr


def test_the_sky_example_comes_close_to_the_traced_sky(server):
    done = subprocess.run(
        ["/usr/bin/python3", ROOT / "clients/examples/sky_by_dot_product.py", SPOT,
         ROOT / "tests/data/env/venice_sunset_64.hdr", f"http://{server.host}:{server.port}"],
        capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    percent = float(done.stdout.rsplit("rms difference", 1)[1].split("%")[0])
    assert percent < 25, done.stdout
