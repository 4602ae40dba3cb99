"""The bare port against clients that mean harm; bounded in time and count, on loopback only.

Runs against relightd or guard_echo (conftest.py). Tests of what only the latter has are skipped."""

import contextlib
import gzip
import json
import resource
import socket
import struct
import time
import zlib

import pytest

from conftest import Server, running, settles

HEAD_S, GRACE_S, BODY_BYTES = 3, 2, 4 << 20
UPLOAD = b"POST /v1/meshes HTTP/1.1\r\nHost: x\r\n"
LAST = b"GET /healthz HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"
CHUNKED = UPLOAD + b"Transfer-Encoding: chunked\r\n\r\n"


@pytest.fixture(scope="module")
def strict(tmp_path_factory):
    """The server with limits small enough to wait for; in all of these tests it neither dies,
    keeps a thread nor grows by 50 MiB (a sanitizer keeps freed memory, so it is not asked)."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    yield from running(
        tmp_path_factory.mktemp("store"), "--head-time-ms", str(1000 * HEAD_S),
        "--grace-ms", str(1000 * GRACE_S), "--max-upload-bytes", str(BODY_BYTES),
        "--max-json-bytes", str(BODY_BYTES))
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


@pytest.fixture(autouse=True)
def unharmed(request):
    if "strict" not in request.fixturenames:
        yield
        return
    server = request.getfixturevalue("strict")
    healthy(server)
    threads, rss = server.threads(), server.rss_bytes()
    yield
    assert server.alive()
    healthy(server)
    assert settles(lambda: server.threads() <= threads), "a connection kept its thread"
    if not server.is_sanitized():
        assert server.rss_bytes() - rss < 50 << 20


def connect(server, **options):
    sock = socket.socket()
    sock.settimeout(options.get("timeout", 15))
    if "receive_buffer" in options:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, options["receive_buffer"])
    sock.connect((server.host, server.port))
    return sock


def received(sock):
    """All bytes up to the end of the connection, however it comes."""
    data = bytearray()
    with contextlib.suppress(ConnectionError):
        while piece := sock.recv(1 << 16):
            data += piece
    return bytes(data)


def send_what_goes(sock, data):
    """Whether the server took all of it."""
    try:
        sock.sendall(data)
        return True
    except OSError:
        return False


def responses(data):
    """[(status, {field: value}, body)] of a stream of responses; a cut one is an error."""
    found = []
    while data:
        head, mark, data = data.partition(b"\r\n\r\n")
        assert mark, f"a response's head is cut: {head!r}"
        first, *fields = head.decode("ascii").split("\r\n")
        version, status, _ = first.split(" ", 2)
        assert version == "HTTP/1.1"
        fields = {k.lower(): v for k, v in (f.split(": ", 1) for f in fields)}
        size = int(fields.get("content-length", 0))
        assert len(data) >= size, "a response's body is cut"
        found.append((int(status), fields, data[:size]))
        data = data[size:]
    return found


def exchange(server, data):
    with connect(server) as sock:
        send_what_goes(sock, data)
        return responses(received(sock))


def healthy(server, within=5.0):
    within *= 5 if server.is_sanitized() else 1
    start = time.monotonic()
    (answer,) = exchange(server, LAST)
    assert answer[0] == 200
    assert time.monotonic() - start < within


def assert_refused(answers, statuses):
    assert len(answers) == 1, f"a second request was read out of the first: {answers}"
    status, fields, body = answers[0]
    assert status in statuses
    assert fields["connection"] == "close"
    assert fields["content-type"] == "application/problem+json"
    problem = json.loads(body)
    assert problem["status"] == status
    assert problem["detail"] and problem["code"]


def only_on_guard_echo(server):
    (answer,) = exchange(server, LAST.replace(b"/healthz", b"/headers"))
    if answer[0] == 404:
        pytest.skip("a route of guard_echo")


# --- framing -------------------------------------------------------------------------------------

def upload(*fields, body=b"hello"):
    return UPLOAD + b"".join(f + b"\r\n" for f in fields) + b"\r\n" + body


def get(*lines, first=b"GET /healthz HTTP/1.1"):
    return b"\r\n".join((first, *lines)) + b"\r\n\r\n"


HOST = b"Host: x"
TE = b"Transfer-Encoding: chunked"
ZERO = b"0\r\n\r\n"
REFUSED = {
    "length and chunked": (upload(b"Content-Length: 5", TE, body=ZERO), 400),
    "chunked and length": (upload(TE, b"Content-Length: 5", body=ZERO), 400),
    "two equal lengths": (upload(b"Content-Length: 5", b"Content-Length: 5"), 400),
    "two lengths": (upload(b"Content-Length: 5", b"content-length: 0"), 400),
    "length +5": (upload(b"Content-Length: +5"), 400),
    "length 5, 5": (upload(b"Content-Length: 5, 5"), 400),
    "length 0x5": (upload(b"Content-Length: 0x5"), 400),
    "length 5 5": (upload(b"Content-Length: 5 5"), 400),
    "length -1": (upload(b"Content-Length: -1"), 400),
    "length 5.0": (upload(b"Content-Length: 5.0"), 400),
    "length empty": (upload(b"Content-Length:"), 400),
    "length of other digits": (upload("Content-Length: ５".encode()), 400),
    "length beyond 64 bits": (upload(b"Content-Length: 18446744073709551621"), 413),
    "length beyond the limit": (upload(b"Content-Length: 4194305"), 413),
    "chunked twice": (upload(b"Transfer-Encoding: chunked, chunked", body=ZERO), 501),
    "chunked in two fields": (upload(TE, TE, body=ZERO), 400),
    "chunked and identity": (upload(TE, b"Transfer-Encoding: identity", body=ZERO), 400),
    "xchunked": (upload(b"Transfer-Encoding: xchunked", body=ZERO), 501),
    "identity": (upload(b"Transfer-Encoding: identity"), 501),
    "gzip, chunked": (upload(b"Transfer-Encoding: gzip, chunked", body=ZERO), 501),
    "chunked with parameter": (upload(b"Transfer-Encoding: chunked;q=1", body=ZERO), 501),
    "chunked quoted": (upload(b'Transfer-Encoding: "chunked"', body=ZERO), 501),
    "empty coding": (upload(b"Transfer-Encoding:", body=ZERO), 501),
    "vertical tab before chunked": (upload(b"Transfer-Encoding: \x0bchunked", body=ZERO), 400),
    "folded coding": (upload(b"Transfer-Encoding:\r\n chunked", body=ZERO), 501),
    "folded field": (upload(b"X: a\r\n b", b"Content-Length: 5"), 400),
    "first field folded": (b"GET /healthz HTTP/1.1\r\n Host: x\r\n\r\n", 400),
    "space before colon": (upload(b"Transfer-Encoding : chunked", body=ZERO), 400),
    "space in name": (upload(b"Content Length: 5"), 400),
    "NUL in name": (upload(b"Content\0-Length: 5"), 400),
    "NUL in value": (upload(b"X: a\0b", b"Content-Length: 5"), 400),
    "no name": (upload(b": 5"), 400),
    "no colon": (upload(b"Content-Length 5"), 400),
    "LF alone ends every line": (upload(b"Content-Length: 5").replace(b"\r\n", b"\n"), 400),
    "LF alone in a field": (upload(b"X: a\nContent-Length: 5"), 400),
    "CR alone in a field": (upload(b"X: a\rContent-Length: 5"), 400),
    "CR before CR LF": (upload(b"Content-Length: 5\r"), 400),
    "HTTP/1.0 chunked": (upload(TE, body=ZERO).replace(b"HTTP/1.1", b"HTTP/1.0"), 400),
    "HTTP/1.0 without length": (upload().replace(b"HTTP/1.1", b"HTTP/1.0"), 411),
    "no Host": (get(), 400),
    "two Hosts": (get(HOST, HOST), 400),
    "Host with a path": (get(b"Host: x/y"), 400),
    "HTTP/2.0": (get(HOST, first=b"PRI * HTTP/2.0"), 505),
    "HTTP/1.2": (get(HOST, first=b"GET /healthz HTTP/1.2"), 505),
    "HTTP/0.9": (get(HOST, first=b"GET /healthz"), 400),
    "http/1.1": (get(HOST, first=b"GET /healthz http/1.1"), 400),
    "two spaces": (get(HOST, first=b"GET  /healthz HTTP/1.1"), 400),
    "tab for space": (get(HOST, first=b"GET\t/healthz HTTP/1.1"), 400),
    "space after version": (get(HOST, first=b"GET /healthz HTTP/1.1 "), 400),
    "unknown method": (get(HOST, first=b"BREW /healthz HTTP/1.1"), 501),
    "CONNECT": (get(HOST, first=b"CONNECT x:80 HTTP/1.1"), 501),
    "method that is no token": (get(HOST, first=b"G(T /healthz HTTP/1.1"), 400),
    "target without slash": (get(HOST, first=b"GET healthz HTTP/1.1"), 400),
    "target with %00": (get(HOST, first=b"GET /healthz%00 HTTP/1.1"), 400),
    "target with %0d%0a": (get(HOST, first=b"GET /x%0d%0aX:1 HTTP/1.1"), 400),
    "target with half an escape": (get(HOST, first=b"GET /x%4 HTTP/1.1"), 400),
    "target with fragment": (get(HOST, first=b"GET /healthz#x HTTP/1.1"), 400),
    "target beyond ASCII": (get(HOST, first="GET /é HTTP/1.1".encode()), 400),
    "target with user": (get(HOST, first=b"GET http://a@b/ HTTP/1.1"), 400),
    "target too long": (get(HOST, first=b"GET /?" + b"a" * 5000 + b" HTTP/1.1"), 414),
    "path too long": (get(HOST, first=b"GET /" + b"a" * 300 + b" HTTP/1.1"), 414),
    "request line too long": (get(HOST, first=b"GET /" + b"a" * 20000 + b" HTTP/1.1"), 414),
    "field too long": (get(HOST, b"X: " + b"a" * 20000), 431),
    "too many fields": (get(HOST, *[b"X: a"] * 101), 431),
    "head too large": (get(HOST, *[b"X: " + b"a" * 4000] * 10), 431),
    "two empty lines first": (b"\r\n\r\n" + LAST, 400),
    "TLS": (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(500), 400),
    "Content-Encoding": (upload(b"Content-Encoding: gzip", b"Content-Length: 5"), 415),
    "two Content-Encodings": (upload(b"Content-Encoding: br", b"Content-Encoding: br"), 415),
    "unknown expectation": (upload(b"Expect: tea", b"Content-Length: 5"), 417),
    "chunk size +5": (CHUNKED + b"+5\r\nhello\r\n" + ZERO, 400),
    "chunk size -5": (CHUNKED + b"-5\r\nhello\r\n" + ZERO, 400),
    "space before chunk size": (CHUNKED + b" 5\r\nhello\r\n" + ZERO, 400),
    "space after chunk size": (CHUNKED + b"5 \r\nhello\r\n" + ZERO, 400),
    "chunk size 0x5": (CHUNKED + b"0x5\r\nhello\r\n" + ZERO, 400),
    "chunk size 5g": (CHUNKED + b"5g\r\nhello\r\n" + ZERO, 400),
    "chunk size 5_0": (CHUNKED + b"5_0\r\nhello\r\n" + ZERO, 400),
    "no chunk size": (CHUNKED + b"\r\nhello\r\n" + ZERO, 400),
    "chunk size of 17 digits": (CHUNKED + b"10000000000000005\r\nhello\r\n" + ZERO, 400),
    "chunk size near 2^64": (CHUNKED + b"ffffffffffffffff\r\nhello\r\n" + ZERO, 413),
    "chunks that add up past 2^64": (CHUNKED + b"5\r\nhello\r\nfffffffffffffffb\r\n", 413),
    "chunk without its end": (CHUNKED + b"5\r\nhello" + ZERO, 400),
    "chunk longer than its size": (CHUNKED + b"5\r\nhelloX\r\n" + ZERO, 400),
    "chunk shorter than its size": (CHUNKED + b"7\r\nhello\r\n" + ZERO, 400),
    "LF alone after chunk size": (CHUNKED + b"5\nhello\r\n" + ZERO, 400),
    "LF alone after chunk": (CHUNKED + b"5\r\nhello\n" + ZERO, 400),
    "LF alone in extension": (CHUNKED + b"5;a\nb\r\nhello\r\n" + ZERO, 400),
    "CR alone in extension": (CHUNKED + b"5;a\rb\r\nhello\r\n" + ZERO, 400),
    "NUL in extension": (CHUNKED + b"5;a\0b\r\nhello\r\n" + ZERO, 400),
    "endless extension": (CHUNKED + b"5;" + b"a" * 100000 + b"\r\nhello\r\n" + ZERO, 400),
    "many extensions": (CHUNKED + b"1;abcdefghij\r\na\r\n" * 10000 + ZERO, 400),
    "trailer without colon": (CHUNKED + b"0\r\nX\r\n\r\n", 400),
    "trailer folded": (CHUNKED + b"0\r\nX: a\r\n b: c\r\n\r\n", 400),
    "trailer with LF alone": (CHUNKED + b"0\r\nX: a\n\r\n", 400),
    "endless trailer": (CHUNKED + b"0\r\nX: " + b"a" * 100000 + b"\r\n\r\n", 400),
    "many trailers": (CHUNKED + b"0\r\n" + b"X: a\r\n" * 10000 + b"\r\n", 400),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_can_be_read_in_two_ways_is_refused_and_nothing_after_it_is_read(strict, case):
    request, status = REFUSED[case]
    assert_refused(exchange(strict, request + LAST), {status})


UNAMBIGUOUS = {
    "space around the length": (upload(b"Content-Length: \t5 "), 5),
    "zeros before the length": (upload(b"Content-Length: 0000000005"), 5),
    "Chunked": (upload(b"Transfer-Encoding: Chunked", body=b"5\r\nhello\r\n" + ZERO), 5),
    "tab before chunked": (upload(b"Transfer-Encoding:\tchunked", body=b"5\r\nhello\r\n" + ZERO), 5),
    "zeros before a chunk's size": (CHUNKED + b"0005\r\nhello\r\n000\r\n\r\n", 5),
    "capitals in a chunk's size": (CHUNKED + b"A\r\nhellohello\r\n" + ZERO, 10),
    "an extension": (CHUNKED + b'5;a="b;c"\r\nhello\r\n' + ZERO, 5),
    "a trailer": (CHUNKED + b"5\r\nhello\r\n0\r\nContent-Length: 3\r\n\r\n", 5),
    "a request inside a body": (upload(b"Content-Length: %d" % len(LAST), body=LAST), len(LAST)),
    "a request inside a chunk": (CHUNKED + b"%x\r\n" % len(LAST) + LAST + b"\r\n" + ZERO, len(LAST)),
    "no body": (upload(body=b""), 0),
    "an empty line first": (b"\r\n" + upload(b"Content-Length: 5"), 5),
    "absolute form": (upload(b"Content-Length: 5").replace(b"/v1", b"http://y/v1"), 5),
    "a multipart type": (upload(b"Content-Type: multipart/form-data; boundary=b",
                                b"Content-Length: 5"), 5),
}


@pytest.mark.parametrize("case", UNAMBIGUOUS)
def test_what_can_be_read_in_one_way_is_read_so(strict, case):
    request, size = UNAMBIGUOUS[case]
    first, *rest = exchange(strict, request + LAST)
    assert first[0] < 500
    if first[0] == 200:
        assert json.loads(first[2]).get("bytes", size) == size
    assert [r[0] for r in rest] == [200] or (not rest and first[1]["connection"] == "close")


def test_a_body_that_no_handler_reads_is_not_read_as_a_request(strict):
    for first in (b"GET /healthz HTTP/1.1", b"POST /nowhere HTTP/1.1"):
        head = get(HOST, b"Content-Length: %d" % len(LAST), first=first)
        (answer,) = exchange(strict, head + LAST)
        assert answer[1]["connection"] == "close"


@pytest.mark.parametrize("method", [b"GET", b"POST", b"DELETE", b"OPTIONS"])
def test_the_longest_path_is_looked_up_like_any_other(strict, method):
    path = b"/v1/meshes/".ljust(256, b"a")
    request = get(HOST, b"Content-Length: 0", first=b"%s %s HTTP/1.1" % (method, path))
    assert [a[0] // 100 for a in exchange(strict, request + LAST)] == [4, 2]


def test_pipelined_requests_are_answered_in_order(strict):
    paths = [b"/healthz" if i % 3 else b"/nowhere-%d" % i for i in range(50)]
    requests = b"".join(get(HOST, first=b"GET " + p + b" HTTP/1.1") for p in paths)
    answers = exchange(strict, requests + LAST)
    assert [a[0] for a in answers] == [200 if i % 3 else 404 for i in range(50)] + [200]


def test_pipelined_bodies_stay_with_their_requests(strict):
    only_on_guard_echo(strict)
    requests = b"".join(
        upload(b"Content-Length: %d" % i, body=b"a" * i) +
        upload(TE, body=b"1\r\na\r\n" * i + ZERO) for i in range(1, 26))
    answers = exchange(strict, requests + LAST)
    want = [{"bytes": i, "crc32": zlib.crc32(b"a" * i)} for i in range(1, 26) for _ in "ab"]
    assert [json.loads(a[2]) for a in answers[:-1]] == want


def test_continue_is_said_once_the_body_is_wanted_and_not_before_a_refusal(strict):
    with connect(strict) as sock:
        sock.sendall(UPLOAD + b"Expect: 100-continue\r\nContent-Length: 5\r\n\r\n")
        assert sock.recv(100) == b"HTTP/1.1 100 Continue\r\n\r\n"
        sock.sendall(b"hello" + LAST)
        assert responses(received(sock))[0][0] < 500
    huge = UPLOAD + b"Expect: 100-continue\r\nContent-Length: 99999999999\r\n\r\n"
    assert_refused(exchange(strict, huge), {413})


# --- too much ------------------------------------------------------------------------------------

def flood(server, head, piece, most):
    """Sends head, then pieces until the server stops taking them; its answers."""
    with connect(server) as sock:
        send_what_goes(sock, head)
        sent = 0
        while sent < most and send_what_goes(sock, piece):
            sent += len(piece)
        return responses(received(sock))


@pytest.mark.parametrize("head, piece, status", [
    (b"GET /healthz HTTP/1.1\r\n", b"X: a\r\n" * 100, 431),
    (b"GET /healthz HTTP/1.1\r\nX: ", b"a" * 10000, 431),
    (b"GET /", b"a" * 10000, 414),
    (b"", b"a" * 10000, 414),
    (CHUNKED, b"10000\r\n" + b"a" * 65536 + b"\r\n", 413),
], ids=["lines", "line", "target", "method", "chunks"])
def test_an_endless_request_is_refused_once_it_is_too_long(strict, head, piece, status):
    assert_refused(flood(strict, head, piece, 32 << 20), {status})


def test_1200_ranges_get_the_whole_answer_once(strict):
    ranges = b"Range: bytes=" + b",".join(b"0-%d" % (i % 9) for i in range(1200))
    for field in (ranges, b"Range: bytes=5-2", b"Range: bytes=-99999999999999999999", b"Range: x"):
        (answer,) = exchange(strict, LAST[:-2] + field + b"\r\n\r\n")
        assert answer[0] == 200
        assert answer[2] == exchange(strict, LAST)[0][2]


def test_a_gzip_bomb_is_refused_before_it_is_read(strict):
    bomb = gzip.compress(bytes(20_000_000))
    head = UPLOAD + b"Content-Length: %d\r\n" % len(bomb)
    start = time.monotonic()
    assert_refused(exchange(strict, head + b"Content-Encoding: gzip\r\n\r\n" + bomb), {415})
    assert time.monotonic() - start < 5
    plain = exchange(strict, head + b"\r\n" + bomb + LAST)  # a file that is none of our formats
    assert plain[0][0] == 200 or 400 <= plain[0][0] < 500


# --- too slow ------------------------------------------------------------------------------------

def test_200_slow_heads_do_not_hold_up_others_and_end_in_408(strict):
    with contextlib.ExitStack() as stack:
        slow = [stack.enter_context(connect(strict)) for _ in range(200)]
        for sock in slow:
            sock.sendall(b"GET /healthz HTTP/1.1\r\nX: ")
        for _ in range(5):
            for sock in slow:
                send_what_goes(sock, b"a")
            healthy(strict, within=2.0)
            time.sleep(0.1)
        for sock in slow:
            assert_refused(responses(received(sock)), {408})


@pytest.mark.parametrize("head, drip", [
    (UPLOAD + b"Content-Length: 1000\r\n\r\n", b"a"),
    (UPLOAD + b"Content-Length: 1000\r\n\r\n", b""),
    (UPLOAD + b"Content-Length: 1000000\r\n\r\n" + bytes(900_000), b"a"),
    (CHUNKED, b"1\r\na\r\n"),
    (CHUNKED + b"5;", b"a"),
    (CHUNKED + b"0\r\nX: ", b"a"),
], ids=["bytes", "nothing", "fast, then bytes", "chunks", "extension", "trailer"])
def test_a_body_that_comes_too_slowly_ends_in_408(strict, head, drip):
    with connect(strict, timeout=GRACE_S + 10) as sock:
        sock.sendall(head)
        start = time.monotonic()
        sock.setblocking(False)
        answer = b""
        while not answer and time.monotonic() - start < GRACE_S + 8:
            send_what_goes(sock, drip)
            time.sleep(0.1)
            with contextlib.suppress(BlockingIOError):
                answer = sock.recv(1 << 16)
        assert_refused(responses(answer), {408})


def test_a_reader_too_slow_for_a_big_answer_is_left(strict):
    only_on_guard_echo(strict)
    time.sleep(0.5)  # that question's thread has ended
    threads = strict.threads()
    with connect(strict, receive_buffer=4096) as sock:
        sock.sendall(get(HOST, first=b"GET /big HTTP/1.1"))
        assert settles(lambda: strict.threads() > threads)
        assert settles(lambda: strict.threads() <= threads, GRACE_S + 8)
        assert len(received(sock)) < 10_000_000


def test_a_steady_reader_gets_a_big_answer_whole(strict):
    only_on_guard_echo(strict)
    with connect(strict, receive_buffer=65536) as sock:
        sock.sendall(LAST.replace(b"/healthz", b"/big"))
        data = bytearray()
        start = time.monotonic()
        while piece := sock.recv(1 << 17):
            data += piece
            if time.monotonic() - start < GRACE_S + 1:  # slow, past the grace
                time.sleep(0.05)
        assert len(responses(bytes(data))[0][2]) == 10_000_000


# --- gone, and many ------------------------------------------------------------------------------

def hang_up(sock, reset):
    if reset:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    sock.close()


@pytest.mark.parametrize("reset", [False, True], ids=["FIN", "RST"])
@pytest.mark.parametrize("sent", [
    b"", b"GET /hea", UPLOAD + b"Content-Length: 1000\r\n\r\nhello", CHUNKED + b"5\r\nhel",
    get(HOST, first=b"GET /big HTTP/1.1") * 3,
], ids=["nothing", "head", "body", "chunk", "answer"])
def test_a_client_that_hangs_up_frees_its_thread(strict, sent, reset):
    for _ in range(20):
        sock = connect(strict)
        send_what_goes(sock, sent)
        hang_up(sock, reset)
    # `unharmed` waits for the threads


def test_1000_idle_connections_do_not_keep_others_out(strict):
    count = min(1000, resource.getrlimit(resource.RLIMIT_NOFILE)[0] - 100)
    with contextlib.ExitStack() as stack:
        idle = [stack.enter_context(connect(strict)) for _ in range(count)]
        rss = strict.rss_bytes()
        healthy(strict)
        for sock in idle[:100]:  # those that have waited still get their answer
            sock.sendall(LAST)
        for sock in idle[:100]:
            assert responses(received(sock))[0][0] == 200
        assert strict.is_sanitized() or strict.rss_bytes() - rss < 50 << 20


def test_beyond_the_last_place_the_answer_is_503_and_when_to_come_back(start):
    server = start("--max-connections", "20")
    with contextlib.ExitStack() as stack:
        for _ in range(20):
            stack.enter_context(connect(server))
        with connect(server) as sock:  # says nothing: the answer comes at once
            answers = responses(received(sock))
        assert_refused(answers, {503})
        assert int(answers[0][1]["retry-after"]) > 0
    assert settles(lambda: exchange(server, LAST)[0][0] == 200)


# --- the guard and its handlers ------------------------------------------------------------------

def test_an_exception_tells_the_client_nothing(strict):
    only_on_guard_echo(strict)
    (answer,) = exchange(strict, LAST.replace(b"/healthz", b"/throw"))
    assert answer[0] == 500
    assert json.loads(answer[2])["code"] == "internal"
    assert "secret" not in str(answer)
    with connect(strict) as sock:  # thrown while the answer is under way: cut, and no more
        sock.sendall(LAST.replace(b"/healthz", b"/throw-late"))
        assert received(sock).endswith(b"\r\n\r\n")


def test_handlers_see_fields_as_sent_and_none_that_only_the_guard_may_set(strict):
    only_on_guard_echo(strict)
    request = get(HOST, b"Connection: close", b"X-Text: 100%0d%0a", b"REMOTE_ADDR: 8.8.8.8",
                  b"Relight-Accept-Encoding: forged", b"Accept-Encoding: br", b"Accept-Encoding: gzip",
                  first=b"GET /headers?a=b?c HTTP/1.1")
    lines = exchange(strict, request)[0][2].decode().split("\n")
    assert "X-Text=100%0d%0a" in lines
    assert "REMOTE_ADDR=127.0.0.1" in lines
    assert [l for l in lines if "ncoding" in l] == ["Relight-Accept-Encoding=br, gzip"]
    assert not [l for l in lines if "8.8.8.8" in l]
    assert lines[-1] == "/headers?a=b%3Fc"


def test_on_sigterm_running_requests_are_answered_and_idle_connections_end(tmp_path):
    server = Server(tmp_path)
    with contextlib.ExitStack() as stack:
        stack.callback(server.stop)
        only_on_guard_echo(server)
        idle, busy = (stack.enter_context(connect(server)) for _ in "ab")
        idle.sendall(get(HOST))
        while not idle.recv(1 << 16).endswith(b"}"):
            pass
        busy.sendall(get(HOST, first=b"GET /slow HTTP/1.1"))
        time.sleep(0.3)
        server.process.terminate()
        assert received(idle) == b""
        assert exchange(server, LAST)[0][0] in (200, 503)  # until the last one is answered
        (answer,) = responses(received(busy))
        assert answer[2] == b"slow" and answer[1]["connection"] == "close"
        assert server.process.wait(timeout=10) == 0
        with pytest.raises(ConnectionError):
            connect(server)
