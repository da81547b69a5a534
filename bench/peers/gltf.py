"""Triangles and materials of a plain glTF file as arrays: enough for the scenes of renders.py, no more."""

import io
import json
import pathlib
import struct

import numpy as np
from PIL import Image

TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Gltf:
    """A .gltf or .glb file without compressed meshes."""

    def __init__(self, path):
        self.folder = pathlib.Path(path).parent
        data, chunk = pathlib.Path(path).read_bytes(), b""
        if data[:4] == b"glTF":
            length = struct.unpack("<I", data[12:16])[0]
            data, chunk = data[20 : 20 + length], data[28 + length :]
        self.json = json.loads(data)
        self.buffers = [(self.folder / b["uri"]).read_bytes() if "uri" in b else chunk for b in self.json["buffers"]]

    def view(self, index):
        view = self.json["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self.buffers[view["buffer"]][start : start + view["byteLength"]], view.get("byteStride")

    def accessor(self, index):
        """`count x width` numbers."""
        accessor = self.json["accessors"][index]
        data, stride = self.view(accessor["bufferView"])
        kind, width = np.dtype(TYPES[accessor["componentType"]]), WIDTHS[accessor["type"]]
        stride = stride or kind.itemsize * width
        return np.ndarray((accessor["count"], width), kind, data, accessor.get("byteOffset", 0), (stride, kind.itemsize)).copy()

    def image(self, texture):
        """Pixels `height x width x 4`, uint8, of a texture reference, or None."""
        if texture is None:
            return None
        image = self.json["images"][self.json["textures"][texture["index"]]["source"]]
        data = (self.folder / image["uri"]).read_bytes() if "uri" in image else self.view(image["bufferView"])[0]
        return np.array(Image.open(io.BytesIO(data)).convert("RGBA"))

    def primitives(self):
        """(triangles `n x 3`, positions, normals, texture coordinates, material) of every placed primitive, in metres of the file."""
        scene = self.json["scenes"][self.json.get("scene", 0)]
        stack = [(node, np.eye(4)) for node in scene["nodes"]]
        while stack:
            index, parent = stack.pop()
            node = self.json["nodes"][index]
            world = parent @ local(node)
            stack += [(child, world) for child in node.get("children", [])]
            for primitive in self.json["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
                if primitive.get("mode", 4) != 4:
                    continue
                attributes = {name: self.accessor(at) for name, at in primitive["attributes"].items()}
                positions = attributes["POSITION"] @ world[:3, :3].T + world[:3, 3]
                normals = attributes["NORMAL"] @ np.linalg.inv(world[:3, :3])
                normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20)
                indices = self.accessor(primitive["indices"]).reshape(-1, 3)
                uv = attributes.get("TEXCOORD_0", np.zeros((len(positions), 2)))
                yield indices, positions, normals, uv, self.json["materials"][primitive["material"]]


def local(node):
    """Matrix of a node."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]))
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix
