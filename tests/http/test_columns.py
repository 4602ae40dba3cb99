"""Upload once, relight many: what costs no ray, and that it is what a fresh trace would give."""

import copy
import json
import threading

import numpy
import pytest

from client import call, read_npz, relight, upload
from conftest import ROOT

SPOT = (ROOT / "tests/data/meshes/spot.ply").read_bytes()
POINT = {"type": "point", "position": [1, 2, -2], "intensity_w_sr": 10}
SPOTLIGHT = {"type": "spot", "position": [0, 3, -2], "direction": [0, -1, 0.6], "intensity_w_sr": 20,
             "inner_cone_deg": 10, "outer_cone_deg": 60}
WINDOW = {"type": "rect", "center": [2, 1, -1], "edge_u": [0, 1, 0], "edge_v": [0, 0, 1],
          "radiance_w_m2_sr": 5, "two_sided": True}
SKY = {"type": "environment", "radiance_w_m2_sr": 1}
QUANTITIES = ["irradiance", "radiance", "visibility", "per_light", "standard_error"]
GLOSSY = {"model": "cook_torrance", "roughness": 0.4, "albedo": [0.3, 0.2, 0.1]}


@pytest.fixture(scope="module")
def mesh(server):
    return {"id": upload(server, SPOT, "?format=ply").json()["id"]}


def ask(mesh, lights, quantities=QUANTITIES, **members):
    transport = {"samples": 16, **members.pop("transport", {})}
    return {"mesh": mesh, "lights": copy.deepcopy(lights), "transport": transport,
            "output": {"format": "npz", "quantities": quantities}, **members}


def lit(server, request):
    """The arrays, and how many rays were traced for them."""
    reply = relight(server, request)
    assert reply.status == 200, reply.body
    arrays = read_npz(reply.body)
    return {name: arrays[name] for name in arrays.files}, int(reply.headers["Relight-Rays"])


def forget(server, mesh):
    """The same mesh on a server that remembers nothing of it."""
    assert call(server, "DELETE", "/v1/meshes/" + mesh["id"]).status == 204
    assert upload(server, SPOT, "?format=ply").json()["id"] == mesh["id"]


CHANGES = {
    "power": lambda r: r["lights"][0].update(intensity_w_sr=77),
    "colour": lambda r: r["lights"][1].update(color=[1, 0.5, 0.25]),
    "enabled": lambda r: r["lights"][0].update(enabled=False),
    "exposure": lambda r: r.update(display={"exposure_ev": 2}),
    "name": lambda r: r["lights"][0].update(name="key"),
    "diffuse material": lambda r: r.update(material={"model": "lambert", "albedo": [0.1, 0.5, 0.9]}),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_moves_no_light_costs_no_ray_and_gives_what_a_fresh_trace_would(server, mesh, change):
    lights = [POINT, WINDOW, SKY]
    forget(server, mesh)
    _, rays = lit(server, ask(mesh, lights))
    assert rays > 3 * 2900
    changed = ask(mesh, lights)
    CHANGES[change](changed)
    kept, rays = lit(server, changed)
    assert rays == 0
    forget(server, mesh)
    fresh, rays = lit(server, changed)
    assert rays > 0
    for name, values in fresh.items():
        assert numpy.array_equal(kept[name], values), name  # the very same, not only within 1e-6


@pytest.mark.parametrize("change", [{"material": {**GLOSSY, "roughness": 0.1}},
                                    {"material": {"model": "oren_nayar", "sigma_deg": 20}},
                                    {"material": {"model": "principled", "clearcoat": 1}},
                                    {"view": {"type": "direction", "toward_viewer": [0, 1, -1]}},
                                    {"view": {"type": "camera"}, "camera": {"eye": [0, 2, -4]}}])
def test_under_delta_lights_a_new_material_roughness_or_view_costs_no_ray(server, mesh, change):
    lights = [POINT, SPOTLIGHT]
    forget(server, mesh)
    assert lit(server, ask(mesh, lights, material=GLOSSY))[1] > 0
    kept, rays = lit(server, ask(mesh, lights, **{"material": GLOSSY, **change}))
    assert rays == 0
    forget(server, mesh)
    fresh, _ = lit(server, ask(mesh, lights, **{"material": GLOSSY, **change}))
    assert numpy.array_equal(kept["radiance"], fresh["radiance"])
    assert kept["radiance"].max() > 0


@pytest.mark.parametrize("change", [
    {"transport": {"samples": 32}}, {"transport": {"seed": 1}}, {"transport": {"two_sided": True}},
    {"transport": {"shadows": False}}, {"transport": {"max_distance": 0.2}},
    {"transport": {"bounces": 1}}, {"transport": {"target_standard_error": 0.5, "samples": 256}},
    {"points": {"radius_scale": 2.0}}, {"refine": {"max_edge": 0.02}}])
def test_what_a_column_depends_on_is_traced_anew(server, mesh, change):
    lights = [POINT, WINDOW]
    forget(server, mesh)
    before, _ = lit(server, ask(mesh, lights))
    changed, rays = lit(server, ask(mesh, lights, **change))
    shadowless = change == {"transport": {"shadows": False}}
    assert (rays == 0) == shadowless
    if "radius_scale" not in str(change):  # of a mesh nothing changes, but its model is another
        assert changed["irradiance"].shape != before["irradiance"].shape or \
            not numpy.array_equal(changed["irradiance"], before["irradiance"])


def test_with_bounces_the_albedo_is_traced_and_the_power_is_not(server, mesh):
    def request(albedo, power):
        return ask(mesh, [{**POINT, "intensity_w_sr": power}], transport={"bounces": 2},
                   material={"model": "lambert", "albedo": albedo})
    forget(server, mesh)
    assert lit(server, request([0.8] * 3, 10))[1] > 0
    assert lit(server, request([0.8] * 3, 20))[1] == 0
    assert lit(server, request([0.4] * 3, 20))[1] > 0


def test_moving_one_light_of_many_retraces_that_light_alone(server, mesh):
    lights = [POINT, WINDOW, SKY]
    forget(server, mesh)
    _, all_of_them = lit(server, ask(mesh, lights))
    lights = [{**POINT, "position": [1, 2.5, -2]}, WINDOW, SKY]
    _, one = lit(server, ask(mesh, lights))
    assert 0 < one <= 2930  # at most a ray a vertex
    assert one < all_of_them / 10


def test_glossy_radiance_of_a_window_is_kept_by_material_and_view(server, mesh):
    forget(server, mesh)
    first, rays = lit(server, ask(mesh, [WINDOW], material=GLOSSY))
    power, again = lit(server, ask(mesh, [{**WINDOW, "radiance_w_m2_sr": 10}], material=GLOSSY))
    assert rays > 0 and again == 0
    numpy.testing.assert_allclose(power["radiance"], 2 * first["radiance"], rtol=1e-6)
    _, rougher = lit(server, ask(mesh, [WINDOW], material={**GLOSSY, "roughness": 0.8}))
    assert 0 < rougher < rays  # its E is kept


def test_two_who_ask_for_the_same_column_at_once_compute_it_once(server, mesh):
    lights = [{**WINDOW, "center": [2, 1.01, -1]}]
    forget(server, mesh)
    rays = []
    threads = [threading.Thread(target=lambda: rays.append(lit(server, ask(
        mesh, lights, transport={"samples": 256}))[1])) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(rays)[0] == 0 and sorted(rays)[1] > 0


def test_the_answer_is_the_same_bytes_in_any_cache_state_and_by_any_threads(server, mesh, start):
    lights = [POINT, WINDOW, SKY]
    request = ask(mesh, lights, material=GLOSSY, transport={"bounces": 1})
    forget(server, mesh)
    bodies = {relight(server, request).body for _ in range(2)}
    for threads in ("1", "3"):
        other = start("--threads", threads, "--memory", "1300000")  # keeps little
        upload(other, SPOT, "?format=ply")
        for _ in range(2):
            bodies.add(relight(other, request).body)
    assert len(bodies) == 1


def test_what_is_kept_stays_within_its_bytes(start):
    small = start("--memory", "3000000")
    mesh = {"id": upload(small, SPOT, "?format=ply").json()["id"]}
    for x in range(60):  # 60 columns of 2930 x 12 bytes and more
        lit(small, ask(mesh, [{**WINDOW, "center": [2, 1, x / 10]}], transport={"samples": 4}))
        held = json.loads(call(small, "GET", "/readyz").body)["cache_bytes"]
        assert held <= 3000000


def test_a_mesh_that_stood_in_the_request_is_traced_each_time(server):
    inline = {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}
    for _ in range(2):
        assert lit(server, ask(inline, [{**POINT, "position": [0, 0, 3]}]))[1] == 3
