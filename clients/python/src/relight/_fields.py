"""The binary answer of `?fields=`: a head that says what there is, and the arrays as they lie in memory.

u32, little-endian: length of the head; the head, JSON; from its end on, at each field's "offset", the
numbers, little-endian, vertex after vertex. "bytes_total" is the length of all of it, so that messages
can follow one another.
"""

from __future__ import annotations

import http.client
import json
import struct
from typing import Any, Dict, Optional, Tuple, Union

MEDIA_TYPE = "application/octet-stream"
Message = Union[bytes, bytearray]


def head_of(message: Message) -> Tuple[Dict[str, Any], int]:
    """The head, and where it ends."""
    (length,) = struct.unpack_from("<I", message)
    head = json.loads(message[4 : 4 + length])
    assert isinstance(head, dict)
    return head, 4 + length


def arrays_of(message: Message) -> Dict[str, Any]:
    """NumPy arrays that look into the message, by name: (V, components), or (V,) of one."""
    import numpy

    head, begin = head_of(message)
    arrays = {}
    for field in head["fields"]:
        numbers = numpy.frombuffer(
            message,
            numpy.dtype(field["type"]).newbyteorder("<"),
            head["vertices"] * field["components"],
            begin + field["offset"],
        )
        one = field["components"] == 1
        arrays[field["name"]] = numbers if one else numbers.reshape(-1, field["components"])
    return arrays


def read_message(response: http.client.HTTPResponse) -> Optional[bytearray]:
    """The next message of a response that holds several; None at its end."""
    start = response.read(4)
    if not start:
        return None
    (length,) = struct.unpack("<I", _whole(start, 4))
    start = _whole(start + response.read(length), 4 + length)
    head, begin = head_of(start)
    message = bytearray(head["bytes_total"])
    message[:begin] = start
    with memoryview(message) as view:
        at = begin
        while at < len(message):
            more = response.readinto(view[at:])
            if not more:
                raise http.client.IncompleteRead(bytes(message[:at]), len(message) - at)
            at += more
    return message


def _whole(start: bytes, length: int) -> bytes:
    if len(start) < length:
        raise http.client.IncompleteRead(start, length - len(start))
    return start
