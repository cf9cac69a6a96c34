"""Textures as PNG files and a sky as a Radiance file, by the standard library alone."""

import math
import os
import random
import struct
import zlib


def write_png(path, rows):
    """Rows from the top of (r, g, b) in [0, 1], encoded values."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    lines = bytearray()
    for row in rows:
        lines.append(0)
        for colour in row:
            lines.extend(int(min(max(c, 0), 1) * 255 + 0.5) for c in colour)
    header = struct.pack(">2I5B", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(lines), 6)) +
                   chunk(b"IEND", b""))


def write_hdr(path, rows):
    """Rows from the top of linear (r, g, b)."""
    with open(path, "wb") as file:
        file.write(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {len(rows)} +X {len(rows[0])}\n".encode())
        for row in rows:
            for colour in row:
                exponent = math.frexp(max(max(colour), 1e-30))[1]
                file.write(bytes([min(int(c * 2.0**(8 - exponent)), 255) for c in colour] + [exponent + 128]))


class Noise:
    """Value noise in octaves that repeats after 1 in u and v, in [0, 1]."""

    def __init__(self, seed, octaves=((4, 4), (8, 8), (16, 16), (32, 32))):
        numbers = random.Random(seed)
        self.octaves = [(w, h, [[numbers.random() for _ in range(w)] for _ in range(h)]) for w, h in octaves]

    def __call__(self, u, v):
        total, weight, left = 0.0, 0.5, 1.0
        for w, h, table in self.octaves:
            x, y = u % 1 * w, v % 1 * h
            i, j = int(x), int(y)
            s, t = x - i, y - j
            s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
            i, j = i % w, j % h
            above, below = table[j], table[(j + 1) % h]
            k = (i + 1) % w
            total += weight * ((above[i] * (1 - s) + above[k] * s) * (1 - t) + (below[i] * (1 - s) + below[k] * s) * t)
            left -= weight
            weight /= 2
        return total / (1 - left)


def mixed(a, b, t):
    t = min(max(t, 0), 1)
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def grey(value):
    return (value, value, value)


def wood(seed, dark, bright):
    grain, rings = Noise(seed, ((32, 2), (128, 4), (256, 8))), Noise(seed + 1, ((4, 2), (8, 2)))
    return lambda u, v: mixed(dark, bright, 0.6 * grain(u, v) + 0.4 * (0.5 + 0.5 * math.sin(40 * rings(u, v))))


def marble(seed, ground, vein):
    noise = Noise(seed)
    return lambda u, v: mixed(ground, vein, max(0, 1 - 9 * abs(noise(u, v) - 0.5)))


def mottled(seed, dark, bright):
    noise = Noise(seed, ((4, 4), (8, 8), (32, 32), (128, 128)))
    return lambda u, v: mixed(dark, bright, 1.6 * noise(u, v) - 0.3)


def cloth(seed, a, b, threads=32):
    noise = Noise(seed, ((64, 64), (128, 128)))

    def colour(u, v):
        weave = math.sin(2 * math.pi * threads * u) * math.sin(2 * math.pi * threads * v)
        return mixed(a, b, 0.5 + 0.35 * weave + 0.4 * (noise(u, v) - 0.5))

    return colour


def tiles(seed, colours, joint, count=8):
    numbers = random.Random(seed)
    table = [[numbers.choice(colours) for _ in range(count)] for _ in range(count)]
    noise = Noise(seed, ((64, 64), ))

    def colour(u, v):
        x, y = u * count % count, v * count % count
        if min(x % 1, y % 1) < 0.05:
            return joint
        return mixed(table[int(y)][int(x)], joint, 0.2 * noise(u, v))

    return colour


def stripes(a, b, count=8):
    return lambda u, v: a if u * count % 1 < 0.5 else b


def scratches(seed, low, high):
    noise = Noise(seed, ((8, 8), (128, 4), (16, 256)))
    return lambda u, v: grey(low + (high - low) * noise(u, v))


def bumps(seed):
    noise = Noise(seed, ((16, 16), (32, 32), (64, 64)))
    return lambda u, v: grey(noise(u, v))


def waves(seed):
    """A normal map: the slopes of a noise."""
    noise = Noise(seed, ((8, 8), (16, 16)))

    def normal(u, v):
        step = 1 / 256
        x, y = (noise(u - step, v) - noise(u + step, v)) * 8, (noise(u, v - step) - noise(u, v + step)) * 8
        scale = 1 / math.sqrt(x * x + y * y + 1)
        return (0.5 + 0.5 * x * scale, 0.5 + 0.5 * y * scale, 0.5 + 0.5 * scale)

    return normal


def leaf(u, v):
    """An opacity: a leaf along v."""
    return grey(1 if abs(u - 0.5) < 0.42 * math.sin(math.pi * v)**0.8 else 0)


def lace(u, v):
    x, y = u * 12 % 1 - 0.5, v * 12 % 1 - 0.5
    return grey(0.15 if x * x + y * y < 0.12 else 0.95)


TEXTURES = {
    "oak": (wood(1, (0.35, 0.2, 0.1), (0.68, 0.46, 0.27)), 512),
    "walnut": (wood(5, (0.16, 0.08, 0.05), (0.4, 0.24, 0.15)), 512),
    "marble": (marble(8, (0.88, 0.86, 0.83), (0.35, 0.34, 0.36)), 512),
    "slate": (marble(9, (0.2, 0.21, 0.24), (0.5, 0.5, 0.52)), 256),
    "red-cloth": (cloth(11, (0.35, 0.05, 0.06), (0.75, 0.2, 0.16)), 256),
    "blue-cloth": (cloth(12, (0.06, 0.12, 0.3), (0.35, 0.45, 0.7)), 256),
    "linen": (cloth(13, (0.62, 0.58, 0.5), (0.9, 0.88, 0.8), 64), 256),
    "white-tiles": (tiles(14, [(0.9, 0.9, 0.88), (0.86, 0.88, 0.88)], (0.45, 0.44, 0.42)), 256),
    "blue-tiles": (tiles(15, [(0.2, 0.45, 0.6), (0.25, 0.55, 0.62), (0.8, 0.85, 0.85)], (0.6, 0.6, 0.58)), 256),
    "chequers": (tiles(16, [(0.1, 0.1, 0.11), (0.85, 0.83, 0.78)], (0.4, 0.4, 0.4), 4), 256),
    "stripes": (stripes((0.85, 0.8, 0.7), (0.3, 0.42, 0.4)), 64),
    "wallpaper": (stripes((0.8, 0.76, 0.66), (0.74, 0.7, 0.6), 16), 128),
    "stone": (mottled(41, (0.36, 0.33, 0.28), (0.8, 0.75, 0.65)), 512),
    "asphalt": (mottled(42, (0.12, 0.12, 0.13), (0.36, 0.35, 0.34)), 256),
    "grass": (mottled(43, (0.16, 0.27, 0.1), (0.5, 0.47, 0.25)), 512),
    "smudges": (scratches(21, 0.08, 0.35), 256),
    "brushed": (scratches(22, 0.1, 0.5), 256),
    "bumps": (bumps(31), 256),
    "waves": (waves(32), 256),
    "leaf": (leaf, 128),
    "lace": (lace, 256),
}
PLAIN = {"smudges", "brushed", "bumps", "waves", "leaf", "lace"}  # numbers, not colours


def texture_file(folder, name):
    """Writes the texture unless it is there; its path relative to the folder."""
    path = os.path.join(folder, "textures", f"{name}.png")
    if not os.path.exists(path):
        os.makedirs(os.path.dirname(path), exist_ok=True)
        colour, size = TEXTURES[name]
        write_png(path, [[colour((x + 0.5) / size, (y + 0.5) / size) for x in range(size)] for y in range(size)])
    return f"textures/{name}.png"


def sky_file(folder, name, sun, azimuth, height, width=512):
    """A sky above z = 0 over a grey ground; the sun (a radiance; 0: overcast) covers about 3 degrees. Angles in
    degrees."""
    path = os.path.join(folder, "textures", f"{name}.hdr")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    clouds = Noise(71, ((4, 8), (8, 16), (32, 32)))
    towards = direction(azimuth, height)
    rows = []
    for y in range(width // 2):
        row = []
        for x in range(width):
            d = direction(90 - (x + 0.5) / width * 360, 90 - (y + 0.5) / width * 360)
            if d[2] < 0:
                row.append((0.22, 0.2, 0.17))
                continue
            cosine = sum(a * b for a, b in zip(d, towards))
            colour = mixed((1.1, 1.15, 1.2), (0.35, 0.6, 1.2), d[2])
            colour = mixed(colour, (1.4, 1.4, 1.4), 2.5 * clouds(x / width, y / width * 2) - 1.1)
            if sun > 0:
                glow = 2 * max(cosine, 0)**60
                colour = tuple(c + glow * g for c, g in zip(colour, (1, 0.8, 0.5)))
                if cosine > math.cos(math.radians(1.6)):
                    colour = (sun, 0.9 * sun, 0.75 * sun)
            row.append(colour)
        rows.append(row)
    write_hdr(path, rows)
    return f"textures/{name}.hdr"


def direction(azimuth, height):
    a, h = math.radians(azimuth), math.radians(height)
    return (math.cos(h) * math.cos(a), math.cos(h) * math.sin(a), math.sin(h))
