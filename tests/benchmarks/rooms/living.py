"""Rooms that people live and work in: one function each, which makes the scene in a folder of OUT."""

import math

import furniture as f
from modelling import light
from room import GLASS, METALS, Room, frosted, placed


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
             f.sheet(300, 300, lambda u, v: (1.35 + 0.5 * u, 3.3 + 0.02 * math.sin(25 * u), 0.4 + 0.7 * v)))
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


def steel_kitchen(out):
    room = Room("steel-kitchen", out, depth=18)
    room.camera((0.5, 0.4, 1.65), (3.1, 4.4, 0.95), 66)
    room.sky(0, scale=1.3)
    room.shell(5, 5.5, 2.9, room.plastic("white-tiles", 0.08), room.plastic("slate", 0.12, 0.6),
               room.diffuse((0.85, 0.85, 0.83)), [("right", (1.2, 1.1, 3.4, 2.2), 3)], "thin")
    brushed, dented = room.metal("Cr", "brushed"), room.dented(room.metal("Cr", 0.15), "waves", 0.5)
    polished = room.metal("Cr", 0.05, "beckmann")
    for i in range(7):
        x = 0.35 + 0.62 * i
        room.put(brushed, f.boxes(((x, 4.8, 0.1), (x + 0.6, 5.5, 0.86))))
        if abs(i - 3) > 1:
            room.put(dented, f.boxes(((x, 5.1, 1.65), (x + 0.6, 5.5, 2.4))))
        room.put(polished, f.boxes(((x + 0.1, 4.76, 0.76), (x + 0.5, 4.78, 0.78))))
    room.put(dented, f.boxes(((0.33, 4.77, 0.88), (4.7, 5.5, 0.92))), f.boxes(((1.6, 2.2, 0.86), (3.6, 3.1, 0.9))))
    room.put(brushed, f.boxes(((1.7, 2.3, 0.3), (3.5, 3.0, 0.32))),
             *[f.boxes(((x, y, 0), (x + 0.05, y + 0.05, 0.86))) for x in (1.65, 3.5) for y in (2.25, 3.0)])
    room.put(dented, f.boxes(((0.0, 3.2, 0.05), (0.75, 4.6, 2.1))))
    room.put(polished, f.boxes(((0.78, 3.85, 0.5), (0.8, 3.88, 1.8))))
    # A hood with bulbs above four burners.
    room.put(
        brushed,
        f.boxes(((1.6, 4.75, 1.7), (3.4, 4.77, 2.0)), ((1.6, 4.77, 1.7), (1.62, 5.5, 2.0)),
                ((3.38, 4.77, 1.7), (3.4, 5.5, 2.0)), ((1.6, 4.75, 2.0), (3.4, 5.5, 2.02))),
        f.turned([(0.18, 0), (0.18, 0.3), (0.18, 0.6), (0.18, 0.9)], (2.5, 5.15, 2.02)))
    for i in range(4):
        x = 1.8 + 0.42 * i
        room.bulb((x + 0.07, 5.1, 1.92), 0.03, (60, 52, 40))
        room.put(room.diffuse((0.03, 0.03, 0.03)),
                 f.turned([(0, 0), (0.13, 0), (0.13, 0.015), (0, 0.015)], (x + 0.07, 5.1, 0.921)))
    for i in range(26):
        metal = ("Cr", "Cu", "Al", "Ag")[i % 4]
        radius = room.random.uniform(0.07, 0.13)
        pot = [(0, 0), (radius, 0), (radius, 1.3 * radius), (radius - 0.004, 1.3 * radius), (radius - 0.004, 0.006),
               (0, 0.006)]
        x, y = 1.75 + 0.22 * (i % 8), 2.4 + 0.2 * (i // 8 % 3)
        where = (x, y, 0.322) if i < 16 else (0.55 + 0.42 * (i - 16), 5.25, 0.921)
        room.put(room.metal(metal, (0, 0.08, "brushed", 0.2)[i // 2 % 4]), f.turned(pot, where))
    # Ladles and pans of copper on a rail above the table.
    room.put(
        polished,
        f.boxes(((1.6, 2.64, 2.0), (3.6, 2.66, 2.02)), ((1.62, 2.64, 2.02), (1.64, 2.66, 2.9)),
                ((3.56, 2.64, 2.02), (3.58, 2.66, 2.9))))
    for i in range(9):
        x = 1.75 + 0.21 * i
        handle = f.Mesh()
        handle.tube([(x, 2.63, 2.03), (x, 2.63, 1.85), (x, 2.63, 1.66)], 0.008, 16)
        room.put(room.metal("Cu", 0.1), f.bowl((x, 2.63, 1.6), 0.05 + 0.012 * (i % 4)))
        room.put(polished, handle)
    for i in range(10):
        where = (1.8 + 0.17 * i, 2.8 - 0.06 * (i % 3), 0.901)
        room.put((GLASS, room.plastic((0.85, 0.84, 0.8)), polished)[i % 3],
                 (f.tumbler, f.bowl, f.goblet)[i % 3](where, (0.035, 0.11, 0.18)[i % 3]))
    room.put(polished, f.tap(4.3, 5.4, 0.92), f.bowl((2.9, 2.45, 0.901), 0.2))
    room.put(
        room.diffuse((0.75, 0.4, 0.1)), *[
            f.rock((2.9 + 0.07 * math.cos(2 * i), 2.45 + 0.07 * math.sin(2 * i), 0.98), (0.045, 0.045, 0.042),
                   i,
                   power=1) for i in range(3)
        ])
    for i in range(6):
        x, y = 0.9 + 1.5 * (i % 3), 1.2 + 2.2 * (i // 3)
        room.panel(x, y, x + 0.9, y + 0.15, 2.88, (30, 31, 32))
    return room


def attic(out):
    room = Room("attic", out, depth=20, rfilter="tent")
    room.camera((3.5, 0.4, 1.6), (2.1, 4.6, 0.75), 68)
    room.sky(9000, 78, 24, scale=3)
    planks, beams = room.diffuse("oak", 0.8), room.plastic("oak", 0.35, 1.5)
    hole = (2.0, 1.1, 2.9, 2.0)
    room.put(planks, f.wall("y", 0, 5, 3.4), f.wall("y", 6, 5, 3.4, [hole]))
    bars, slab = f.window("y", 6, hole, 1, 2)
    room.put(room.diffuse((0.7, 0.68, 0.62)), bars)
    room.put(GLASS, slab)
    room.put(room.diffuse("oak", 0.5), f.slab(0, 0, 5, 6, 0))
    ridge, eaves = (2.5, 3.3), 0.7
    for x in (0, 5):
        side, across = f.Mesh(), 0.0 if x else 0.05
        side.quad((x, 0, eaves), (x, 6, eaves), (ridge[0], 6, ridge[1]), (ridge[0], 0, ridge[1]))
        room.put(room.diffuse("oak", 0.7), side)
        room.put(planks, f.wall("x", x, 6, eaves))
        for i in range(7):
            y = 0.3 + 0.9 * i
            base = [(x, y, eaves - 0.13), (x, y, eaves + 0.02), (x, y + 0.1, eaves + 0.02), (x, y + 0.1, eaves - 0.13)]
            room.put(beams, f.prism(base[::-1] if x else base, (ridge[0] - x, 0, ridge[1] - eaves)))
        room.put(beams, f.boxes(((abs(x - across) - 0.05, 0, eaves - 0.1), (abs(x - across) + 0.05, 6, eaves))))
    room.put(beams, *[f.boxes(((1.0, y, 2.2), (4.0, y + 0.1, 2.35))) for y in (1.2, 3.0, 4.8)],
             f.boxes(((2.44, 0, 3.1), (2.56, 6, 3.25))),
             *[f.boxes(((2.44, y, 0), (2.56, y + 0.12, 3.1))) for y in (3.0, 5.6)])
    # Boxes of cardboard, a chest, and what nobody throws away.
    r, cardboard = room.random, ((0.5, 0.36, 0.22), (0.44, 0.3, 0.18), (0.6, 0.47, 0.3))
    for i in range(24):
        x, y, size = 0.2 + 0.55 * (i % 2) + r.uniform(0, 0.1), 0.9 + 0.42 * (i // 2), r.uniform(0.25, 0.4)
        x = 5.0 - x - size if i // 2 % 3 == 2 else x
        room.put(room.diffuse(cardboard[i % 3]), f.boxes(((x, y, 0), (x + size, y + 0.38, size))))
        if i % 5 == 0 and x < 4.4:
            room.books(x + 0.02, y + 0.05, size, size - 0.04)
    room.put(room.plastic("walnut", 0.15), f.boxes(((1.5, 4.6, 0.02), (2.3, 5.1, 0.45))))
    room.put(room.metal("Cu", "smudges"), *[f.boxes(((x, 4.59, 0.01), (x + 0.06, 5.11, 0.46))) for x in (1.6, 2.14)])
    room.put(room.metal("Ag"), f.boxes(((4.05, 4.3, 0.06), (4.07, 5.0, 1.3))))
    room.put(room.metal("Au", 0.2), f.boxes(((4.07, 4.25, 0), (4.12, 5.05, 1.36))))
    room.put(room.diffuse("marble", 2), f.statue((1.75, 4.85, 0.45), 0.6, 100, 160, 2))
    room.put(room.plastic("oak", 0.2), f.chair(2.9, 3.8, -1), f.chair(3.5, 2.9))
    room.put(room.diffuse("red-cloth", 4), f.rug(1.3, 1.6, 1.9, 2.3, 250, 250, 8))
    room.put(GLASS, f.vase((1.9, 2.6, 0.02), 0.35), f.bottle((2.15, 2.75, 0.02)), f.bottle((2.3, 2.5, 0.02), 0.25))
    room.put(room.metal("Cu", 0.15), f.teapot((2.9, 3.8, 0.49), 0.3))
    room.put(room.bumpy(room.diffuse("linen", 3), "bumps", 4, 0.01), f.cushion(2.7, 4.6, 0, 0.9, 0.7, 0.35, 120))
    return room


def library_night(out):
    room = Room("library-night", out, depth=14)
    room.camera((3.5, 0.4, 1.75), (3.4, 6.0, 1.15), 64)
    room.sky(0, scale=0.05)
    room.shell(7, 8, 3.6, room.plastic("walnut", 0.25, 0.7), room.plastic("oak", 0.1, 0.6),
               room.diffuse((0.85, 0.83, 0.78)), [("right", (0.8, 1.0, 2.6, 3.0), 2),
                                                  ("left", (0.8, 1.0, 2.6, 3.0), 2)], "thin")
    case = room.plastic("walnut", 0.12)
    for x, y, width in ((0.1, 3.4, 1.7), (0.1, 5.0, 1.7), (5.2, 3.4, 1.7), (5.2, 5.0, 1.7), (0.15, 7.6, 2.1),
                        (2.45, 7.6, 2.1), (4.75, 7.6, 2.1)):
        room.put(case, f.shelf(x, y, width, 2.5, rows=7))
        for row in range(7):
            room.books(x + 0.02,
                       y + 0.03,
                       2.5 * row / 7 + 0.026, (width - 0.04) * room.random.uniform(0.75, 1),
                       tall=0.31)
    for i in range(3):
        y = 1.7 + 1.7 * i
        room.put(room.plastic("oak", 0.06, 1.2), f.table(2.4, y, 2.2, 0.9))
        room.put(room.plastic("walnut", 0.2), *[f.chair(x, y - 0.25, -1) for x in (2.9, 4.1)])
        for x in (2.75, 3.5, 4.25):
            room.lamp(x, y + 0.55, 0.75, (700, 520, 300))
        for x in (3.0, 3.8):
            low = 0.751
            for k in range(1 + (i + int(x)) % 3):
                cover, pages = f.book((0, 0, 0), (0.035, 0.2, 0.28))
                lying = placed((x + 0.02 * k, y + 0.2, low + 0.036), (0, 1, 0), 90)
                room.put(room.any_material(0.4) + lying, cover)
                room.put(room.diffuse((0.8, 0.77, 0.68)) + lying, pages)
                low += 0.036
        room.put(GLASS, f.tumbler((3.2, y + 0.7, 0.751)))
    room.put(room.metal("Cu", 0.2), f.statue((2.1, 6.9, 0), 1.5, 150, 200, 6))
    room.put(room.diffuse("red-cloth", 3), f.rug(2.0, 1.2, 3.0, 5.6, 200, 360, 9))
    room.lamp(6.3, 6.6, 1.0, (700, 520, 300))
    room.put(case, f.boxes(((6.1, 6.4, 0), (6.5, 6.8, 1.0))))
    return room


def greenhouse(out):
    room = Room("greenhouse", out, depth=24, rfilter="tent")
    room.camera((2.5, 0.25, 1.65), (2.45, 5.5, 1.05), 68)
    room.sky(5000, 40, 48)
    frame = room.plastic((0.75, 0.77, 0.74), 0.2)
    room.put(room.diffuse("grass", 0.3), f.slab(-20, -20, 25, 27, -0.05))
    room.put(room.diffuse("stone", 1.5), f.boxes(((0, 0, -0.04), (5, 7, 0))))
    room.put(room.plastic("slate", 0.3, 1.5), f.boxes(((1.9, 0, 0), (3.1, 6.4, 0.02))))
    room.put(
        room.diffuse("stone", 2),
        f.boxes(((-0.1, 0, 0), (0.1, 7, 0.5)), ((4.9, 0, 0), (5.1, 7, 0.5)), ((0.1, 6.9, 0), (4.9, 7.1, 0.5)),
                ((0.1, -0.1, 0), (4.9, 0.1, 0.5))))
    eaves, ridge = 2.3, 3.5
    for i in range(8):  # bars, with a plate of glass between each and the next
        y = i * 1.0 - 0.03 + (0.03, 0, 0, 0, 0, 0, 0, -0.03)[i]
        room.put(frame, f.boxes(((-0.03, y, 0.5), (0.03, y + 0.06, eaves)), ((4.97, y, 0.5), (5.03, y + 0.06, eaves))))
        for x in (0, 5):
            base = [(x, y, eaves - 0.06), (x, y, eaves), (x, y + 0.06, eaves), (x, y + 0.06, eaves - 0.06)]
            room.put(frame, f.prism(base[::-1] if x else base, (2.5 - x, 0, ridge - eaves)))
            if i < 7:
                room.put(GLASS, f.boxes(((x - 0.004, i + 0.02, 0.49), (x + 0.004, i + 0.98, eaves - 0.02))))
                low = [(x, i + 0.02, eaves - 0.034), (x, i + 0.02, eaves - 0.026), (x, i + 0.98, eaves - 0.026),
                       (x, i + 0.98, eaves - 0.034)]
                room.put(GLASS, f.prism(low[::-1] if x else low, (2.48 - x, 0, ridge - eaves)))
    room.put(frame, f.boxes(((2.45, 0, ridge - 0.07), (2.55, 7, ridge))),
             *[f.boxes(((x - 0.05, 0, eaves - 0.08), (x + 0.05, 7, eaves))) for x in (0, 5)])
    for k in range(5):
        room.put(frame, f.boxes(((k * 1.2 + 0.08, 6.97, 0.5), (k * 1.2 + 0.14, 7.03, eaves + 0.9))))
        if k < 4:
            room.put(GLASS, f.boxes(((k * 1.2 + 0.13, 6.996, 0.49), (k * 1.2 + 1.29, 7.004, eaves))))
    # Beds, pots and climbing plants.
    r, soil = room.random, room.diffuse((0.16, 0.1, 0.06))
    for x in (0.2, 3.3):
        room.put(
            room.plastic("oak", 0.4),
            f.boxes(((x, 0.8, 0), (x + 0.04, 6.4, 0.35)), ((x + 1.46, 0.8, 0), (x + 1.5, 6.4, 0.35)),
                    ((x + 0.04, 0.8, 0), (x + 1.46, 0.84, 0.35))))
        room.put(soil, f.rug(x + 0.04, 0.84, 1.42, 5.56, 100, 300, 12),
                 f.boxes(((x + 0.04, 0.84, 0), (x + 1.46, 6.4, 0.3))))
        for i in range(24):
            green = (r.uniform(0.06, 0.25), r.uniform(0.28, 0.5), r.uniform(0.04, 0.12))
            where = (x + 0.3 + 0.45 * (i % 3), 1.1 + 0.68 * (i // 3), 0.3)
            tall = 0.35 + 0.05 * (i // 3) + (0.5 if i % 3 == (0 if x < 1 else 2) else 0)
            room.put(room.cut(room.plastic(green, 0.3) if i % 2 else room.diffuse(green), "leaf"),
                     f.plant(where, 160, tall, 40 + i))
            if i % 4 == 1:
                room.put(
                    room.plastic((0.7, 0.06, 0.04), 0.05), *[
                        f.rock((where[0] + r.uniform(-0.15, 0.15), where[1] + r.uniform(-0.15, 0.15),
                                where[2] + r.uniform(0.2, tall)), (0.03, 0.03, 0.027), k, 16, 1) for k in range(8)
                    ])
    for i in range(10):
        x, y = (1.98, 3.02)[i % 2], 1.3 + 0.5 * i
        room.put(room.diffuse((0.55, 0.27, 0.15)), f.vase((x, y, 0.02), 0.28, 64))
        room.put(room.cut(room.diffuse((0.15, 0.42, 0.1)), "leaf"), f.plant((x, y, 0.25), 80, 0.3, 90 + i))
    room.put(room.metal("Al", "smudges"), f.teapot((2.75, 1.7, 0.02), 0.35))
    return room
