"""Meshes and Mitsuba XML for the generators of the gallery."""

import math
import os
import struct
import sys


class Mesh:
    """Triangles with normals and texture coordinates."""

    def __init__(self):
        self.vertices = []  # (x, y, z, nx, ny, nz, u, v)
        self.faces = []

    def write(self, path):
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(self.vertices)}"]
        header += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz", "u", "v")]
        header += [f"element face {len(self.faces)}", "property list uchar int vertex_indices", "end_header", ""]
        with open(path, "wb") as file:
            file.write("\n".join(header).encode())
            for vertex in self.vertices:
                file.write(struct.pack("<8f", *vertex))
            for face in self.faces:
                file.write(struct.pack("<B3i", 3, *face))

    def quad(self, a, b, c, d, uv=None):
        """A flat quadrilateral, counter-clockwise from its front. Texture coordinates are lengths, unless given."""
        if uv is None:
            u, v = math.dist(a, b), math.dist(a, d)
            uv = [(0, 0), (u, 0), (u, v), (0, v)]
        normal = cross(difference(c, a), difference(d, b))
        normal = [x / length(normal) for x in normal]
        first = len(self.vertices)
        self.vertices += [(*p, *normal, *t) for p, t in zip((a, b, c, d), uv)]
        self.faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]

    def box(self, low, high, offset=(0, 0)):
        """Texture coordinates are world coordinates along the two longest sides of each face, plus the offset."""
        corners = [[(high if i >> axis & 1 else low)[axis] for axis in range(3)] for i in range(8)]
        for face in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
            points = [corners[i] for i in face]
            flat = next(axis for axis in range(3) if len({p[axis] for p in points}) == 1)
            u, v = [axis for axis in range(3) if axis != flat]
            self.quad(*points, uv=[(p[u] + offset[0], p[v] + offset[1]) for p in points])

    def grid(self, points, closed=False):
        """A smooth surface through rows of points; its front is where columns x rows points to. `closed`: rows are
        rings, and their last point is their first."""
        rows, columns = len(points), len(points[0])
        first = len(self.vertices)

        def along(i, j):
            if closed:
                left, right = (j - 1) % (columns - 1), (j + 1) % (columns - 1)
            else:
                left, right = max(j - 1, 0), min(j + 1, columns - 1)
            return difference(points[i][right], points[i][left])

        for i in range(rows):
            for j in range(columns):
                u = along(i, j)
                if length(u) < 1e-6:  # at a pole: a ring beside it has the direction
                    u = max((along(k, j) for k in (i - 1, i + 1) if 0 <= k < rows), key=length)
                normal = cross(u, difference(points[min(i + 1, rows - 1)][j], points[max(i - 1, 0)][j]))
                scale = 1 / (length(normal) or 1)
                self.vertices.append((*points[i][j], *(x * scale for x in normal), j / (columns - 1), i / (rows - 1)))
        for i in range(rows - 1):
            for j in range(columns - 1):
                a, b = first + i * columns + j, first + (i + 1) * columns + j
                if points[i][j] != points[i][j + 1]:
                    self.faces.append((a, a + 1, b + 1))
                if points[i + 1][j] != points[i + 1][j + 1]:
                    self.faces.append((a, b + 1, b))

    def lathe(self, profile, centre=(0, 0, 0), segments=128, radius=lambda angle, r, z: r):
        """Turns (r, z) about the z axis; a profile that goes up has its front outside."""
        rings = []
        for r, z in profile:
            ring = []
            for j in range(segments):
                angle = 2 * math.pi * j / segments
                s = radius(angle, r, z) if r > 0 else 0.0
                ring.append((centre[0] + s * math.cos(angle), centre[1] + s * math.sin(angle), centre[2] + z))
            rings.append(ring + ring[:1])
        self.grid(rings, closed=True)

    def tube(self, path, radius, segments=12):
        """A tube along points; its ends are open."""
        rings = []
        for i, p in enumerate(path):
            along = difference(path[min(i + 1, len(path) - 1)], path[max(i - 1, 0)])
            side = cross(along, (0, 0, 1) if abs(along[2]) < 0.9 * length(along) else (1, 0, 0))
            up = cross(along, side)
            side, up = ([x / length(v) for x in v] for v in (side, up))
            ring = []
            for j in range(segments):
                c, s = math.cos(-2 * math.pi * j / segments), math.sin(-2 * math.pi * j / segments)
                ring.append(tuple(p[k] + radius * (c * side[k] - s * up[k]) for k in range(3)))
            rings.append(ring + ring[:1])
        self.grid(rings, closed=True)


def difference(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(sum(x * x for x in a))


def spline(points, steps=8):
    """A smooth line through points (Catmull and Rom)."""
    line = []
    for i in range(len(points) - 1):
        p0, p1, p2 = points[max(i - 1, 0)], points[i], points[i + 1]
        p3 = points[min(i + 2, len(points) - 1)]
        chord = [max(math.dist(a, b), 1e-9)**0.5 for a, b in ((p0, p1), (p1, p2), (p2, p3))]
        for step in range(steps):
            t = step / steps
            value = []
            for a, b, c, d in zip(p0, p1, p2, p3):
                m1 = chord[1] * ((b - a) / chord[0] - (c - a) / (chord[0] + chord[1]) +
                                 (c - b) / chord[1]) if i else c - b
                m2 = (chord[1] * ((c - b) / chord[1] - (d - b) / (chord[1] + chord[2]) + (d - c) / chord[2]) if i +
                      2 < len(points) else c - b)
                value.append(b + m1 * t + (3 * (c - b) - 2 * m1 - m2) * t * t + (2 * (b - c) + m1 + m2) * t**3)
            line.append(tuple(value))
    return line + [tuple(points[-1])]


def numbers(values):
    return ", ".join(f"{x:.6g}" for x in values)


class Scene:
    """A Mitsuba scene and its meshes, in the folder that the command line names unless one is given."""

    def __init__(self, name, folder=None):
        if folder is None:
            if len(sys.argv) != 2:
                sys.exit(f"usage: {sys.argv[0]} FOLDER")
            folder = sys.argv[1]
        self.folder, self.name = folder, name
        os.makedirs(self.folder, exist_ok=True)
        self.parts = []

    def add(self, xml):
        self.parts.append(xml.strip("\n"))

    def mesh(self, name, mesh, content):
        """Content: its BSDF and the like."""
        file = f"{self.name}-{name}.ply"
        mesh.write(os.path.join(self.folder, file))
        self.add(f'<shape type="ply" id="{name}"><string name="filename" value="{file}"/>{content}</shape>')

    def sphere(self, centre, radius, content):
        x, y, z = (f"{c:.6g}" for c in centre)
        self.add(f'<shape type="sphere"><point name="center" x="{x}" y="{y}" z="{z}"/>'
                 f'<float name="radius" value="{radius:.6g}"/>{content}</shape>')

    def write(self):
        with open(os.path.join(self.folder, f"{self.name}.xml"), "w", encoding="utf-8") as file:
            file.write('<scene version="3.0.0">\n' + "\n".join(self.parts) + "\n</scene>\n")


def ref(name):
    return f'<ref id="{name}"/>'


def light(colour):
    return f'<emitter type="area"><rgb name="radiance" value="{numbers(colour)}"/></emitter>'
