"""The Python client against the real server."""

import hashlib
import math
import pathlib
import socket
import subprocess
import sys
import threading

import pytest

import relight

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPOT = ROOT / "tests/data/meshes/spot.ply"
CUBE = ROOT / "tests/data/meshes/cube.off"
LAMP = relight.point_light((0, 2, 0), flux_w=40, name="lamp")


@pytest.fixture
def client(server):
    with relight.Client(f"http://{server.host}:{server.port}") as client:
        yield client


def test_upload_describes_the_mesh_and_keeps_its_bytes(client):
    mesh = client.upload(SPOT)
    data = SPOT.read_bytes()
    assert mesh.id == hashlib.sha256(data).hexdigest()
    assert (mesh.kind, mesh.format, mesh.vertices, mesh.faces) == ("mesh", "ply", 2930, 5856)
    assert mesh.bytes == len(data)
    assert client.content(mesh.id) == data
    assert client.mesh(mesh.id) == mesh
    assert client.upload(data) == mesh  # bytes or path: the same object


def test_a_file_whose_format_only_its_name_tells_is_read(client):
    assert client.upload(ROOT / "tests/data/meshes/suzanne.obj").format == "obj"
    assert client.upload(CUBE.read_bytes(), format="off").vertices == 8


def test_meshes_lists_newest_first_and_delete_forgets(client):
    older, newer = client.upload(SPOT), client.upload(CUBE)
    ids = [mesh.id for mesh in client.meshes()]
    assert ids.index(newer.id) < ids.index(older.id)
    client.delete(newer.id)
    assert newer.id not in [mesh.id for mesh in client.meshes()]
    with pytest.raises(relight.RelightError) as refused:
        client.mesh(newer.id)
    assert (refused.value.status, refused.value.code) == (404, "not_found")


def test_a_stored_mesh_and_the_same_file_sent_along_give_the_same_answer(client):
    stored = client.relight(client.upload(SPOT), lights=[LAMP])
    assert stored.content.startswith(b"ply\n")
    assert stored.content_type == "model/ply"
    assert client.relight(SPOT, lights=[LAMP]).content == stored.content
    assert client.relight(SPOT.read_bytes(), lights=[LAMP]).content == stored.content


def test_numbers_are_those_of_the_formula(client):
    # E = Phi / (4 pi d^2) cos: a corner of the square is sqrt(6) from the lamp, cos = 2 / sqrt(6).
    obj = b"v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n"
    answer = client.relight(
        obj, lights=[LAMP], output={"format": "json", "quantities": ["irradiance", "visibility"]}
    )
    found = answer.json()
    expected = 40 / (4 * math.pi * 6) * 2 / math.sqrt(6)
    assert found["units"]["irradiance"] == "W/m2"
    assert found["visibility"]["lamp"] == [1, 1, 1, 1]
    for rgb in found["irradiance"]:
        assert rgb == pytest.approx([expected] * 3, rel=1e-6)


def test_arrays_are_numpy_arrays_of_the_quantities(client):
    numpy = pytest.importorskip("numpy")
    answer = client.relight(
        SPOT, lights=[LAMP], output={"format": "npz", "quantities": ["color", "irradiance"]}
    )
    arrays = answer.arrays()
    assert arrays["irradiance"].shape == (2930, 3)
    assert arrays["irradiance"].dtype == numpy.float32
    assert arrays["color"].dtype == numpy.uint8
    with pytest.raises(ValueError, match="application/x-npz"):
        answer.json()


def test_arrays_without_numpy_say_what_to_do(client, monkeypatch):
    answer = client.relight(SPOT, lights=[LAMP], output="npz")
    monkeypatch.setitem(sys.modules, "numpy", None)
    with pytest.raises(RuntimeError, match="NumPy"):
        answer.arrays()


def test_timings_and_rays_come_with_the_answer(client):
    mesh = client.upload(SPOT)
    lights = [relight.spot_light((0, 3, 0), (0, -1, 0), outer_cone_deg=40, intensity_cd=900)]
    first = client.relight(mesh, lights=lights)
    assert first.rays > 0
    assert {"parse", "bvh", "trace", "shade", "encode", "total"} <= first.timings.keys()
    assert all(ms >= 0 for ms in first.timings.values())


def test_a_refusal_names_code_and_place(client):
    with pytest.raises(relight.RelightError) as refused:
        client.relight(SPOT, lights=[{"type": "point", "position": [0, 1, 0], "flux_W": 3}])
    assert refused.value.status == 422 or refused.value.status == 400
    assert refused.value.code == "unknown_field"
    assert refused.value.pointer == "/lights/0/flux_W"
    assert "flux_w" in refused.value.detail
    assert "/lights/0/flux_W" in str(refused.value)


def test_a_broken_file_names_its_place(client):
    with pytest.raises(relight.RelightError) as refused:
        client.upload(ROOT / "tests/data/broken/a_ply_index_out_of_range.ply")
    assert refused.value.code == "index_out_of_range"
    assert refused.value.line is not None or refused.value.byte is not None


def test_one_connection_serves_many_requests_also_after_a_refusal(server, client):
    mesh = client.upload(SPOT)
    port = client._connection._http.sock.getsockname()[1]
    with pytest.raises(relight.RelightError):
        client.mesh("0" * 64)
    client.mesh(mesh.id)
    assert client._connection._http.sock.getsockname()[1] == port


def test_an_upload_past_the_limit_is_refused_with_the_limit_named(start, tmp_path):
    limited = start("--max-upload-bytes", "1000000")
    big = tmp_path / "big.ply"
    with open(big, "wb") as file:
        file.truncate(200_000_000)  # sparse: neither the disk nor the client holds it
    with relight.Client(f"http://{limited.host}:{limited.port}") as client:
        with pytest.raises(relight.RelightError) as refused:
            client.upload(big)
        assert (refused.value.status, refused.value.code) == (413, "body_too_large")


def test_a_connection_the_server_has_closed_is_opened_anew():
    # A bare peer, because when a server closes an idle connection is its own business.
    answer = b'HTTP/1.1 200 OK\r\nContent-Length: 33\r\n\r\n{"meshes":[],"next_cursor": null}'
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def serve():
            for _ in range(2):  # one answer a connection, without saying that it will be closed
                peer, _ = listener.accept()
                with peer:
                    peer.recv(65536)
                    peer.sendall(answer)

        thread = threading.Thread(target=serve)
        thread.start()
        with relight.Client(f"http://127.0.0.1:{listener.getsockname()[1]}") as client:
            assert list(client.meshes()) == []
            assert list(client.meshes()) == []
        thread.join()


def command(server, *arguments):
    return subprocess.run(
        [sys.executable, "-m", "relight", "--server", f"http://{server.host}:{server.port}",
         *map(str, arguments)],
        env={"PYTHONPATH": str(ROOT / "clients/python/src"), "PATH": "/usr/bin:/bin"},
        capture_output=True, text=True, timeout=120)


LAMP_TEXT = '{"type": "point", "position": [0, 2, -1], "flux_w": 40}'


@pytest.mark.parametrize("ending, magic", [(".ply", b"ply\n"), (".npz", b"PK"), (".json", b"{"),
                                           (".png", b"\x89PNG")])
def test_the_command_saves_what_the_file_name_says(server, tmp_path, ending, magic):
    out = tmp_path / ("lit" + ending)
    extra = ["--size", "64x48"] if ending == ".png" else []
    done = command(server, "relight", SPOT, "--light", LAMP_TEXT, "-o", out, *extra)
    assert done.returncode == 0, done.stderr
    assert out.read_bytes().startswith(magic)


def test_the_command_uploads_and_lists(server):
    done = command(server, "upload", SPOT, CUBE)
    assert done.returncode == 0, done.stderr
    ids = [line.split()[0] for line in done.stdout.splitlines()]
    assert len(ids) == 2
    listed = command(server, "list").stdout
    assert all(id in listed for id in ids)


def test_the_command_tells_a_refusal_in_a_line_and_fails(server, tmp_path):
    bad = '{"type": "point", "position": [0, 2, -1], "flux_w": -1}'
    done = command(server, "relight", SPOT, "--light", bad, "-o", tmp_path / "lit.ply")
    assert done.returncode == 1
    assert "/lights/0/flux_w" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "lit.ply").exists()


def test_skies_and_lamps_are_stored_and_light_the_mesh(client):
    sky = client.store_environment(ROOT / "tests/data/env/venice_sunset_64.hdr")
    lamp = client.store_profile(ROOT / "tests/data/ies/bega_6339_wall.ies")
    assert (sky["kind"], lamp["kind"]) == ("environment", "profile")
    mesh = client.upload(CUBE)
    for light in (relight.environment_light(sky["id"], scale=2), relight.sky_light(sun_direction=(1, 1, 1)),
                  relight.ies_light((0, 3, 0), (0, -1, 0), lamp["id"]),
                  relight.sphere_light((0, 3, 0), 0.5, flux_lm=800, temperature_k=2700),
                  relight.disk_light((0, 3, 0), (0, -1, 0), 0.5, flux_w=8),
                  relight.rect_light((0, 3, 0), (1, 0, 0), (0, 0, 1), radiance_w_m2_sr=3)):
        lit = client.relight(mesh, lights=[light], output={"format": "json", "quantities": ["irradiance"]}).json()
        assert max(max(E) for E in lit["irradiance"]) > 0


def test_a_vertex_says_why_it_is_as_bright_as_it_is(client):
    why = client.explain(client.upload(SPOT), [3, 5], lights=[LAMP])
    assert [item["vertex"] for item in why["vertices"]] == [3, 5]
    assert why["vertices"][0]["lights"][0]["light"] == "lamp"


def test_the_server_proves_its_formulas(client):
    proof = client.check()
    assert proof["failed"] == 0 and proof["passed"] > 30
