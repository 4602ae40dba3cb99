"""Every file people have: meshes, clouds and glTF go in, and come out lit in every format."""

import gzip
import hashlib
import itertools
import json
import socket
import struct

import numpy
import pytest

from client import call, multipart, read_npz, read_ply, relight, rgb, upload
from conftest import Server
from files import DATA, document_of, embedded, faces_of, floats, shown, split_glb, table, vertices_of

SUN = {"type": "directional", "direction": [-1, -3, -2], "irradiance_w_m2": 3}
LONG = ["irradiance", "radiance", "normal", "color", "per_light", "visibility"]  # beyond a block as JSON
LAMPS = [SUN, {"type": "environment", "radiance_w_m2_sr": 0.3}]
MESHES = sorted(name for name in table("meshes") if (DATA / "meshes" / name).exists())
CLOUDS = sorted(table("clouds"))
GLTFS = sorted(table("gltf"))
COMPRESSED = {"simple.laz", "1.2-with-color.copc.laz"}


def stored(server, data, query=""):
    reply = upload(server, data, query)
    assert reply.status in (200, 201), reply.body[:500]
    return reply.json()


# --- in ------------------------------------------------------------------------------------------

@pytest.mark.parametrize("name", MESHES)
def test_a_mesh_has_the_counts_of_its_table(server, name):
    mesh = stored(server, (DATA / "meshes" / name).read_bytes())
    assert (mesh["vertices"], mesh["faces"]) == table("meshes")[name]
    assert mesh["kind"] == "mesh"


@pytest.mark.parametrize("name", CLOUDS)
def test_a_cloud_has_the_points_of_its_table_and_is_lit(server, name):
    data = (DATA / "clouds" / name).read_bytes()
    if name in COMPRESSED:
        reply = upload(server, data)
        assert reply.problem()[0] == "not_available" and "decompress" in reply.json()["detail"]
        return
    cloud = stored(server, data)
    assert (cloud["vertices"], cloud["faces"]) == table("clouds")[name]
    assert cloud["kind"] == "points"
    assert 0 < cloud["intake"]["expected_light_leak"] < 0.001
    if cloud["vertices"] > 50_000:
        return  # test_places_without_a_point_stay_in_place has it
    lit = relight(server, {"mesh": {"id": cloud["id"]}, "lights": LAMPS, "transport": {"samples": 16},
                           "output": {"format": "npz", "quantities": ["irradiance", "normal"]}})
    assert lit.status == 200, lit.body[:500]
    arrays = read_npz(lit.body)
    assert arrays["irradiance"].shape == (cloud["vertices"], 3)
    assert numpy.isfinite(arrays["irradiance"]).all()
    lengths = numpy.linalg.norm(arrays["normal"], axis=1)
    if cloud["vertices"] > 10:
        assert (lengths > 0.99).mean() > 0.9 and arrays["irradiance"].max() > 0.1


@pytest.mark.parametrize("name", GLTFS)
def test_a_gltf_has_the_vertices_of_what_its_scene_shows(server, name):
    data = embedded(DATA / "gltf" / name)
    document = document_of(data)
    pairs = shown(document)
    expected = table("gltf")[name]
    in_file = [p for mesh in document["meshes"] for p in mesh["primitives"]]
    assert (sum(vertices_of(document, p) for p in in_file), sum(faces_of(document, p) for p in in_file)) \
        == expected, "the table counts each mesh of the file once"
    mesh = stored(server, data)
    assert mesh["vertices"] == sum(vertices_of(document, p) for _, _, p in pairs)
    assert mesh["faces"] == sum(faces_of(document, p) for _, _, p in pairs)
    assert mesh["format"] == ("glb" if name.endswith(".glb") else "gltf")


def test_lights_of_the_file_shine_unless_the_request_has_its_own(server):
    mesh = stored(server, embedded(DATA / "gltf/geometry-camera-light.glb"))
    assert mesh["has"]["lights"] and len(mesh["lights"]) >= 1
    ask = {"mesh": {"id": mesh["id"]}, "output": {"format": "json", "quantities": ["irradiance", "per_light"]}}
    own = relight(server, ask).json()
    assert own["units"]["irradiance"] == "lx"
    assert list(own["per_light"]) == mesh["lights"]
    assert numpy.max(own["irradiance"]) > 0
    assert relight(server, {**ask, "lights": [SUN]}).json()["units"]["irradiance"] == "W/m2"
    mixed = relight(server, {**ask, "lights": [SUN, {"type": "from_mesh"}]})
    assert mixed.problem() == ("mixed_units", "/lights/1")
    both = relight(server, {**ask, "lights": [SUN, {"type": "from_mesh"}], "luminous_efficacy_lm_w": 100}).json()
    assert set(both["per_light"]) == {"light_0", *mesh["lights"]}
    for name in mesh["lights"]:
        assert both["per_light"][name] == own["per_light"][name]


def test_a_textured_material_is_sampled_at_the_vertices(server):
    mesh = stored(server, embedded(DATA / "gltf/NormalTangentTest.glb"))
    ask = {"mesh": {"id": mesh["id"]}, "lights": [SUN],
           "output": {"format": "json", "quantities": ["radiance", "irradiance"]}}
    own = relight(server, ask).json()
    white = relight(server, {**ask, "material": {"model": "lambert", "albedo": [1, 1, 1]}}).json()
    assert own["irradiance"] == white["irradiance"], "a material does not change what arrives"
    vertex = relight(server, {**ask, "material": {"model": "lambert", "albedo": "vertex"}}).json()
    albedo = numpy.array(vertex["radiance"]) / numpy.maximum(numpy.array(white["radiance"]), 1e-9)
    lit = numpy.array(white["radiance"]).min(axis=1) > 1e-3
    assert 0 <= albedo[lit].min() and albedo[lit].max() <= 1 + 1e-5
    assert numpy.ptp(albedo[lit], axis=0).max() > 0.05, "the texture shows"
    assert own["radiance"] != white["radiance"]


def test_what_a_file_only_names_is_refused_by_its_name(server):
    for name, where in (("a_gltf_uri_file.gltf", "etc/passwd"), ("a_gltf_uri_http.gltf", "http")):
        reply = upload(server, (DATA / "broken" / name).read_bytes())
        assert reply.problem()[0] == "not_available"
        assert where in reply.json()["detail"]
    outside = upload(server, (DATA / "gltf/Mesh_PrimitiveMode/Mesh_PrimitiveMode_05.gltf").read_bytes())
    assert outside.problem()[0] == "not_available"
    assert "Mesh_PrimitiveMode_05.bin" in outside.json()["detail"]


def test_a_file_that_breaks_its_decoder_costs_the_server_nothing(server):
    reply = upload(server, (DATA / "broken/a_draco_corrupt_payload.glb").read_bytes())
    assert reply.status in (201, 422)
    assert server.alive() and call(server, "GET", "/healthz").status == 200


# --- clouds --------------------------------------------------------------------------------------

def test_places_without_a_point_stay_in_place(server):
    cloud = stored(server, (DATA / "clouds/table_scene_mug_stereo_textured.pcd").read_bytes())
    absent = cloud["intake"]["absent_points"]
    assert cloud["vertices"] == 640 * 480 and absent > 1000
    reply = relight(server, {"mesh": {"id": cloud["id"]}, "lights": [SUN],
                             "output": {"format": "ply", "quantities": ["irradiance"]}})
    assert reply.status == 200 and f"{absent} places" in reply.headers["Relight-Warnings"]
    columns, faces = read_ply(reply.body)
    assert faces == [] and len(columns["x"]) == 640 * 480
    holes = numpy.isnan(columns["x"])
    assert holes.sum() == absent
    E = rgb(columns, "irradiance")
    assert numpy.isfinite(E).all() and (E[holes] == 0).all() and E[~holes].max() > 1
    again = stored(server, reply.body)  # what came out goes in
    assert again["intake"]["absent_points"] == absent


def test_normals_come_from_the_file_or_its_points(server):
    bare = stored(server, (DATA / "clouds/milk_color.pcd").read_bytes())
    assert not bare["has"]["normals"] and bare["intake"]["normals_estimated"] > 13_000
    ask = {"mesh": {"id": bare["id"]}, "lights": [SUN],
           "output": {"format": "json", "quantities": ["normal"]}}
    filed = relight(server, {**ask, "points": {"normals": "file"}})
    assert filed.problem() == ("normals_required", "/points/normals")
    eye = [0, 0, -10]
    toward = relight(server, {**ask, "points": {"normals": "estimate", "viewpoint": eye}}).json()["normal"]
    away = relight(server, {**ask, "points": {"normals": "estimate", "viewpoint": [0, 0, 10]}}).json()["normal"]
    assert numpy.mean(numpy.array(toward)[:, 2]) < -0.1 < 0.1 < numpy.mean(numpy.array(away)[:, 2])
    brings = stored(server, (DATA / "clouds/colored_cloud.pcd").read_bytes())
    assert brings["has"]["normals"] and brings["intake"]["normals_estimated"] == 0


def test_a_las_comes_back_with_its_colours_replaced(server):
    data = (DATA / "clouds/autzen-thin.las").read_bytes()
    cloud = stored(server, data)
    ask = {"mesh": {"id": cloud["id"]}, "lights": LAMPS, "transport": {"samples": 16},
           "points": {"normals": "estimate"}}
    reply = relight(server, {**ask, "output": {"format": "las"}})
    assert reply.status == 200 and reply.headers["Content-Type"] == "application/vnd.las"
    assert len(reply.body) == len(data)
    offset, record = struct.unpack_from("<I", data, 96)[0], struct.unpack_from("<H", data, 105)[0]
    before = numpy.frombuffer(data, numpy.uint8, offset=offset)[:cloud["vertices"] * record].reshape(-1, record)
    after = numpy.frombuffer(reply.body, numpy.uint8, offset=offset)[:cloud["vertices"] * record] \
        .reshape(-1, record)
    assert (before[:, :28] == after[:, :28]).all(), "all but the colours stays"
    codes = relight(server, {**ask, "output": {"format": "json"}}).json()["color"]
    assert (after[:, 28:34].copy().view("<u2") == numpy.array(codes) * 257).all()
    as_ply = stored(server, relight(server, {**ask, "output": {"format": "ply"}}).body)
    other = relight(server, {"mesh": {"id": as_ply["id"]}, "output": {"format": "las"}})
    assert other.problem() == ("conflicting_fields", "/output/format")


# --- out -----------------------------------------------------------------------------------------

SPOT = (DATA / "meshes/spot.ply").read_bytes()


@pytest.mark.parametrize("format_", ["ply", "ply_ascii", "obj", "off", "glb"])
def test_what_goes_out_comes_in_again_the_same(server, format_):
    ask = {"mesh": {"part": "mesh"}, "lights": [SUN], "output": {"format": format_}}
    parts = [("mesh", "spot.ply", SPOT), ("request", None, json.dumps(ask).encode())]
    out = multipart(server, parts)
    assert out.status == 200, out.body[:500]
    back = stored(server, out.body)
    assert (back["vertices"], back["faces"]) == (2930, 5856)
    assert back["has"]["colors"]
    before = stored(server, SPOT)
    assert numpy.allclose(back["bounds"]["min"], before["bounds"]["min"], atol=1e-6)
    assert numpy.allclose(back["bounds"]["max"], before["bounds"]["max"], atol=1e-6)
    # The colours that it brings are those that a JSON answer says.
    said = relight(server, {**ask, "mesh": {"id": before["id"]}, "output": {"format": "json"}}).json()["color"]
    read = relight(server, {"mesh": {"id": back["id"]}, "lights": [{"type": "environment", "radiance_w_m2_sr": 1}],
                            "material": {"model": "lambert", "albedo": "vertex"}, "transport": {"shadows": False},
                            "output": {"format": "json"}}).json()["color"]
    said, read = numpy.array(said, float), numpy.array(read, float)
    if format_ == "obj":  # viewers take its numbers as sRGB, so it is written so; they are read as linear
        said = 255 * numpy.where(said <= 0.0031308 * 255, 12.92 * said / 255, 1.055 * (said / 255) ** (1 / 2.4) - 0.055)
    assert numpy.abs(said - read).max() <= 1


@pytest.mark.parametrize("format_, media, magic", [
    ("obj", "model/obj", b""), ("off", "model/off", b""), ("glb", "model/gltf-binary", b"glTF"),
    ("vtp", "application/x-vtp", b"<"), ("jpeg", "image/jpeg", b"\xff\xd8\xff"),
    ("hdr", "image/vnd.radiance", b"#?RADIANCE"), ("png", "image/png", b"\x89PNG")])
def test_a_format_is_asked_for_by_name_or_by_accept(server, format_, media, magic):
    mesh = stored(server, SPOT)
    small = {"width": 64, "height": 48, "samples": 1} if media.startswith("image") else {}
    ask = {"mesh": {"id": mesh["id"]}, "lights": [SUN]}
    named = relight(server, {**ask, "output": {"format": format_, **small}})
    assert named.status == 200 and named.headers["Content-Type"] == media and named.body.startswith(magic)
    if not small:
        assert relight(server, ask, {"Accept": media}).body == named.body
    assert relight(server, {**ask, "output": {"format": format_, **small}}).body == named.body


@pytest.mark.parametrize("format_", ["obj", "off", "ply_ascii", "ply", "npz", "glb", "vtp", "json"])
def test_a_length_is_said_where_it_is_known_and_text_comes_in_chunks(server, format_):
    mesh = stored(server, SPOT)
    ask = {"mesh": {"id": mesh["id"]}, "lights": [SUN], "output": {"format": format_}}
    if format_ == "json":
        ask["output"]["quantities"] = LONG  # what is short has a length
    reply = relight(server, ask)
    in_chunks = reply.headers["Transfer-Encoding"] == "chunked"
    assert in_chunks == (format_ in ("obj", "off", "ply_ascii", "json"))
    assert in_chunks or int(reply.headers["Content-Length"]) == len(reply.body)
    # HTTP/1.0 knows no chunks: the same bytes, and how many.
    body = json.dumps(ask).encode()
    with socket.create_connection((server.host, server.port), timeout=60) as old:
        old.sendall(b"POST /v1/relight HTTP/1.0\r\nContent-Type: application/json\r\nContent-Length: "
                    + str(len(body)).encode() + b"\r\n\r\n" + body)
        answer = b"".join(iter(lambda: old.recv(1 << 16), b""))
    head, _, same = answer.partition(b"\r\n\r\n")
    assert b"chunked" not in head and same == reply.body
    receipt = call(server, "POST", "/v1/relight?receipt=1", body, {"Content-Type": "application/json"})
    if format_ == "json":  # its last member
        cut = receipt.body.rindex(b',"receipt":')
        said = receipt.json()["receipt"]["result_sha256"]
        assert receipt.body[:cut] + b"}" == reply.body and said == hashlib.sha256(reply.body).hexdigest()
        assert receipt.headers["Transfer-Encoding"] == "chunked"
    else:
        said = json.loads(receipt.headers["Relight-Receipt"])["result_sha256"]
        assert receipt.body == reply.body and said == hashlib.sha256(reply.body).hexdigest()


def test_short_json_has_a_length_and_the_log_tells_the_bytes_of_every_body(tmp_path):
    few = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
          b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    want = []
    with open(tmp_path / "log", "wb") as log:
        server = Server(tmp_path / "store", "--log", "json", log=log)
        try:
            for file in (few, SPOT):
                mesh = upload(server, file, "?format=ply").json()["id"]
                content = call(server, "GET", f"/v1/meshes/{mesh}/content")
                assert content.body == file
                want.append(len(file))
                for format_, query in itertools.product(("json", "obj", "ply"), ("", "?receipt=1")):
                    body = json.dumps({"mesh": {"id": mesh}, "lights": [SUN], "output": {
                        "format": format_, "quantities": ["color"] if format_ == "obj" else LONG}})
                    reply = call(server, "POST", "/v1/relight" + query, body, {"Content-Type": "application/json"})
                    assert reply.status == 200
                    in_chunks = reply.headers["Transfer-Encoding"] == "chunked"
                    assert in_chunks == (format_ == "obj" or (format_ == "json" and len(reply.body) > 1 << 18))
                    assert in_chunks or int(reply.headers["Content-Length"]) == len(reply.body)
                    if query and format_ == "json":
                        whole, _, end = reply.body.rpartition(b',"receipt":')
                        assert json.loads(b"{" + b'"receipt":' + end)["receipt"]["result_sha256"] == \
                            hashlib.sha256(whole + b"}").hexdigest()
                    want.append(len(reply.body))
        finally:
            assert server.stop() == 0
    lines = [json.loads(line) for line in (tmp_path / "log").read_text().splitlines() if '"path"' in line]
    assert [line["bytes"] for line in lines if not line["path"].endswith("/meshes")] == want


def test_json_is_packed_while_it_is_sent_and_for_those_alone_who_take_it(server):
    mesh = stored(server, SPOT)
    ask = {"mesh": {"id": mesh["id"]}, "lights": LAMPS, "transport": {"samples": 4},
           "output": {"format": "json", "quantities": ["color", "irradiance", "radiance", "normal", "per_light",
                                                       "visibility", "ambient_occlusion", "sh"]}}
    plain = relight(server, ask)
    assert "Content-Encoding" not in plain.headers and len(plain.body) > 1 << 18  # several pieces
    said = plain.json()
    assert all(len(said[name]) == 2930 for name in ("color", "irradiance", "radiance", "normal", "sh"))
    packed = relight(server, ask, {"Accept-Encoding": "gzip"})
    assert packed.headers["Content-Encoding"] == "gzip" and packed.headers["Transfer-Encoding"] == "chunked"
    assert gzip.decompress(packed.body) == plain.body and len(packed.body) < 0.5 * len(plain.body)
    body, kind = json.dumps(ask).encode(), {"Content-Type": "application/json"}
    receipt = call(server, "POST", "/v1/relight?receipt=1", body, kind)
    packed = call(server, "POST", "/v1/relight?receipt=1", body, {**kind, "Accept-Encoding": "gzip"})
    assert gzip.decompress(packed.body) == receipt.body
    assert {**receipt.json(), "receipt": None} == {**said, "receipt": None}
    obj = relight(server, {**ask, "output": {"format": "obj"}}, {"Accept-Encoding": "gzip"})
    assert "Content-Encoding" not in obj.headers


def test_a_long_json_answer_is_not_held_by_the_server(start):
    server = start()
    mesh = stored(server, SPOT)
    ask = {"mesh": {"id": mesh["id"]}, "lights": [SUN], "refine": {"max_edge": 0.008},
           "output": {"format": "npz", "quantities": ["irradiance", "radiance", "normal", "color"]}}
    relight(server, ask)  # all that is kept for the next is kept
    server.forget_peak()
    relight(server, ask)
    before = server.peak_bytes()
    ask["output"]["format"] = "json"
    long = relight(server, ask)
    assert long.status == 200 and len(long.body) > 20_000_000
    grown = server.peak_bytes() - before
    assert server.is_sanitized() or grown < len(long.body), (grown, len(long.body))


def test_a_client_that_leaves_amid_an_answer_costs_it_alone(server):
    mesh = stored(server, SPOT)
    body = json.dumps({"mesh": {"id": mesh["id"]}, "lights": [SUN], "refine": {"max_edge": 0.01},
                       "output": {"format": "obj"}}).encode()
    for _ in range(3):
        with socket.create_connection((server.host, server.port), timeout=60) as gone:
            gone.sendall(b"POST /v1/relight HTTP/1.1\r\nHost: a\r\nContent-Type: application/json\r\n"
                         b"Content-Length: " + str(len(body)).encode() + b"\r\n\r\n" + body)
            assert gone.recv(1000).startswith(b"HTTP/1.1 200")
    assert relight(server, json.loads(body)).status == 200


def test_formats_without_a_place_for_a_quantity_say_so(server):
    mesh = stored(server, SPOT)
    for format_ in ("obj", "off", "jpeg", "hdr"):
        reply = relight(server, {"mesh": {"id": mesh["id"]},
                                 "output": {"format": format_, "quantities": ["irradiance"]}})
        assert reply.problem() == ("conflicting_fields", "/output/quantities"), format_


def test_a_picture_as_hdr_is_the_picture_as_exr_to_its_precision(server):
    mesh = stored(server, SPOT)
    ask = {"mesh": {"id": mesh["id"]}, "lights": [SUN],
           "output": {"format": "hdr", "width": 80, "height": 60, "samples": 4}}
    sky = call(server, "POST", "/v1/environments", relight(server, ask).body)
    assert sky.status == 201 and (sky.json()["width"], sky.json()["height"]) == (80, 60)


def test_glb_gives_back_all_that_came_and_the_light(server):
    for name in ("geometry-camera-light.glb", "terrain.glb", "BoxMeshopt.glb", "suzi_draco.glb"):
        data = (DATA / "gltf" / name).read_bytes()
        before, _ = split_glb(data)
        mesh = stored(server, data)
        reply = relight(server, {"mesh": {"id": mesh["id"]}, "lights": [SUN],
                                 "output": {"format": "glb", "quantities": ["color", "irradiance"]}})
        assert reply.status == 200, (name, reply.body[:300])
        after, binary = split_glb(reply.body)
        for key in ("materials", "textures", "samplers", "cameras", "animations", "skins"):
            assert after.get(key) == before.get(key), (name, key)
        assert len(after["nodes"]) == len(before["nodes"]) and after["scenes"] == before["scenes"]
        E = relight(server, {"mesh": {"id": mesh["id"]}, "lights": [SUN],
                             "output": {"format": "json", "quantities": ["irradiance"]}}).json()["irradiance"]
        at = 0
        for _, _, primitive in shown(after):
            attributes = primitive["attributes"]
            count = vertices_of(after, primitive)
            rows = floats(after, binary, attributes["_IRRADIANCE"])
            assert len(rows) == count == len(floats(after, binary, attributes["COLOR_0"]))
            assert numpy.array_equal(numpy.float32(rows), numpy.float32(E[at:at + count])), name
            at += count
        assert at == mesh["vertices"]
        again = stored(server, reply.body)
        assert (again["vertices"], again["faces"]) == (mesh["vertices"], mesh["faces"])


def test_refinement_shows_a_shadow_that_is_thinner_than_a_triangle(server):
    floor = {"positions": [[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2],
                           [-0.1, 1, -3], [0.1, 1, -3], [0.1, 1, 3], [-0.1, 1, 3]],
             "faces": [[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6]]}
    ask = {"mesh": floor, "lights": [{"type": "directional", "direction": [0, -1, 0], "irradiance_w_m2": 1}],
           "output": {"format": "npz", "quantities": ["irradiance"]}}
    coarse = read_npz(relight(server, ask).body)
    assert (coarse["irradiance"][:4] == 1).all(), "no vertex of the floor is in the shadow"
    reply = relight(server, {**ask, "refine": {"max_edge": 0.15}})
    assert "lit very differently" in reply.headers["Relight-Warnings"]
    fine = read_npz(reply.body)
    assert (fine["positions"][:8] == coarse["positions"]).all()
    on_floor = fine["positions"][:, 1] == 0
    dark = on_floor & (fine["irradiance"][:, 0] == 0)
    assert dark.any() and (numpy.abs(fine["positions"][dark, 0]) <= 0.1 + 1e-6).all()
    edges = fine["positions"][fine["faces"]]
    assert numpy.linalg.norm(edges - numpy.roll(edges, 1, axis=1), axis=2).max() <= 0.15 + 1e-6
    too_fine = relight(server, {**ask, "refine": {"max_edge": 1e-6}})
    assert too_fine.problem()[1] == "/refine/max_edge"
