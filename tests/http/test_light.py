"""Lights with an extent, skies, profiles and materials through HTTP, against closed forms computed here."""

import json
import math
import struct

import numpy
import pytest

from client import call, multipart, read_npz, read_ply, relight, rgb, upload
from conftest import ROOT

DATA = ROOT / "tests/data"
SPOT = (DATA / "meshes/spot.ply").read_bytes()

# Meters over nothing: a far triangle makes them a mesh, and stands in no light's way.
METERS = numpy.array([[0, 0, 0], [1, 0.5, 0], [-2, 1, 0.25]])
NORMALS = numpy.array([[0, 0, 1], [0, 0.6, 0.8], [0.6, 0, 0.8]])
MESH = {"positions": numpy.vstack([METERS, [[900, 900, -900], [901, 900, -900], [900, 901, -900]]]).tolist(),
        "faces": [[3, 4, 5]], "normals": numpy.vstack([NORMALS, [[0, 0, 1]] * 3]).tolist()}
# A floor: nothing of it rises above itself.
FLOOR = {"positions": [[-2, 0, 2], [2, 0, 2], [2, 0, -2], [-2, 0, -2], [0, 0, 0]],
         "faces": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]}


def answer(server, quantities, lights, mesh=MESH, **fields):
    reply = relight(server, {"mesh": mesh, "lights": lights, **fields,
                             "output": {"format": "json", "quantities": quantities}})
    assert reply.status == 200, reply.body
    assert int(reply.headers["Relight-Rays"]) >= 0
    return reply.json()


def E(server, light, mesh=MESH, **fields):
    return numpy.array(answer(server, ["irradiance"], [light], mesh, **fields)["irradiance"])


def radiance_hdr(pixels):
    """A flat Radiance file of (height, width, 3) floats."""
    height, width, _ = pixels.shape
    body = b""
    for r, g, b in pixels.reshape(-1, 3):
        largest = max(r, g, b)
        if largest < 1e-32:
            body += b"\0\0\0\0"
            continue
        mantissa, exponent = math.frexp(largest)
        scale = mantissa * 256 / largest
        body += bytes([int(r * scale), int(g * scale), int(b * scale), exponent + 128])
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + body


# --- closed forms --------------------------------------------------------------------------------

def polygon_E(corners, p, n):
    v = [numpy.array(c) - p for c in corners]
    total = numpy.zeros(3)
    for a, b in zip(v, v[1:] + v[:1]):
        normal = numpy.cross(a, b)
        total += math.atan2(numpy.linalg.norm(normal), a @ b) * normal / numpy.linalg.norm(normal)
    return abs(total @ n) / 2


def test_a_rectangle_gives_lamberts_polygon(server):
    u, v, c = numpy.array([0, 1.0, 0]), numpy.array([0.5, 0, 0.1]), numpy.array([0.2, 0.1, 3])
    light = {"type": "rect", "center": c.tolist(), "edge_u": u.tolist(), "edge_v": v.tolist(), "radiance_w_m2_sr": 5}
    corners = [c - u / 2 - v / 2, c + u / 2 - v / 2, c + u / 2 + v / 2, c - u / 2 + v / 2]
    got = E(server, light)
    for i, (p, n) in enumerate(zip(METERS, NORMALS)):
        assert got[i][0] == pytest.approx(5 * polygon_E(corners, p, n), rel=1e-6)
    flux = {**light, "flux_w": 5 * math.pi * numpy.linalg.norm(numpy.cross(u, v))}
    del flux["radiance_w_m2_sr"]
    numpy.testing.assert_allclose(E(server, flux), got, rtol=1e-6)
    assert not E(server, {**light, "edge_u": v.tolist(), "edge_v": u.tolist()})[:3].any(), "it shines toward u x v"
    both = E(server, {**light, "edge_u": v.tolist(), "edge_v": u.tolist(), "two_sided": True})
    numpy.testing.assert_allclose(both, got, rtol=1e-6)


def test_a_ball_above_the_horizon_is_a_point_light_at_any_distance(server):
    for R in (0.1, 1.0, 2.9):
        ball = {"type": "sphere", "center": [0, 0, 3], "radius": R, "luminance_cd_m2": 1000}
        assert E(server, ball)[0][0] == pytest.approx(1000 * math.pi * R * R / 9, rel=1e-6)
    lumens = {"type": "sphere", "center": [0, 0, 3], "radius": 1, "flux_lm": 800}
    assert E(server, lumens)[0][0] == pytest.approx(800 / (4 * math.pi * 9), rel=1e-6)


def test_a_disk_on_its_axis(server):
    disk = {"type": "disk", "center": [0, 0, 2], "normal": [0, 0, -7], "radius": 1.5, "radiance_w_m2_sr": 3}
    assert E(server, disk)[0][0] == pytest.approx(3 * math.pi * 1.5**2 / (1.5**2 + 4), rel=1e-6)


def test_areas_are_in_square_metres(server):
    disk = {"type": "disk", "center": [0, 0, 2], "normal": [0, 0, -1], "radius": 1.5, "flux_w": 3}
    small = E(server, disk, length_unit_m=0.01)[0][0]
    assert small == pytest.approx(1e4 * E(server, disk)[0][0], rel=1e-6)


def test_a_sun_with_a_disc_gives_the_same_light_to_those_who_face_it(server):
    sun = {"type": "directional", "direction": [0, 0, -1], "irradiance_w_m2": 3, "angle_deg": 20}
    got = E(server, sun)
    assert got[0][0] == pytest.approx(3, rel=1e-6)
    assert got[1][0] == pytest.approx(3 * 0.8, rel=1e-6)


def test_a_sky_on_an_open_plane_is_pi_times_its_radiance(server):
    sky = {"type": "environment", "radiance_w_m2_sr": 2, "color": [1, 0.5, 0.25]}
    got = answer(server, ["irradiance", "standard_error"], [sky], FLOOR, transport={"samples": 1024})
    numpy.testing.assert_allclose(got["irradiance"], [[2 * math.pi, math.pi, math.pi / 2]] * 5, rtol=1e-6)
    assert not numpy.array(got["standard_error"]).any()


def test_an_image_of_one_colour_is_a_constant_sky(server):
    stored = call(server, "POST", "/v1/environments", radiance_hdr(numpy.full((8, 16, 3), [0.5, 0.25, 1.0])))
    assert stored.status == 201 and stored.headers["Location"] == "/v1/environments/" + stored.json()["id"]
    light = {"type": "environment", "image": {"id": stored.json()["id"]}, "scale": 2, "rotation_deg": 33}
    got = E(server, light, FLOOR, transport={"samples": 256})
    numpy.testing.assert_allclose(got, [[math.pi, math.pi / 2, 2 * math.pi]] * 5, rtol=1e-4)


def test_a_bright_texel_lights_from_where_it_is(server):
    pixels = numpy.zeros((16, 32, 3))
    pixels[3, 24] = 100  # u = 24.5 / 32: +Z; v = 3.5 / 16: 39 degrees from the zenith
    image = ("sun.hdr", "sun.hdr", radiance_hdr(pixels))
    request = {"mesh": FLOOR, "lights": [{"type": "environment", "image": {"part": "sun.hdr"}}],
               "output": {"format": "json", "quantities": ["irradiance", "standard_error"]}}
    reply = multipart(server, [("request", None, json.dumps(request).encode()), image])
    assert reply.status == 200, reply.body
    top, bottom = math.pi * 3 / 16, math.pi * 4 / 16
    exact = 100 * 2 * math.pi / 32 * (math.sin(bottom)**2 - math.sin(top)**2) / 2
    got = reply.json()
    for value, error in zip(got["irradiance"], got["standard_error"]):
        assert abs(value[0] - exact) <= 4 * error[0] + 1e-6
        assert error[0] < 0.1 * exact


def test_a_clear_sky_is_photometric_and_plausible(server):
    sky = {"type": "sky", "sun_direction": [0, 1, 0.3], "turbidity": 2.5}
    got = answer(server, ["irradiance"], [sky], FLOOR, transport={"samples": 256})
    assert got["units"] == {"irradiance": "lx"}
    assert 8e4 < got["irradiance"][4][1] < 1.5e5
    mixed = relight(server, {"mesh": FLOOR, "lights": [sky, {"type": "point", "position": [0, 1, 0], "flux_w": 1}]})
    assert mixed.status == 422 and mixed.problem()[0] == "mixed_units"
    placed = {"type": "sky", "latitude_deg": 48.1, "longitude_deg": 11.6, "time": "2026-06-21T13:15:00+02:00"}
    assert answer(server, ["irradiance"], [placed], FLOOR)["irradiance"][4][1] > 6e4
    night = {**placed, "time": "2026-06-21T00:00:00Z"}
    reply = relight(server, {"mesh": FLOOR, "lights": [night]})
    assert "below the horizon" in reply.headers["Relight-Warnings"]


def test_an_isotropic_profile_is_a_point_light_and_says_its_flux(server):
    text = b"IESNA:LM-63-2002\n[TEST] x\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 0\n0 90 180\n0\n70 70 70\n"
    stored = call(server, "POST", "/v1/profiles", text)
    assert stored.status == 201, stored.body
    described = stored.json()
    assert described["flux_lm"] == pytest.approx(4 * math.pi * 70) and described["symmetry"] == "axial"
    lamp = {"type": "ies", "position": [0.5, 1, 2], "direction": [0, 0, -1], "profile": {"id": described["id"]}}
    point = {"type": "point", "position": [0.5, 1, 2], "intensity_cd": 70}
    numpy.testing.assert_allclose(E(server, lamp)[:3], E(server, point)[:3], rtol=1e-6)
    assert call(server, "DELETE", stored.headers["Location"]).status == 204
    gone = relight(server, {"mesh": MESH, "lights": [lamp]})
    assert gone.status == 404 and gone.problem() == ("not_found", "/lights/0/profile/id")


def test_a_temperature_is_a_colour_of_luminance_one(server):
    warm = E(server, {"type": "point", "position": [0, 0, 1], "flux_w": 10, "temperature_k": 2700})[0]
    white = E(server, {"type": "point", "position": [0, 0, 1], "flux_w": 10})[0]
    assert warm @ [0.2126, 0.7152, 0.0722] == pytest.approx(white[0], rel=1e-5)
    assert warm[0] > warm[1] > warm[2]


# --- what is stored ------------------------------------------------------------------------------

@pytest.mark.parametrize("path,name", [("/v1/environments", "env"), ("/v1/profiles", "ies")])
def test_files_of_lights_are_kept_as_meshes_are(server, path, name):
    files = sorted(file for file in (DATA / name).iterdir() if file.suffix in (".hdr", ".exr", ".ies"))
    assert files
    for file in files:
        first = call(server, "POST", path, file.read_bytes())
        assert first.status in (200, 201), (file.name, first.body)
        assert call(server, "POST", path, file.read_bytes()).status == 200
        where = first.headers["Location"]
        assert call(server, "GET", where).json() == first.json()
        content = call(server, "GET", where + "/content")
        assert content.body == file.read_bytes()
        kinds = {".hdr": "image/vnd.radiance", ".exr": "image/x-exr", ".ies": "application/octet-stream"}
        assert content.headers["Content-Type"] == kinds[file.suffix]
    listed = call(server, "GET", path + "?limit=1000").json()
    assert first.json() in listed[path.rsplit("/", 1)[1]]
    assert call(server, "DELETE", where).status == 204
    assert call(server, "GET", where).status == 404


BROKEN = sorted(path for path in (DATA / "broken").iterdir() if path.suffix in (".hdr", ".exr", ".ies"))


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.name)
def test_broken_files_of_lights_are_refused_and_the_server_lives(server, path):
    data = path.read_bytes()
    kind = "/v1/profiles" if path.suffix == ".ies" else "/v1/environments"
    for body in (data, data[:len(data) // 2], data + b"\0" * 7):
        reply = call(server, "POST", f"{kind}?format={path.suffix[1:]}", body)
        if reply.status < 300:  # half of an image may be one
            continue
        code, _ = reply.problem()
        assert 400 <= reply.status < 500 and code not in ("internal", "bad_request")
    assert call(server, "POST", kind + f"?format={path.suffix[1:]}", data).status >= 400
    assert server.alive() and call(server, "GET", "/healthz").status == 200


# --- answers -------------------------------------------------------------------------------------

LIGHTS = [{"type": "rect", "name": "window", "center": [0, 2, 1], "edge_u": [0, 0, 1], "edge_v": [1, 0, 0],
           "radiance_w_m2_sr": 5, "two_sided": True},
          {"type": "point", "name": "lamp", "position": [1, 1, 2], "flux_w": 40, "color": [1, 0.5, 0.2]},
          {"type": "environment", "name": "sky", "radiance_w_m2_sr": 0.5}]


def test_every_array_holds_the_same_numbers_and_the_lights_add_up(server):
    mesh = {"id": upload(server, SPOT).json()["id"]}
    quantities = ["irradiance", "radiance", "standard_error", "per_light", "visibility", "ambient_occlusion", "sh"]
    got = answer(server, quantities, LIGHTS, mesh, transport={"samples": 16, "bounces": 1},
                 material={"model": "principled", "roughness": 0.4})
    whole = {"mesh": mesh, "lights": LIGHTS, "transport": {"samples": 16, "bounces": 1},
             "material": {"model": "principled", "roughness": 0.4}}
    arrays = read_npz(relight(server, {**whole, "output": {"format": "npz", "quantities": quantities}}).body)
    columns, _ = read_ply(relight(server, {**whole, "output": {"format": "ply", "quantities": quantities}}).body)
    for name in ("irradiance", "radiance", "standard_error"):
        numpy.testing.assert_array_equal(arrays[name], numpy.array(got[name], numpy.float32))
        numpy.testing.assert_array_equal(rgb(columns, name), arrays[name])
    numpy.testing.assert_array_equal(arrays["ambient_occlusion"], numpy.array(got["ambient_occlusion"], numpy.float32))
    numpy.testing.assert_array_equal(arrays["sh"], numpy.array(got["sh"], numpy.float32))
    assert arrays["sh"].shape == (len(got["irradiance"]), 9)
    numpy.testing.assert_array_equal(columns["sh_4"], arrays["sh"][:, 4])
    total = sum(numpy.array(values) for values in got["per_light"].values())
    numpy.testing.assert_allclose(total, got["irradiance"], rtol=1e-6, atol=1e-9)
    assert set(got["per_light"]) == {"window", "lamp", "sky"}
    assert (numpy.array(got["standard_error"]) > 0).any()
    assert all(0 <= v <= 1 for v in got["visibility"]["window"])


def test_a_seed_and_any_number_of_threads_give_the_same_bytes(start):
    request = {"lights": LIGHTS, "transport": {"samples": 16, "bounces": 1, "seed": 5},
               "output": {"format": "npz", "quantities": ["irradiance", "standard_error", "radiance"]}}
    bodies = set()
    for threads in ("1", "2", "5"):
        server = start("--threads", threads)
        mesh = {"id": upload(server, SPOT).json()["id"]}
        bodies.add(relight(server, {**request, "mesh": mesh}).body)
    assert len(bodies) == 1
    request["transport"]["seed"] = 6
    assert relight(server, {**request, "mesh": mesh}).body not in bodies


def test_a_new_power_of_a_sampled_light_scales_its_answer_exactly(server):
    mesh = {"id": upload(server, SPOT).json()["id"]}
    one = answer(server, ["irradiance"], [LIGHTS[0]], mesh)
    two = answer(server, ["irradiance"], [{**LIGHTS[0], "radiance_w_m2_sr": 10}], mesh)
    numpy.testing.assert_array_equal(2 * numpy.float32(one["irradiance"]), numpy.float32(two["irradiance"]))


def test_a_target_is_met_at_every_vertex(server):
    mesh = {"id": upload(server, SPOT).json()["id"]}
    got = answer(server, ["standard_error"], LIGHTS, mesh, transport={"target_standard_error": 0.05})
    assert numpy.array(got["standard_error"]).max() <= 0.05


def test_explained_light_adds_up_to_what_relight_says_to_the_bit(server):
    mesh = {"id": upload(server, SPOT).json()["id"]}
    scene = {"mesh": mesh, "lights": LIGHTS, "transport": {"samples": 16, "bounces": 1},
             "material": {"model": "metallic_roughness", "roughness": 0.4, "clearcoat": 0.5}}
    got = relight(server, {**scene, "output": {"format": "json", "quantities": ["irradiance", "radiance"]}}).json()
    vertices = list(range(0, len(got["irradiance"]), 97))
    reply = call(server, "POST", "/v1/explain", json.dumps({**scene, "vertices": vertices}),
                 {"Content-Type": "application/json"})
    assert reply.status == 200, reply.body
    lit = 0
    for item in reply.json()["vertices"]:
        irradiance, radiance = [0.0] * 3, item["own_radiance"]
        for light in item["lights"]:
            irradiance = [a + b for a, b in zip(irradiance, light["irradiance"])]
            if "radiance" in light:
                radiance = [a + b for a, b in zip(radiance, light["radiance"])]
            assert 0 <= light["visibility"] <= 1
            if light["light"] == "lamp" and light["visibility"] == 0 and light["cosine"] > 0:
                assert light["blocker"]["face"] >= 0
            lit += light["visibility"] > 0
        assert [numpy.float32(x) for x in irradiance] == [numpy.float32(x) for x in got["irradiance"][item["vertex"]]]
        assert [numpy.float32(x) for x in radiance] == [numpy.float32(x) for x in got["radiance"][item["vertex"]]]
        assert item["irradiance"] == got["irradiance"][item["vertex"]]
    assert lit > 10
    bad = call(server, "POST", "/v1/explain", json.dumps({**scene, "vertices": [0, 10**6]}))
    assert bad.status == 422 and bad.problem() == ("index_out_of_range", "/vertices/1")
    none = call(server, "POST", "/v1/explain", json.dumps(scene))
    assert none.status == 422 and none.problem() == ("missing_field", "/vertices")


def test_transfer_applies_a_sky_by_a_dot_product(server):
    got = answer(server, ["sh"], [], FLOOR)
    # L = 1 + 0.5 y: E on a plane facing +y is pi + (2 pi / 3) 0.5.
    L = numpy.zeros(9)
    L[0], L[1] = 1 / 0.28209479177387814, 0.5 / 0.4886025119029199
    numpy.testing.assert_allclose(numpy.array(got["sh"]) @ L, math.pi + math.pi / 3, rtol=1e-5)


def test_emissive_groups_shine_and_light_the_rest(server):
    obj = b"""v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv -.5 2 -.5\nv .5 2 -.5\nv .5 2 .5\nv -.5 2 .5
usemtl floor\nf 1 2 3 4\nusemtl lamp\nf 5 6 7 8\n"""
    request = {"lights": [{"type": "from_mesh"}], "transport": {"samples": 1024},
               "materials": {"lamp": {"model": "metallic_roughness", "emissive": [1, 0.5, 0], "emissive_strength": 10}},
               "output": {"format": "json", "quantities": ["irradiance", "standard_error", "radiance"]}}
    reply = multipart(server, [("request", None, json.dumps(request).encode()), ("mesh", "lamp.obj", obj)])
    assert reply.status == 200, reply.body
    got = reply.json()
    corners = [[-.5, 2, -.5], [.5, 2, -.5], [.5, 2, .5], [-.5, 2, .5]]
    exact = 10 * polygon_E(corners, numpy.array([-1, 0, 1]), numpy.array([0, 1, 0]))
    assert abs(got["irradiance"][0][0] - exact) <= 4 * got["standard_error"][0][0] + 1e-5
    assert got["irradiance"][0][1] == pytest.approx(got["irradiance"][0][0] / 2, rel=1e-5)
    assert got["radiance"][4] == pytest.approx([10, 5, 0]), "a face that shines is seen to"
    unknown = {**request, "materials": {"lmap": request["materials"]["lamp"]}}
    reply = multipart(server, [("request", None, json.dumps(unknown).encode()), ("mesh", "lamp.obj", obj)])
    assert reply.status == 422 and reply.problem() == ("unknown_value", "/materials/lmap")
    assert "lamp" in reply.json()["detail"]


def exr_channels(data):
    """Names of an EXR's channels, and its size."""
    assert data[:4] == b"\x76\x2f\x31\x01"
    at, channels, size = 8, [], None
    while data[at] != 0:
        name_end = data.index(b"\0", at)
        name = data[at:name_end].decode()
        type_end = data.index(b"\0", name_end + 1)
        length = struct.unpack_from("<i", data, type_end + 1)[0]
        value = data[type_end + 5:type_end + 5 + length]
        if name == "channels":
            place = 0
            while value[place] != 0:
                end = value.index(b"\0", place)
                channels.append(value[place:end].decode())
                place = end + 17
        if name == "dataWindow":
            x0, y0, x1, y1 = struct.unpack("<4i", value)
            size = (x1 - x0 + 1, y1 - y0 + 1)
        at = type_end + 5 + length
    return channels, size


def test_an_exr_has_its_layers(server):
    mesh = {"id": upload(server, SPOT).json()["id"]}
    request = {"mesh": mesh, "lights": LIGHTS,
               "output": {"format": "exr", "width": 40, "height": 30, "samples": 4,
                          "quantities": ["standard_error", "per_light", "normal"]}}
    reply = relight(server, request)
    assert reply.status == 200, reply.body
    assert reply.headers["Content-Type"] == "image/x-exr"
    channels, size = exr_channels(reply.body)
    assert size == (40, 30)
    layers = ["standard_error", "normal", "per_light_window", "per_light_lamp", "per_light_sky"]
    expected = ["R", "G", "B", "A"] + [f"{layer}.{band}" for layer in layers for band in "RGB"]
    assert sorted(channels) == sorted(expected)
    refused = relight(server, {**request, "output": {"format": "exr", "quantities": ["irradiance"]}})
    assert refused.status == 422 and refused.problem() == ("conflicting_fields", "/output/quantities")


def test_a_light_without_area_gives_nothing_and_says_so(server):
    flat = {"type": "disk", "name": "dot", "center": [0, 0, 2], "normal": [0, 0, -1], "radius": 0, "radiance_w_m2_sr": 5}
    reply = relight(server, {"mesh": MESH, "lights": [flat], "output": {"format": "json", "quantities": ["irradiance"]}})
    assert not numpy.array(reply.json()["irradiance"]).any()
    assert '"dot" has no area' in reply.headers["Relight-Warnings"]
    watts = {key: value for key, value in flat.items() if key != "radiance_w_m2_sr"}
    assert relight(server, {"mesh": MESH, "lights": [{**watts, "flux_w": 1}]}).status == 422
