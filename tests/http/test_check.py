"""GET /v1/check and `relight check`: the program proves its formulas on request."""

import json
import math
import pathlib
import subprocess

import pytest

from client import call
from conftest import PROGRAM

COMMAND = str(pathlib.Path(PROGRAM).with_name("relight"))
PROMISED = {"point", "spot", "sun", "polygon", "sphere", "disk", "sky", "half-plane blocker", "furnace", "D", "G1",
            "Jacobian", "reciprocity", "integrating sphere"}
KEYS = {"name", "group", "formula", "unit", "expected", "computed", "error", "tolerance", "tolerance_kind", "pass"}


def relight_command(*words):
    return subprocess.run([COMMAND, *words], capture_output=True, text=True, timeout=300, check=False)


def hold(answer):
    """Every case of an answer, seen to add up."""
    cases = answer["cases"]
    assert len(cases) > 100 and answer["passed"] == len(cases) and answer["failed"] == 0
    assert "Embree" in answer["kernel"] and answer["version"]
    for case in cases:
        assert set(case) == KEYS, case
        assert all(math.isfinite(case[key]) for key in ("expected", "computed", "error", "tolerance")), case
        assert case["error"] == case["computed"] - case["expected"]
        assert case["pass"] is (abs(case["error"]) <= case["tolerance"]) is True, case
    assert PROMISED <= {case["group"] for case in cases}
    assert len({case["name"] for case in cases}) == len(cases)


def test_the_running_server_proves_its_formulas(server):
    reply = call(server, "GET", "/v1/check")
    assert reply.status == 200 and reply.headers["Content-Type"] == "application/json"
    hold(reply.json())


def test_the_same_cases_any_time_and_on_any_number_of_threads(server, start):
    one = call(start("--threads", "1"), "GET", "/v1/check").body
    assert call(server, "GET", "/v1/check").body == one == call(server, "GET", "/v1/check").body


def test_check_takes_no_query_and_no_post(server):
    assert call(server, "GET", "/v1/check?group=point").problem()[0] == "unknown_field"
    assert call(server, "POST", "/v1/check", b"{}").problem()[0] == "method_not_allowed"


def test_the_command_line_prints_a_table_and_exits_with_0():
    ran = relight_command("check")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    lines = ran.stdout.splitlines()
    assert PROMISED <= set(lines)
    assert "\033" not in ran.stdout  # no terminal, no colours
    cases = [line for line in lines if line.startswith("  ok  ")]
    assert lines[-1].startswith(f"{len(cases)} passed, 0 failed (relight ")
    formula = lines[0].index("formula")
    assert all(line[formula - 1] == " " and line[formula] != " " for line in cases)


def test_the_command_line_gives_the_answer_of_the_server_as_json(server):
    ran = relight_command("check", "--json", "--threads", "1")
    assert ran.returncode == 0, ran.stderr
    hold(json.loads(ran.stdout))
    assert json.loads(ran.stdout) == call(server, "GET", "/v1/check").json()


@pytest.mark.parametrize("words", [("--help",), ("check", "--help"), ("--version",)])
def test_the_command_line_says_what_it_is(words):
    ran = relight_command(*words)
    assert ran.returncode == 0 and "relight" in ran.stdout or "--json" in ran.stdout


@pytest.mark.parametrize("words", [(), ("chek",), ("check", "--jsn"), ("check", "--threads", "-1")])
def test_a_mistyped_command_is_refused(words):
    ran = relight_command(*words)
    assert ran.returncode not in (0, 1) and ran.stderr and not ran.stdout
