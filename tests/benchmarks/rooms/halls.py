"""Halls and other large rooms: one function each, which makes the scene in a folder of OUT."""

import math

import furniture as f
import pictures
from modelling import light, numbers
from room import GLASS, METALS, Room, placed, twosided


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


def car_paint(colour, flakes, coat):
    """The principled BSDF of a metallic paint below a clear coat."""
    return twosided(f'<bsdf type="principled"><rgb name="base_color" value="{numbers(colour)}"/>'
                    f'<float name="metallic" value="{flakes}"/><float name="roughness" value="0.35"/>'
                    f'<float name="clearcoat" value="{coat}"/><float name="clearcoat_gloss" value="0.97"/></bsdf>')


def blended(a, b, weight):
    return f'<bsdf type="blendbsdf"><float name="weight" value="{weight}"/>{a}{b}</bsdf>'


def car(room, position, turn, paint, glass, lamps=(), dull=False):
    """4.4 m long, its front at x = 0; lamps: radiances of front and rear."""
    where = placed(position, (0, 0, 1), turn)
    body = [(0, 0, 0.45, 0.55), (0.04, 0.55, 0.3, 0.62), (0.25, 0.8, 0.22, 0.72), (1.2, 0.88, 0.2, 0.88),
            (2.4, 0.9, 0.2, 0.92), (3.6, 0.88, 0.22, 0.93), (4.2, 0.8, 0.28, 0.9), (4.36, 0.6, 0.35, 0.8),
            (4.4, 0, 0.5, 0.7)]
    cabin = [(1.0, 0, 0.8, 0.82), (1.1, 0.6, 0.78, 0.88), (1.9, 0.7, 0.75, 1.32), (2.5, 0.71, 0.75, 1.4),
             (3.2, 0.69, 0.75, 1.34), (3.95, 0.6, 0.78, 0.95), (4.05, 0, 0.8, 0.85)]
    count = 48 if dull else 240
    room.put(paint + where, f.pod((0, 0, 0), body, 0.42, count, count))
    room.put(glass + where, f.pod((0, 0, 0), cabin, 0.5, count, count))
    rubber, alloy = room.diffuse((0.03, 0.03, 0.03)), room.metal("Al", 0.12)
    turned = math.radians(turn)
    for x in (0.85, 3.5):
        for side in (-1, 1):
            y = 0.72 * side
            at = (position[0] + x * math.cos(turned) - y * math.sin(turned),
                  position[1] + x * math.sin(turned) + y * math.cos(turned), position[2] + 0.32)
            stand = placed((0, 0, 0),
                           (1, 0, 0), -90 * side).replace("</transform>", "") + placed(at, (0, 0, 1), turn).replace(
                               '<transform name="to_world">', "")
            tyre, rim = f.wheel()
            room.put(rubber + stand, tyre)
            room.put(alloy + stand, rim)
    for radiance, x in zip(lamps, (0.12, 4.33)):
        for y in (-0.55, 0.55):
            room.bulb((position[0] + x * math.cos(turned) - y * math.sin(turned),
                       position[1] + x * math.sin(turned) + y * math.cos(turned), position[2] + 0.62), 0.09, radiance)


def car_studio(out):
    room = Room("car-studio", out, depth=12)
    room.camera((-2.6, -4.6, 1.5), (1.6, 0.3, 0.55), 44)
    room.put(
        room.plastic((0.5, 0.5, 0.52), 0.12),
        f.sheet(
            60, 120, lambda u, v:
            (-7 + 16 * u, -7 + 10 * min(v / 0.7, 1) + 1.5 * math.sin(math.pi / 2 * min(max(v - 0.7, 0) / 0.1, 1)), 1.5 -
             1.5 * math.cos(math.pi / 2 * min(max(v - 0.7, 0) / 0.1, 1)) + 3 * max(v - 0.8, 0) / 0.2)))
    room.put(room.diffuse((0.25, 0.25, 0.26)), f.slab(-7, -7, 9, 5, 5, down=True), f.boxes(((-7.2, -7, 0), (-7, 5, 5))),
             f.boxes(((9, -7, 0), (9.2, 5, 5))), f.boxes(((-7, -7.2, 0), (9, -7, 5))))
    dark = room.plastic((0.02, 0.02, 0.022))
    car(room, (-0.6, -0.3, 0), 8, car_paint((0.5, 0.02, 0.03), 0.5, 1), dark, ((3, 3, 2.8), (1.2, 0.05, 0.03)))
    car(room, (3.1, 1.6, 0), -20,
        blended(room.metal("Al", 0.25, tint=(0.25, 0.45, 0.8)), room.plastic((0.02, 0.05, 0.2)), 0.4), dark)
    # Swatches, an engine part and cans on a bench.
    room.put(room.plastic("oak", 0.2), f.table(-4.2, 1.4, 2.2, 0.7))
    for i in range(12):
        colour = [room.random.uniform(0.03, 0.7) for _ in range(3)]
        room.put(
            car_paint(colour, 0.15 * (i % 5), 0.25 * (i % 4)) + placed((-4.0 + 0.17 * i, 1.75, 0.85),
                                                                       (0, 0, 1), 30 * i),
            f.rock((0, 0, 0), (0.08, 0.08, 0.1), i, 32, 1))
    room.put(room.metal("Cr", 0.05), f.knot((-3.6, 0.6, 0.02), 0.9))
    for x, y, w, d, power in ((-2.0, -2.2, 5.5, 1.4, 9), (-1.5, 1.2, 4.5, 0.8, 7), (-5.5, -3.0, 1.0, 4.0, 8)):
        room.panel(x, y, x + w, y + d, 4.2, (power, power, power))
    return room


def tunnel(out):
    room = Room("tunnel", out, depth=12)
    room.camera((1.7, 0.5, 1.6), (0.2, 30, 1.5), 58)
    long = 125

    def vault(u, v):
        angle = math.pi * u
        return (-5.2 * math.cos(angle), long * v, 2.0 + 3.8 * math.sin(angle))

    room.put(room.bumpy(room.diffuse("stone", 6), "bumps", 12, 0.05), f.sheet(96, 600, vault))
    tiled = room.plastic("white-tiles", 0.12, 0.6)
    room.put(tiled, f.wall("x", -5.2, long, 2.0), f.wall("x", 5.2, long, 2.0))
    room.put(room.diffuse((0.05, 0.05, 0.06)),
             f.boxes(((-5.2, -0.1, 0), (5.2, 0, 6)), ((-5.2, long, 0), (5.2, long + 0.1, 6))))
    road = f.Mesh()
    road.quad((-4.3, 0, 0), (4.3, 0, 0), (4.3, long, 0), (-4.3, long, 0))
    room.put(room.bumpy(room.plastic("asphalt", 0.12, 0.5), "bumps", 1.5, 0.01), road)
    room.put(room.diffuse("stone", 1), f.boxes(((-5.2, 0, 0), (-4.3, long, 0.25)), ((4.3, 0, 0), (5.2, long, 0.25))))
    paint = room.diffuse((0.8, 0.8, 0.76))
    room.put(paint, *[f.boxes(((-0.07, 2.0 + 8 * i, 0), (0.07, 5.0 + 8 * i, 0.004))) for i in range(15)],
             f.boxes(((-4.1, 0, 0), (-4.0, long, 0.004)), ((4.0, 0, 0), (4.1, long, 0.004))))
    sodium, white = (55, 30, 9), (35, 38, 40)
    for i in range(500):
        row, k = i % 4, i // 4
        x = (-3.2, -1.6, 1.6, 3.2)[row]
        z = 2.0 + 3.8 * math.sqrt(1 - (x / 5.2)**2) - 0.12
        room.panel(x - 0.07, 0.8 + 0.99 * k, x + 0.07, 1.2 + 0.99 * k, z, sodium if row in (0, 3) else white)
    room.put(
        room.metal("Al", 0.25), *[
            f.boxes(((x - 0.1, 0, 2.0 + 3.8 * math.sqrt(1 - (x / 5.2)**2) - 0.119),
                     (x + 0.1, long, 2.0 + 3.8 * math.sqrt(1 - (x / 5.2)**2) - 0.07))) for x in (-3.2, -1.6, 1.6, 3.2)
        ])
    front, rear, dark = (9, 9, 8), (5, 0.15, 0.08), room.plastic((0.02, 0.02, 0.022))
    for i, (x, y, turn) in enumerate(
        ((2.0, 13, -90), (-2.0, 9, 90), (2.1, 30, -90), (-2.1, 26, 90), (1.9, 52, -90), (-2, 47, 90))):
        colour = [room.random.uniform(0.05, 0.6) for _ in range(3)]
        car(room, (x, y, 0), turn,
            room.plastic(colour, 0.05) if i % 2 else car_paint(colour, 0.4, 1), dark, (front, rear), True)
    for i in range(10):
        room.put(
            light((0.3, 3, 0.8)) + room.diffuse((0.1, 0.1, 0.1)),
            f.boxes(((-5.17, 6 + 12 * i, 1.5), (-5.12, 6.7 + 12 * i, 1.75))))
    return room


def mirror_room(out):
    room = Room("mirror-room", out, depth=40, rfilter="tent")
    room.camera((0.5, 0.45, 1.6), (2.6, 3.2, 1.25), 70)
    mirror = room.metal("Ag")
    room.shell(4, 4.6, 3, mirror, room.plastic("chequers", 0.04, 0.5), room.diffuse((0.3, 0.3, 0.36)))
    room.put(room.metal("Au", 0.15),
             *[f.boxes(((x, y, 0), (x + 0.05, y + 0.05, 3))) for x in (0, 0.98, 1.98, 2.98, 3.95) for y in (0.0, 4.55)],
             *[f.boxes(((x, y, 0), (x + 0.05, y + 0.05, 3))) for x in (0, 3.95) for y in (1.1, 2.25, 3.4)])
    r = room.random
    for i in range(14):
        where = (r.uniform(0.7, 3.4), r.uniform(1.4, 4.2), r.uniform(1.5, 2.7))
        room.bulb(where, 0.05, ((12, 4, 2.5), (3, 5, 12), (10, 8, 4), (4, 11, 5))[i % 4])
        cord = f.Mesh()
        cord.tube([(where[0], where[1], where[2] + 0.035), (where[0], where[1], (where[2] + 3) / 2),
                   (where[0], where[1], 3)], 0.004, 8)
        room.put(room.diffuse((0.1, 0.1, 0.1)), cord)
    for i in range(4):
        x, y = 1.1 + 1.7 * (i % 2), 2.0 + 1.7 * (i // 2)
        room.put((mirror, room.metal("Au"))[i % 2], f.boxes(((x - 0.12, y - 0.12, 0), (x + 0.12, y + 0.12, 3))))
    for i in range(9):
        where = (r.uniform(0.7, 3.3), r.uniform(1.5, 4.1), 0.25)
        stuff = (mirror, GLASS, room.metal("Cu", 0.1), room.plastic("red-cloth", 0.1, 3))[i % 4]
        room.sphere(where, 0.16 + 0.02 * (i % 4), stuff)
    room.put(room.plastic((0.8, 0.15, 0.1)), f.chair(2.0, 2.9))
    return room


def ruins(out):
    room = Room("ruins", out, depth=12)
    room.camera((2.0, -9.0, 2.1), (0.5, 6.0, 2.2), 60)
    room.sky(3500, 215, 33)
    hills = pictures.Noise(81, ((5, 5), (13, 13), (29, 29), (128, 128)))

    def ground(x, y):
        far = max(abs(x), abs(y - 8), 12) - 12
        return 0.9 * (hills(x / 60 + 0.5, y / 60 + 0.5) - 0.5) * (1 + 0.25 * far)

    room.put(room.diffuse("grass", 12),
             f.sheet(840, 640, lambda u, v: (60 * u - 30, 60 * v - 16, ground(60 * u - 30, 60 * v - 16))))
    r = room.random
    stones = (room.diffuse("stone", 2), room.bumpy(room.diffuse("stone", 1), "bumps", 3, 0.03),
              room.plastic("marble", 0.3, 1), room.bumpy(room.plastic("slate", 0.35, 1), "waves", 1, 0.02))
    for i in range(20):
        x, y = (-4.2, 4.2)[i % 2], 2.4 * (i // 2) - 3
        tall = 5.2 if r.random() < 0.5 else r.uniform(1.2, 4.6)
        base = ground(x, y)
        room.put(stones[1 + i % 2], f.column((x, y, base), 0.5, tall, 20 + i, 220, 120))
        room.put(stones[0], f.boxes(((x - 0.7, y - 0.7, base - 1), (x + 0.7, y + 0.7, base + 0.3))))
    for i in range(16):  # blocks on the ground, and drums of fallen columns
        x, y, size = r.uniform(-7, 7), r.uniform(-4, 20), r.uniform(0.25, 0.8)
        room.put(stones[i % 4] + placed((x, y, ground(x, y) + 0.4 * size), (0.3, 0.2, 1), 360 * r.random()),
                 f.rock((0, 0, 0), (size, 0.7 * size, 0.6 * size), i, 90, 0.35))
    for i in range(6):
        x, y = r.uniform(-3.5, 3.5), r.uniform(-3, 16)
        room.put(stones[1] + placed((x, y, ground(x, y) + 0.45), (r.uniform(-1, 1), 1, 0), 90),
                 f.column((0, 0, 0), 0.46, r.uniform(0.8, 2.2), 50 + i, 160, 80))
    wall_at = 20.5
    for row in range(9):  # the wall of a temple with a gate and a broken edge
        for k in range(12):
            x = -7.2 + 1.25 * k + 0.6 * (row % 2)
            if row > 8 - abs(hills(k / 12, 0.3) - 0.5) * 22 or (abs(x - 0.2) < 1.5 and row < 5):
                continue
            room.put(stones[(row + k) % 4],
                     f.rock((x, wall_at, 0.35 + 0.7 * row), (0.61, 0.5, 0.345), 100 * row + k, 50, 0.22))
    for i in range(14):
        k = r.randrange(20)
        x, y = (-4.2, 4.2)[k % 2] + r.uniform(-0.4, 0.4), 2.4 * (k // 2) - 3.5
        green = (r.uniform(0.05, 0.2), r.uniform(0.2, 0.42), 0.05)
        room.put(room.cut(room.diffuse(green), "leaf"), f.plant((x, y, ground(x, y)), 260, r.uniform(0.6, 2.5),
                                                                120 + i))
    room.put(room.plastic("marble", 0.2, 1), f.boxes(((-0.6, 9.4, -1), (0.6, 10.6, 1.0))))
    room.put(room.bumpy(room.plastic("marble", 0.2), "bumps", 4, 0.01), f.statue((0, 10, 1.0), 2.6, 200, 300, 7))
    return room
