"""Scenes of glass, liquids and media: one function each, which makes the scene in a folder of OUT."""

import math

import furniture as f
from room import GLASS, METALS, Room, THIN, WATER, frosted, medium, placed, tinted


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


def glass_museum(out):
    room = Room("glass-museum", out, depth=28)
    room.camera((0.6, 0.5, 1.7), (4.2, 5.6, 1.15), 64)
    room.sky(0, scale=1.5)
    room.shell(7, 8, 3.6, room.diffuse((0.55, 0.55, 0.57)), room.plastic("oak", 0.08, 0.5), room.diffuse(
        (0.6, 0.6, 0.6)), [("left", (3.0, 0.8, 6.5, 3.0), 3)], "slab")
    diamond = '<bsdf type="dielectric"><string name="int_ior" value="diamond"/></bsdf>'
    makers = (lambda at, size, seed: f.statue(at, 1.3 * size, 150, 240, seed),
              lambda at, size, seed: f.vase(at, size, 160), lambda at, size, seed: f.knot(
                  (at[0], at[1], at[2] + 0.03), size), lambda at, size, seed: f.teapot(at, size),
              lambda at, size, seed: f.goblet(at, 1.2 * size, 160), lambda at, size, seed: f.rock(
                  (at[0], at[1], at[2] + 0.31 * size), [0.3 * size] * 3, seed, 8, 0.9))
    colours = ((0.95, 0.5, 0.2), (0.3, 0.6, 0.95), (0.4, 0.85, 0.5), (0.9, 0.3, 0.5))
    for i in range(16):
        x, y = 1.1 + 1.6 * (i % 4), 2.0 + 1.45 * (i // 4)
        room.put((room.plastic((0.75, 0.74, 0.72), 0.15), room.plastic("slate", 0.2))[i % 2],
                 f.boxes(((x - 0.28, y - 0.28, 0), (x + 0.28, y + 0.28, 0.85))))
        stuff = (GLASS, tinted(colours[i % 4]), frosted(0.04 * (1 + i % 5)), tinted(colours[(i + 1) % 4],
                                                                                    0.1), diamond)[i % 5]
        room.put(stuff, makers[i % 6]((x, y, 0.8505), 0.55, 60 + i))
        room.panel(x - 0.06, y - 0.06, x + 0.06, y + 0.06, 3.5, (75, 70, 60))
    # A chandelier of drops around six bulbs.
    for i in range(96):
        ring, angle = i // 32, 2 * math.pi * i / 32
        where = (3.5 + (0.5 + 0.12 * ring) * math.cos(angle), 3.6 + (0.5 + 0.12 * ring) * math.sin(angle),
                 2.6 + 0.18 * ring)
        room.put((GLASS, tinted(colours[i % 4]))[i % 2],
                 f.turned([(0, 0), (0.022, 0.02), (0.018, 0.045), (0.004, 0.1), (0, 0.1)], where, 24, 3))
    for i in range(6):
        angle = math.pi * i / 3
        room.bulb((3.5 + 0.4 * math.cos(angle), 3.6 + 0.4 * math.sin(angle), 2.8), 0.025, (45, 36, 24))
    room.put(room.metal("Au", 0.15),
             f.turned([(0, 0), (0.42, 0.0), (0.45, 0.03), (0.05, 0.08), (0.02, 0.3), (0.02, 0.9)], (3.5, 3.6, 2.72)))
    return room


def aquarium(out):
    room = Room("aquarium", out, medium="water", depth=48)
    room.add(medium("water", (0.9, 0.45, 0.35), (0.25, 0.6, 0.7), 0.5))
    inside = '<ref name="interior" id="water"/>'
    room.camera((0.3, -1.75, 0.55), (0, 0.05, 0.27), 48)
    room.put(room.diffuse("wallpaper", 1.5), f.wall("y", 0.6, 1.6, 1.6), f.wall("y", 0.6, -1.6, 1.6))
    room.put(room.plastic("walnut", 0.1), f.boxes(((-0.75, -0.4, -0.4), (0.75, 0.4, -0.012))))
    room.put(room.diffuse("oak", 0.8), f.slab(-1.6, -2.4, 1.6, 0.6, -0.4))
    room.put(room.diffuse((0.7, 0.7, 0.7)), f.slab(-1.6, -2.4, 1.6, 0.6, 1.6, down=True))
    # Five plates of glass, and the water half a millimetre beside them.
    x, y, z, g = 0.6, 0.25, 0.6, 0.01
    room.put(
        GLASS, *[
            f.boxes(box)
            for box in (((-x - g, -y - g, -g), (x + g, y + g, 0)), ((-x - g, -y - g, 0.0001), (x + g, -y, z)),
                        ((-x - g, y, 0.0001), (x + g, y + g, z)), ((-x - g, -y + 0.0001, 0.0001), (-x, y - 0.0001, z)),
                        ((x, -y + 0.0001, 0.0001), (x + g, y - 0.0001, z)))
        ])
    sides = f.boxes(((-x + 0.0005, -y + 0.0005, 0.0005), (x - 0.0005, y - 0.0005, 0.53)))
    room.put(WATER + inside, sides)
    room.put(room.plastic((0.05, 0.05, 0.055), 0.1),
             f.boxes(((-x - 0.02, -y - 0.02, z + 0.07), (x + 0.02, y + 0.02, z + 0.1))),
             *[f.boxes(((s * (x + 0.015) - 0.005, -y, z), (s * (x + 0.015) + 0.005, y, z + 0.07))) for s in (-1, 1)])
    for at in (-0.12, 0.12):
        room.panel(-x + 0.05, at - 0.07, x - 0.05, at + 0.07, z + 0.065, (22, 23, 25))
    room.bulb((1.2, -1.2, 1.3), 0.06, (10, 7.5, 4.5))
    r = room.random
    for i in range(420):
        where = (r.uniform(-0.57, 0.57), r.uniform(-0.22, 0.22), 0.012 + 0.012 * r.random())
        grey = r.uniform(0.25, 0.75)
        room.put(
            room.diffuse("stone", 2) if i % 9 == 0 else room.diffuse((grey, 0.93 * grey, 0.82 * grey)),
            f.rock(where, [r.uniform(0.006, 0.012) * (2.2 if i % 9 == 0 else 1) for _ in range(3)], i, 12, 0.8))
    for i, (at, size) in enumerate((((-0.33, 0.08, 0.06), 0.11), ((0.35, 0.1, 0.05), 0.09))):
        room.put(room.diffuse("stone", 1), f.rock(at, (size, 0.8 * size, 0.9 * size), 70 + i, 64))
    for i in range(10):
        green = (r.uniform(0.05, 0.2), r.uniform(0.3, 0.5), 0.06)
        room.put(room.cut(room.diffuse(green), "leaf"),
                 f.plant((r.uniform(-0.5, 0.5), r.uniform(0.02, 0.17), 0.02), 40, r.uniform(0.12, 0.35), 80 + i, 0.35))
    scales = (room.plastic((0.85, 0.32, 0.04),
                           0.08), room.metal("Ag", 0.2), room.plastic("stripes", 0.12,
                                                                      2), room.plastic((0.1, 0.25, 0.75), 0.08))
    for i in range(14):
        size, turn = r.uniform(0.05, 0.1), r.choice((r.uniform(-35, 35), r.uniform(145, 215)))
        where = (r.uniform(-0.45, 0.45), r.uniform(-0.16, 0.0), r.uniform(0.16, 0.46))
        body = [(0, 0, 0, 0), (0.15, 0.09, -0.14, 0.14), (0.4, 0.12, -0.22, 0.22), (0.75, 0.05, -0.1, 0.1),
                (0.88, 0.02, -0.05, 0.05), (1.1, 0.012, -0.18, 0.2), (1.12, 0, -0.1, 0.1)]
        room.put(scales[i % 4] + placed(where, (0, 0, 1), turn),
                 f.pod((0, 0, 0), [[size * t for t in station] for station in body], 1))
    bubble = (
        '<bsdf type="dielectric"><string name="int_ior" value="air"/><string name="ext_ior" value="water"/></bsdf>'
        '<ref name="exterior" id="water"/>')
    for i in range(40):
        room.sphere((0.5 + r.uniform(-0.02, 0.02), 0.18 + r.uniform(-0.02, 0.02), 0.04 + 0.012 * i),
                    r.uniform(0.002, 0.005), bubble)
    return room
