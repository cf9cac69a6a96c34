#!/usr/bin/env python3
"""Writes rooms like those of public scene sets, which Penumbra and Mitsuba 3 both read: OUT/NAME/scene.xml,
meshes, textures.

Work on the scenes that are called tuning; look at those that are held back only to see whether what was done
holds there.
The same names are the same files, on every machine.
"""

import argparse
import os
import random
import textwrap

import furniture as f
import pictures
from modelling import Scene, light, numbers

METALS = ("Cu", "Au", "Ag", "Al", "Cr", "W", "TiN")


class Room(Scene):
    """A scene and what its furniture is made of."""

    def __init__(self, name, out, depth=12, medium=None, film=(640, 360), rfilter="box", integrator=None):
        super().__init__("scene", os.path.join(out, name))
        self.random = random.Random(name)
        self.count = 0
        self.film, self.rfilter, self.inside = film, rfilter, medium
        kind = integrator or ("volpath" if medium else "path")
        self.add(f'<integrator type="{kind}"><integer name="max_depth" value="{depth}"/></integrator>')

    def camera(self, origin, target, fov=60, inside=""):
        width, height = self.film
        self.add(f'''<sensor type="perspective"><float name="fov" value="{fov}"/>
  <transform name="to_world"><lookat origin="{numbers(origin)}" target="{numbers(target)}" up="0, 0, 1"/></transform>
  <sampler type="independent"><integer name="sample_count" value="64"/></sampler>
  <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/>
    <string name="pixel_format" value="rgb"/><rfilter type="{self.rfilter}"/></film>{inside}
</sensor>''')

    def put(self, content, *meshes):
        for mesh in meshes:
            self.count += 1
            self.mesh(f"mesh{self.count:04}", mesh, content)

    # Light.
    def sky(self, sun=0.0, azimuth=0.0, height=40.0, scale=1.0):
        file = pictures.sky_file(self.folder, "sky", sun, azimuth, height)
        self.add(f'<emitter type="envmap"><string name="filename" value="{file}"/><float name="scale" value="{scale}"/>'
                 '<transform name="to_world"><rotate x="1" angle="90"/></transform></emitter>')

    def bulb(self, centre, radius, radiance):
        self.sphere(centre, radius, light(radiance))

    def panel(self, x0, y0, x1, y1, z, radiance):
        """A rectangle that shines down."""
        self.add(
            f'''<shape type="rectangle"><transform name="to_world"><scale x="{(x1 - x0) / 2:.6g}" y="{(y1 - y0) / 2:.6g}"/>
  <rotate x="1" angle="180"/><translate x="{(x0 + x1) / 2:.6g}" y="{(y0 + y1) / 2:.6g}" z="{z:.6g}"/></transform>{light(radiance)}</shape>'''
        )

    # What things are made of.
    def picture(self, parameter, name, scale=1.0):
        file = pictures.texture_file(self.folder, name)
        raw = '<boolean name="raw" value="true"/>' if name in pictures.PLAIN else ""
        size = "" if scale == 1 else f'<transform name="to_uv"><scale x="{scale:.6g}" y="{scale:.6g}"/></transform>'
        return f'<texture type="bitmap" name="{parameter}"><string name="filename" value="{file}"/>{raw}{size}</texture>'

    def colour(self, parameter, value, scale=1.0):
        """A texture by its name, or a colour."""
        if isinstance(value, str):
            return self.picture(parameter, value, scale)
        return f'<rgb name="{parameter}" value="{numbers(value)}"/>'

    def alpha(self, value):
        return self.picture("alpha", value, 2) if isinstance(value,
                                                             str) else f'<float name="alpha" value="{value:.6g}"/>'

    def diffuse(self, colour, scale=1.0):
        return twosided(f'<bsdf type="diffuse">{self.colour("reflectance", colour, scale)}</bsdf>')

    def plastic(self, colour, alpha=0.0, scale=1.0, nonlinear=True):
        rough = f'<float name="alpha" value="{alpha:.6g}"/>' if alpha else ""
        return twosided(
            f'<bsdf type="{"roughplastic" if alpha else "plastic"}">{self.colour("diffuse_reflectance", colour, scale)}{rough}'
            f'<boolean name="nonlinear" value="{str(nonlinear).lower()}"/></bsdf>')

    def metal(self, name, alpha=0.0, distribution="ggx", tint=None):
        tinted = self.colour("specular_reflectance", tint) if tint else ""
        if not alpha:
            return twosided(f'<bsdf type="conductor"><string name="material" value="{name}"/>{tinted}</bsdf>')
        return twosided(
            f'<bsdf type="roughconductor"><string name="material" value="{name}"/>{self.alpha(alpha)}{tinted}'
            f'<string name="distribution" value="{distribution}"/></bsdf>')

    def bumpy(self, bsdf, name="bumps", scale=1.0, height=0.02):
        return f'<bsdf type="bumpmap">{self.picture("arbitrary", name, scale)}<float name="scale" value="{height}"/>{bsdf}</bsdf>'

    def dented(self, bsdf, name="waves", scale=1.0):
        return f'<bsdf type="normalmap">{self.picture("normalmap", name, scale)}{bsdf}</bsdf>'

    def cut(self, bsdf, name):
        return f'<bsdf type="mask">{self.picture("opacity", name)}{bsdf}</bsdf>'

    def any_material(self, textured=0.3):
        """One of the kinds that exporters write, with colours of its own."""
        r = self.random
        colour = [r.uniform(0.05, 0.85) for _ in range(3)]
        if r.random() < textured:
            colour = r.choice(
                ["oak", "walnut", "marble", "slate", "red-cloth", "blue-cloth", "linen", "stripes", "chequers"])
        kind = r.random()
        if kind < 0.4:
            return self.diffuse(colour)
        if kind < 0.55:
            return self.plastic(colour)
        if kind < 0.8:
            return self.plastic(colour, r.uniform(0.05, 0.4))
        if kind < 0.95:
            return self.metal(r.choice(METALS), r.uniform(0.05, 0.4), r.choice(["ggx", "beckmann"]))
        return self.metal(r.choice(METALS))

    # Whole rooms.
    def shell(self, width, depth, height, walls, floor, ceiling, windows=(), glass=None, frame=None):
        """Four walls; windows (side, hole, panes) with side in "left", "right", "back". glass: "slab", "thin"
        or None."""
        frame = frame or self.plastic((0.8, 0.8, 0.78), 0.2)
        for side, axis, at, length, out in (("left", "x", 0, depth, -1), ("right", "x", width, depth, 1),
                                            ("back", "y", depth, width, 1), ("front", "y", 0, width, -1)):
            holes = [(hole, panes) for where, hole, panes in windows if where == side]
            self.put(walls, f.wall(axis, at, length, height, [hole for hole, _ in holes]))
            for hole, panes in holes:
                bars, slab = f.window(axis, at, hole, out, panes)
                self.put(frame, bars)
                if glass == "slab":
                    self.put(GLASS, slab)
                elif glass == "thin":
                    self.put(THIN, f.pane(axis, at + 0.1 * out, hole))
        self.put(floor, f.slab(0, 0, width, depth, 0))
        self.put(ceiling, f.slab(0, 0, width, depth, height, down=True))

    def books(self, x, y, z, width, deep=0.22, tall=0.3):
        r, end = self.random, x + width
        paper = self.diffuse((0.8, 0.77, 0.68))
        while True:
            thick, high = r.uniform(0.02, 0.05), tall * r.uniform(0.65, 0.95)
            if x + thick > end:
                return
            cover, pages = f.book((x, y + r.uniform(0, 0.03), z), (x + thick - 0.001, y + deep, z + high))
            self.put(self.any_material(0.5), cover)
            self.put(paper, pages)
            x += thick

    def lamp(self, x, y, z, radiance, shade=True):
        """A stand with a bulb, in a shade of cloth."""
        self.put(self.metal("Cu", 0.15), f.vase((x, y, z), 0.3))
        self.bulb((x, y, z + 0.42), 0.035, radiance)
        if shade:
            self.put(self.diffuse("linen", 3), f.lampshade((x, y, z + 0.33)))


def twosided(bsdf):
    return f'<bsdf type="twosided">{bsdf}</bsdf>'


GLASS = '<bsdf type="dielectric"><string name="int_ior" value="bk7"/></bsdf>'
THIN = '<bsdf type="thindielectric"/>'
WATER = '<bsdf type="dielectric"><string name="int_ior" value="water"/></bsdf>'


def frosted(alpha):
    return f'<bsdf type="roughdielectric"><float name="alpha" value="{alpha}"/><string name="int_ior" value="bk7"/></bsdf>'


def medium(identifier, sigma, albedo, g=0.0):
    most = max(sigma)  # Mitsuba reads colours up to 1
    return (
        f'<medium type="homogeneous" id="{identifier}"><rgb name="sigma_t" value="{numbers(x / most for x in sigma)}"/>'
        f'<float name="scale" value="{most}"/><rgb name="albedo" value="{numbers(albedo)}"/>'
        f'<phase type="hg"><float name="g" value="{g}"/></phase></medium>')


def bathroom(out):
    room = Room("bathroom", out)
    room.camera((2.6, 0.3, 1.6), (0.9, 3.4, 0.9), 65)
    room.sky(3000, 150, 35)
    tiled = room.bumpy(room.plastic("white-tiles", 0.05, 1.2), "bumps", 2, 0.003)
    room.shell(3, 3.6, 2.5, tiled, room.plastic("blue-tiles", 0.12, 0.8), room.diffuse((0.85, 0.85, 0.83)),
               [("left", (1.2, 1.0, 2.6, 2.1), 2)], "slab")
    room.put(room.plastic((0.9, 0.9, 0.9), 0.03), f.bowl((2.4, 3.1, 0.75), 0.28),
             f.boxes(((2.3, 3.0, 0), (2.5, 3.2, 0.75))))
    room.put(room.plastic((0.92, 0.92, 0.9)), f.bowl((0.75, 2.9, 0.02), 0.7, 256))
    room.put(room.metal("Cr"), f.tap(2.4, 3.35, 0.9), f.tap(0.75, 3.5, 0.6))
    room.put(room.metal("Ag"), f.boxes(((1.9, 3.57, 1.2), (2.9, 3.59, 2.0))))
    room.put(room.metal("Al", 0.12), f.boxes(((1.3, 3.5, 1.2), (1.31, 3.55, 1.8)),
                                             ((1.3, 3.4, 1.2), (1.8, 3.55, 1.21))))
    for i in range(7):
        x, y = 1.35 + 0.07 * i, 3.47
        room.put(GLASS if i % 2 else frosted(0.1), f.bottle((x, y, 1.212), 0.16 + 0.02 * (i % 3)))
    room.put(room.plastic("blue-cloth", 0.3, 4),
             f.sheet(300, 300, lambda u, v: (1.35 + 0.5 * u, 3.3 + 0.02 * f.math.sin(25 * u), 0.4 + 0.7 * v)))
    room.put(room.diffuse("red-cloth", 6), f.rug(1.2, 1.5, 1.0, 0.7, 300, 200, 5))
    for x in (2.0, 2.8):
        room.bulb((x, 3.45, 2.15), 0.05, (18, 15, 11))
    return room


def bedroom(out):
    room = Room("bedroom", out, depth=16, rfilter="tent")
    room.camera((3.8, 0.4, 1.5), (1.4, 3.8, 0.8), 62)
    room.sky(6000, 90, 30)
    room.shell(4.2, 4.4, 2.6, room.diffuse("wallpaper", 1.5), room.plastic("oak", 0.18, 0.7),
               room.diffuse((0.86, 0.86, 0.84)), [("back", (1.0, 0.6, 3.0, 2.2), 3)], "thin")
    for x in (0.6, 2.9):
        room.put(room.cut(room.diffuse((0.9, 0.88, 0.84)), "lace"), f.curtain(x, 4.25, 0.6, 2.3))
    room.put(room.plastic("walnut", 0.1), f.boxes(((0.3, 1.6, 0), (0.4, 3.4, 1.0)),
                                                  ((0.4, 1.6, 0.2), (2.4, 3.4, 0.35))))
    room.put(room.bumpy(room.diffuse("blue-cloth", 5), "bumps", 6, 0.01), f.cushion(0.4, 1.6, 0.35, 2.0, 1.8, 0.25,
                                                                                    300))
    for y in (1.75, 2.6):
        room.put(room.dented(room.diffuse((0.88, 0.85, 0.8)), "waves", 2),
                 f.cushion(0.45, y, 0.58, 0.45, 0.65, 0.14, 160))
    room.put(room.plastic("oak", 0.15), f.boxes(((0.3, 1.05, 0), (0.75, 1.5, 0.5))),
             f.boxes(((0.3, 3.5, 0), (0.75, 3.95, 0.5))))
    room.lamp(0.5, 1.27, 0.5, (60, 45, 28))
    room.lamp(0.5, 3.7, 0.5, (60, 45, 28))
    room.put(GLASS, f.tumbler((0.68, 1.4, 0.5)), f.vase((0.68, 3.85, 0.5), 0.18))
    room.put(room.metal("Ag"), f.boxes(((0.02, 2.0, 1.3), (0.03, 3.0, 2.1))))
    room.put(room.diffuse("linen", 5), f.rug(2.2, 1.4, 1.6, 2.2, 500, 400, 6))
    for i in range(40):
        room.put(room.any_material(), f.vase((0.4 + 0.08 * (i % 20), 4.2, 0.3 + 0.15 * (i // 20)), 0.12, 32))
    return room


def kitchen(out):
    room = Room("kitchen", out, depth=17)
    room.camera((0.5, 0.4, 1.6), (3.0, 4.0, 0.95), 65)
    room.sky(0, scale=1.5)
    room.shell(4.5, 5, 2.7, room.plastic("white-tiles", 0.1), room.plastic("chequers", 0.07, 0.5),
               room.diffuse((0.85, 0.84, 0.8)), [("right", (1.5, 1.0, 3.5, 2.2), 3)], "slab")
    for i in range(6):
        x = 0.5 + 0.62 * i
        room.put(room.plastic("walnut", 0.12, 0.6), f.boxes(((x, 4.4, 0), (x + 0.6, 5, 0.88))),
                 f.boxes(((x, 4.65, 1.6), (x + 0.6, 5, 2.3))))
        room.put(room.metal("Al", "brushed"), f.boxes(((x + 0.25, 4.37, 0.7), (x + 0.35, 4.39, 0.72))))
    room.put(room.plastic("marble", 0.03), f.boxes(((0.45, 4.37, 0.88), (4.3, 5, 0.92))))
    room.put(room.plastic("oak", 0.1), f.table(1.8, 1.9, 1.6, 0.9))
    for x, y, turn in ((2.1, 1.6, -1), (3.0, 1.6, -1), (2.1, 3.1, 1), (3.0, 3.1, 1)):
        room.put(room.plastic("walnut", 0.2), f.chair(x, y, turn))
    makers = (f.vase, f.bottle, f.goblet, f.bowl, f.teapot)
    for i in range(220):
        make = makers[i % 5]
        size = room.random.uniform(0.07, 0.13) * (1.6 if make is f.bottle else 0.6 if make is f.bowl else 1)
        row, k = divmod(i, 44)
        where = (0.5 + 0.085 * k, 4.75,
                 0.92) if row == 0 else (0.5 + 0.085 * k, 4.5,
                                         0.92) if row == 1 else (0.06 + 0.02 * (k % 2), 0.9 + 0.08 * k,
                                                                 0.6 + 0.4 * row - 0.4)
        room.put(GLASS if i % 4 == 2 else room.any_material(), make(where, size))
    room.put(room.plastic("oak", 0.2), *[f.boxes(((0.0, 0.8, z), (0.25, 4.5, z + 0.02))) for z in (0.98, 1.38, 1.78)])
    for i in range(6):
        room.put(GLASS, f.tumbler((2.0 + 0.22 * i, 2.3, 0.75)))
        room.put(room.metal("Ag", 0.1), f.boxes(((2.0 + 0.22 * i, 2.05, 0.751), (2.02 + 0.22 * i, 2.2, 0.755))))
    room.put(room.metal("Cr"), f.tap(3.6, 4.9, 0.92), f.bowl((2.6, 2.5, 0.75), 0.18))
    for i in range(8):
        room.panel(0.6 + i % 4 * 1.0, 1.4 + i // 4 * 2, 0.8 + i % 4 * 1.0, 1.6 + i // 4 * 2, 2.69, (14, 13, 11))
    return room


def living_room(out):
    room = Room("living-room", out, depth=14, rfilter="tent")
    room.camera((0.6, 0.5, 1.5), (3.6, 4.2, 0.9), 66)
    room.sky(5000, 20, 28)
    room.shell(6, 5.5, 2.9, room.diffuse((0.75, 0.73, 0.68)), room.plastic("oak", 0.12, 0.5),
               room.diffuse((0.87, 0.86, 0.84)), [("right", (1.0, 0.3, 4.6, 2.5), 4)], "slab")
    cloth = room.bumpy(room.plastic("blue-cloth", 0.4, 4), "bumps", 5, 0.01)
    room.put(cloth, f.boxes(((2.0, 4.4, 0.1), (4.4, 4.6, 0.85))),
             *[f.cushion(2.0 + 0.8 * i, 3.6, 0.25, 0.8, 0.85, 0.22, 200) for i in range(3)])
    room.put(room.diffuse("red-cloth", 5),
             *[f.cushion(2.1 + 0.9 * i, 4.0, 0.48, 0.45, 0.35, 0.3, 120) for i in range(3)])
    room.put(room.diffuse("linen", 5), f.rug(1.8, 1.6, 3.0, 2.2, 900, 550, 7))
    room.put(GLASS, f.boxes(((2.4, 2.2, 0.42), (4.0, 3.0, 0.435))))
    room.put(room.metal("Cr", 0.08),
             *[f.boxes(((x, y, 0), (x + 0.03, y + 0.03, 0.419))) for x in (2.45, 3.9) for y in (2.25, 2.9)])
    room.put(frosted(0.08), f.vase((2.7, 2.5, 0.436), 0.3))
    room.put(GLASS, f.bowl((3.5, 2.6, 0.436), 0.16), f.goblet((3.1, 2.75, 0.436)), f.goblet((3.25, 2.4, 0.436)))
    room.put(room.plastic("walnut", 0.15), f.shelf(0.4, 5.1, 1.3, 2.1))
    for row in range(5):
        room.books(0.42, 5.13, 0.42 * row + 0.026, 1.25)
    for i in range(60):
        room.put(room.any_material(),
                 f.vase((4.8 + 0.1 * (i % 10), 5.3 - 0.1 * (i // 30), 0.3 * (i // 10 % 3) + 0.026), 0.2, 48))
    room.put(room.plastic("oak"), f.shelf(4.75, 5.1, 1.1, 0.9, 0.35, 3))
    room.put(room.cut(room.plastic((0.15, 0.4, 0.1), 0.2), "leaf"), f.plant((5.4, 4.6, 0.1), 240, 1.4, 3))
    room.lamp(5.2, 5.25, 0.93, (70, 52, 33))
    room.put(room.metal("Au", 0.2), f.boxes(((2.3, 5.45, 1.4), (4.1, 5.48, 2.4))))
    room.put(room.diffuse("marble", 1), f.boxes(((2.4, 5.43, 1.5), (4.0, 5.46, 2.3))))
    return room


def bookshelf(out):
    room = Room("bookshelf", out, depth=20, rfilter="tent")
    room.camera((1.6, 0.6, 1.5), (1.8, 3.8, 1.05), 50)
    room.shell(3.6, 4, 2.6, room.diffuse("wallpaper"), room.plastic("walnut", 0.15), room.diffuse((0.8, 0.8, 0.78)))
    room.put(room.plastic("oak", 0.1), f.shelf(0.4, 3.6, 2.8, 2.2, rows=6))
    for row in range(6):
        room.books(0.42, 3.63, 2.2 * row / 6 + 0.026, 1.9 if row % 2 else 2.75)
    for i, row in enumerate((1, 3, 5)):
        z = 2.2 * row / 6 + 0.026
        room.put(room.metal(METALS[i], 0.1), f.knot((2.6, 3.75, z), 0.3))
        room.put(GLASS, f.vase((3.0, 3.75, z), 0.25))
    room.put(room.plastic("walnut", 0.08), f.table(1.0, 2.3, 1.3, 0.6))
    for x, glass in ((1.3, GLASS), (2.0, frosted(0.15))):  # a bulb within glass
        room.put(room.metal("Cu", 0.2), f.boxes(((x - 0.05, 2.55, 0.75), (x + 0.05, 2.65, 0.9))))
        room.sphere((x, 2.6, 1.02), 0.09, glass)
        room.bulb((x, 2.6, 1.02), 0.03, (120, 90, 55))
    return room


def glass_of_water(out):
    room = Room("glass-of-water", out, depth=32, rfilter="tent")
    room.camera((0.02, -0.55, 0.32), (0, 0, 0.06), 38)
    room.sky(4000, 70, 40)
    room.put(room.plastic("oak", 0.1, 2), f.slab(-1.5, -1, 1.5, 2, 0))
    room.put(room.diffuse((0.7, 0.7, 0.72)), f.wall("y", 2, 3, 2))
    room.put(GLASS, f.tumbler((0, 0, 0.0005), 0.04, 0.12, 192))
    # Water that ends within the glass: three interfaces, as modellers leave them.
    room.put(
        WATER,
        f.turned([(0, 0.013), (0.0282, 0.0135), (0.031, 0.018), (0.0355, 0.075), (0.034, 0.078), (0, 0.078)],
                 (0, 0, 0.0005), 192))
    for i in range(5):
        x, y = 0.1 + 0.03 * i, -0.05 + 0.04 * (i % 2)
        room.put(frosted(0.05), f.boxes(((x, y, 0.0005), (x + 0.022, y + 0.022, 0.0225))))
    room.put(GLASS, f.goblet((-0.12, 0.1, 0.0005), 0.16, 128), f.bottle((0.14, 0.16, 0.0005), 0.28, 128))
    room.put(room.metal("Ag", 0.08), f.boxes(((-0.06, -0.15, 0.001), (0.1, -0.14, 0.004))))
    return room


def vitrines(out):
    room = Room("vitrines", out, depth=24)
    room.camera((0.4, 0.4, 1.65), (3.2, 4.2, 1.15), 62)
    room.shell(5, 5, 3, room.diffuse((0.7, 0.68, 0.64)), room.plastic("marble", 0.08, 0.5),
               room.diffuse((0.4, 0.4, 0.42)))
    for i in range(9):
        x, y = 0.9 + 1.4 * (i % 3), 1.6 + 1.15 * (i // 3)
        room.put(room.plastic("slate", 0.25), f.boxes(((x - 0.3, y - 0.3, 0), (x + 0.3, y + 0.3, 0.9))))
        art = room.metal(METALS[i % 7], 0.05 + 0.03 * i, "beckmann" if i %
                         2 else "ggx") if i % 3 else GLASS if i == 3 else room.plastic("marble", 0.05)
        room.put(art, f.statue((x, y, 0.9), 0.55, 100, 200, i) if i % 2 else f.knot((x, y, 0.95), 0.5))
        if i % 2:
            low, high = 0.901, 1.6
            room.put(
                GLASS, *[
                    f.boxes(box)
                    for box in (((x - 0.29, y - 0.29, low), (x + 0.29, y - 0.28, high)),
                                ((x - 0.29, y + 0.28, low), (x + 0.29, y + 0.29, high)), ((x - 0.29, y - 0.279, low),
                                                                                          (x - 0.28, y + 0.279, high)),
                                ((x + 0.28, y - 0.279, low), (x + 0.29, y + 0.279, high)))
                ])
        else:
            room.put(THIN, *[f.pane("x", x + s, (y - 0.29, 0.901, y + 0.29, 1.6)) for s in (-0.29, 0.29)],
                     *[f.pane("y", y + s, (x - 0.29, 0.901, x + 0.29, 1.6)) for s in (-0.29, 0.29)])
        room.panel(x - 0.08, y - 0.08, x + 0.08, y + 0.08, 2.95, (45, 40, 32))
    for i in range(3):
        room.put(room.diffuse(("marble", "chequers", "stripes")[i], 2),
                 f.boxes(((0.6 + 1.4 * i, 4.95, 1.2), (1.6 + 1.4 * i, 4.98, 2.2))))
    return room


def haze(out):
    room = Room("haze", out, medium="haze", depth=24)
    room.add(medium("haze", (0.12, 0.12, 0.12), (0.95, 0.95, 0.95), 0.3))
    room.camera((0.5, 0.4, 1.6), (3, 4.5, 1.2), 65, '<ref name="medium" id="haze"/>')
    inside = '<ref name="interior" id="haze"/>'
    room.put('<bsdf type="null"/>' + inside, f.boxes(((-0.5, -0.5, -0.5), (5.5, 6.5, 3.5))))
    room.shell(5, 6, 3, room.diffuse((0.6, 0.57, 0.5)), room.diffuse("oak", 0.6), room.diffuse((0.7, 0.7, 0.7)))
    for i in range(8):
        room.put(
            room.diffuse((0.5, 0.45, 0.4)) if i % 2 else room.plastic("marble", 0.2),
            f.boxes(((0.3 + 0.55 * i, 5.0, 0), (0.5 + 0.55 * i, 5.2, 2.2))))
    room.put(room.metal("Cu", 0.2), f.statue((3.2, 3.6, 0), 1.5, 100, 150, 3))
    room.put(room.plastic("walnut", 0.2), f.table(1.0, 2.6, 1.2, 0.8))
    room.put(room.metal("Au", 0.1), f.teapot((1.5, 3.0, 0.75)))
    for i in range(4):
        room.panel(0.8 + i, 1.5 + i, 1.1 + i, 1.8 + i, 2.98, ((30, 26, 20), (12, 18, 30))[i % 2])
    return room


def fogged_spot(out):
    room = Room("fogged-spot", out, medium="fog", depth=32)
    room.add(medium("fog", (0.25, 0.25, 0.25), (0.9, 0.9, 0.9), 0.0))
    room.camera((0.5, 0.4, 1.4), (2.6, 4.0, 1.1), 60, '<ref name="medium" id="fog"/>')
    room.put('<bsdf type="null"/><ref name="interior" id="fog"/>', f.boxes(((-0.5, -0.5, -0.5), (5.5, 5.5, 3.5))))
    room.shell(5, 5, 3, room.diffuse((0.5, 0.5, 0.52)), room.plastic("chequers", 0.2, 0.5), room.diffuse(
        (0.5, 0.5, 0.5)))
    room.add(
        '''<emitter type="spot"><rgb name="intensity" value="60, 55, 48"/><float name="cutoff_angle" value="16"/><float name="beam_width" value="11"/>
  <transform name="to_world"><lookat origin="4.6, 2.0, 2.8" target="1.6, 3.4, 0.4" up="0, 0, 1"/></transform><ref name="medium" id="fog"/></emitter>'''
    )
    room.put(room.metal("Ag", 0.15), f.knot((1.7, 3.3, 0.3), 1.0))
    room.put(room.diffuse("red-cloth", 2), f.boxes(((2.8, 3.4, 0), (3.4, 4.0, 0.8))))
    room.put(room.plastic((0.2, 0.3, 0.6)), f.vase((3.1, 3.7, 0.8), 0.5))
    return room


def door_ajar(out):
    room = Room("door-ajar", out, depth=20, rfilter="tent")
    room.camera((1.6, 0.4, 1.5), (2.2, 4.0, 0.9), 60)
    room.shell(4, 5, 2.6, room.diffuse((0.72, 0.68, 0.6)), room.plastic("chequers", 0.05, 0.5),
               room.diffuse((0.8, 0.8, 0.8)), [("back", (2.4, 0, 3.3, 2.1), 1)])
    paint = room.diffuse((0.8, 0.78, 0.7))
    room.put(paint, f.wall("y", 7, 4, 2.6), f.slab(0, 5.2, 4, 7, 2.6, down=True),
             f.wall("y", 5.2, 4, 2.6, [(2.35, 0, 3.35, 2.15)]))
    for x in (0, 4):
        room.put(paint, hall_side(x))
    room.put(room.diffuse("oak"), f.slab(0, 5, 4, 7, 0))
    hinge = (3.29, 5.0)
    door = f.Mesh()
    c, s = -0.87 * 0.88, -0.5 * 0.88  # open by 30 degrees
    across = (0.5 * 0.04, -0.87 * 0.04)
    p = [(hinge[0], hinge[1]), (hinge[0] + c, hinge[1] + s), (hinge[0] + c + across[0], hinge[1] + s + across[1]),
         (hinge[0] + across[0], hinge[1] + across[1])]
    for i in range(4):
        q, r = p[i], p[(i + 1) % 4]
        door.quad((*q, 0.01), (*r, 0.01), (*r, 2.08), (*q, 2.08))
    room.put(room.plastic("walnut", 0.15), door)
    room.panel(1.0, 5.6, 2.0, 6.4, 2.59, (40, 36, 30))
    room.put(room.plastic("oak", 0.1), f.table(1.3, 2.7, 1.4, 0.8))
    room.put(room.metal("Ag", 0.08), f.teapot((1.55, 3.05, 0.75)))
    room.put(GLASS, f.teapot((2.05, 3.2, 0.751)))
    room.put(room.diffuse("marble", 2), f.teapot((2.45, 2.95, 0.75)))
    for i in range(3):
        room.put(room.diffuse(("stripes", "marble", "blue-tiles")[i], 1.5),
                 f.boxes(((0.3 + 0.7 * i, 4.96, 1.3), (0.8 + 0.7 * i, 4.98, 1.9))))
    return room


def hall_side(x):
    mesh = f.Mesh()
    mesh.quad((x, 5, 0), (x, 7, 0), (x, 7, 2.6), (x, 5, 2.6))
    return mesh


def caustics(out):
    room = Room("caustics", out, depth=20)
    room.camera((0.0, -0.75, 0.5), (0, 0, 0.06), 42)
    room.put(room.diffuse("linen", 4), f.slab(-2, -2, 2, 2, 0))
    room.put(room.diffuse((0.6, 0.58, 0.55)), f.wall("y", 1.0, 2, 2), f.slab(-2, -2, 2, 2, 2, down=True))
    room.bulb((0.35, 0.45, 0.75), 0.025, (160, 140, 110))
    room.put(GLASS, f.tumbler((-0.2, 0.05, 0.0005), 0.05, 0.13), f.goblet((0.0, 0.12, 0.0005), 0.2),
             f.bowl((0.22, 0.0, 0.0005), 0.09))
    room.put(frosted(0.1), f.vase((-0.06, -0.12, 0.0005), 0.14))
    room.sphere((0.12, -0.16, 0.0405), 0.04, GLASS)
    room.put(room.metal("Cu"), f.turned([(0.05, 0), (0.053, 0), (0.053, 0.03), (0.05, 0.03)], (-0.24, -0.17, 0), 128))
    return room


def goblets(out):
    room = Room("goblets", out, depth=24, rfilter="tent")
    room.camera((0.1, -0.9, 0.55), (0, 0, 0.1), 44)
    room.put(room.plastic("walnut", 0.15, 2), f.slab(-2, -2, 2, 2, 0))
    room.put(room.diffuse("wallpaper"), f.wall("y", 1.2, 2, 2))
    room.put(room.diffuse((0.7, 0.7, 0.7)), f.slab(-2, -2, 2, 2, 2.2, down=True))
    room.bulb((-0.4, 0.3, 0.8), 0.04, (90, 75, 50))
    room.panel(-0.3, -1.5, 0.3, -1.2, 2.1, (2, 2.2, 2.6))
    for i in range(12):
        where = (-0.36 + 0.2 * (i % 4) + 0.07 * (i // 4), -0.2 + 0.2 * (i // 4), 0.0005)
        room.put((GLASS, frosted(0.03), frosted(0.2), room.metal("Au", 0.05),
                  '<bsdf type="dielectric"><string name="int_ior" value="diamond"/></bsdf>')[i % 5],
                 (f.goblet, f.vase, f.bottle)[i % 3](where, 0.18 + 0.01 * i))
    return room


def thousand_lights(out):
    room = Room("thousand-lights", out, depth=10)
    room.camera((0.5, 0.3, 1.6), (4.0, 6.0, 1.5), 66)
    room.shell(6, 7, 3.2, room.plastic("slate", 0.2), room.plastic("marble", 0.06, 0.5), room.diffuse((0.5, 0.5, 0.52)))
    r = room.random
    for i in range(1000):
        x, y, z = r.uniform(0.2, 5.8), r.uniform(0.8, 6.8), r.uniform(1.9, 3.1)
        colour = [r.choice((2, 8, 14)) * r.uniform(0.5, 2) for _ in range(3)]
        if i % 3 == 0:
            room.bulb((x, y, z), 0.015, colour)
        elif i % 3 == 1:
            room.panel(x - 0.02, y - 0.02, x + 0.02, y + 0.02, z, colour)
        else:
            room.put(
                room.metal("Al", 0.2) + light(colour),
                f.turned([(0, 0), (0.02, 0.01), (0.025, 0.03), (0, 0.05)], (x, y, z), 8, 2))
    for i in range(24):
        x, y = 0.6 + 0.9 * (i % 6), 2.5 + 1.2 * (i // 6)
        room.put(room.any_material(0.4), f.statue((x, y, 0.0), r.uniform(0.8, 1.5), 80, 120, i))
        room.put(GLASS, f.vase((x + 0.4, y, 0), 0.4, 48))
    return room


def jars(out):
    room = Room("jars", out, medium="milk", depth=48)
    room.add(medium("milk", (60, 60, 60), (0.99, 0.985, 0.96), 0.4))
    room.add(medium("juice", (25, 40, 60), (0.9, 0.6, 0.15), 0.2))
    room.add(medium("tea", (6, 14, 40), (0.3, 0.2, 0.1)))
    room.camera((0.05, -0.7, 0.4), (0, 0, 0.08), 42)
    room.sky(0, scale=0.6)
    room.put(room.plastic("oak", 0.12, 2), f.slab(-1.5, -1, 1.5, 2, 0))
    room.put(room.diffuse((0.6, 0.62, 0.65)), f.wall("y", 1.2, 3, 1.5))
    room.panel(-0.4, -0.3, 0.0, 0.1, 0.9, (9, 8.5, 8))
    for i, (name, x, y) in enumerate((("milk", -0.22, 0.05), ("juice", -0.07, -0.02), ("tea", 0.08, 0.06),
                                      ("juice", 0.22, 0.0), ("milk", 0.15, -0.14))):
        inside = f'<ref name="interior" id="{name}"/>'
        if i == 4:
            room.put('<bsdf type="roughdielectric"><float name="alpha" value="0.2"/></bsdf>' + inside,
                     f.statue((x, y, 0.0005), 0.12, 80, 120, 4))
        else:
            room.put(
                WATER + inside,
                f.turned([(0, 0), (0.045, 0), (0.05, 0.01), (0.055, 0.1), (0.05, 0.13), (0, 0.13)], (x, y, 0.0005), 96))
    return room


def sculpture_hall(out):
    room = Room("sculpture-hall", out, depth=10)
    room.camera((0.8, 0.6, 1.8), (4.5, 7.0, 1.3), 66)
    room.sky(2500, 150, 40)
    room.shell(8, 9, 4, room.diffuse((0.7, 0.68, 0.62)), room.plastic("marble", 0.1, 0.4), room.diffuse(
        (0.8, 0.8, 0.78)), [("left", (1.5, 1.0, 3.5, 3.4), 1), ("left", (5.0, 1.0, 7.5, 3.4), 1)])
    for i in range(10):
        x, y = 1.6 + 1.6 * (i % 4), 2.6 + 2.2 * (i // 4)
        stuff = (room.diffuse((0.8, 0.78, 0.74)), room.metal("Cu", 0.25), room.plastic(
            (0.3, 0.1, 0.1), 0.1), room.metal("Au", 0.1, "beckmann"), room.plastic("marble", 0.2))[i % 5]
        room.put(room.plastic("slate", 0.3), f.boxes(((x - 0.35, y - 0.35, 0), (x + 0.35, y + 0.35, 0.5))))
        room.put(stuff, f.statue((x, y, 0.5), 1.7, 300, 500, 10 + i))
    return room


def conservatory(out):
    room = Room("conservatory", out, depth=20)
    room.camera((0.5, 0.3, 1.6), (3.0, 4.5, 1.1), 66)
    room.sky(5000, 60, 50)
    holes = [("back", (0.3, 0.5, 4.7, 2.6), 6), ("right", (0.5, 0.5, 5.5, 2.6), 7)]
    room.shell(5, 6, 3, room.diffuse((0.7, 0.68, 0.6)), room.plastic("slate", 0.2, 0.7), room.diffuse((0.8, 0.8, 0.8)),
               holes, "thin")
    for i in range(14):
        x, y = 0.8 + 0.6 * (i % 7), 3.2 + 1.6 * (i // 7)
        green = (0.1 + 0.15 * room.random.random(), 0.35 + 0.2 * room.random.random(), 0.08)
        room.put(room.plastic((0.6, 0.3, 0.18), 0.3), f.vase((x, y, 0), 0.5, 64))
        room.put(room.cut(room.plastic(green, 0.25) if i % 2 else room.diffuse(green), "leaf"),
                 f.plant((x, y, 0.45), 300, 1.2, 20 + i))
    room.put(room.metal("Al", 0.15), f.chair(2.5, 2.0), f.chair(3.4, 2.2, -1))
    room.put(GLASS, f.boxes(((2.6, 2.3, 0.7), (3.3, 2.9, 0.715))), f.tumbler((2.8, 2.5, 0.716)))
    room.put(room.metal("Al", 0.15), f.boxes(((2.9, 2.55, 0), (2.95, 2.6, 0.699))))
    return room


def metal_room(out):
    room = Room("metal-room", out, depth=16, rfilter="tent")
    room.camera((0.4, 0.4, 1.5), (3.0, 3.8, 0.9), 65)
    room.shell(4.5, 4.5, 2.8, room.metal("Al", "brushed", tint="blue-tiles"), room.plastic("chequers", 0.1, 0.6),
               room.metal("Cu", 0.4, tint="linen"))
    room.put(room.bumpy(room.plastic("walnut", 0.08), "bumps", 2, 0.01), f.table(1.2, 2.0, 1.8, 1.0))
    for i in range(30):
        x, y = 0.7 + 0.6 * (i % 6), 1.5 + 0.6 * (i // 6)
        z = 0.75 if 1.2 < x < 2.9 and 2.0 < y < 2.95 else 0
        stuff = (room.metal(METALS[i % 7], "smudges",
                            tint="marble"), room.plastic("blue-cloth", 0.05 + 0.01 * i, nonlinear=i % 4 < 2),
                 room.metal(METALS[i % 7], 0.03 * (1 + i % 5), "beckmann", tint=(0.9, 0.8, 0.7)))[i % 3]
        room.put(stuff, f.statue((x, y, z), 0.35, 60, 100, i) if i % 2 else f.knot((x, y, z + 0.02), 0.4, 600, 24))
    for x in (1.2, 3.0):
        room.panel(x, 1.5, x + 0.4, 2.5, 2.75, (16, 15, 13))
    room.bulb((2.2, 4.2, 1.8), 0.06, (25, 20, 14))
    return room


def office(out):
    room = Room("office", out, depth=12)
    room.camera((0.4, 0.4, 1.6), (3.4, 4.6, 1.0), 66)
    room.sky(0)
    room.shell(5, 6, 2.7, room.bumpy(room.diffuse((0.78, 0.77, 0.72)), "bumps", 2, 0.005),
               room.dented(room.plastic("slate", 0.2), "waves"), room.diffuse((0.85, 0.85, 0.85)),
               [("back", (0.5, 0.9, 4.5, 2.2), 4)], "thin")
    r = room.random
    for i in range(6):
        x, y = 0.6 + 2.2 * (i % 2), 1.4 + 1.4 * (i // 2)
        room.put(room.plastic("oak", 0.12), f.table(x, y, 1.5, 0.75))
        room.put(
            room.plastic((0.05, 0.05, 0.06), 0.1),
            f.boxes(((x + 0.4, y + 0.5, 0.8), (x + 1.0, y + 0.53, 1.2)),
                    ((x + 0.6, y + 0.45, 0.75), (x + 0.8, y + 0.6, 0.8))))
        room.put(
            light((0.6, 0.8, 1.2)) + room.diffuse((0.1, 0.1, 0.1)),
            f.pane("y", y + 0.499, (x + 0.42, 0.82, x + 0.98, 1.18)))
        room.put(room.any_material(), f.chair(x + 0.7, y - 0.3, -1))
        for k in range(16):
            room.put(room.any_material(0.4), f.vase((x + 0.1 + 0.08 * k, y + 0.65, 0.75), r.uniform(0.06, 0.14), 24))
        room.put(GLASS, f.tumbler((x + 1.2, y + 0.3, 0.75)))
    for i in range(12):  # tubes
        mesh = f.Mesh()
        x, y = 0.6 + 1.3 * (i % 4), 1.2 + 1.6 * (i // 4)
        mesh.tube([(x, y, 2.62), (x + 0.5, y, 2.62), (x + 1.0, y, 2.62)], 0.018, 24)
        room.put(room.diffuse((0.5, 0.5, 0.5)) + light((9, 9.5, 10)), mesh)
    return room


# name: (what writes it, half, what it is about)
SCENES = {
    "bathroom": (bathroom, "tuning", "sun through a slab of glass, tiles with bumps, chrome, bottles"),
    "kitchen": (kitchen, "tuning", "hundreds of materials, 8 lights, window"),
    "bookshelf": (bookshelf, "tuning", "two bulbs within glass light hundreds of books"),
    "vitrines": (vitrines, "tuning", "art behind slabs and thin panes"),
    "haze": (haze, "tuning", "homogeneous haze in a room"),
    "door-ajar": (door_ajar, "tuning", "indirect light alone"),
    "caustics": (caustics, "tuning", "smooth and rough glass under a small lamp"),
    "sculpture-hall": (sculpture_hall, "tuning", "3 million triangles, open windows"),
    "metal-room": (metal_room, "tuning", "textured two-sided rough metals and plastics"),
    "bedroom": (bedroom, "held_back", "sun through thin panes and lace, cloth"),
    "living-room": (living_room, "held_back", "1.3 million triangles, hundreds of materials, large panes"),
    "glass-of-water": (glass_of_water, "held_back", "nested glass and water in the sun"),
    "fogged-spot": (fogged_spot, "held_back", "a spot in fog"),
    "goblets": (goblets, "held_back", "caustics of smooth and rough glass, diamond, gold"),
    "thousand-lights": (thousand_lights, "held_back", "1000 small lights of three kinds"),
    "jars": (jars, "held_back", "coloured media within smooth and rough boundaries"),
    "conservatory": (conservatory, "held_back", "thousands of masked leaves behind thin panes"),
    "office": (office, "held_back", "meshes that shine, normal maps, many materials"),
}


def main():
    table = "\n".join(f"  {name:16} {half:10} {about}" for name, (_, half, about) in SCENES.items())
    parser = argparse.ArgumentParser(description=textwrap.dedent(__doc__),
                                     epilog="scenes:\n" + table,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", metavar="OUT", help="folder to write into")
    parser.add_argument("--only", metavar="NAME", choices=SCENES, action="append", help="this scene (can be repeated)")
    arguments = parser.parse_args()
    for name in arguments.only or SCENES:
        SCENES[name][0](arguments.out).write()
        print(name, flush=True)


if __name__ == "__main__":
    main()
