"""Prints Google Benchmark's JSON as a Markdown table: what, its times and rate, and beside it each
yardstick with the ratio of the rates (1: as fast as the yardstick; more is faster).

    table.py FILE [--brief]    --brief: all threads alone, and of Embree's patterns the fastest alone

A benchmark is named "what[ beside yardstick]/vertices[/threads]/real_time" (sizes.h); the median of
its repetitions counts.
"""

import json
import re
import statistics
import sys

SIZES = (100_000, 1_000_000)
NAME = re.compile(r"(?P<what>.*?)(?: beside (?P<yardstick>.*?))?"
                  r"/(?P<vertices>\d+)(?:/(?P<threads>\d+))?/real_time(?:/|$)")
# unit of a counter -> (what a million or a thousand million of it a second is called, how many)
UNITS = {"rays": ("M rays/s", 1e6), "vertices": ("M vertices/s", 1e6),
         "triangles": ("M triangles/s", 1e6), "vertex_lights": ("M vertex-lights/s", 1e6),
         "pixels": ("M pixels/s", 1e6), "bytes": ("GB/s", 1e9)}


def medians(runs):
    """{(what, threads): {yardstick or "": {vertices: (ms, rate, unit)}}}, in the order of the runs."""
    samples = {}
    for run in runs:
        if run.get("run_type") != "iteration":
            continue
        name = NAME.match(run["run_name"])
        if run.get("error_occurred") or name is None:
            sys.exit(f"{run['run_name']}: {run.get('error_message', 'is not named as in sizes.h')}")
        unit = next(u for u in UNITS if u in run)
        row = samples.setdefault((name["what"], name["threads"]), {})
        sizes = row.setdefault(name["yardstick"] or "", {})
        sizes.setdefault(int(name["vertices"]), []).append((run["real_time"], run[unit], unit))
    return {key: {yardstick: {vertices: (statistics.median(ms for ms, _, _ in found),
                                         statistics.median(rate for _, rate, _ in found),
                                         found[0][2])
                              for vertices, found in sizes.items()}
                  for yardstick, sizes in row.items()}
            for key, row in samples.items()}


def brief(table):
    def kept(row):
        patterns = [name for name in row if name.endswith("Morton order")]
        slower = sorted(patterns, key=lambda name: row[name][max(row[name])][1])[:-1]
        return {name: sizes for name, sizes in row.items() if name not in slower}
    return {key: kept(row) for key, row in table.items() if key[1] != "1"}


def number(value):
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def cells(sizes):
    """The time at each size, and the rate at the largest."""
    _, rate, unit = sizes[max(sizes)]
    word, scale = UNITS[unit]
    times = [number(sizes[v][0]) if v in sizes else "" for v in SIZES]
    return times + [f"{number(rate / scale)} {word}"]


def lines(table):
    threads_word = {None: "", "1": " · 1 thread", "0": " · all threads"}
    yield ["what", "100k ms", "1M ms", "rate", "beside", "100k ms", "1M ms", "ours : it"]
    yield ["---", "--:", "--:", "--:", "---", "--:", "--:", "--:"]
    for (what, threads), row in table.items():
        if "" not in row:
            sys.exit(f"{what}: a yardstick without what it stands beside")
        ours = row.pop("")
        first = [what + threads_word[threads]] + cells(ours)
        if not row:
            yield first + ["", "", "", ""]
        for yardstick, sizes in row.items():
            ratios = [f"{ours[v][1] / sizes[v][1]:.2f}" for v in SIZES if v in ours and v in sizes]
            yield first + [yardstick] + cells(sizes)[:-1] + [" / ".join(ratios)]
            first = ["", "", "", ""]


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        report = json.load(file)
    # Interleaving reports runs as they came: back into the order they are written in.
    runs = sorted(report["benchmarks"], key=lambda run: (run["family_index"],
                                                         run["per_family_instance_index"]))
    table = medians(runs)
    if "--brief" in sys.argv[2:]:
        table = brief(table)
    context = report["context"]
    load = context.get("load_avg", [])
    print(f"{context['num_cpus']} cores at {context['mhz_per_cpu']} MHz; load before "
          f"{load[0] if load else '?'}. Rates are of the largest size. `ours : it` is ours over the "
          "yardstick's speed in the same run, 100k / 1M: 1 is as fast, more is faster.\n")
    for line in lines(table):
        print("| " + " | ".join(line) + " |")


if __name__ == "__main__":
    main()
