"""Prints mikktspace.inc: the tangents that Blender 5.0 itself computes for small meshes, for mikktspace_test.cpp.

    python3 tests/scenes/mikktspace.py > tests/scenes/mikktspace.inc    # with the package bpy
"""

import math
import random

import bpy


def mesh_of(name, positions, triangles, uvs, smooth):
    """uvs: of each corner of each triangle."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(positions, [], triangles)
    mesh.shade_smooth() if smooth else mesh.shade_flat()
    layer = mesh.uv_layers.new(name="uv")
    for corner, uv in zip(layer.uv, uvs, strict=True):
        corner.vector = uv
    mesh.calc_tangents(uvmap="uv")
    return mesh


def globe(columns=5, rows=4):
    """A sphere of longitude and latitude: a seam in u, and poles where triangles have coordinates of their own."""
    def point(i, j):
        along, down = 2 * math.pi * i / columns, math.pi * j / rows
        return (math.sin(down) * math.cos(along), math.sin(down) * math.sin(along), math.cos(down))

    positions, number = [], {}

    def vertex(i, j):
        key = (0 if j in {0, rows} else i % columns, j)
        if key not in number:
            number[key] = len(positions)
            positions.append(point(*key))
        return number[key]

    triangles, uvs = [], []
    for i in range(columns):
        for j in range(rows):
            quads = [[(i, j), (i, j + 1), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i + 1, j)]]
            for triangle in quads:
                if len({vertex(*corner) for corner in triangle}) == 3:
                    triangles.append([vertex(*corner) for corner in triangle])
                    uvs += [(a / columns, 1 - b / rows) for a, b in triangle]
    return positions, triangles, uvs


def hill(uv_of, size=4):
    """A bumpy square. uv_of(x, y, triangle): texture coordinates."""
    generator = random.Random(5)
    heights = [[0.4 * generator.random() for _ in range(size)] for _ in range(size)]
    positions = [(x, y, heights[y][x]) for y in range(size) for x in range(size)]
    triangles, uvs = [], []
    for y in range(size - 1):
        for x in range(size - 1):
            for corners in ([(x, y), (x + 1, y), (x + 1, y + 1)], [(x, y), (x + 1, y + 1), (x, y + 1)]):
                uvs += [uv_of(*corner, len(triangles)) for corner in corners]
                triangles.append([a + size * b for a, b in corners])
    return positions, triangles, uvs


SKEW = random.Random(11)
SKEWED = {(x, y): (x / 4 + 0.15 * SKEW.random(), y / 4 + 0.15 * SKEW.random()) for x in range(4) for y in range(4)}
MESHES = {
    "globe": (*globe(), True),
    "skewed": (*hill(lambda x, y, triangle: SKEWED[x, y]), True),
    # u falls again beyond the middle: neighbours whose corners are equal have opposite orientations.
    "mirrored": (*hill(lambda x, y, triangle: (abs(x - 2) / 4, y / 4)), True),
    # All corners of two triangles have one place in the texture.
    "collapsed": (*hill(lambda x, y, triangle: (0.5, 0.5) if triangle in {7, 8} else (x / 4, y / 4 + x * x / 40)), True),
    # A column of triangles without area in the texture that share its edges with others.
    "pinched": (*hill(lambda x, y, triangle: (min(x, 1) / 4 + max(x - 2, 0) / 4, y / 4)), True),
    "faceted": (*hill(lambda x, y, triangle: SKEWED[x, y], 3), False),
}


def numbers(values):
    return ", ".join(f"{value:.9g}" for value in values)


print("// Written by mikktspace.py: positions, normals, texture coordinates, tangents and signs of corners.")
print("// clang-format off")
for name, made in MESHES.items():
    mesh = mesh_of(name, *made)
    print(f"const std::vector<Corner> k{name.capitalize()} = {{")
    for loop, uv in zip(mesh.loops, mesh.uv_layers["uv"].uv, strict=True):
        print(f"{{{{{numbers(mesh.vertices[loop.vertex_index].co)}}}, {{{numbers(loop.normal)}}}, {{{numbers(uv.vector)}}}, "
              f"{{{numbers([*loop.tangent, loop.bitangent_sign])}}}}},")
    print("};")
print("// clang-format on")
