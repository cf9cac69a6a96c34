"""A cube, a pyramid and a light in a corner: writes the meshes of all formats, and gltf.gltf.

Usage: python3 formats.py FOLDER
"""

import base64
import json
import math
import os
import struct
import sys

# Vertices, and faces that are counter-clockwise from their front.
OBJECTS = {
    "floor": ("white", [(-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)], [(0, 1, 2, 3)]),
    "wall": ("white", [(-2, 0, -2), (2, 0, -2), (2, 2.5, -2), (-2, 2.5, -2)], [(0, 1, 2, 3)]),
    "cube": ("orange",
             [(x - 0.7, y, z - 0.4) for y in (0, 1) for x, z in ((0.1, 0.7), (0.7, -0.1), (-0.1, -0.7), (-0.7, 0.1))],
             [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]),
    "pyramid": ("blue",
                [(0.2, 0, 0.9), (1.4, 0, 0.9), (1.4, 0, -0.3), (0.2, 0, -0.3), (0.8, 1.2, 0.3)],
                [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]),
    "light": ("light", [(-0.5, 2.5, -0.5), (0.5, 2.5, -0.5), (0.5, 2.5, 0.5), (-0.5, 2.5, 0.5)], [(0, 1, 2, 3)]),
}
COLOURS = {"white": (0.8, 0.8, 0.8), "orange": (0.8, 0.4, 0.1), "blue": (0.1, 0.3, 0.7), "light": (0, 0, 0)}
RADIANCE = (16, 14, 11)
EYE, TARGET, ANGLE = (2, 1.8, 6), (0, 1, 0), 40


def obj(names, with_materials):
    """Wavefront text of the objects."""
    lines, first = (["mtllib tinyrender.mtl"] if with_materials else []), 1
    for name in names:
        material, vertices, faces = OBJECTS[name]
        lines += [f"o {name}"] + [f"v {x:g} {y:g} {z:g}" for x, y, z in vertices]
        lines += [f"usemtl {material}"] if with_materials else []
        lines += ["f " + " ".join(str(first + corner) for corner in face) for face in faces]
        first += len(vertices)
    return "\n".join(lines) + "\n"


def camera_matrix():
    """From glTF's camera, which looks along -z, to the world; by columns."""
    normalise = lambda v: [x / math.hypot(*v) for x in v]
    cross = lambda a, b: [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]
    back = normalise([e - t for e, t in zip(EYE, TARGET)])
    right = normalise(cross((0, 1, 0), back))
    return [round(x, 9) for x in (*right, 0, *cross(back, right), 0, *back, 0, *EYE, 1)]


def gltf():
    """The scene in one file of glTF 2.0."""
    buffer, views, accessors, meshes, nodes = b"", [], [], [], []

    def accessor(numbers, format, **facts):
        nonlocal buffer
        data = struct.pack(f"<{len(numbers)}{format}", *numbers)
        views.append({"buffer": 0, "byteOffset": len(buffer), "byteLength": len(data)})
        buffer += data + bytes(-len(data) % 4)
        accessors.append({"bufferView": len(views) - 1, **facts})
        return len(accessors) - 1

    for name, (material, vertices, faces) in OBJECTS.items():
        corners = [c for face in faces for i in range(1, len(face) - 1) for c in (face[0], face[i], face[i + 1])]
        axes = list(zip(*vertices))
        position = accessor([x for vertex in vertices for x in vertex], "f", componentType=5126, type="VEC3",
                            count=len(vertices), min=[min(axis) for axis in axes], max=[max(axis) for axis in axes])
        indices = accessor(corners, "H", componentType=5123, type="SCALAR", count=len(corners))
        meshes.append({"name": name, "primitives": [{"attributes": {"POSITION": position}, "indices": indices,
                                                     "material": list(COLOURS).index(material)}]})
        nodes.append({"name": name, "mesh": len(meshes) - 1})
    nodes.append({"name": "camera", "camera": 0, "matrix": camera_matrix()})
    materials = [{"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0}}
                 for name, colour in COLOURS.items()]
    strength = max(RADIANCE)
    materials[-1] |= {"emissiveFactor": [x / strength for x in RADIANCE],
                      "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}}
    parts = {"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_emissive_strength"], "scene": 0,
             "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
             "cameras": [{"type": "perspective", "perspective": {
                 "yfov": round(math.radians(ANGLE), 9), "aspectRatio": 1, "znear": 0.01}}],
             "materials": materials, "meshes": meshes, "accessors": accessors, "bufferViews": views,
             "buffers": [{"byteLength": len(buffer), "uri": "data:application/octet-stream;base64," +
                          base64.b64encode(buffer).decode()}]}
    return "{\n" + ",\n".join(f'"{key}": {json.dumps(value)}' for key, value in parts.items()) + "\n}\n"


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w") as file:
        file.write(text)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for name in OBJECTS:
        write(os.path.join(sys.argv[1], "meshes", name + ".obj"), obj([name], False))
    write(os.path.join(sys.argv[1], "tinyrender.obj"), obj(OBJECTS, True))
    write(os.path.join(sys.argv[1], "gltf.gltf"), gltf())
