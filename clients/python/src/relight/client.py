"""The client: what can be asked of a Relight server, and what it answers."""

from __future__ import annotations

import dataclasses
import http.client
import io
import json
import os
import re
import urllib.parse
from email.message import Message
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Union

from relight import _fields
from relight._http import Connection, Reply, Source, body_of, multipart

_ID = re.compile(r"[0-9a-f]{64}")
_MEDIA_TYPES = {
    "ply": "model/ply",
    "obj": "model/obj",
    "stl": "model/stl",
    "off": "model/off",
    "glb": "model/gltf-binary",
    "gltf": "model/gltf+json",
    "las": "application/vnd.las",
}


class RelightError(Exception):
    """The server's refusal (RFC 9457). `code` is stable; `detail` says what was found and what is
    allowed; `pointer` is the place in the request, `line` or `byte` the place in a file."""

    def __init__(self, status: int, problem: Mapping[str, Any]) -> None:
        self.status = status
        self.code = str(problem.get("code", f"http_{status}"))
        self.title = str(problem.get("title", ""))
        self.detail = str(problem.get("detail", ""))
        self.pointer: Optional[str] = problem.get("pointer")
        self.line: Optional[int] = problem.get("line")
        self.byte: Optional[int] = problem.get("byte")
        place = "".join(
            f" at {name} {value}" if name != "pointer" else f" at {value}"
            for name, value in (("pointer", self.pointer), ("line", self.line), ("byte", self.byte))
            if value is not None
        )
        super().__init__(f"{self.code}{place}: {self.detail or self.title or status}")


@dataclasses.dataclass(frozen=True)
class Mesh:
    """A stored mesh or point cloud, as the server describes it."""

    id: str
    kind: str  # "mesh" or "points"
    format: str
    bytes: int
    vertices: int
    faces: int
    bounds: Dict[str, List[float]]
    has: Dict[str, bool]
    materials: List[str]  # names of the groups of faces
    lights: List[str]  # names of those that the file brings
    intake: Dict[str, Any]  # what loading found and did

    @classmethod
    def _of(cls, description: Mapping[str, Any]) -> Mesh:
        return cls(**{field.name: description[field.name] for field in dataclasses.fields(cls)})


class Answer:
    """What came of a relight request."""

    def __init__(self, content: Union[bytes, bytearray], headers: Message) -> None:
        self.content = content
        self.headers = headers  #: case does not matter: headers["relight-rays"]

    @property
    def content_type(self) -> str:
        return self.headers.get_content_type()

    @property
    def rays(self) -> Optional[int]:
        """Rays traced for this answer; 0 when all came from the server's cache."""
        rays = self.headers.get("Relight-Rays")
        return None if rays is None else int(rays)

    @property
    def timings(self) -> Dict[str, float]:
        """Milliseconds of each step: parse, bvh, trace, shade, encode, total."""
        found = re.findall(r"([\w-]+);dur=([0-9.]+)", self.headers.get("Server-Timing", ""))
        return {name: float(ms) for name, ms in found}

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the answer to a file."""
        with open(path, "wb") as file:
            file.write(self.content)

    def json(self) -> Any:
        """The answer of `"format": "json"`."""
        self._must_be("application/json", "json")
        return json.loads(self.content)

    @property
    def head(self) -> Dict[str, Any]:
        """What an answer of `fields=` says beside its arrays: "vertices", each field's unit, "samples",
        "warnings" …; of progressive answers, whether this is the "final" one."""
        self._must_be(_fields.MEDIA_TYPE, "fields")
        return _fields.head_of(self.content)[0]

    def arrays(self) -> Dict[str, Any]:
        """The NumPy arrays of `fields=`, which look into `content` (no copy), or of
        `"format": "npz"`, by name."""
        if self.content_type != _fields.MEDIA_TYPE:
            self._must_be("application/x-npz", "npz")
        try:
            import numpy
        except ImportError:
            raise RuntimeError(
                "arrays() needs NumPy, which is not installed; json() reads the same numbers from "
                'an answer of "format": "json" without it'
            ) from None
        if self.content_type == _fields.MEDIA_TYPE:
            return _fields.arrays_of(self.content)
        with numpy.load(io.BytesIO(self.content), allow_pickle=False) as arrays:
            return dict(arrays)

    def _must_be(self, media_type: str, name: str) -> None:
        if self.content_type != media_type:
            way = 'fields="irradiance:float32"'
            if name != "fields":
                way = f'output={{"format": "{name}"}}'
            raise ValueError(
                f"this answer is {self.content_type}, not {media_type}: ask for it with {way}"
            )


class Client:
    """Speaks to one server over one connection; one thread at a time."""

    def __init__(
        self,
        base_url: str = "http://127.0.0.1:8080",
        *,
        timeout: float = 600.0,
        token: Optional[str] = None,
    ) -> None:
        """`timeout` [s] is the longest silence; a big scene is computed in silence."""
        self._connection = Connection(base_url, timeout, token)
        self._last: Optional[Answer] = None  # of relight(), for the server to say "the same"

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._connection.close()

    def upload(self, mesh: Source, format: Optional[str] = None) -> Mesh:
        """Stores a file, given as path or bytes; the same file again is the same mesh. The format is
        told by the path's ending, or else by the server from the first bytes."""
        query = _query(format=format)
        headers = {"Content-Type": _media_type(mesh)}
        return Mesh._of(self._json("POST", "/v1/meshes" + query, body_of(mesh), headers))

    def store_environment(self, image: Source, format: Optional[str] = None) -> Dict[str, Any]:
        """Stores an equirectangular .hdr or .exr; the description's "id" goes into an
        `environment_light`."""
        return self._store("/v1/environments", image, format)

    def store_profile(self, profile: Source) -> Dict[str, Any]:
        """Stores a photometric profile (.ies); the description has its "id" and its flux."""
        return self._store("/v1/profiles", profile, "ies")

    def check(self) -> Dict[str, Any]:
        """The server's proof of its formulas: every closed-form case, expected and computed."""
        return self._json("GET", "/v1/check")

    def mesh(self, id: str) -> Mesh:
        """The description of a stored mesh."""
        return Mesh._of(self._json("GET", "/v1/meshes/" + _checked(id)))

    def meshes(self) -> Iterator[Mesh]:
        """All stored meshes, newest first."""
        cursor: Optional[str] = None
        while True:
            page = self._json("GET", "/v1/meshes" + _query(cursor=cursor))
            yield from map(Mesh._of, page["meshes"])
            cursor = page["next_cursor"]
            if cursor is None:
                return

    def content(self, id: str) -> bytes:
        """The very bytes that were uploaded."""
        return self._request("GET", f"/v1/meshes/{_checked(id)}/content").content

    def delete(self, id: str) -> None:
        """Forgets a mesh and all that was derived from it."""
        self._request("DELETE", "/v1/meshes/" + _checked(id))

    def relight(
        self,
        mesh: Union[Mesh, Source],
        lights: Optional[Sequence[Mapping[str, Any]]] = None,
        material: Optional[Mapping[str, Any]] = None,
        output: Union[None, str, Mapping[str, Any]] = None,
        *,
        fields: Optional[str] = None,
        session: Optional[str] = None,
        **members: Any,
    ) -> Answer:
        """Lights a stored mesh (a `Mesh`, or its id) or a file (path or bytes), which is then sent
        along and not stored. `output` is the API's object, or just the format's name. `members` are the
        other members of the request as the API has them: view, camera, transport, display, points,
        refine, materials.

        `fields` asks for raw arrays instead of a file, the fastest way: "irradiance:float16,color:uint8"
        (float32, float16, uint8); `arrays()` looks into them. A newer request of the same `session` (1
        to 64 letters, digits, "-", "_") drops an older one that is still computed, also one of another
        client; that one raises RelightError with the code "superseded".

        The client keeps its last answer: where the server says that nothing has changed, it comes
        again without being computed or sent."""
        headers = {"Relight-Session": session} if session else {}
        if self._last is not None:
            headers["If-None-Match"] = self._last.headers["ETag"]
        path = "/v1/relight" + _query(fields=fields)
        reply = self._ask(path, mesh, lights, material, output, members, headers)
        if reply.status == 304 and self._last is not None:
            return self._last
        answer = Answer(reply.content, reply.headers)
        self._last = answer if "ETag" in reply.headers else None
        return answer

    def progressive(
        self,
        mesh: Union[Mesh, Source],
        lights: Optional[Sequence[Mapping[str, Any]]] = None,
        material: Optional[Mapping[str, Any]] = None,
        *,
        fields: str,
        session: Optional[str] = None,
        **members: Any,
    ) -> Iterator[Answer]:
        """The answers to one request, from few samples at first and from more and more after: `head`
        says from how many ("samples"), how far off it is ("standard_error") and whether it is the
        "final" one; without that one the stream was cut short, as by a newer request of the session.
        Until the last is taken, or the iterator closed, the client can ask nothing else."""
        headers = {"Relight-Session": session} if session else {}
        path = "/v1/relight" + _query(fields=fields, progressive="1")
        response = self._ask(path, mesh, lights, material, None, members, headers, _begun)
        try:
            while True:
                message = _fields.read_message(response)
                if message is None:
                    return
                yield Answer(message, response.headers)
        finally:
            if not response.isclosed():
                self.close()  # nothing of a half-read answer may meet the next request

    def explain(
        self,
        mesh: Union[Mesh, Source],
        vertices: Sequence[int],
        lights: Optional[Sequence[Mapping[str, Any]]] = None,
        material: Optional[Mapping[str, Any]] = None,
        **fields: Any,
    ) -> Dict[str, Any]:
        """Why these vertices are as bright as they are: a light's cosine, distance, visibility,
        blocker, the BRDF's terms, and what they add up to."""
        asked = {**fields, "vertices": [int(v) for v in vertices]}
        reply = self._ask("/v1/explain", mesh, lights, material, None, asked, {})
        found = json.loads(reply.content)
        assert isinstance(found, dict)
        return found

    def _store(self, path: str, file: Source, format: Optional[str]) -> Dict[str, Any]:
        query = _query(format=format)
        headers = {"Content-Type": "application/octet-stream"}
        return self._json("POST", path + query, body_of(file), headers)

    def _ask(
        self,
        path: str,
        mesh: Union[Mesh, Source],
        lights: Optional[Sequence[Mapping[str, Any]]],
        material: Optional[Mapping[str, Any]],
        output: Union[None, str, Mapping[str, Any]],
        members: Mapping[str, Any],
        headers: Mapping[str, str],
        read: Any = Reply,
    ) -> Any:
        request: Dict[str, Any] = dict(members)
        if lights is not None:
            request["lights"] = [dict(light) for light in lights]
        if material is not None:
            request["material"] = dict(material)
        if output is not None:
            request["output"] = {"format": output} if isinstance(output, str) else dict(output)
        id = mesh.id if isinstance(mesh, Mesh) else mesh
        if isinstance(id, str) and _ID.fullmatch(id):
            request["mesh"] = {"id": id}
            body, content_type = body_of(_dumped(request)), "application/json"
        else:
            content_type, body = multipart(
                [
                    ("request", "application/json", body_of(_dumped(request))),
                    ("mesh", _media_type(id), body_of(id)),
                ]
            )
        return self._request("POST", path, body, {"Content-Type": content_type, **headers}, read)

    def _request(self, *arguments: Any) -> Any:
        reply = self._connection.request(*arguments)
        if reply.status >= 300 and reply.status != 304:
            raise RelightError(reply.status, _problem(reply))
        return reply

    def _json(self, *arguments: Any) -> Dict[str, Any]:
        found = json.loads(self._request(*arguments).content)
        assert isinstance(found, dict)
        return found


def _query(**parameters: Optional[str]) -> str:
    given = {name: value for name, value in parameters.items() if value}
    return "?" + urllib.parse.urlencode(given, safe=":,") if given else ""


def _begun(response: http.client.HTTPResponse) -> Union[Reply, http.client.HTTPResponse]:
    """A good answer is read message by message, a refusal at once."""
    return response if response.status < 300 else Reply(response)


def _checked(id: str) -> str:
    if not _ID.fullmatch(id):
        raise ValueError(f"{id!r} is no mesh id: 64 hex digits, as upload() gives them")
    return id


def _dumped(request: Mapping[str, Any]) -> bytes:
    return json.dumps(request, allow_nan=False, separators=(",", ":")).encode()


def _media_type(source: Source) -> str:
    """Told by the path's ending; for anything else the server looks at the first bytes."""
    ending = "" if isinstance(source, bytes) else os.path.splitext(os.fspath(source))[1]
    return _MEDIA_TYPES.get(ending[1:].lower(), "application/octet-stream")


def _problem(reply: Reply) -> Dict[str, Any]:
    try:
        problem = json.loads(reply.content)
    except ValueError:
        problem = None
    return problem if isinstance(problem, dict) else {}
