"""Files made to hurt a reader: each is refused in a second, and the server neither dies nor grows."""

import time

import pytest

from client import call, multipart, relight, upload
from conftest import ROOT

FILES = sorted(path for path in (ROOT / "tests/data/broken").iterdir()
               if path.suffix not in (".md", ".py"))

# Extreme but legal: README.md beside them allows an answer with finite numbers.
LEGAL = {"a_obj_million_char_line.obj", "a_ply_10000_properties.ply", "a_ply_all_same_point.ply",
         "a_ply_huge_coordinates.ply", "draco_degenerate_mesh.obj", "a_gltf_zero_scale.gltf"}

# Without the name of its format it is what its bytes say: rows of x y z.
OTHERWISE_LEGAL = {"pdal_missingheader.pcd"}
FORMATS = {".ply", ".obj", ".off", ".stl", ".pcd", ".las", ".glb", ".gltf"}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_it_is_refused_quickly(server, path):
    data = path.read_bytes()
    server.forget_peak()
    rss = server.rss_bytes()
    named = path.suffix[1:] if path.suffix in FORMATS else None
    if path.name in OTHERWISE_LEGAL:
        assert upload(server, data, f"?format={named}").status == 422
        return
    for reply_to in (lambda: upload(server, data),
                     lambda: upload(server, data, f"?format={named}") if named else None,
                     lambda: multipart(server, [("mesh", path.name, data)])):
        begin = time.monotonic()
        reply = reply_to()
        if reply is None:
            continue
        assert time.monotonic() - begin < 1
        if reply.status < 300:
            assert path.name in LEGAL, f"accepted: {reply.body[:300]}"
            assert b"nan" not in reply.body.lower()[:20000] or reply.headers["Content-Type"] != "application/json"
            continue
        code, _ = reply.problem()
        assert 400 <= reply.status < 500, (reply.status, reply.body)
        assert code not in ("internal", "bad_request")
    assert server.alive() and call(server, "GET", "/healthz").status == 200
    if not server.is_sanitized():
        assert server.peak_bytes() - rss < 50 << 20
    for mesh in call(server, "GET", "/v1/meshes").json()["meshes"]:  # only legal ones are kept
        lit = relight(server, {"mesh": {"id": mesh["id"]}, "output": {"format": "json"}})
        assert lit.status == 200 or lit.problem()[0] == "normals_required"


def test_refused_files_leave_nothing(start, tmp_path):
    server = start()
    for path in FILES:
        if path.name not in LEGAL | OTHERWISE_LEGAL:
            upload(server, path.read_bytes())
    assert call(server, "GET", "/v1/meshes").json()["meshes"] == []
    store = next(path for path in tmp_path.iterdir() if path.is_dir())
    left = {str(path.relative_to(store)) for path in store.rglob("*") if path.is_file()}
    assert left == {"lock", "environments/lock", "profiles/lock"}
