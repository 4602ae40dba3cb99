"""Measures relightd through HTTP on one keep-alive connection and prints a Markdown table.

    /usr/bin/python3 tests/bench/http_bench.py [--program relightd] [--json FILE] [--quick]

What the client costs stands in the table's first rows. `stages`: the sum of Server-Timing's parse,
bvh, trace, shade and encode; `bytes`: the same bytes there and back over a bare loopback socket.
"""

import argparse
import itertools
import json
import socket
import statistics
import threading
import time

import service

# what -> most milliseconds, of limits.md's and the README's targets on two quiet cores
TARGETS = {"one shot: upload, relight": 600, "kept mesh, another light": 200, "another power": 50,
           "moved light": 1000 / 30, "power changed": 1000 / 200}
ANSWERS = {"PLY": "", "color:uint8": "?fields=color:uint8",
           "irradiance:float16": "?fields=irradiance:float16"}


def milliseconds(work):
    began = time.perf_counter()
    result = work()
    return 1000.0 * (time.perf_counter() - began), result


def loopback_ms(up, down, times):
    """Bytes there, then back, between two threads of this process."""
    listener = socket.create_server(("127.0.0.1", 0))

    def take(connection, size):
        room = memoryview(bytearray(1 << 20))
        while size > 0:
            size -= connection.recv_into(room, min(size, len(room)))

    def peer():
        connection, _ = listener.accept()
        for _ in range(times):
            take(connection, up)
            connection.sendall(bytes(down))
        connection.close()

    thread = threading.Thread(target=peer)
    thread.start()
    with socket.create_connection(listener.getsockname()) as client:
        data = bytes(up)

        def there_and_back():
            client.sendall(data)
            take(client, down)
        measured = [milliseconds(there_and_back)[0] for _ in range(times)]
    thread.join()
    listener.close()
    return statistics.median(measured)


class Table:
    def __init__(self):
        self.rows = []

    def absent(self, what, vertices, why):
        self.rows.append({"what": what, "vertices": vertices, "absent": why})

    def measure(self, what, vertices, times, ask, up=0, bare=False):
        """ask(i) -> Answer; the first, which warms caches, does not count."""
        service.must(ask(0))
        found = []
        for i in range(1, times + 1):
            ms, answer = milliseconds(lambda i=i: ask(i))
            stages = service.must(answer).stages()
            total = stages.pop("total", 0.0)
            found.append((ms, stages, total, answer))
        row = {"what": what, "vertices": vertices, "times": times,
               "ms": statistics.median(f[0] for f in found),
               "slowest_ms": max(f[0] for f in found),
               "bytes_up": up, "bytes_down": found[-1][3].size, "rays": found[-1][3].rays()}
        if not bare:
            row["stages"] = {name: statistics.median(f[1].get(name, 0.0) for f in found)
                             for name in found[-1][1]}
            row["stages_ms"] = statistics.median(sum(f[1].values()) for f in found)
            row["server_ms"] = statistics.median(f[2] for f in found)
            row["bytes_ms"] = loopback_ms(up, row["bytes_down"], 5)
        self.rows.append(row)
        return row

    def print(self):
        print("| through HTTP | vertices | ms | a second | slowest ms | stages, ms | sum | bytes ms "
              "| whole : sum + bytes | MB up / down | rays |")
        print("| --- | --: | --: | --: | --: | --- | --: | --: | --: | --: | --: |")
        for row in self.rows:
            if "absent" in row:
                cells = [row["what"], f"{row['vertices']:,}", row["absent"]] + 8 * [""]
                print("| " + " | ".join(cells) + " |")
                continue
            cells = [row["what"], f"{row['vertices']:,}", f"{row['ms']:.3g}",
                     f"{1000.0 / row['ms']:.3g}", f"{row['slowest_ms']:.3g}"]
            if "stages" in row:
                whole = row["ms"] / (row["stages_ms"] + row["bytes_ms"])
                cells += [" ".join(f"{n} {ms:.3g}" for n, ms in row["stages"].items() if ms >= 0.05),
                          f"{row['stages_ms']:.3g}", f"{row['bytes_ms']:.3g}", f"{whole:.2f}"]
            else:
                cells += 4 * [""]
            cells += [f"{row['bytes_up'] / 1e6:.3g} / {row['bytes_down'] / 1e6:.3g}",
                      f"{row['rays']:,}"]
            print("| " + " | ".join(cells) + " |")
        print("\n| target | ms | at most | |\n| --- | --: | --: | --- |")
        for row in self.rows:
            most = TARGETS.get(row["what"].split(" (")[0])
            if most and "ms" in row:
                print(f"| {row['what']}, {row['vertices']:,} | {row['ms']:.3g} | {most:.3g} "
                      f"| {'met' if row['ms'] <= most else str(round(row['ms'] / most, 2)) + ' times that'} |")


def request_of(mesh, light, fields=""):
    request = {"lights": [light], "material": {"model": "lambert", "albedo": [0.8, 0.8, 0.8]}}
    if not fields:
        request["output"] = {"format": "ply"}
    return {"mesh": {"id": mesh}, **request} if mesh else request


PLACES = itertools.count()


def elsewhere():
    """A place where the light has not been before."""
    i = next(PLACES)
    return 0.3 - 0.0005 * i, -0.2 + 0.0003 * i


def one_shot(table, server, times):
    vertices = 1_000_000
    file, first = service.ply(vertices)
    connection = service.Connection(server)

    def ask(i):
        file[first + 8:first + 9] = bytes([i + 1])  # a bit of a height: a mesh not seen before
        pieces = service.multipart(request_of(None, service.point_light(0.3, -0.2)), file)
        return connection.call("POST", "/v1/relight", *pieces, headers=service.MULTIPART)

    service.touch(700 * vertices * times)
    table.measure("one shot: upload, relight", vertices, times, ask, up=len(file))
    connection.close()


def kept(table, server, vertices, times, name):
    """Another light, another power, an answer of each kind."""
    connection = service.Connection(server)
    mesh = connection.upload(service.ply(vertices)[0])
    for kind, query in ANSWERS.items():
        if query:  # is it there?
            answer = connection.relight(request_of(mesh, service.point_light(0.3, -0.2), query), query)
            if answer.status >= 400 or "ply" in answer.headers.get("content-type", ""):
                for what in (name[0], name[1]):
                    table.absent(f"{what} ({kind})", vertices, f"not there ({answer.status})")
                continue
        table.measure(f"{name[0]} ({kind})", vertices, times, lambda i: connection.relight(
            request_of(mesh, service.point_light(*elsewhere()), query), query))
        table.measure(f"{name[1]} ({kind})", vertices, times, lambda i: connection.relight(
            request_of(mesh, service.point_light(0.3, -0.2, flux=40.0 + i), query), query))
    connection.close()
    return mesh


def dropped(table, server, mesh, vertices):
    """How long a stale request still runs, once its client has sent a newer one."""
    what = "stale request dropped (409)"
    token = (("Relight-Session", "bench"),)
    sky = {"type": "environment", "radiance_w_m2_sr": 1.0}
    long_request = {**request_of(mesh, sky), "transport": {"samples": 1024}}
    first, second = service.Connection(server), service.Connection(server)
    body = json.dumps(long_request).encode()
    kind = (("Content-Type", "application/json"),)
    first.send("POST", "/v1/relight", body, headers=kind + token)
    time.sleep(0.5)
    began = time.perf_counter()
    # A first answer in time can only be the refusal: the whole takes minutes.
    second.send("POST", "/v1/relight", json.dumps(request_of(mesh, service.point_light(0.3, -0.2))).encode(),
                headers=kind + token)
    first.socket.settimeout(5.0)
    try:
        answer = first.receive()
        ms = 1000.0 * (time.perf_counter() - began)
        if answer.status == 409:
            table.rows.append({"what": what, "vertices": vertices, "ms": ms, "slowest_ms": ms,
                               "bytes_up": 0, "bytes_down": answer.size, "rays": 0})
        else:
            table.absent(what, vertices, f"not there ({answer.status})")
    except (TimeoutError, socket.timeout):
        table.absent(what, vertices, "not there (no answer in 5 s)")
    first.close()
    second.close()


def progressive(table, server, times):
    """A sampled light: when the first, coarse answer is there, and when the last."""
    vertices = 100_000
    connection = service.Connection(server)
    mesh = connection.upload(service.ply(vertices)[0])
    first, last = [], []
    for i in range(times + 1):
        query = "?fields=color:uint8&progressive=1"
        request = {**request_of(mesh, {"type": "environment", "radiance_w_m2_sr": 1.0}, query),
                   "transport": {"samples": 64, "seed": i}}
        began = time.perf_counter()
        answer = connection.relight(request, query)
        ended = time.perf_counter()
        if answer.status >= 400:
            table.absent("a sky, progressively", vertices, f"not there ({answer.status})")
            return
        first.append(1000.0 * (answer.begun - began))
        last.append(1000.0 * (ended - began))
    for what, found in (("first", first[1:]), ("last", last[1:])):
        table.rows.append({"what": f"a sky of 64 samples, progressively: the {what} answer",
                           "vertices": vertices, "ms": statistics.median(found),
                           "slowest_ms": max(found), "bytes_up": 0, "bytes_down": answer.size,
                           "rays": answer.rays()})
    connection.close()


def main():
    options = argparse.ArgumentParser(description=__doc__,
                                      formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", default=str(service.PROGRAM))
    options.add_argument("--json", help="where every figure goes")
    options.add_argument("--quick", action="store_true", help="each but a few times")
    asked = options.parse_args()
    few, many = (2, 10) if asked.quick else (7, 100)
    table = Table()
    with service.Server(asked.program) as server:
        connection = service.Connection(server)
        table.measure("the client: GET /healthz", 0, many, lambda _: connection.call("GET", "/healthz"),
                      bare=True)
        connection.close()
        one_shot(table, server, few)
        large = kept(table, server, 1_000_000, few, ("kept mesh, another light", "another power"))
        kept(table, server, 100_000, many, ("moved light", "power changed"))
        progressive(table, server, few)
        dropped(table, server, large, 1_000_000)
    table.print()
    if asked.json:
        with open(asked.json, "w", encoding="utf-8") as file:
            json.dump(table.rows, file, indent=1)


if __name__ == "__main__":
    main()
