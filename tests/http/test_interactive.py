"""Raw fields, sessions, progressive answers, entity tags and receipts."""

import hashlib
import http.client
import json
import struct
import threading
import time

import numpy
import pytest

from client import call, read_npz, relight, upload
from conftest import ROOT

SPOT = (ROOT / "tests/data/meshes/spot.ply").read_bytes()
POINT = {"type": "point", "position": [1, 2, -2], "intensity_w_sr": 10, "name": "key"}
SKY = {"type": "environment", "radiance_w_m2_sr": 1}
JSON = {"Content-Type": "application/json"}
TYPES = {"float32": "<f4", "float16": "<f2", "uint8": "u1"}


@pytest.fixture(scope="module")
def mesh(server):
    return {"id": upload(server, SPOT, "?format=ply").json()["id"]}


def post(server, query, request, headers=None):
    return call(server, "POST", "/v1/relight" + query, json.dumps(request), {**JSON, **(headers or {})})


def read_fields(data):
    """Head and arrays of the first message, and what follows it."""
    length, = struct.unpack_from("<I", data)
    assert (4 + length) % 8 == 0
    head = json.loads(data[4:4 + length])
    arrays = {}
    for field in head["fields"]:
        begin = 4 + length + field["offset"]
        assert begin % 8 == 0
        values = numpy.frombuffer(data[begin:begin + field["bytes"]], TYPES[field["type"]])
        arrays[field["name"]] = values.reshape(-1, field["components"])
        assert len(arrays[field["name"]]) == head["vertices"]
    return head, arrays, data[head["bytes_total"]:]


# --- raw fields ----------------------------------------------------------------------------------

def test_raw_fields_hold_the_numbers_of_the_npz(server, mesh):
    names = ["color", "irradiance", "radiance", "normal", "standard_error", "ambient_occlusion", "sh"]
    request = {"mesh": mesh, "lights": [POINT, SKY], "transport": {"samples": 16}}
    reply = post(server, "?fields=" + ",".join(names) + ",visibility,per_light", request)
    assert reply.status == 200, reply.body
    assert reply.headers["Content-Type"] == "application/octet-stream"
    assert int(reply.headers["Content-Length"]) == len(reply.body)
    head, arrays, rest = read_fields(reply.body)
    assert rest == b"" and head["bytes_total"] == len(reply.body) and head["vertices"] == 2930
    npz = read_npz(relight(server, {**request, "output": {
        "format": "npz", "quantities": names + ["visibility", "per_light"]}}).body)
    for name, values in arrays.items():
        expected = npz[name.replace("/", "_")]
        assert numpy.array_equal(values, expected.reshape(values.shape), equal_nan=True), name
    assert {f["name"]: f["unit"] for f in head["fields"]}["irradiance"] == "W/m2"
    assert set(arrays) == {*names, "visibility/key", "visibility/light_1", "per_light/key",
                           "per_light/light_1"}


def test_halves_and_bytes_round_the_floats(server, mesh):
    request = {"mesh": mesh, "lights": [POINT, SKY], "transport": {"samples": 16}}
    _, exact, _ = read_fields(post(server, "?fields=irradiance,visibility", request).body)
    _, small, _ = read_fields(post(server, "?fields=irradiance:float16,visibility:uint8", request).body)
    assert numpy.array_equal(small["irradiance"], exact["irradiance"].astype("<f2"))
    assert numpy.abs(small["visibility/light_1"] / 255.0 - exact["visibility/light_1"]).max() < 0.502 / 255


@pytest.mark.parametrize("query, output, code", [
    ("?fields=", {}, "unknown_value"), ("?fields=irradiance,,color", {}, "unknown_value"),
    ("?fields=irradiance:float64", {}, "unknown_value"), ("?fields=color:float16", {}, "unknown_value"),
    ("?fields=irradiance:uint8", {}, "unknown_value"), ("?fields=color,color", {}, "duplicate_field"),
    ("?fields=color", {"output": {"format": "ply"}}, "conflicting_fields"),
    ("?fields=color", {"output": {"quantities": ["color"]}}, "conflicting_fields"),
    ("?fields=color&fields=normal", {}, "duplicate_field"), ("?field=color", {}, "unknown_field"),
    ("?progressive=1", {}, "conflicting_fields"),
    ("?fields=color&progressive=1&receipt=1", {}, "conflicting_fields")])
def test_what_fields_cannot_be_is_refused(server, mesh, query, output, code):
    assert post(server, query, {"mesh": mesh, **output}).problem()[0] == code


# --- progressive ---------------------------------------------------------------------------------

def test_progressive_answers_come_coarse_at_once_and_end_as_the_whole_answer(server, mesh):
    request = {"mesh": mesh, "lights": [{**SKY, "name": "s"}], "transport": {"samples": 128, "seed": 5}}
    reply = post(server, "?fields=irradiance&progressive=1", request)
    assert reply.status == 200 and reply.headers["Transfer-Encoding"] == "chunked"
    heads, irradiances, rest = [], [], reply.body
    while rest:
        head, arrays, rest = read_fields(rest)
        heads.append(head)
        irradiances.append(arrays["irradiance"])
    assert [head["samples"] for head in heads] == [4, 16, 64, 128]
    assert [head["final"] for head in heads] == [False, False, False, True]
    errors = [head["standard_error"]["root_mean_square"] for head in heads]
    assert errors[0] > errors[1] > errors[2] > errors[3] > 0
    off = [numpy.sqrt(numpy.mean((E - irradiances[-1]) ** 2)) for E in irradiances]
    assert off[0] > off[1] > off[2]
    assert 0.3 < off[1] / errors[1] < 3  # flagged with an honest error
    _, whole, _ = read_fields(post(server, "?fields=irradiance", request).body)
    assert numpy.array_equal(irradiances[-1], whole["irradiance"])


def test_a_progressive_answer_without_samples_is_one_message(server, mesh):
    reply = post(server, "?fields=irradiance&progressive=1", {"mesh": mesh, "lights": [POINT],
                                                              "transport": {"samples": 4}})
    head, _, rest = read_fields(reply.body)
    assert head["final"] is True and rest == b""


# --- sessions ------------------------------------------------------------------------------------

SLOW = {"lights": [SKY], "transport": {"samples": 4096, "bounces": 4},
        "output": {"format": "npz", "quantities": ["irradiance"]}}


def test_a_newer_request_of_the_session_stops_the_older_one_at_once(server, mesh):
    got = {}

    def old():
        got["reply"] = post(server, "", {"mesh": mesh, **SLOW}, {"Relight-Session": "a-1"})
        got["at"] = time.monotonic()

    thread = threading.Thread(target=old)
    thread.start()
    time.sleep(1.0 if not server.is_sanitized() else 5.0)
    assert not got
    asked = time.monotonic()
    newer = post(server, "", {"mesh": mesh, "lights": [POINT]}, {"Relight-Session": "a-1"})
    thread.join()
    assert newer.status == 200
    assert got["reply"].status == 409 and got["reply"].problem()[0] == "superseded"
    assert got["at"] - asked < (0.5 if not server.is_sanitized() else 5.0)


def test_other_sessions_and_requests_without_one_are_left_alone(server, mesh):
    request = {"mesh": mesh, "lights": [SKY], "transport": {"samples": 256, "seed": 9}}
    replies = {}

    def ask(name, headers):
        replies[name] = post(server, "", {**request, "transport": {"samples": 256, "seed": len(name)}},
                             headers).status

    threads = [threading.Thread(target=ask, args=(name, headers)) for name, headers in [
        ("a", {"Relight-Session": "x"}), ("bb", {"Relight-Session": "y"}), ("ccc", {}), ("dddd", {})]]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert replies == {"a": 200, "bb": 200, "ccc": 200, "dddd": 200}


@pytest.mark.parametrize("name", ["a b", "é", "x" * 65, "a/b"])
def test_a_session_has_a_plain_name(server, mesh, name):
    assert post(server, "", {"mesh": mesh}, {"Relight-Session": name.encode("latin-1")}).problem()[0] == \
        "bad_request"


def test_a_superseded_progressive_answer_ends_between_messages(server, mesh):
    connection = http.client.HTTPConnection(server.host, server.port, timeout=120)
    connection.request("POST", "/v1/relight?fields=irradiance&progressive=1", json.dumps(
        {"mesh": mesh, "lights": [SKY], "transport": {"samples": 65536, "bounces": 1, "seed": 3}}),
        {**JSON, "Relight-Session": "p"})
    response = connection.getresponse()
    assert response.status == 200
    begun = response.read(1000)
    assert post(server, "", {"mesh": mesh, "lights": [POINT]}, {"Relight-Session": "p"}).status == 200
    rest = begun + response.read()
    connection.close()
    while rest:
        head, _, rest = read_fields(rest)
        assert head["final"] is False


# --- entity tags ---------------------------------------------------------------------------------

def test_the_tag_of_an_answer_spares_computing_it_again(server, mesh):
    request = {"mesh": mesh, "lights": [POINT], "output": {"format": "ply"}}
    first = post(server, "", request)
    tag = first.headers["ETag"]
    for header in (tag, "W/" + tag, '"x", ' + tag, "*"):
        again = post(server, "", request, {"If-None-Match": header})
        assert again.status == 304 and again.body == b"" and again.headers["ETag"] == tag
    assert post(server, "", request, {"If-None-Match": '"x"'}).body == first.body
    spaced = call(server, "POST", "/v1/relight", json.dumps(dict(reversed(request.items())), indent=2),
                  {**JSON, "If-None-Match": tag})
    assert spaced.status == 304  # the same request in another order


def test_whatever_changes_the_bytes_changes_the_tag(server, mesh):
    base = {"mesh": mesh, "lights": [POINT], "output": {"format": "json", "quantities": ["irradiance"]}}
    variants = [("", base, {}), ("", {**base, "lights": [{**POINT, "intensity_w_sr": 11}]}, {}),
                ("", {**base, "output": {"format": "npz", "quantities": ["irradiance"]}}, {}),
                ("?receipt=1", base, {}), ("", {**base, "transport": {"seed": 1}}, {}),
                ("?fields=irradiance", {**base, "output": {}}, {}),
                ("?fields=irradiance:float16", {**base, "output": {}}, {}),
                ("", {k: v for k, v in base.items() if k != "output"}, {"Accept": "model/ply"}),
                ("", {k: v for k, v in base.items() if k != "output"}, {"Accept": "application/json"})]
    tags = [post(server, query, request, headers).headers["ETag"] for query, request, headers in variants]
    assert len(set(tags)) == len(tags)


def test_errors_have_no_tag_and_a_deleted_mesh_is_not_unmodified(start):
    own = start()
    mesh = {"id": upload(own, SPOT, "?format=ply").json()["id"]}
    tag = post(own, "", {"mesh": mesh, "lights": [POINT]}).headers["ETag"]
    assert call(own, "DELETE", "/v1/meshes/" + mesh["id"]).status == 204
    gone = post(own, "", {"mesh": mesh, "lights": [POINT]}, {"If-None-Match": tag})
    assert gone.problem()[0] == "not_found" and gone.headers["ETag"] is None


# --- receipts ------------------------------------------------------------------------------------

def test_a_receipt_names_what_went_in_and_what_came_out(server, mesh):
    request = {"mesh": mesh, "lights": [POINT], "transport": {"seed": 7},
               "output": {"format": "ply", "quantities": ["irradiance"]}}
    plain = post(server, "", request)
    reply = post(server, "?receipt=1", request)
    receipt = json.loads(reply.headers["Relight-Receipt"])
    assert reply.body == plain.body
    assert receipt["result_sha256"] == hashlib.sha256(reply.body).hexdigest()
    assert receipt["mesh_sha256"] == mesh["id"] == hashlib.sha256(SPOT).hexdigest()
    assert receipt["seed"] == 7 and receipt["units"] == "radiometric"
    ready = json.loads(call(server, "GET", "/readyz").body)["versions"]
    assert receipt["relight"] == ready["relight"] and receipt["rays"] == ready["rays"]
    assert json.loads(post(server, "?receipt=1", request).headers["Relight-Receipt"]) == receipt


def test_the_receipt_of_json_stands_in_it_and_hashes_the_rest(server, mesh):
    request = {"mesh": mesh, "lights": [POINT], "output": {"format": "json", "quantities": ["irradiance"]}}
    plain = post(server, "", request).body
    answer = post(server, "", {**request, "receipt": True}).json()
    assert answer.pop("receipt")["result_sha256"] == hashlib.sha256(plain).hexdigest()
    assert answer == json.loads(plain)
