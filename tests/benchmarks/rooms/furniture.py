"""Meshes of the rooms, in metres, z up: one function per kind of furniture. Each returns a Mesh or several."""

import math
import os
import random
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../scenes/gallery"))
from modelling import Mesh, spline  # noqa: E402


def boxes(*corners):
    """Boxes from pairs of opposite corners."""
    mesh = Mesh()
    for low, high in corners:
        mesh.box(low, high)
    return mesh


def wall(axis, at, width, height, holes=(), scale=1.0):
    """A wall in the plane x = at or y = at, with holes (start, bottom, end, top). Texture coordinates are metres
    * scale."""
    mesh = Mesh()
    xs = sorted({0, width, *(h[0] for h in holes), *(h[2] for h in holes)})
    zs = sorted({0, height, *(h[1] for h in holes), *(h[3] for h in holes)})
    for a, b in zip(xs, xs[1:]):
        for low, high in zip(zs, zs[1:]):
            if any(h[0] <= a and b <= h[2] and h[1] <= low and high <= h[3] for h in holes):
                continue
            corners = [(a, low), (b, low), (b, high), (a, high)]
            points = [(at, s, z) if axis == "x" else (s, at, z) for s, z in corners]
            mesh.quad(*points, uv=[(s * scale, z * scale) for s, z in corners])
    return mesh


def slab(x0, y0, x1, y1, z, scale=1.0, down=False):
    """A floor, or a ceiling that looks down."""
    points = [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]
    mesh = Mesh()
    points = points[::-1] if down else points
    mesh.quad(*points, uv=[(x * scale, y * scale) for x, y, _ in points])
    return mesh


def window(axis, at, hole, outwards, panes):
    """Frame with bars, and panes of glass with a thickness that end within the frame."""
    a, low, b, high = hole
    near, far = sorted((at, at + 0.2 * outwards))
    frame, glass = Mesh(), Mesh()

    def put(mesh, s0, z0, s1, z1, d0, d1):
        mesh.box((d0, s0, z0), (d1, s1, z1)) if axis == "x" else mesh.box((s0, d0, z0), (s1, d1, z1))

    for s0, z0, s1, z1 in ((a - 0.03, low - 0.05, b + 0.03, low), (a - 0.03, high, b + 0.03, high + 0.05),
                           (a - 0.05, low - 0.03, a, high + 0.03), (b, low - 0.03, b + 0.05, high + 0.03)):
        put(frame, s0, z0, s1, z1, near, far)
    middle = (near + far) / 2
    for i in range(1, panes):
        s = a + (b - a) * i / panes
        put(frame, s - 0.02, low, s + 0.02, high, middle - 0.03, middle + 0.03)
    put(glass, a - 0.01, low - 0.01, b + 0.01, high + 0.01, middle - 0.004, middle + 0.004)
    return frame, glass


def pane(axis, at, hole):
    a, low, b, high = hole
    mesh = Mesh()
    corners = [(a, low), (b, low), (b, high), (a, high)]
    mesh.quad(*[(at, s, z) if axis == "x" else (s, at, z) for s, z in corners], uv=[(0, 0), (1, 0), (1, 1), (0, 1)])
    return mesh


def table(x, y, width, depth, height=0.75):
    leg, x1, y1 = 0.06, x + width, y + depth
    legs = [((px, py, 0), (px + leg, py + leg, height - 0.04)) for px in (x + 0.05, x1 - 0.11)
            for py in (y + 0.05, y1 - 0.11)]
    return boxes(((x, y, height - 0.04), (x1, y1, height)), *legs)


def chair(x, y, turned=1):
    """`turned`: 1, its back is at the greater y."""
    back = y + 0.2 * turned
    low, high = sorted((back, back + 0.04 * turned))
    legs = [((px, py, 0), (px + 0.04, py + 0.04, 0.45)) for px in (x - 0.2, x + 0.16) for py in (y - 0.2, y + 0.16)]
    bars = [((px, low, 0.49), (px + 0.03, high, 1.0)) for px in (x - 0.2, x - 0.1, x, x + 0.1, x + 0.17)]
    return boxes(((x - 0.22, y - 0.22, 0.45), (x + 0.22, y + 0.22, 0.49)),
                 ((x - 0.21, low, 0.95), (x + 0.21, high, 1.02)), *legs, *bars)


def sheet(columns, rows, point):
    """A smooth surface: point(u, v)."""
    mesh = Mesh()
    mesh.grid([[point(i / columns, j / rows) for i in range(columns + 1)] for j in range(rows + 1)])
    return mesh


def cushion(x, y, z, width, depth, height, size=48):
    """A soft block, closed but for its underside."""

    def point(u, v):
        a, b = 2 * u - 1, 2 * v - 1
        swell = ((1 - a**8) * (1 - b**8))**0.35
        return (x + width * u, y + depth * v, z + height * swell * (1 + 0.04 * math.sin(9 * u + 4 * v)))

    return sheet(size, size, point)


def rug(x, y, width, depth, columns, rows, seed):
    """Pile: heights at random."""
    numbers = random.Random(seed)
    return sheet(columns, rows, lambda u, v: (x + width * u, y + depth * v, 0.004 + 0.012 * numbers.random()))


def curtain(x, y, width, height, along="x", folds=9, columns=240, rows=60):

    def point(u, v):
        deep = 0.05 * math.sin(2 * math.pi * folds * u + 0.6 * math.sin(5 * v)) * (0.6 + 0.4 * v)
        s, z = width * u, height * v + 0.03
        return (x + s, y + deep, z) if along == "x" else (x + deep, y + s, z)

    return sheet(columns, rows, point)


def turned(profile, centre, segments=96, steps=6):
    """A smooth body of revolution through (r, z)."""
    mesh = Mesh()
    mesh.lathe([(max(r, 0.0), z) for r, z, _ in spline([(r, z, 0) for r, z in profile], steps)], centre, segments)
    return mesh


def vase(centre, size=0.3, segments=96):
    """Closed, with a thick wall."""
    outside = [(0, 0), (0.25, 0), (0.38, 0.15), (0.42, 0.4), (0.22, 0.75), (0.2, 0.85), (0.3, 1.0)]
    inside = [(0.26, 0.99), (0.16, 0.85), (0.18, 0.75), (0.37, 0.4), (0.33, 0.17), (0.2, 0.06), (0, 0.05)]
    return turned([(r * size, z * size) for r, z in outside + inside], centre, segments)


def tumbler(centre, radius=0.035, height=0.11, segments=96):
    wall_, foot = radius * 0.08, radius * 0.3
    return turned([(0, 0), (radius * 0.8, 0), (radius * 0.88, radius * 0.1), (radius, height),
                   (radius - wall_ / 2, height + wall_ / 2), (radius - wall_, height),
                   (radius * 0.8 - wall_, foot * 1.3), (radius * 0.7, foot), (0, foot)], centre, segments)


def goblet(centre, size=0.2, segments=96):
    outside = [(0, 0), (0.3, 0), (0.3, 0.03), (0.05, 0.08), (0.04, 0.4), (0.2, 0.5), (0.32, 0.7), (0.28, 1.0)]
    inside = [(0.27, 1.01), (0.26, 1.0), (0.3, 0.7), (0.18, 0.53), (0, 0.48)]
    return turned([(r * size, z * size) for r, z in outside + inside], centre, segments)


def bottle(centre, size=0.3, segments=64):
    return turned([(r * size, z * size)
                   for r, z in ((0, 0), (0.13, 0), (0.15, 0.03), (0.15, 0.5), (0.13, 0.62), (0.05, 0.75), (0.05, 0.97),
                                (0.06, 1.0), (0, 1.0))], centre, segments)


def bowl(centre, radius=0.15, segments=128):
    r = radius
    return turned([(0, 0), (0.4 * r, 0), (0.85 * r, 0.3 * r), (r, 0.65 * r), (0.97 * r, 0.66 * r), (0.93 * r, 0.63 * r),
                   (0.78 * r, 0.33 * r), (0.3 * r, 0.07 * r), (0, 0.06 * r)], centre, segments)


def teapot(centre, size=0.25):
    """Body, and spout and handle."""
    body = turned([(r * size, z * size) for r, z in ((0, 0), (0.35, 0), (0.5, 0.2), (0.5, 0.4), (0.3, 0.62),
                                                     (0.08, 0.66), (0.05, 0.7), (0.08, 0.76), (0, 0.8))], centre, 128)
    at = lambda points: [tuple(c + size * p for c, p in zip(centre, (x, 0, z))) for x, z in points]  # noqa: E731
    body.tube(spline(at([(0.42, 0.2), (0.6, 0.3), (0.65, 0.5), (0.8, 0.6)])), 0.05 * size, 32)
    body.tube(spline(at([(-0.4, 0.5), (-0.7, 0.55), (-0.75, 0.3), (-0.46, 0.15)])), 0.03 * size, 24)
    return body


def tap(x, y, z, reach=0.18):
    mesh = Mesh()
    mesh.tube(
        spline([(x, y, z), (x, y, z + 0.2), (x, y - reach / 2, z + 0.28), (x, y - reach, z + 0.2),
                (x, y - reach, z + 0.17)]), 0.015, 32)
    return mesh


def lampshade(centre, radius=0.16, height=0.22):
    mesh = Mesh()
    mesh.lathe([(radius, 0), (radius * 0.92, height * 0.33), (radius * 0.7, height)], centre, 64)
    return mesh


def knot(centre, size, rings=1200, segments=48, p=2, q=3):
    """A tube along a torus knot."""
    mesh = Mesh()
    path = []
    for i in range(rings + 1):
        t = 2 * math.pi * i / rings
        r = 0.35 + 0.13 * math.cos(q * t)
        path.append(
            tuple(c + size * x
                  for c, x in zip(centre, (r * math.cos(p * t), r * math.sin(p * t), 0.5 + 0.3 * math.sin(q * t)))))
    mesh.tube(path, 0.07 * size, segments)
    return mesh


def statue(centre, size, rings, segments, seed):
    """A lump with folds, smooth and fine: rings * segments * 2 triangles."""
    numbers = random.Random(seed)
    waves = [(numbers.randrange(2, 24), numbers.uniform(2, 40), numbers.uniform(0, 6.3)) for _ in range(5)]

    def radius(angle, r, z):
        return r * (1 + sum(0.25 / (n + 3) * math.sin(n * angle + k * z / size + s) for n, k, s in waves))

    mesh = Mesh()
    profile = []
    for i in range(rings + 1):
        t = i / rings
        profile.append(
            (size * 0.3 * math.sin(math.pi * t)**0.6 * (1 + 0.35 * math.sin(7 * t)) if 0 < i < rings else 0.0,
             size * t))
    mesh.lathe(profile, centre, segments, radius)
    return mesh


def plant(centre, leaves, height, seed, size=1.0):
    """Leaves of 12 triangles each and 0.12 to 0.3 * size; texture coordinates go once over a leaf."""
    numbers = random.Random(seed)
    mesh = Mesh()
    for _ in range(leaves):
        a, rise, long = numbers.uniform(0, 6.28), numbers.uniform(0.1, 1) * height, numbers.uniform(0.12, 0.3) * size
        out, side = (math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a))
        bend, start = numbers.uniform(0.2, 1.2), numbers.uniform(0, 0.1) * size
        rows = []
        for j in range(4):
            t = j / 3
            rows.append([
                tuple(centre[k] + out[k] * (start + long * t) + side[k] * w * long * 0.5
                      for k in (0, 1)) + (centre[2] + rise + long * t * (0.6 - bend * t), ) for w in (-0.5, 0, 0.5)
            ])
        mesh.grid(rows)
    return mesh


def book(low, high):
    """Cover and pages."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    cover = boxes(((x0, y0, z0), (x0 + 0.003, y1, z1)), ((x1 - 0.003, y0, z0), (x1, y1, z1)),
                  ((x0, y0 - 0.003, z0), (x1, y0, z1)))
    return cover, boxes(((x0 + 0.003, y0, z0 + 0.004), (x1 - 0.003, y1 - 0.005, z1 - 0.004)))


def shelf(x, y, width, height, depth=0.3, rows=5):
    boards = [((x, y, height * i / rows), (x + width, y + depth, height * i / rows + 0.025)) for i in range(rows + 1)]
    sides = [((px, y, 0), (px + 0.03, y + depth, height + 0.025)) for px in (x - 0.03, x + width)]
    return boxes(*boards, *sides, ((x - 0.03, y + depth, 0), (x + width + 0.03, y + depth + 0.01, height + 0.025)))


def prism(base, along):
    """A quadrilateral, counter-clockwise as `along` points away from the eye, swept along a vector: sloped beams and
    plates."""
    mesh = Mesh()
    end = [tuple(a + b for a, b in zip(p, along)) for p in base]
    mesh.quad(*base)
    mesh.quad(*end[::-1])
    for i in range(4):
        k = (i + 1) % 4
        mesh.quad(base[k], base[i], end[i], end[k])
    return mesh


def pod(centre, stations, power=0.6, rings=96, segments=96):
    """A smooth hull along x through stations (x, half width, lowest z, highest z) of rounded sections; smaller powers
    are more angular. Its ends are closed where the width is 0."""
    mesh, rows = Mesh(), []
    line = spline([(x, w, low) for x, w, low, _ in stations], rings // len(stations))
    top = spline([(x, w, high) for x, w, _, high in stations], rings // len(stations))
    for (x, w, low), (_, _, high) in zip(line, top):
        ring = []
        for j in range(segments):
            c, s = math.cos(2 * math.pi * j / segments), math.sin(2 * math.pi * j / segments)
            across, up = (math.copysign(abs(t)**power, t) for t in (c, s))
            ring.append(
                (centre[0] + x, centre[1] + max(w, 0) * across, centre[2] + (low + high) / 2 + (high - low) / 2 * up))
        rows.append(ring + ring[:1])
    mesh.grid(rows, closed=True)
    return mesh


def rock(centre, size, seed, count=24, power=0.6):
    """A lump of 2 * count^2 triangles with half axes `size`; smaller powers are more like a block."""
    numbers = random.Random(seed)
    waves = [(numbers.randrange(1, 7), numbers.randrange(1, 7), numbers.uniform(0, 6.3)) for _ in range(6)]

    def point(u, v):
        a, b = 2 * math.pi * u, math.pi * (v - 0.5)
        across = math.cos(b) if 0 < v < 1 else 0.0  # exactly one point at a pole
        rough = 1 + sum(0.04 * math.sin(n * a + s) * math.cos(m * b) * across for n, m, s in waves)
        direction = (math.cos(a) * across, math.sin(a) * across, math.sin(b))
        return tuple(c + s * rough * math.copysign(abs(d)**power, d) for c, s, d in zip(centre, size, direction))

    return sheet(count, count, point)


def column(centre, radius, height, seed, columns, rows):
    """A fluted shaft with a broken top."""
    numbers = random.Random(seed)
    waves = [(numbers.randrange(1, 9), numbers.uniform(0.3, 1), numbers.uniform(0, 6.3)) for _ in range(6)]

    def point(u, v):
        angle = 2 * math.pi * u
        up = min(v / 0.9, 1)
        inwards = 1 - max(v - 0.9, 0) / 0.1 if v < 1 else 0.0
        jag = sum(k * math.sin(n * angle * inwards + s) for n, k, s in waves)
        chips = sum(math.sin(n * angle + 9 * k * up * height + s) for n, k, s in waves)
        r = radius * inwards * (1 - 0.12 * up + 0.03 * math.cos(20 * angle) + 0.008 * chips)
        z = up * (height + radius * 0.25 * jag) if v < 0.9 else height + radius * 0.25 * jag
        return (centre[0] + r * math.cos(angle), centre[1] + r * math.sin(angle), centre[2] + z)

    return sheet(columns, rows, point)


def wheel(radius=0.32, width=0.22):
    """About the z axis from 0 to `width`: a tyre, and a rim with its hub."""
    r, w = radius, width
    tyre = turned([(0.66 * r, 0), (0.94 * r, 0), (r, 0.2 * w), (r, 0.8 * w), (0.94 * r, w), (0.66 * r, w)], (0, 0, 0),
                  96)
    rim = turned([(0, 0.3 * w), (0.1 * r, 0.3 * w), (0.2 * r, 0.6 * w), (0.55 * r, 0.7 * w), (0.68 * r, 0.1 * w)],
                 (0, 0, 0), 96)
    return tyre, rim
