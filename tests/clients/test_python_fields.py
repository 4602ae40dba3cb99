"""Raw arrays, progressive answers and answers that are kept, by the Python client: against a peer that
answers with messages made here, byte by byte, and against the real server."""

import http.client
import json
import pathlib
import socket
import struct
import threading

import pytest

import relight

numpy = pytest.importorskip("numpy")

IRRADIANCE = numpy.array([[0.5, 1, 2], [3, 4, 65504]], "<f2")
VISIBILITY = numpy.array([0, 255], "u1")
MESH = "0" * 64


def message(**more):
    head = {
        "vertices": 2,
        "fields": [
            {"name": "irradiance", "type": "float16", "components": 3, "offset": 0, "bytes": 12,
             "unit": "W/m2", "clamped": 0},
            {"name": "visibility/key", "type": "uint8", "components": 1, "offset": 16, "bytes": 2,
             "unit": "1"},
        ],
        **more, "bytes_total": 0}
    length = (4 + len(json.dumps(head)) + 20 + 7) // 8 * 8 - 4
    head["bytes_total"] = 4 + length + 24
    arrays = IRRADIANCE.tobytes().ljust(16, b"\0") + VISIBILITY.tobytes().ljust(8, b"\0")
    return struct.pack("<I", length) + json.dumps(head).encode().ljust(length) + arrays


def answer(body, *headers, status="200 OK"):
    lines = [f"HTTP/1.1 {status}", f"Content-Length: {len(body)}",
             "Content-Type: application/octet-stream", *headers]
    return "\r\n".join(lines).encode() + b"\r\n\r\n" + body


def chunked(body, size):
    """The body in pieces that end anywhere but where messages do."""
    pieces = [body[at:at + size] for at in range(0, len(body), size)]
    return (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\nContent-Type: application/octet-stream\r\n\r\n"
            + b"".join(b"%x\r\n%s\r\n" % (len(piece), piece) for piece in pieces) + b"0\r\n\r\n")


class Peer:
    """Answers the requests of one connection after another with what it was given; keeps their heads."""

    def __init__(self, *connections):
        self.heads = []
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._thread = threading.Thread(target=self._serve, args=(connections,), daemon=True)
        self._thread.start()
        self.client = relight.Client(f"http://127.0.0.1:{self._listener.getsockname()[1]}", timeout=10)

    def _serve(self, connections):
        for answers in connections:
            peer, _ = self._listener.accept()
            with peer, peer.makefile("rb") as stream:
                for reply in answers:
                    first = stream.readline().decode().strip()
                    headers = http.client.parse_headers(stream)
                    stream.read(int(headers["Content-Length"]))
                    self.heads.append((first, headers))
                    peer.sendall(reply)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.client.close()
        self._listener.close()
        self._thread.join(10)


def test_arrays_of_fields_look_into_the_answer():
    with Peer([answer(message(samples=16, warnings=[]))]) as peer:
        lit = peer.client.relight(MESH, fields="irradiance:float16,visibility:uint8", session="drag-1")
    first, headers = peer.heads[0]
    assert first == "POST /v1/relight?fields=irradiance:float16,visibility:uint8 HTTP/1.1"
    assert headers["Relight-Session"] == "drag-1"
    assert lit.head["samples"] == 16
    arrays = lit.arrays()
    assert list(arrays) == ["irradiance", "visibility/key"]
    assert arrays["irradiance"].dtype == numpy.float16
    assert numpy.array_equal(arrays["irradiance"], IRRADIANCE)
    assert numpy.array_equal(arrays["visibility/key"], VISIBILITY)
    whole = numpy.frombuffer(lit.content, "u1")
    assert all(numpy.shares_memory(array, whole) for array in arrays.values())


def test_the_head_of_another_answer_is_refused_with_the_way_to_it():
    with Peer([answer(b"{}").replace(b"octet-stream", b"json")]) as peer:
        lit = peer.client.relight(MESH)
    assert peer.heads[0][0] == "POST /v1/relight HTTP/1.1"
    with pytest.raises(ValueError, match="fields="):
        lit.head


def test_an_answer_that_has_not_changed_comes_again_without_being_sent():
    changed = answer(message(samples=2), 'ETag: "b"')
    with Peer([answer(message(samples=1), 'ETag: "a"'),
               b'HTTP/1.1 304 Not Modified\r\nETag: "a"\r\n\r\n', changed, changed]) as peer:
        first, again, other, _ = [peer.client.relight(MESH, fields="irradiance:float16")
                                  for _ in range(4)]
    assert again is first
    assert other.head["samples"] == 2
    assert [headers["If-None-Match"] for _, headers in peer.heads] == [None, '"a"', '"a"', '"b"']


@pytest.mark.parametrize("size", [1, 3, 100, 10_000])
def test_progressive_answers_come_one_by_one_however_they_are_cut(size):
    stream = b"".join(message(samples=n, final=n == 64) for n in (4, 16, 64))
    with Peer([chunked(stream, size), answer(message(samples=1))]) as peer:
        seen = []
        for lit in peer.client.progressive(MESH, fields="irradiance:float16", session="s"):
            seen.append((lit.head["samples"], lit.head["final"]))
            assert numpy.array_equal(lit.arrays()["irradiance"], IRRADIANCE)
        assert seen == [(4, False), (16, False), (64, True)]
        assert peer.client.relight(MESH, fields="irradiance:float16").head["samples"] == 1
    first, headers = peer.heads[0]
    assert first == "POST /v1/relight?fields=irradiance:float16&progressive=1 HTTP/1.1"
    assert headers["Relight-Session"] == "s"


def test_what_is_left_of_a_progressive_answer_does_not_meet_the_next_request():
    stream = chunked(message(samples=4, final=False) * 3, 50)
    with Peer([stream], [answer(message(samples=9))]) as peer:
        answers = peer.client.progressive(MESH, fields="irradiance:float16")
        assert next(answers).head["samples"] == 4
        answers.close()
        assert peer.client.relight(MESH, fields="irradiance:float16").head["samples"] == 9


@pytest.mark.parametrize("left", [2, 40, 800])
def test_a_progressive_answer_that_breaks_off_is_an_error(left):
    cut = (message(samples=4) + message(samples=16))[:len(message(samples=4)) + left]
    with Peer([answer(cut)[:-1]]) as peer:
        answers = peer.client.progressive(MESH, fields="irradiance:float16")
        next(answers)
        with pytest.raises(http.client.IncompleteRead):
            next(answers)


def test_a_refusal_of_a_progressive_request_is_told_as_ever():
    problem = b'{"code": "superseded", "detail": "a newer request took its place"}'
    with Peer([answer(problem, status="409 Conflict"), answer(message(samples=1))]) as peer:
        with pytest.raises(relight.RelightError) as refused:
            next(peer.client.progressive(MESH, fields="irradiance:float16"))
        assert (refused.value.status, refused.value.code) == (409, "superseded")
        assert peer.client.relight(MESH, fields="irradiance:float16").head["samples"] == 1


# Against the real server.

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPOT = ROOT / "tests/data/meshes/spot.ply"
LAMP = relight.point_light((0, 2, 0), flux_w=40, name="lamp")


@pytest.fixture
def client(server):
    with relight.Client(f"http://{server.host}:{server.port}") as client:
        yield client


def test_fields_hold_the_numbers_of_an_npz(client):
    mesh = client.upload(SPOT)
    npz = client.relight(mesh, lights=[LAMP], output={
        "format": "npz", "quantities": ["irradiance", "color", "visibility"]}).arrays()
    lit = client.relight(mesh, lights=[LAMP], session="a",
                         fields="irradiance:float32,color:uint8,visibility:uint8")
    arrays = lit.arrays()
    assert lit.head["vertices"] == 2930
    assert numpy.array_equal(arrays["irradiance"], npz["irradiance"])
    assert numpy.array_equal(arrays["color"], npz["color"])
    assert numpy.array_equal(arrays["visibility/lamp"], numpy.round(255 * npz["visibility_lamp"]))
    half = client.relight(mesh, lights=[LAMP], fields="irradiance:float16").arrays()["irradiance"]
    assert numpy.array_equal(half, npz["irradiance"].astype(numpy.float16))


def test_the_same_request_again_is_answered_from_what_the_client_holds(client):
    mesh = client.upload(SPOT)
    first = client.relight(mesh, lights=[LAMP], fields="color:uint8")
    assert client.relight(mesh, lights=[LAMP], fields="color:uint8") is first
    assert client.relight(mesh, lights=[LAMP], fields="irradiance:float16") is not first


def test_progressive_answers_end_with_the_one_that_a_single_answer_is(client):
    mesh = client.upload(SPOT)
    lights = [relight.sphere_light((0, 3, 0), 0.5, flux_w=40)]
    asked = {"lights": lights, "transport": {"samples": 64}, "fields": "irradiance:float32"}
    answers = list(client.progressive(mesh, **asked))
    heads = [answer.head for answer in answers]
    assert [head["final"] for head in heads] == [False] * (len(heads) - 1) + [True]
    samples = [head["samples"] for head in heads]
    assert samples == sorted(set(samples)) and len(samples) > 1 and samples[-1] == 64
    errors = [head["standard_error"]["root_mean_square"] for head in heads]
    assert errors == sorted(errors, reverse=True)
    single = client.relight(mesh, **asked).arrays()["irradiance"]
    assert numpy.array_equal(answers[-1].arrays()["irradiance"], single)
