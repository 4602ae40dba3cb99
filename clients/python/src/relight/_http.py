"""One keep-alive connection, and bodies that are sent as they are read."""

from __future__ import annotations

import http.client
import os
import socket
import urllib.parse
import uuid
from typing import Any, BinaryIO, Callable, Iterator, List, Mapping, Optional, Tuple, Union

_BLOCK = 1 << 18

Source = Union[bytes, str, "os.PathLike[str]"]
Body = Tuple[int, Callable[[], Iterator[bytes]]]  # length, and what gives the bytes (again)


def body_of(source: Source) -> Body:
    """A body from bytes, or from a file that is never held in memory whole."""
    if isinstance(source, bytes):
        return len(source), lambda: iter((source,))
    path = os.fspath(source)

    def blocks() -> Iterator[bytes]:
        with open(path, "rb") as file:
            yield from _blocks(file)

    return os.stat(path).st_size, blocks


def _blocks(file: BinaryIO) -> Iterator[bytes]:
    while True:
        block = file.read(_BLOCK)
        if not block:
            return
        yield block


def multipart(parts: List[Tuple[str, str, Body]]) -> Tuple[str, Body]:
    """multipart/form-data (RFC 7578) of (name, media type, body): its Content-Type and its body."""
    boundary = uuid.uuid4().hex
    heads = [
        (
            f'--{boundary}\r\nContent-Disposition: form-data; name="{name}"; filename="{name}"\r\n'
            f"Content-Type: {media_type}\r\n\r\n"
        ).encode("ascii")
        for name, media_type, _ in parts
    ]
    tail = f"--{boundary}--\r\n".encode("ascii")
    length = len(tail) + sum(len(h) + part[2][0] + 2 for h, part in zip(heads, parts))

    def blocks() -> Iterator[bytes]:
        for head, (_, _, (_, content)) in zip(heads, parts):
            yield head
            yield from content()
            yield b"\r\n"
        yield tail

    return f"multipart/form-data; boundary={boundary}", (length, blocks)


class Reply:
    """An answer, read whole."""

    def __init__(self, response: http.client.HTTPResponse) -> None:
        self.status = response.status
        self.headers = response.headers
        self.content = response.read()


class Connection:
    """Requests to one server, over one connection while the server keeps it."""

    def __init__(self, base_url: str, timeout: float, token: Optional[str]) -> None:
        url = urllib.parse.urlsplit(base_url)
        if url.scheme not in ("http", "https") or not url.hostname:
            raise ValueError(f"{base_url!r} is not an address like http://127.0.0.1:8080")
        kind = http.client.HTTPSConnection if url.scheme == "https" else http.client.HTTPConnection
        self._http = kind(url.hostname, url.port, timeout=timeout, blocksize=_BLOCK)
        self._prefix = url.path.rstrip("/")
        self._headers = {"Authorization": f"Bearer {token}"} if token else {}

    def close(self) -> None:
        self._http.close()

    def request(
        self,
        method: str,
        path: str,
        body: Optional[Body] = None,
        headers: Optional[Mapping[str, str]] = None,
        read: Callable[[http.client.HTTPResponse], Any] = Reply,
    ) -> Any:
        """One request; what `read` makes of the response. All of this API may be sent again, so a kept
        connection that the server has closed in the meantime is opened anew, once."""
        kept = self._http.sock is not None
        try:
            return self._once(method, path, body, headers or {}, read)
        except (ConnectionError, http.client.BadStatusLine):
            self._http.close()
            if not kept:
                raise
        return self._once(method, path, body, headers or {}, read)

    def _open(self) -> None:
        self._http.connect()
        # Head and body go out in separate writes: without this the second waits for the first's
        # acknowledgement.
        self._http.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _once(
        self,
        method: str,
        path: str,
        body: Optional[Body],
        headers: Mapping[str, str],
        read: Callable[[http.client.HTTPResponse], Any],
    ) -> Any:
        all_headers = {**self._headers, **headers}
        if body is not None:
            all_headers["Content-Length"] = str(body[0])
        if self._http.sock is None:
            self._open()
        try:
            self._http.request(
                method, self._prefix + path, body[1]() if body else None, all_headers
            )
        except (BrokenPipeError, ConnectionResetError):
            pass  # it refused the body half-way: the reason is in its answer
        try:
            return read(self._http.getresponse())
        except BaseException:
            self._http.close()  # nothing of a half-read answer may meet the next request
            raise
