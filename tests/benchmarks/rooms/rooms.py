"""Writes the rooms on which renderers are compared: Mitsuba 3 scenes with their meshes and textures, as exporters write
them (independent samples, smooth meshes, two-sided materials). Usage: python3 rooms.py FOLDER [ROOM...]

Rooms of TUNING may be looked at while kernels are tuned. Those of HELD_BACK are only ever measured, so that gains on
them are gains on scenes that nobody tuned. Lengths are metres, z is up."""

import math
import os
import random
import struct
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "scenes", "gallery"))
from modelling import Mesh, Scene, light, numbers, ref

HALF_WIDTH, HALF_LENGTH, HEIGHT = 3.0, 6.0, 3.0
TABLE_TOP = 0.8


# Materials.


def rgb(name, colour):
    return f'<rgb name="{name}" value="{numbers(colour)}"/>'


def number(name, value):
    return f'<float name="{name}" value="{value:.6g}"/>'


def bsdf(kind, content=""):
    return f'<bsdf type="{kind}">{content}</bsdf>'


def two_sided(kind, content):
    return bsdf("twosided", bsdf(kind, content))


def matte(*colour):
    return two_sided("diffuse", rgb("reflectance", colour))


def plastic(alpha, colour):
    return two_sided("roughplastic", number("alpha", alpha) + rgb("diffuse_reflectance", colour))


def metal(name, alpha):
    return two_sided("roughconductor", f'<string name="material" value="{name}"/>' + number("alpha", alpha))


def glass(alpha=0.0, inside=1.5, outside=1.0):
    content = number("int_ior", inside) + number("ext_ior", outside)
    return bsdf("roughdielectric", number("alpha", alpha) + content) if alpha > 0 else bsdf("dielectric", content)


def bitmap(parameter, file, scale=1):
    return (f'<texture type="bitmap" name="{parameter}"><string name="filename" value="{file}"/>'
            f'<transform name="to_uv"><scale x="{scale}" y="{scale}"/></transform></texture>')


# Shapes and lights.


def write_png(path, size, channels, value):
    """`value(x, y)` returns the bytes of a pixel."""
    rows = b"".join(b"\0" + bytes(b for x in range(size) for b in value(x, y)) for y in range(size))
    header = struct.pack(">IIBBBBB", size, size, 8, {1: 0, 3: 2}[channels], 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for name, data in ((b"IHDR", header), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")):
            file.write(struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)))


class Room(Scene):
    """A scene with what all rooms share: the camera, and walls."""

    def __init__(self, folder, name, integrator="path", medium="", camera=((0, -5.4, 1.9), (0, 0, 1.1))):
        super().__init__(name, folder)
        self.random = random.Random(name)
        origin, target = (numbers(point) for point in camera)
        self.add(f"""{medium}
<integrator type="{integrator}"><integer name="max_depth" value="32"/></integrator>
<sensor type="perspective">
  <float name="fov" value="55"/>
  <transform name="to_world"><lookat origin="{origin}" target="{target}" up="0, 0, 1"/></transform>
  <sampler type="independent"><integer name="sample_count" value="64"/></sampler>
  <film type="hdrfilm">
    <integer name="width" value="480"/><integer name="height" value="270"/><rfilter type="box"/>
  </film>
  {ref("air") if medium else ""}
</sensor>""")

    def texture(self, name, size, channels, value):
        """Writes a PNG file and returns its name."""
        file = f"{self.name}-{name}.png"
        write_png(os.path.join(self.folder, file), size, channels, value)
        return file

    def walls(self, material, window=False, back=True):
        """`window`: a hole in the wall on the right, 4 by 1.5. Without `back` the wall behind the table is missing."""
        x, y, z = HALF_WIDTH, HALF_LENGTH, HEIGHT
        walls = Mesh()
        walls.quad((-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0))
        walls.quad((-x, -y, z), (-x, y, z), (x, y, z), (x, -y, z))
        walls.quad((x, -y, 0), (-x, -y, 0), (-x, -y, z), (x, -y, z))
        walls.quad((-x, -y, 0), (-x, y, 0), (-x, y, z), (-x, -y, z))
        if back:
            walls.quad((-x, y, 0), (x, y, 0), (x, y, z), (-x, y, z))
        if window:
            for y0, y1, z0, z1 in ((-y, -2, 0, z), (2, y, 0, z), (-2, 2, 0, 1), (-2, 2, 2.5, z)):
                walls.quad((x, y0, z0), (x, y1, z0), (x, y1, z1), (x, y0, z1))
        else:
            walls.quad((x, -y, 0), (x, y, 0), (x, y, z), (x, -y, z))
        self.mesh("walls", walls, material)

    def box(self, name, low, high, material):
        mesh = Mesh()
        mesh.box(low, high)
        self.mesh(name, mesh, material)

    def table(self, material):
        self.box("table top", (-1.6, -0.8, TABLE_TOP - 0.08), (1.6, 0.9, TABLE_TOP), material)
        for i, (x, y) in enumerate(((-1.5, -0.7), (1.5, -0.7), (-1.5, 0.8), (1.5, 0.8))):
            self.box(f"leg {i}", (x - 0.05, y - 0.05, 0), (x + 0.05, y + 0.05, TABLE_TOP - 0.08), material)

    def vase(self, name, x, y, material, segments=96, size=1.0):
        """A closed, thick-walled vase that stands on the table."""
        outside = [(0, 0), (0.3, 0), (0.42, 0.15), (0.45, 0.3), (0.38, 0.5), (0.25, 0.7), (0.2, 0.9), (0.3, 1.1)]
        inside = [(0.27, 1.1), (0.17, 0.9), (0.22, 0.7), (0.34, 0.5), (0.41, 0.3), (0.36, 0.12), (0, 0.06)]
        mesh = Mesh()
        mesh.lathe([(size * r, size * z) for r, z in outside + inside], (x, y, TABLE_TOP + 0.001), segments)
        self.mesh(name, mesh, material)

    def ball(self, x, y, radius, material):
        self.sphere((x, y, TABLE_TOP + radius + 0.001), radius, material)

    def panel(self, x, y, size, radiance):
        """A square light below the ceiling."""
        self.add(f'<shape type="rectangle"><transform name="to_world"><scale value="{size / 2}"/><rotate x="1" '
                 f'angle="180"/><translate x="{x}" y="{y}" z="{HEIGHT - 0.05}"/></transform>{light(radiance)}</shape>')

    def daylight(self):
        """A sky, and a sun that shines through the window."""
        self.add(f'<emitter type="constant">{rgb("radiance", (4, 5, 6))}</emitter>')
        self.sphere((60, -10, 40), 2.5, light((800, 760, 700)))

    def bumpy_ball(self, name, centre, radius, rows, material):
        """4 rows^2 triangles."""
        phase = self.random.uniform(0, 6)
        rings = []
        for i in range(rows + 1):
            polar = math.pi * (1 - i / rows)
            ring = []
            for j in range(2 * rows):
                turn = math.pi * j / rows
                r = radius * (1 + 0.06 * math.sin(9 * turn + phase) * math.sin(7 * polar) * math.sin(polar))
                ring.append((centre[0] + r * math.sin(polar) * math.cos(turn),
                             centre[1] + r * math.sin(polar) * math.sin(turn), centre[2] + r * math.cos(polar)))
            rings.append(ring + ring[:1])
        mesh = Mesh()
        mesh.grid(rings, closed=True)
        self.mesh(name, mesh, material)


# The rooms.


def glassware(folder):
    """Smooth and rough glass on a table."""
    room = Room(folder, "glassware")
    room.walls(matte(0.7, 0.65, 0.6))
    room.table(matte(0.5, 0.35, 0.2))
    room.panel(1, -1, 0.8, (40, 36, 30))
    room.vase("clear", -1, 0, glass())
    room.vase("frosted", 0.9, 0.2, glass(0.15))
    room.ball(0, -0.2, 0.3, glass())
    room.ball(-0.3, 0.5, 0.2, metal("Au", 0.1))
    room.write()


def bulbs(folder):
    """All light comes from spheres inside glass shells."""
    room = Room(folder, "bulbs")
    room.walls(matte(0.7, 0.65, 0.6))
    room.table(plastic(0.1, (0.4, 0.2, 0.1)))
    for x, y in ((-1, 0), (1, 0.5), (0, -1)):
        room.sphere((x, y, 2.1), 0.12, light((40, 35, 25)))
        room.sphere((x, y, 2.1), 0.19, glass(inside=1.0, outside=1.5))
        room.sphere((x, y, 2.1), 0.2, glass())
    room.ball(0, 0, 0.3, matte(0.6, 0.2, 0.2))
    room.write()


def window(folder):
    """Sun and sky behind a pane of glass."""
    room = Room(folder, "window")
    room.walls(matte(0.7, 0.65, 0.6), window=True)
    room.box("pane", (2.98, -2.02, 0.98), (3.02, 2.02, 2.52), glass())
    room.table(plastic(0.2, (0.45, 0.3, 0.2)))
    room.vase("porcelain", 0, 0, plastic(0.05, (0.8, 0.8, 0.75)))
    room.daylight()
    room.write()


def materials(folder):
    """Three hundred materials of all kinds, and a hundred small lights."""
    room = Room(folder, "materials")
    room.walls(matte(0.6, 0.6, 0.6))
    draw = room.random
    for i in range(300):
        colour = [draw.uniform(0.1, 0.8) for _ in range(3)]
        alpha = draw.uniform(0.03, 0.4)
        kinds = (matte(*colour), plastic(alpha, colour), metal(draw.choice(("Au", "Cu", "Al", "Ag")), alpha),
                 two_sided("plastic", rgb("diffuse_reflectance", colour)), glass(), glass(alpha),
                 two_sided("conductor", '<string name="material" value="Cr"/>'))
        room.sphere((0.36 * (i % 15) - 2.5, 0.36 * (i // 15 % 10) - 1.6, 0.3 + 1.2 * (i // 150)), 0.15,
                    kinds[i % len(kinds)])
    for i in range(100):
        room.sphere((draw.uniform(-2.8, 2.8), draw.uniform(-4, 5), 2.9), 0.03, light((60, 55, 50)))
    room.write()


def textures(folder):
    """Textured, bumpy two-sided plastics and metals, with textured roughness."""
    room = Room(folder, "textures")
    noise = [[room.random.random() for _ in range(64)] for _ in range(64)]

    def grain(x, y, stretch=1):
        return noise[int(x / stretch) % 64][y % 64]

    def wood_colour(x, y):
        tone = 0.6 + 0.4 * grain(x, y, 16) * (0.7 + 0.3 * math.sin(0.4 * y))
        return int(150 * tone), int(95 * tone), int(55 * tone)

    wood = room.texture("wood", 512, 3, wood_colour)
    tiles = room.texture("tiles", 512, 3, lambda x, y: (40, 42, 45) if x % 64 < 3 or y % 64 < 3 else
                         (int(170 + 60 * noise[x // 64][y // 64]), ) * 3)
    worn = room.texture("worn", 256, 1, lambda x, y: (int(30 + 120 * grain(x, y, 4)), ))
    dents = room.texture("dents", 256, 1,
                         lambda x, y: (int(127 + 60 * math.sin(0.4 * x) * math.sin(0.4 * y) + 20 * grain(x, y)), ))
    room.walls(two_sided("roughplastic", number("alpha", 0.3) + bitmap("diffuse_reflectance", tiles)))
    room.table(two_sided("roughplastic", number("alpha", 0.1) + bitmap("diffuse_reflectance", wood)))
    room.vase("copper", -0.9, 0, two_sided(
        "roughconductor", '<string name="material" value="Cu"/>' + bitmap("alpha", worn)))
    room.vase("painted", 0.9, 0.2, two_sided("plastic", bitmap("diffuse_reflectance", tiles, 4)))
    room.vase("dented", 0, -0.2, bsdf("twosided", bsdf("bumpmap", bitmap("arbitrary", dents, 3).replace(
        ' name="arbitrary"', "") + number("scale", 0.02) + bsdf(
            "roughconductor", '<string name="material" value="Al"/>' + number("alpha", 0.15)))))
    room.panel(0, -1, 1.5, (12, 11, 10))
    room.write()


def haze(folder):
    """A spot light in thin fog."""
    fog = ('<medium type="homogeneous" id="air">' + rgb("albedo", (0.9, 0.9, 0.9)) + number("sigma_t", 0.08) +
           '<phase type="hg"><float name="g" value="0.4"/></phase></medium>')
    room = Room(folder, "haze", "volpath", fog)
    room.walls(matte(0.5, 0.5, 0.5))
    room.table(matte(0.5, 0.35, 0.2))
    room.vase("white", 0, 0, matte(0.8, 0.8, 0.8))
    room.add('<emitter type="spot"><transform name="to_world"><lookat origin="-2, 1, 2.9" target="0.2, 0, 1" '
             f'up="0, 0, 1"/></transform>{rgb("intensity", (60, 60, 55))}<float name="cutoff_angle" value="25"/>'
             f'{ref("air")}</emitter>')
    room.panel(1, -2, 0.5, (8, 8, 9))
    room.write()


def cabinet(folder):
    """Objects behind glass."""
    room = Room(folder, "cabinet")
    room.walls(matte(0.7, 0.65, 0.6))
    for i, (low, high) in enumerate((((-1.5, 0.2, 0.8), (1.5, 0.22, 2.4)), ((-1.5, 1.6, 0.8), (1.5, 1.62, 2.4)),
                                     ((-1.52, 0.2, 0.8), (-1.5, 1.62, 2.4)), ((1.5, 0.2, 0.8), (1.52, 1.62, 2.4)))):
        room.box(f"pane {i}", low, high, glass())
    room.box("base", (-1.6, 0.1, 0), (1.6, 1.7, 0.79), matte(0.4, 0.3, 0.2))
    room.panel(1, -1, 0.8, (40, 36, 30))
    room.vase("blue", -0.8, 0.9, matte(0.7, 0.7, 0.8))
    room.vase("copper", 0.1, 0.9, metal("Cu", 0.2))
    room.vase("clear", 0.9, 0.9, glass())
    room.write()


def ajar(folder):
    """Light only comes through a door that is ajar."""
    room = Room(folder, "ajar")
    room.walls(matte(0.7, 0.65, 0.6), back=False)
    y = HALF_LENGTH
    wall = Mesh()
    for x0, x1, z0, z1 in ((-3, 0.5, 0, 3), (1.7, 3, 0, 3), (0.5, 1.7, 2.2, 3)):
        wall.quad((x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1))
    room.mesh("back", wall, matte(0.7, 0.65, 0.6))
    door = Mesh()
    door.quad((0.5, y, 0), (1.5, y + 0.65, 0), (1.5, y + 0.65, 2.2), (0.5, y, 2.2))
    room.mesh("door", door, plastic(0.2, (0.35, 0.2, 0.1)))
    beyond = Mesh()
    for a, b, c, d in (((-4, y, 0), (4, y, 0), (4, y + 4, 0), (-4, y + 4, 0)),
                       ((-4, y, 3), (-4, y + 4, 3), (4, y + 4, 3), (4, y, 3)),
                       ((-4, y + 4, 0), (4, y + 4, 0), (4, y + 4, 3), (-4, y + 4, 3)),
                       ((-4, y, 0), (-4, y + 4, 0), (-4, y + 4, 3), (-4, y, 3)),
                       ((4, y, 0), (4, y, 3), (4, y + 4, 3), (4, y + 4, 0))):
        beyond.quad(a, b, c, d)
    room.mesh("beyond", beyond, matte(0.8, 0.8, 0.8))
    room.add(f'<shape type="rectangle"><transform name="to_world"><scale value="0.6"/><rotate x="1" angle="180"/>'
             f'<translate x="-1" y="{y + 2.5}" z="2.95"/></transform>{light((150, 140, 130))}</shape>')
    room.table(matte(0.5, 0.35, 0.2))
    room.vase("porcelain", -0.8, 0, plastic(0.05, (0.8, 0.8, 0.75)))
    room.vase("copper", 0.1, 0, metal("Cu", 0.2))
    room.vase("clear", 0.9, 0, glass())
    room.write()


def caustics(folder):
    """A small lamp beside balls of smooth and rough glass, and mirrors."""
    room = Room(folder, "caustics")
    room.walls(matte(0.5, 0.5, 0.5))
    room.table(matte(0.6, 0.6, 0.6))
    room.sphere((-1.2, 0.2, 2.2), 0.12, light((220, 200, 180)))
    room.ball(0, 0, 0.35, glass())
    room.ball(0.8, -0.3, 0.25, glass(0.1))
    room.ball(-0.8, -0.4, 0.2, two_sided("conductor", '<string name="material" value="Ag"/>'))
    room.write()


def leaves(folder):
    """Masked leaves before a window without a pane."""
    room = Room(folder, "leaves")
    shape = room.texture("leaf", 128, 1, lambda x, y: (
        255 if abs(x - 64) < 40 * math.sin(math.pi * y / 128)**0.7 else 0, ))
    room.walls(matte(0.7, 0.65, 0.6), window=True)
    room.table(matte(0.5, 0.35, 0.2))
    draw = room.random
    mesh = Mesh()
    for _ in range(1500):
        p = [draw.uniform(1.5, 2.9), draw.uniform(-2, 2), draw.uniform(0.3, 2.6)]
        u, v = ([draw.gauss(0, 0.06) for _ in range(3)] for _ in range(2))
        a, b, c, d = ([p[k] + s * u[k] + t * v[k] for k in range(3)] for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
        mesh.quad(a, b, c, d, uv=[(0, 0), (1, 0), (1, 1), (0, 1)])
    room.mesh("leaves", mesh, bsdf("mask", bitmap("opacity", shape).replace(
        "</texture>", '<boolean name="raw" value="true"/></texture>') + matte(0.2, 0.45, 0.1)))
    room.panel(0, -1, 1, (5, 5, 5))
    room.daylight()
    room.write()


def dense(folder):
    """1.6 million triangles."""
    room = Room(folder, "dense")
    room.walls(matte(0.7, 0.65, 0.6))
    room.panel(0, -1, 1.5, (14, 13, 12))
    kinds = (plastic(0.1, (0.5, 0.2, 0.1)), matte(0.3, 0.5, 0.3), metal("Au", 0.2), glass())
    for i in range(16):
        room.bumpy_ball(f"ball {i}", (1.2 * (i % 4) - 1.8, 1.2 * (i // 4) - 1.5, 0.55), 0.5, 160, kinds[i % 4])
    room.write()


def milk(folder):
    """A coloured medium in rough glass, and one in an invisible box."""
    room = Room(folder, "milk", "volpath")
    room.walls(matte(0.7, 0.65, 0.6))
    room.table(matte(0.5, 0.35, 0.2))
    room.panel(1, -1, 0.8, (40, 36, 30))

    def medium(sigma_t, albedo):
        return (f'<medium type="homogeneous" name="interior">{rgb("albedo", albedo)}{rgb("sigma_t", sigma_t)}'
                f'</medium>')

    room.ball(-0.7, 0, 0.4, glass(0.2, 1.33) + medium((0.8, 0.9, 1), (0.99, 0.97, 0.9)).replace(
        "</medium>", number("scale", 15) + "</medium>"))
    cube = ('<transform name="to_world"><scale value="0.4"/><translate x="0.7" y="0" z="1.25"/></transform>' +
            bsdf("null") + medium((0.25, 0.5, 1), (0.95, 0.9, 0.8)).replace(
                "</medium>", number("scale", 6) + "</medium>"))
    room.add(f'<shape type="cube">{cube}</shape>')
    room.write()


def thousand(folder):
    """A thousand lights of all sizes, and rough metals."""
    room = Room(folder, "thousand")
    room.walls(plastic(0.2, (0.5, 0.5, 0.55)))
    room.table(metal("Al", 0.2))
    room.vase("gold", -0.9, 0, metal("Au", 0.1))
    room.vase("chrome", 0.9, 0.2, metal("Cr", 0.05))
    draw = room.random
    for _ in range(1000):
        colour = [draw.uniform(0.3, 1) * 10**draw.uniform(0, 1.5) for _ in range(3)]
        room.sphere((draw.uniform(-2.9, 2.9), draw.uniform(-5.5, 5.9), draw.uniform(2, 2.9)),
                    10**draw.uniform(-2.3, -1.5), light(colour))
    room.write()


TUNING = (glassware, bulbs, window, materials, textures, haze)
HELD_BACK = (cabinet, ajar, caustics, leaves, dense, milk, thousand)


def main():
    makers = {maker.__name__: maker for maker in TUNING + HELD_BACK}
    wanted = sys.argv[2:] or list(makers)
    if len(sys.argv) < 2 or any(name not in makers for name in wanted):
        sys.exit(f"usage: {sys.argv[0]} FOLDER [ROOM...]; rooms: {' '.join(makers)}")
    for name in wanted:
        makers[name](sys.argv[1])
        print(name)


if __name__ == "__main__":
    main()
