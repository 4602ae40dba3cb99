"""Fails where a kernel has fallen behind what stands beside it: the few pairs of gate.json, on
100,000 vertices, in one run, interleaved. Ratios of medians of processor time, so that other
programs on the machine matter little; each least ratio leaves room for what remains.

    /usr/bin/python3 tests/bench/gate.py [--program relight_bench]

A key of gate.json is "what", or "what/threads"; "beside" is how the yardsticks' names begin: the
fastest counts.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

from table import NAME

HERE = pathlib.Path(__file__).resolve().parent
VERTICES = 100_000
REPETITIONS = 9


def speeds(program, pattern):
    """{(what, threads): {yardstick or "": runs a second of processor time, median}}"""
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        subprocess.run([program, f"--benchmark_filter={pattern}", "--benchmark_min_time=0.1",
                        f"--benchmark_repetitions={REPETITIONS}",
                        "--benchmark_enable_random_interleaving=true",
                        f"--benchmark_out={out.name}", "--benchmark_out_format=json"],
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        runs = json.load(out)["benchmarks"]
    samples = {}
    for run in runs:
        if run.get("error_occurred"):
            sys.exit(f"{run['run_name']}: {run['error_message']}")
        if run["run_type"] == "iteration":
            name = NAME.match(run["run_name"])
            row = samples.setdefault((name["what"], name["threads"]), {})
            row.setdefault(name["yardstick"] or "", []).append(1.0 / run["cpu_time"])
    return {key: {yardstick: statistics.median(found) for yardstick, found in row.items()}
            for key, row in samples.items()}


def main():
    options = argparse.ArgumentParser(description=__doc__,
                                      formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", default=HERE / "../../build/release/bin/relight_bench")
    asked = options.parse_args()
    rules = []
    for key, rule in json.loads((HERE / "gate.json").read_text(encoding="utf-8")).items():
        what, _, threads = key.partition("/")
        rules.append((what, threads or None, rule["beside"], rule["least"]))
    found = speeds(asked.program, "|".join(
        f"^{what}( beside {beside}.*)?/{VERTICES}{'/' + threads if threads else ''}/real_time"
        for what, threads, beside, _ in rules))
    failed = False
    print("| what | beside | ours : it | at least |\n| --- | --- | --: | --: |")
    for what, threads, beside, least in rules:
        row = found.get((what, threads), {})
        yardsticks = {name: speed for name, speed in row.items() if name.startswith(beside)}
        if "" not in row or not yardsticks:
            sys.exit(f"{what}: no such pair; is gate.json older than the benchmarks?")
        fastest = max(yardsticks, key=yardsticks.get)
        ratio = row[""] / yardsticks[fastest]
        failed = failed or ratio < least
        word = " TOO LOW" if ratio < least else ""
        print(f"| {what} | {fastest} | {ratio:.2f}{word} | {least} |")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
