"""What the real server answers, through HTTP; expected values are computed here from closed forms."""

import gzip
import hashlib
import json
import math
import re

import numpy
import pytest

from client import call, multipart, read_npz, read_ply, read_png, relight, rgb, upload
from conftest import ROOT

MESHES = ROOT / "tests/data/meshes"
CLOUDS = ROOT / "tests/data/clouds"
SPOT = (MESHES / "spot.ply").read_bytes()

# Light meters: vertices that bring normals, no faces needed to be lit.
METERS = numpy.array([[0, 0, 0], [1, 0.5, 0], [-2, 1, 0.25], [0.3, -3, -0.5]])
NORMALS = numpy.array([[0, 0, 1], [0, 0.6, 0.8], [0.6, 0, 0.8], [0, 0, -1.0]])
# A far triangle, so that they are a mesh beside an occluder that blocks nothing.
POSITIONS = numpy.vstack([METERS, [[90, 90, 90], [91, 90, 90], [90, 91, 90]]])
MESH = {"positions": POSITIONS.tolist(), "faces": [[4, 5, 6]],
        "normals": numpy.vstack([NORMALS, [[0, 0, 1]] * 3]).tolist()}


def ask(quantities, lights, mesh=None, **fields):
    output = {"format": "json", "quantities": quantities}
    return {"mesh": mesh or MESH, "lights": lights, "output": output, **fields}


def answer(server, *args, **fields):
    reply = relight(server, ask(*args, **fields))
    assert reply.status == 200, reply.body
    return reply.json()


def point_E(position, I, p=METERS, n=NORMALS):
    """E = I (n.l)+ / r^2"""
    d = numpy.array(position) - p
    r = numpy.linalg.norm(d, axis=1)
    cosine = numpy.maximum(0, numpy.einsum("ij,ij->i", n, d) / r)
    return numpy.outer(cosine / r**2, I)


def spot_falloff(position, axis, inner, outer, p=METERS):
    l = numpy.array(position) - p
    l = l / numpy.linalg.norm(l, axis=1)[:, None]
    cd = -l @ (numpy.array(axis) / numpy.linalg.norm(axis))
    ci, co = math.cos(math.radians(inner)), math.cos(math.radians(outer))
    return numpy.clip((cd - co) / max(0.001, ci - co), 0, 1) ** 2


def close(got, expected, rel=1e-6):
    numpy.testing.assert_allclose(numpy.array(got)[:len(expected)], expected, rtol=rel, atol=1e-9)


# --- light ---------------------------------------------------------------------------------------

def test_a_point_light_falls_off_with_the_square_of_distance_and_the_cosine(server):
    light = {"type": "point", "position": [0.5, 1, 2], "flux_w": 40, "color": [1, 0.5, 0]}
    got = answer(server, ["irradiance"], [light])
    close(got["irradiance"], point_E([0.5, 1, 2], 40 / (4 * math.pi) * numpy.array([1, 0.5, 0])))
    assert got["units"] == {"irradiance": "W/m2"}
    assert got["vertices"] == 7 and got["view"] == {"type": "normal"}


def test_a_spot_shines_into_its_cone_alone(server):
    spot = {"type": "spot", "position": [0, 0, 3], "direction": [0.2, 0, -1], "intensity_cd": 500,
            "inner_cone_deg": 10, "outer_cone_deg": 40}
    got = answer(server, ["irradiance"], [spot])
    fall = spot_falloff([0, 0, 3], [0.2, 0, -1], 10, 40)
    close(got["irradiance"], point_E([0, 0, 3], [500] * 3) * fall[:, None])
    assert got["units"] == {"irradiance": "lx"}
    assert 0 in fall and (fall > 0).any(), "the case sees inside and outside"


def test_a_sun_is_the_same_everywhere_but_for_the_cosine(server):
    sun = {"type": "directional", "direction": [0, -3, -4], "irradiance_w_m2": 3}
    got = answer(server, ["irradiance"], [sun])
    close(got["irradiance"], numpy.outer(numpy.maximum(0, NORMALS @ [0, 0.6, 0.8]), [3] * 3))


def test_a_length_unit_scales_distances(server):
    light = {"type": "point", "position": [0.5, 1, 2], "flux_w": 40}
    far = answer(server, ["irradiance"], [light], length_unit_m=10)
    close(far["irradiance"], point_E([0.5, 1, 2], [40 / (4 * math.pi) / 100] * 3))


def test_lambert_sends_back_albedo_over_pi(server):
    sun = {"type": "directional", "direction": [0, 0, -1], "irradiance_w_m2": 3}
    got = answer(server, ["radiance", "irradiance"], [sun],
                 material={"model": "lambert", "albedo": [0.5, 0.25, 1]})
    close(got["radiance"], numpy.array(got["irradiance"])[:4] * [0.5, 0.25, 1] / math.pi)


def test_vertex_colours_are_an_albedo(server):
    mesh = {**MESH, "colors": [[0.1, 0.2, 0.3]] * 7}
    sun = {"type": "directional", "direction": [0, 0, -1], "irradiance_w_m2": math.pi}
    got = answer(server, ["radiance"], [sun], mesh=mesh, material={"model": "lambert", "albedo": "vertex"})
    close(got["radiance"][:1], [[0.1, 0.2, 0.3]])


def test_what_stands_between_leaves_exactly_nothing(server):
    mesh = {"positions": [[0, 0, 0], [5, 0, 0], [-1, -1, 1], [1, -1, 1], [0, 2, 1]],
            "normals": [[0, 0, 1]] * 5, "faces": [[2, 3, 4]]}
    lamp = {"type": "point", "position": [0, 0, 2], "flux_w": 40, "name": "lamp"}
    got = answer(server, ["irradiance", "visibility"], [lamp], mesh=mesh)
    assert got["irradiance"][0] == [0, 0, 0] and got["irradiance"][1][0] > 0
    assert got["visibility"]["lamp"][:2] == [0, 1]
    for unshadowed in ({"transport": {"shadows": False}}, {"lights": [{**lamp, "cast_shadows": False}]},
                       {"transport": {"max_distance": 0.5}}):
        free = relight(server, {**ask(["irradiance"], [lamp], mesh=mesh), **unshadowed}).json()
        close(free["irradiance"][:1], [[40 / (4 * math.pi) / 4] * 3])


def test_lights_add_up_and_are_told_apart_by_name(server):
    lights = [{"type": "point", "position": [0, 0, 2], "flux_w": 40, "name": "key"},
              {"type": "directional", "direction": [0, -1, -1], "irradiance_w_m2": 1},
              {"type": "point", "position": [1, 1, 2], "flux_w": 9, "enabled": False}]
    got = answer(server, ["irradiance", "per_light"], lights)
    assert sorted(got["per_light"]) == ["key", "light_1", "light_2"]
    total = sum(numpy.array(E) for E in got["per_light"].values())
    close(got["irradiance"], total)
    assert not numpy.array(got["per_light"]["light_2"]).any()


def test_watts_become_lumens_by_the_efficacy_given(server):
    lights = [{"type": "point", "position": [0, 0, 2], "intensity_w_sr": 2}]
    got = answer(server, ["irradiance"], lights, luminous_efficacy_lm_w=100)
    close(got["irradiance"], point_E([0, 0, 2], [200] * 3))
    assert got["units"] == {"irradiance": "lx"}


def test_an_extreme_request_is_answered_in_finite_numbers(server):
    light = {"type": "point", "position": [0, 0, 1e-14], "intensity_cd": 1e12}
    reply = relight(server, ask(["irradiance", "radiance", "color"], [light]))
    assert reply.status == 200
    got = reply.json()
    assert numpy.isfinite(got["irradiance"]).all() and numpy.isfinite(got["radiance"]).all()
    for position in ([1e15, 1e15, 1e15], [0, 0, 0]):
        light = {"type": "point", "position": position, "flux_w": 1}
        assert relight(server, ask(["irradiance"], [light])).status == 200


def test_colour_is_the_srgb_code_of_radiance(server):
    sun = {"type": "directional", "direction": [0, 0, -1], "irradiance_w_m2": math.pi}
    got = answer(server, ["color"], [sun], material={"model": "lambert", "albedo": [0.5, 0.002, 1]},
                 display={"exposure_ev": 0})
    code = [round(255 * (1.055 * 0.5 ** (1 / 2.4) - 0.055)), round(255 * 12.92 * 0.002), 255]
    assert got["color"][0] == code
    assert got["display"] == {"exposure_ev": 0, "tone_map": "none", "transfer": "srgb"}


# --- formats -------------------------------------------------------------------------------------

KEY = {"type": "point", "position": [2, 3, 1], "flux_w": 100, "name": "key light"}
EVERYTHING = ["color", "irradiance", "radiance", "visibility", "normal", "per_light"]


@pytest.fixture(scope="module")
def spot_id(server):
    return upload(server, SPOT).json()["id"]


@pytest.fixture(scope="module")
def spot_json(server, spot_id):
    return answer(server, EVERYTHING, [KEY], mesh={"id": spot_id})


@pytest.mark.parametrize("form", ["ply", "ply_ascii"])
def test_a_ply_keeps_the_mesh_and_adds_what_was_asked_for(server, spot_id, spot_json, form):
    request = ask(EVERYTHING, [KEY], mesh={"id": spot_id})
    request["output"]["format"] = form
    reply = relight(server, request)
    assert reply.status == 200 and reply.headers["Content-Type"] == "model/ply"
    columns, faces = read_ply(reply.body)
    before, faces_before = read_ply(SPOT)
    assert faces == faces_before
    for axis in "xyz":
        numpy.testing.assert_array_equal(numpy.float32(columns[axis]), before[axis])
    for name in ("irradiance", "radiance"):
        numpy.testing.assert_allclose(rgb(columns, name), spot_json[name], rtol=1e-7)
    numpy.testing.assert_allclose(rgb(columns, "per_light_key_light"), spot_json["per_light"]["key light"],
                                  rtol=1e-7)
    numpy.testing.assert_array_equal(columns["visibility_key_light"], spot_json["visibility"]["key light"])
    color = numpy.stack([columns[c] for c in ("red", "green", "blue")], axis=1)
    numpy.testing.assert_array_equal(color, spot_json["color"])
    normal = numpy.stack([columns[c] for c in ("nx", "ny", "nz")], axis=1)
    numpy.testing.assert_allclose(normal, spot_json["normal"], rtol=1e-7)


def test_an_npz_holds_the_same_arrays(server, spot_id, spot_json):
    request = ask(EVERYTHING, [KEY], mesh={"id": spot_id})
    request["output"]["format"] = "npz"
    reply = relight(server, request)
    assert reply.headers["Content-Type"] == "application/x-npz"
    arrays = read_npz(reply.body)
    for name in ("irradiance", "radiance", "normal", "color"):
        numpy.testing.assert_array_equal(arrays[name], numpy.array(spot_json[name], arrays[name].dtype))
    assert arrays["irradiance"].dtype == numpy.float32 and arrays["color"].dtype == numpy.uint8
    assert len(arrays["positions"]) == len(spot_json["irradiance"])


@pytest.mark.parametrize("renderer", ["raytrace", "vtk"])
def test_a_png_shows_the_mesh_in_front_of_its_background(server, spot_id, renderer):
    output = {"format": "png", "width": 64, "height": 48, "samples": 4, "renderer": renderer,
              "background": [0, 1, 0]}
    camera = {"eye": [0, 0.2, 5], "target": [0, 0.1, 0]}
    request = {"mesh": {"id": spot_id}, "camera": camera, "output": output}
    reply = relight(server, request)
    assert reply.status == 200 and reply.headers["Content-Type"] == "image/png"
    image = read_png(reply.body)
    assert image.shape == (48, 64, 3)
    assert image[0, 0].tolist() == [0, 255, 0]
    middle = image[24, 32].astype(int)
    assert middle[0] > 60 and abs(middle[0] - middle[1]) <= 1, "grey under the default sun"
    request["output"]["background"] = "transparent"
    clear = read_png(relight(server, request).body)
    assert clear.shape == (48, 64, 4)
    assert clear[0, 0, 3] == 0 and clear[24, 32].tolist() == [*image[24, 32], 255]


def test_a_shell_wound_inward_is_reported_and_lit_when_asked_for_on_both_sides(server):
    cat = (MESHES / "egyptcat.ply").read_bytes()
    reply = upload(server, cat)
    assert reply.json()["intake"]["wound_inward"] is True
    mesh = {"id": reply.json()["id"]}
    lamp = [{"type": "point", "position": [3, -3, 3], "flux_w": 100}]
    lit = {}
    for two_sided in (False, True):
        request = ask(["radiance"], lamp, mesh, transport={"two_sided": two_sided})
        reply = relight(server, request)
        assert ("wind inward" in reply.headers.get("relight-warnings", "")) is not two_sided
        lit[two_sided] = sum(L[0] > 0 for L in reply.json()["radiance"])
    assert lit[False] < 0.01 * lit[True]
    picture = ask(["color"], lamp, mesh)
    picture["output"] = {"format": "png", "width": 64, "height": 64, "samples": 4}
    reply = relight(server, picture)  # shows what the camera sees
    assert "relight-warnings" not in reply.headers
    assert read_png(reply.body).max() > 50


def test_the_seed_moves_the_samples_of_a_picture_and_nothing_else_does(server, spot_id):
    request = {"mesh": {"id": spot_id}, "output": {"format": "png", "width": 64, "height": 64}}
    pictures = [relight(server, {**request, "transport": {"seed": seed}}).body for seed in (1, 1, 2)]
    assert pictures[0] == pictures[1] != pictures[2]


def test_accept_chooses_where_the_request_names_no_format(server):
    request = {"mesh": MESH, "lights": []}
    for accept, kind in (("*/*", "model/ply"), ("application/json", "application/json"),
                         ("image/png;q=0.4, application/x-npz", "application/x-npz")):
        assert relight(server, request, {"Accept": accept}).headers["Content-Type"] == kind
    assert relight(server, request, {"Accept": "text/html"}).problem() == ("not_acceptable", None)
    request["output"] = {"format": "json"}
    assert relight(server, request, {"Accept": "text/html"}).status == 200


def test_text_is_compressed_for_who_takes_it(server, spot_id):
    request = ask(["irradiance"], [KEY], mesh={"id": spot_id})
    plain = relight(server, request)
    packed = relight(server, request, {"Accept-Encoding": "gzip"})
    assert packed.headers["Content-Encoding"] == "gzip"
    assert "Content-Encoding" not in plain.headers
    assert gzip.decompress(packed.body) == plain.body
    assert "Accept-Encoding" in plain.headers["Vary"]


def test_computing_answers_tell_times_and_rays(server, spot_id):
    moved = {**KEY, "position": [0.11, 2.22, -2.33]}  # no other test asked for it
    reply = relight(server, ask(["irradiance"], [moved], mesh={"id": spot_id}))
    names = re.findall(r"(\w+);dur=[\d.]+", reply.headers["Server-Timing"])
    assert names == ["parse", "bvh", "trace", "shade", "encode", "total"]
    assert 0 < int(reply.headers["Relight-Rays"]) <= 2930


# --- where the mesh comes from -------------------------------------------------------------------

def test_curl_needs_no_earlier_upload(server, spot_id, spot_json):
    request = {"lights": [KEY], "output": {"format": "json", "quantities": EVERYTHING}}
    posted = [("mesh", "spot.ply", SPOT), ("request", "scene.json", json.dumps(request).encode())]
    assert multipart(server, posted).json() == spot_json
    request["mesh"] = {"part": "other"}
    posted = [("request", None, json.dumps(request).encode()), ("other", "x", SPOT)]
    assert multipart(server, posted).json() == spot_json
    alone = multipart(server, [("mesh", "spot.ply", SPOT)])
    assert alone.status == 200 and alone.headers["Content-Type"] == "model/ply"


def test_multipart_refusals_say_what_is_wrong(server):
    assert multipart(server, [("request", None, b"{}")]).problem() == ("missing_field", "/mesh")
    missing = [("request", None, b'{"mesh":{"part":"b"}}'), ("a", "a", SPOT)]
    assert multipart(server, missing).problem() == ("missing_field", "/mesh/part")
    twice = [("mesh", "a", SPOT), ("mesh", "b", SPOT)]
    assert multipart(server, twice).problem()[0] == "bad_request"
    broken = multipart(server, [("mesh", "a", SPOT[:3000])])
    assert broken.status == 422 and "byte" in broken.json()


def test_every_format_is_lit_and_keeps_its_order(server):
    for name in ("suzanne.obj", "cube.off", "featuretype.STL", "spot.ply"):
        data = (MESHES / name).read_bytes()
        reply = upload(server, data)
        assert reply.status in (200, 201), (name, reply.body)
        about = reply.json()
        lit = relight(server, {"mesh": {"id": about["id"]}})
        columns, faces = read_ply(lit.body)
        assert (len(columns["x"]), len(faces)) == (about["vertices"], about["faces"]), name


def test_a_cloud_with_normals_is_lit_as_discs(server):
    n = 20
    flat = [[x / n, y / n, 0] for x in range(n) for y in range(n)]
    cloud = {"positions": flat, "normals": [[0, 0, 1]] * len(flat)}
    sun = {"type": "directional", "direction": [1, 0, -1], "irradiance_w_m2": math.sqrt(2)}
    got = answer(server, ["irradiance"], [sun], mesh=cloud)
    close(got["irradiance"], [[1, 1, 1]] * len(flat))
    bare = ask(["irradiance"], [sun], mesh={"positions": flat})
    close(relight(server, bare).json()["irradiance"], [[1, 1, 1]] * len(flat))  # estimated, upward
    filed = relight(server, {**bare, "points": {"normals": "file"}})
    assert filed.problem() == ("normals_required", "/points/normals")


# --- the store -----------------------------------------------------------------------------------

def test_a_mesh_is_stored_described_listed_given_back_and_forgotten(start):
    server = start()
    first = upload(server, SPOT)
    about = first.json()
    assert first.status == 201 and about["id"] == hashlib.sha256(SPOT).hexdigest()
    assert first.headers["Location"] == "/v1/meshes/" + about["id"]
    assert (about["kind"], about["format"], about["vertices"], about["faces"], about["bytes"]) == \
        ("mesh", "ply", 2930, 5856, len(SPOT))
    columns, _ = read_ply(SPOT)
    numpy.testing.assert_allclose(about["bounds"]["min"], [columns[a].min() for a in "xyz"])
    numpy.testing.assert_allclose(about["bounds"]["max"], [columns[a].max() for a in "xyz"])
    assert about["has"] == {"normals": False, "colors": False, "uvs": False, "materials": False,
                            "lights": False}
    assert about["intake"]["normals_computed"] == 2930 and about["intake"]["degenerate_faces"] == 0
    again = upload(server, SPOT)
    assert again.status == 200 and again.json() == about
    path = "/v1/meshes/" + about["id"]
    assert call(server, "GET", path).json() == about
    content = call(server, "GET", path + "/content")
    assert content.body == SPOT and content.headers["Content-Type"] == "model/ply"
    head = call(server, "HEAD", path + "/content")
    assert head.status == 200 and head.body == b"" and head.headers["Content-Length"] == str(len(SPOT))
    assert relight(server, {"mesh": {"id": about["id"]}}).status == 200
    assert call(server, "DELETE", path).status == 204
    for method, where in (("GET", path), ("GET", path + "/content"), ("DELETE", path)):
        assert call(server, method, where).problem()[0] == "not_found"
    assert relight(server, {"mesh": {"id": about["id"]}}).problem() == ("not_found", "/mesh/id")
    assert call(server, "GET", "/v1/meshes").json() == {"meshes": [], "next_cursor": None}


def test_the_list_is_newest_first_page_by_page(start):
    server = start()
    ids = [upload(server, f"OFF\n3 1 0\n0 0 {i}\n1 0 0\n0 1 0\n3 0 1 2\n".encode()).json()["id"]
           for i in range(5)]
    seen, cursor = [], ""
    while True:
        page = call(server, "GET", "/v1/meshes?limit=2" + cursor).json()
        assert len(page["meshes"]) <= 2
        seen += [mesh["id"] for mesh in page["meshes"]]
        if page["next_cursor"] is None:
            break
        cursor = "&cursor=" + page["next_cursor"]
    assert seen == ids[::-1]
    for bad in ("?limit=0", "?limit=1001", "?limit=x", "?cursor=%2e%2e", "?limt=3", "?limit=1&limit=2"):
        assert call(server, "GET", "/v1/meshes" + bad).status == 422, bad


def test_the_format_is_named_or_seen(server):
    cube = (MESHES / "cube.off").read_bytes()
    assert upload(server, cube, "?format=off").json()["format"] == "off"
    assert upload(server, (MESHES / "suzanne.obj").read_bytes(), content_type="model/obj").status in (200, 201)
    assert upload(server, b"COFF junk", "?format=ply").problem()[0] == "malformed_header"
    assert upload(server, cube + b"\n", "?format=glb").problem()[0] == "malformed_header"
    assert upload(server, cube + b"\n", "?format=zzz").problem()[0] == "unknown_format"
    assert upload(server, b"\x00\x01\x02 nothing we know").problem()[0] == "unknown_format"
    assert upload(server, b"").problem()[0] == "empty_file"


# --- the edges of HTTP ---------------------------------------------------------------------------

def test_unknown_paths_and_methods_are_problems(server):
    for path in ("/nothing", "/v1", "/v1/meshes/", "/v1/meshes/xyz", "/v1/meshes/" + "A" * 64,
                 "/v1/meshes/..%2f..%2fetc%2fpasswd"):
        assert call(server, "GET", path).problem()[0] == "not_found", path
    for method, path in (("GET", "/v1/relight"), ("DELETE", "/v1/meshes"), ("POST", "/healthz"),
                         ("PUT", "/v1/meshes/" + "a" * 64), ("PATCH", "/v1/meshes")):
        reply = call(server, method, path)
        assert reply.problem()[0] == "method_not_allowed"
        assert method not in reply.headers["Allow"].split(", ")
    options = call(server, "OPTIONS", "/v1/relight")
    assert options.status == 204 and options.headers["Allow"] == "POST, OPTIONS"


def test_bodies_that_are_not_what_they_should_be_are_refused(server):
    assert call(server, "POST", "/v1/relight", b"{}", {"Content-Type": "text/plain"}).problem()[0] == \
        "unsupported_media_type"
    assert call(server, "POST", "/v1/meshes", gzip.compress(SPOT), {"Content-Encoding": "gzip"}).problem()[0] \
        == "unsupported_encoding"
    assert call(server, "POST", "/v1/relight", b"x",
                {"Content-Type": "multipart/form-data"}).problem()[0] == "bad_request"
    assert relight(server, b"{\n  nope").json()["line"] == 2
    assert call(server, "POST", "/v1/explain", b'{"mesh": {"part": "m"}, "vertices": [0], "receipt": true}',
                {"Content-Type": "application/json"}).problem() == ("not_available", "/receipt")


@pytest.mark.parametrize("request_, code, pointer", [
    ({"mesh": MESH, "lights": [{"type": "point", "position": [0, 0, 1], "intensty_cd": 3}]},
     "unknown_field", "/lights/0/intensty_cd"),
    ({"mesh": MESH, "lights": [{"type": "rect"}]}, "missing_field", "/lights/0/center"),
    ({"mesh": MESH, "output": {"format": "ply", "width": 30}}, "conflicting_fields", "/output/width"),
    ({"mesh": MESH, "output": {"format": "png", "quantities": ["irradiance"]}}, "conflicting_fields",
     "/output/quantities"),
    ({"mesh": MESH, "material": {"model": "lambert", "albedo": "vertex"}}, "conflicting_fields",
     "/material/albedo"),
    ({"mesh": {"id": "a" * 64}}, "not_found", "/mesh/id"),
    ({"mesh": {"part": "x"}}, "missing_field", "/mesh/part"),
])
def test_a_wrong_request_is_refused_at_its_place(server, request_, code, pointer):
    assert relight(server, request_).problem() == (code, pointer)


def test_limits_are_flags_and_named_by_the_refusal(start):
    server = start("--max-upload-bytes", "1000", "--max-json-bytes", "400", "--max-vertices", "10",
                   "--max-pixels", "100", "--max-rays", "20", "--max-lights", "2")
    limits = call(server, "GET", "/readyz").json()["limits"]
    assert limits["max_upload_bytes"] == 1000 and limits["max_rays"] == 20
    for reply, flag in ((upload(server, b" " * 1001), "--max-upload-bytes"),
                        (relight(server, " " * 401), "--max-json-bytes")):
        assert reply.problem()[0] == "body_too_large" and flag in reply.json()["detail"]
    points = b"OFF\n11 0 0\n" + b"0 0 0\n" * 11
    assert upload(server, points).problem()[0] == "too_many_vertices"
    one = {"positions": [[0, 0, 0]], "normals": [[0, 0, 1]]}
    picture = {"mesh": one, "output": {"format": "png", "width": 11, "height": 10}}
    assert relight(server, picture).problem() == ("out_of_range", "/output/height")
    picture["output"].update(width=10, samples=4)
    assert relight(server, picture).problem() == ("out_of_range", "/output/samples")


def test_the_server_says_how_it_is_and_what_it_does(server):
    assert call(server, "GET", "/healthz").json() == {"status": "ok"}
    ready = call(server, "GET", "/readyz").json()
    assert ready["status"] == "ready" and "Embree" in ready["versions"]["rays"]
    api = call(server, "GET", "/v1/openapi.json").json()
    assert api["openapi"].startswith("3.1")
    assert call(server, "GET", "/").headers["Content-Type"].startswith("text/html")
    for path in ("/healthz", "/readyz", "/v1/openapi.json", "/"):
        assert call(server, "HEAD", path).status == 200


def test_every_route_of_the_description_exists(server):
    api = call(server, "GET", "/v1/openapi.json").json()
    for path, methods in api["paths"].items():
        for method in methods:
            if method == "parameters":
                continue
            reply = call(server, method.upper(), path.replace("{id}", "0" * 64), b"" if method == "post" else None)
            assert reply.status != 405, (method, path)
            if reply.status == 404:
                assert reply.problem()[0] == "not_found" and "id" in reply.json()["detail"]


# --- the process ---------------------------------------------------------------------------------

def test_any_number_of_threads_gives_the_same_bytes(start):
    answers = []
    for threads in ("1", "2", "8"):
        server = start("--threads", threads)
        request = ask(EVERYTHING, [KEY], mesh={"part": "mesh"})
        bodies = []
        for form in ("ply", "npz", "json"):
            request["output"]["format"] = form
            bodies.append(multipart(server, [("mesh", "m", SPOT), ("request", None, json.dumps(request).encode())]).body)
        picture = {"mesh": MESH, "lights": [KEY], "output": {"format": "png", "width": 40, "height": 30}}
        bodies.append(relight(server, picture).body)
        answers.append(bodies)
    assert answers[0] == answers[1] == answers[2]


def test_the_store_outlives_the_server(tmp_path):
    from conftest import Server
    first = Server(tmp_path)
    id_ = upload(first, SPOT).json()["id"]
    assert first.stop() == 0
    second = Server(tmp_path)
    try:
        assert call(second, "GET", f"/v1/meshes/{id_}/content").body == SPOT
        assert relight(second, {"mesh": {"id": id_}}).status == 200
    finally:
        assert second.stop() == 0


def test_a_stopped_server_first_finishes_what_runs(start):
    import threading
    server = start()
    result = []
    picture = {"mesh": {"part": "mesh"},
               "output": {"format": "png", "width": 500, "height": 400, "samples": 16}}
    posted = [("mesh", "m", SPOT), ("request", None, json.dumps(picture).encode())]
    thread = threading.Thread(target=lambda: result.append(multipart(server, posted)))
    thread.start()
    import signal
    import time
    time.sleep(0.4)
    server.process.send_signal(signal.SIGTERM)
    thread.join(60)
    assert result and result[0].status == 200 and result[0].body[:4] == b"\x89PNG"
    assert server.process.wait(30) == 0
    server.alive = lambda: True  # it was asked to end
    server.stop = lambda: 0


def test_a_bind_beyond_loopback_is_refused_at_start(tmp_path):
    import subprocess
    from conftest import PROGRAM
    done = subprocess.run([PROGRAM, "--host", "0.0.0.0", "--port", "0", "--store", str(tmp_path)],
                          capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode != 0 and "loopback" in done.stderr
