"""What the sample files hold, told without the server: their table, and glTF taken apart."""

import base64
import json
import pathlib
import struct

from conftest import ROOT

DATA = ROOT / "tests/data"


def table(kind):
    """(vertices, faces) of each file that SOURCES.md lists under `kind`; faces 0 for points."""
    counts = {}
    section = (DATA / "SOURCES.md").read_text(encoding="utf-8").split(f"## {kind}/")[1].split("\n## ")[0]
    for line in section.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) < 4 or not cells[2] or cells[0] in ("file", "---"):
            continue
        if "points" in cells[2]:
            counts[cells[0]] = (int(cells[2].split()[0]), 0)
        else:
            counts[cells[0]] = tuple(int(number) for number in cells[2].split("/"))
    return counts


def split_glb(data):
    """(JSON, BIN) of a GLB."""
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    document = json.loads(data[20:20 + size])
    at = 20 + size
    if at == length:
        return document, b""
    size, kind = struct.unpack_from("<I4s", data, at)
    assert kind == b"BIN\0"
    return document, data[at + 8:at + 8 + size]


def embedded(path):
    """The bytes of a glTF file with all that it names put inside, as a client sends it."""
    path = pathlib.Path(path)
    if path.suffix == ".glb":
        return path.read_bytes()
    document = json.loads(path.read_text(encoding="utf-8"))
    for item in document.get("buffers", []) + document.get("images", []):
        uri = item.get("uri", "data:")
        if not uri.startswith("data:"):
            kind = {".png": "image/png", ".jpg": "image/jpeg"}.get(pathlib.Path(uri).suffix,
                                                                   "application/octet-stream")
            packed = base64.b64encode((path.parent / uri).read_bytes()).decode()
            item["uri"] = f"data:{kind};base64,{packed}"
    return json.dumps(document).encode()


def document_of(data):
    return split_glb(data)[0] if data[:4] == b"glTF" else json.loads(data)


def shown(document):
    """(node, primitive) pairs that the default scene shows, each with its mesh, depth first."""
    nodes = document["nodes"]
    roots = document["scenes"][document.get("scene", 0)]["nodes"] if "scenes" in document else range(len(nodes))
    pairs, stack = [], list(roots)[::-1]
    while stack:
        number = stack.pop()
        node = nodes[number]
        if "mesh" in node:
            for primitive in document["meshes"][node["mesh"]]["primitives"]:
                pairs.append((number, node["mesh"], primitive))
        stack.extend(node.get("children", [])[::-1])
    return pairs


def vertices_of(document, primitive):
    return document["accessors"][primitive["attributes"]["POSITION"]]["count"]


def faces_of(document, primitive):
    corners = document["accessors"][primitive["indices"]]["count"] if "indices" in primitive \
        else vertices_of(document, primitive)
    mode = primitive.get("mode", 4)
    return corners // 3 if mode == 4 else corners - 2 if mode in (5, 6) else 0


def floats(document, binary, accessor):
    """A float accessor of a GLB's own buffer, rows of numbers."""
    item = document["accessors"][accessor]
    assert item["componentType"] == 5126
    view = document["bufferViews"][item["bufferView"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[item["type"]]
    begin = view.get("byteOffset", 0) + item.get("byteOffset", 0)
    numbers = struct.unpack_from(f"<{item['count'] * width}f", binary, begin)
    return [numbers[i:i + width] for i in range(0, len(numbers), width)]
