"""relight-client: the service from a shell."""

from __future__ import annotations

import argparse
import json
import os
import sys
from typing import Any, Dict, List, Optional

from relight.client import Client, RelightError

_FORMATS = {".ply": "ply", ".json": "json", ".npz": "npz", ".png": "png"}


def _object(text: str) -> Dict[str, Any]:
    """A JSON object on the command line."""
    try:
        found = json.loads(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"not JSON ({error}): {text}") from None
    if not isinstance(found, dict):
        raise argparse.ArgumentTypeError(f"not a JSON object: {text}")
    return found


def _object_file(path: str) -> Dict[str, Any]:
    try:
        with open(path, encoding="utf-8") as file:
            return _object(file.read())
    except OSError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _size(text: str) -> Dict[str, int]:
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(f"{text!r} is not like 800x600")
    return {"width": int(width), "height": int(height)}


def _arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="relight-client", description=__doc__)
    parser.add_argument(
        "--server",
        default=os.environ.get("RELIGHT_SERVER", "http://127.0.0.1:8080"),
        help="where relightd listens (default %(default)s, or $RELIGHT_SERVER)",
    )
    commands = parser.add_subparsers(dest="command", required=True)

    upload = commands.add_parser("upload", help="store meshes; prints their ids")
    upload.add_argument("files", nargs="+", metavar="FILE")
    upload.add_argument("--format", help="ply, obj, off, stl; default: by the file")

    commands.add_parser("list", help="the stored meshes, newest first")

    relight = commands.add_parser("relight", help="light a mesh and save the answer")
    relight.add_argument("mesh", help="a file, or the id of a stored mesh")
    relight.add_argument("-o", "--out", required=True, help="*.ply, *.json, *.npz or *.png")
    relight.add_argument("--request", type=_object_file, default={}, metavar="FILE",
                         help="the scene as JSON; what follows is put over it")
    relight.add_argument("--light", type=_object, action="append", metavar="JSON",
                         help="one light; may be given again")
    relight.add_argument("--material", type=_object, metavar="JSON")
    relight.add_argument("--camera", type=_object, metavar="JSON")
    relight.add_argument("--quantities", metavar="A,B,…",
                         help="color, irradiance, radiance, visibility, normal, per_light")
    relight.add_argument("--size", type=_size, metavar="WxH", help="of a picture, in pixels")
    relight.add_argument("--renderer", choices=["raytrace", "vtk"])
    return parser


def _relight(client: Client, options: argparse.Namespace) -> None:
    request = dict(options.request)
    output = dict(request.pop("output", {}))
    ending = os.path.splitext(options.out)[1].lower()
    if ending not in _FORMATS:
        raise ValueError(f"{options.out}: ends in none of {', '.join(_FORMATS)}")
    if not (ending == ".ply" and output.get("format") == "ply_ascii"):
        output["format"] = _FORMATS[ending]
    if options.quantities:
        output["quantities"] = options.quantities.split(",")
    if options.renderer:
        output["renderer"] = options.renderer
    output.update(options.size or {})
    for name, value in (("lights", options.light), ("material", options.material),
                        ("camera", options.camera)):
        if value is not None:
            request[name] = value
    request.pop("mesh", None)
    answer = client.relight(options.mesh, output=output, **request)
    answer.save(options.out)
    times = ", ".join(f"{name} {ms:.1f}" for name, ms in answer.timings.items())
    print(f"{options.out}: {len(answer.content)} bytes, {answer.rays} rays, ms: {times}")


def main(arguments: Optional[List[str]] = None) -> int:
    options = _arguments().parse_args(arguments)
    try:
        with Client(options.server) as client:
            if options.command == "relight":
                _relight(client, options)
            elif options.command == "upload":
                for file in options.files:
                    mesh = client.upload(file, options.format)
                    print(f"{mesh.id}  {mesh.vertices} vertices, {mesh.faces} faces  {file}")
            else:
                for mesh in client.meshes():
                    print(f"{mesh.id}  {mesh.vertices} vertices, {mesh.faces} faces  {mesh.format}")
        return 0
    except ConnectionRefusedError:
        print(f"relight-client: nothing listens at {options.server}", file=sys.stderr)
    except (RelightError, OSError, ValueError) as error:
        print(f"relight-client: {error}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
