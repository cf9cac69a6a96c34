"""A market at night with thousands of small lights, in metres. Usage: python3 night_market.py FOLDER"""

import math
import os
import random
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from modelling import Mesh, Scene, light, numbers, ref, spline

SCENE = Scene("night-market")
RANDOM = random.Random(11)
STREET = 1.9  # half the width between the stalls
FAR = 34.0

SCENE.add("""
<default name="spp" value="224"/>
<default name="width" value="800"/>
<default name="height" value="450"/>
<integrator type="path"><integer name="max_depth" value="6"/></integrator>
<sensor type="perspective">
  <float name="fov" value="60"/>
  <transform name="to_world"><lookat origin="-0.45, -3.6, 1.5" target="0.2, 8, 1.95" up="0, 0, 1"/></transform>
  <sampler type="sobol"><integer name="sample_count" value="$spp"/></sampler>
  <film type="hdrfilm">
    <integer name="width" value="$width"/><integer name="height" value="$height"/><rfilter type="gaussian"/>
  </film>
</sensor>
<texture type="checkerboard" id="stones">
  <texture type="noise" name="color0">
    <rgb name="color0" value="0.05, 0.05, 0.055"/><rgb name="color1" value="0.16, 0.15, 0.15"/>
    <transform name="to_uv"><scale x="3" y="3"/></transform>
  </texture>
  <texture type="noise" name="color1">
    <rgb name="color0" value="0.09, 0.085, 0.085"/><rgb name="color1" value="0.22, 0.2, 0.19"/>
    <integer name="seed" value="3"/><transform name="to_uv"><scale x="3" y="3"/></transform>
  </texture>
  <transform name="to_uv"><scale x="1.1" y="1.1"/></transform>
</texture>
<bsdf type="blendbsdf" id="wet stones">
  <texture type="noise" name="weight">
    <rgb name="color0" value="0.1"/><rgb name="color1" value="1"/><integer name="octaves" value="4"/>
    <transform name="to_uv"><scale x="0.9" y="0.9"/></transform>
  </texture>
  <bsdf type="diffuse"><ref name="reflectance" id="stones"/></bsdf>
  <bsdf type="bumpmap">
    <texture type="noise">
      <integer name="octaves" value="2"/><transform name="to_uv"><scale x="1.5" y="1.5"/></transform>
    </texture>
    <float name="scale" value="0.006"/>
    <bsdf type="plastic"><ref name="diffuse_reflectance" id="stones"/><float name="int_ior" value="1.36"/></bsdf>
  </bsdf>
</bsdf>
<bsdf type="diffuse" id="boards">
  <texture type="noise" name="reflectance">
    <rgb name="color0" value="0.12, 0.06, 0.03"/><rgb name="color1" value="0.36, 0.21, 0.11"/>
    <integer name="octaves" value="5"/><transform name="to_uv"><scale x="1.3" y="16"/></transform>
  </texture>
</bsdf>
<bsdf type="diffuse" id="posts"><rgb name="reflectance" value="0.07, 0.055, 0.045"/></bsdf>
<bsdf type="diffuse" id="cable"><rgb name="reflectance" value="0.02, 0.02, 0.02"/></bsdf>
<bsdf type="diffuse" id="bricks">
  <texture type="noise" name="reflectance">
    <rgb name="color0" value="0.10, 0.055, 0.045"/><rgb name="color1" value="0.24, 0.15, 0.12"/>
    <integer name="octaves" value="6"/><transform name="to_uv"><scale x="1.2" y="3.5"/></transform>
  </texture>
</bsdf>
<bsdf type="roughconductor" id="brass"><string name="material" value="Au"/><float name="alpha" value="0.25"/></bsdf>
<bsdf type="roughconductor" id="steel"><string name="material" value="Cr"/><float name="alpha" value="0.25"/></bsdf>
<emitter type="constant"><rgb name="radiance" value="0.014, 0.02, 0.05"/></emitter>
""")

AWNINGS = ((0.75, 0.08, 0.06), (0.05, 0.35, 0.6), (0.08, 0.45, 0.2), (0.8, 0.4, 0.05), (0.45, 0.1, 0.45), (0.05, 0.45,
                                                                                                           0.45))
FRUIT = ((0.75, 0.3, 0.03), (0.65, 0.06, 0.04), (0.3, 0.5, 0.05), (0.75, 0.6, 0.08), (0.28, 0.05, 0.22), (0.7, 0.2,
                                                                                                          0.15))
WARM, WHITE = (1.0, 0.46, 0.12), (1.0, 0.72, 0.4)
PARTY = (WARM, WARM, (1, 0.04, 0.02), (0.03, 0.8, 0.08), (0.04, 0.18, 1), (1, 0.06, 0.45), (1, 0.55, 0.03))

for i, colour in enumerate(AWNINGS):
    SCENE.add(
        f"""<bsdf type="twosided" id="awning {i}"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance">
  <rgb name="color0" value="{numbers(colour)}"/><rgb name="color1" value="0.75, 0.72, 0.66"/>
  <transform name="to_uv"><scale x="1.25" y="0.0001"/></transform></texture></bsdf></bsdf>""")
for i, colour in enumerate(FRUIT):
    SCENE.add(f"""<bsdf type="roughplastic" id="fruit {i}"><rgb name="diffuse_reflectance" value="{numbers(colour)}"/>
  <float name="alpha" value="0.15"/></bsdf>""")


def lamp(centre, radius, colour, radiance):
    SCENE.sphere(centre, radius, light([c * radiance for c in colour]))


def garland(a, b, sag, spacing, colours, radius=0.03, radiance=20.0):
    """A cable from a to b with bulbs below it."""
    steps = max(8, int(math.dist(a, b) / 0.25))
    points = []
    for i in range(steps + 1):
        t = i / steps
        points.append(tuple(a[k] + (b[k] - a[k]) * t - (4 * sag * t * (1 - t) if k == 2 else 0) for k in range(3)))
    cables.tube(points, 0.007, 5)
    count = int(math.dist(a, b) / spacing)
    for i in range(1, count):
        t = i / count
        x, y, z = (a[k] + (b[k] - a[k]) * t for k in range(3))
        z -= 4 * sag * t * (1 - t)
        lamp((x, y, z - radius - 0.012), radius,
             colours[i % len(colours)] if len(colours) < 4 else RANDOM.choice(colours), radiance)


cables, boards, posts, bricks, brass, steel = (Mesh() for _ in range(6))
awnings = [Mesh() for _ in AWNINGS]
LANTERN = spline([(0.05, -0.2), (0.12, -0.18), (0.2, -0.09), (0.22, 0), (0.2, 0.09), (0.12, 0.18), (0.05, 0.2)], 4)


def ribbed(colour):
    """The light of a paper lantern: stripes between its ribs."""
    return f"""<emitter type="area"><texture type="checkerboard" name="radiance">
  <rgb name="color0" value="{numbers([0.95 * c for c in colour])}"/>
  <rgb name="color1" value="{numbers([0.55 * c for c in colour])}"/>
  <transform name="to_uv"><scale x="0.0001" y="10"/></transform></texture></emitter>"""


LANTERNS = ((1.0, 0.16, 0.05), (1.0, 0.45, 0.1), (1.0, 0.75, 0.4), (0.25, 0.75, 0.5), (0.9, 0.2, 0.35))
lanterns = [Mesh() for _ in LANTERNS]


def lantern(x, y, z, kind, size=1.0):
    """A paper lantern and the ends of its frame."""
    lanterns[kind].lathe([(r * size, h * size) for r, h in LANTERN], (x, y, z), 20)
    posts.lathe([(0, 0.17 * size), (0.075 * size, 0.17 * size), (0.075 * size, 0.225 * size), (0, 0.225 * size)],
                (x, y, z), 12)
    posts.lathe([(0, -0.225 * size), (0.075 * size, -0.225 * size), (0.075 * size, -0.17 * size), (0, -0.17 * size)],
                (x, y, z), 12)


# Stalls on both sides
WIDTH, PITCH = 2.3, 2.75
number = 0
for side in (-1, 1):
    y = -2.2 if side > 0 else -1.2
    while y < FAR - 3:
        kind = number % len(AWNINGS)
        front, back = side * STREET, side * (STREET + 1.7)

        def box(mesh, x0, x1, y0, y1, z0, z1):
            low, high = sorted((side * x0, side * x1))
            mesh.box((low, y0, z0), (high, y1, z1), (RANDOM.uniform(0, 50), RANDOM.uniform(0, 50)))

        near, far = y, y + WIDTH
        for px in (STREET + 0.02, STREET + 1.65):
            for py in (near, far - 0.07):
                box(posts, px, px + 0.07, py, py + 0.07, 0, 2.25 if px < STREET + 1 else 2.72)
        # the counter, of boards
        for i in range(4):
            box(boards, STREET + 0.1, STREET + 0.13, near + 0.03, far - 0.03, 0.06 + 0.21 * i, 0.255 + 0.21 * i)
        box(boards, STREET + 0.05, STREET + 0.95, near, far, 0.9, 0.94)
        box(boards, STREET + 1.72, STREET + 1.76, near, far, 0, 2.6)
        # shelves at the back
        for z in (1.25, 1.75):
            box(boards, STREET + 1.4, STREET + 1.72, near + 0.05, far - 0.05, z, z + 0.03)
        # the awning and its border
        a = [(side * (STREET - 0.45), near - 0.1, 2.12), (side * (STREET - 0.45), far + 0.1, 2.12),
             (side * (STREET + 1.78), far + 0.1, 2.8), (side * (STREET + 1.78), near - 0.1, 2.8)]
        if side < 0:
            a = [a[1], a[0], a[3], a[2]]
        awnings[kind].quad(*a)
        low = [(x, yy, z - 0.16) for x, yy, z in a[:2]]
        awnings[kind].quad(low[0], low[1], a[1], a[0])
        # lights along the awning
        colours = (WARM, WHITE) if number % 3 else PARTY
        for i in range(24):
            t = (i + 0.5) / 24
            lamp((side * (STREET - 0.47), near - 0.1 + (WIDTH + 0.2) * t, 1.935), 0.024,
                 colours[i % len(colours)] if len(colours) < 4 else RANDOM.choice(colours), 24)
        # crates with fruit, pots of brass and steel, bowls
        goods = number % 4
        if goods in (0, 2):
            for c in range(4):
                y0 = near + 0.12 + 0.53 * c
                for wall in ((STREET + 0.12, STREET + 0.14, y0, y0 + 0.48),
                             (STREET + 0.8, STREET + 0.82, y0, y0 + 0.48), (STREET + 0.14, STREET + 0.8, y0, y0 + 0.02),
                             (STREET + 0.14, STREET + 0.8, y0 + 0.46, y0 + 0.48)):
                    box(boards, *wall, 0.94, 1.08)
                fruit = RANDOM.randrange(len(FRUIT))
                for layer, (rows, columns) in enumerate(((6, 4), (5, 3), (3, 2))):
                    for i in range(rows):
                        for j in range(columns):
                            x = STREET + 0.47 + (i - (rows - 1) / 2) * 0.107
                            yy = y0 + 0.24 + (j - (columns - 1) / 2) * 0.107
                            SCENE.sphere((side * x, yy, 0.995 + 0.078 * layer), 0.053,
                                         ref(f"fruit {(fruit + (c % 2) * 2) % len(FRUIT)}"))
        else:
            mesh = brass if goods == 1 else steel
            for i in range(7):
                for j in range(2):
                    size = RANDOM.uniform(0.75, 1.25) * (0.85 + 0.3 * j)
                    pot = spline([(0.001, 0), (0.055, 0), (0.1, 0.06), (0.105, 0.12), (0.06, 0.19), (0.05, 0.22),
                                  (0.075, 0.26)], 4)
                    mesh.lathe([(r * size, z * size) for r, z in pot],
                               (side * (STREET + 0.28 + 0.42 * j), near + 0.2 + 0.315 * i, 0.942), 24)
        for z in (1.28, 1.78):
            for i in range(9):
                size = RANDOM.uniform(0.6, 1.0)
                jar = spline([(0.001, 0), (0.07, 0), (0.1, 0.05), (0.1, 0.22), (0.05, 0.3), (0.05, 0.34),
                              (0.001, 0.34)], 3)
                RANDOM.choice((brass, steel)).lathe([(r * size, h * size) for r, h in jar],
                                                    (side * (STREET + 1.56), near + 0.2 + 0.235 * i, z + 0.001), 16)
        # lanterns under the awning
        for i in range(2):
            lantern(side * (STREET + 0.35), near + 0.6 + 1.1 * i, 1.83, RANDOM.randrange(3), 0.62)
            lamp((side * (STREET + 0.9), near + 0.55 + 1.2 * i, 2.12), 0.045, WARM if number % 2 else WHITE, 260)
        number += 1
        y += PITCH

# Barrels with fruit before the stalls
for x, y, fruit in ((1.5, 1.2, 0), (-1.52, 2.35, 1), (1.5, 6.7, 2), (-1.52, 7.8, 3), (1.5, 12.2, 4), (-1.52, 13.3, 0)):
    boards.lathe(
        spline([(0.001, 0), (0.22, 0), (0.27, 0.2), (0.29, 0.36), (0.27, 0.52), (0.23, 0.7), (0.21, 0.7), (0.21, 0.62),
                (0.001, 0.62)], 6), (x, y, 0), 32)
    for z, radius in ((0.13, 0.262), (0.58, 0.264)):
        steel.lathe([(radius, z - 0.02), (radius + 0.006, z - 0.018), (radius + 0.006, z + 0.018), (radius, z + 0.02)],
                    (x, y, 0), 32)
    for ring, count, z in ((0.152, 8, 0.672), (0.055, 3, 0.672), (0.1, 5, 0.745), (0, 1, 0.80)):
        for i in range(count):
            a = 2 * math.pi * i / count + ring * 9
            SCENE.sphere((x + ring * math.cos(a), y + ring * math.sin(a), z), 0.05, ref(f"fruit {fruit}"))

# A big wheel behind the market
HUB, RADIUS = (0.6, FAR + 9, 9.4), 7.0
for radius in (RADIUS, RADIUS * 0.62):
    circle = [(HUB[0] + radius * math.cos(2 * math.pi * i / 96), HUB[1],
               HUB[2] + radius * math.sin(2 * math.pi * i / 96)) for i in range(97)]
    posts.tube(circle, 0.06, 8)
    for i in range(0, 96):
        x, y, z = circle[i]
        lamp((x, y - 0.16, z), 0.075, PARTY[2 + i // 6 % 5] if radius == RADIUS else WHITE, 12)
for i in range(16):
    a = 2 * math.pi * i / 16
    tip = (HUB[0] + RADIUS * math.cos(a), HUB[1], HUB[2] + RADIUS * math.sin(a))
    posts.tube([HUB, tip], 0.05, 6)
    for k in range(3, 20):
        lamp([HUB[j] + (tip[j] - HUB[j]) * k / 20 - (0.16 if j == 1 else 0) for j in range(3)], 0.055, PARTY[2 + i % 5],
             9)
    lantern(tip[0], tip[1], tip[2] - 0.75, i % len(LANTERNS), 2.4)
for side in (-1, 1):
    posts.tube([(HUB[0], HUB[1] + 0.5, HUB[2]), (HUB[0] + side * 3.5, HUB[1] + 0.5, 0)], 0.14, 8)

# Houses behind the stalls, with windows
windows = Mesh()
for side in (-1, 1):
    for i in range(8):
        y0, y1 = -6 + 5.2 * i, -6 + 5.2 * (i + 1)
        top = RANDOM.uniform(5.6, 8.0)
        depth = RANDOM.uniform(0, 0.25)
        low, high = sorted((side * (STREET + 2.0 + depth), side * (STREET + 6)))
        bricks.box((low, y0, 0), (high, y1 - 0.02, top), (RANDOM.uniform(0, 50), 0))
        for k in range(3):
            for z in (3.4, 5.0):
                yy = y0 + 0.75 + 1.5 * k
                if z + 1.0 > top - 0.3:
                    continue
                x = side * (STREET + 2.0 + depth - 0.02)
                corners = [(x, yy, z), (x, yy + 0.8, z), (x, yy + 0.8, z + 1.1), (x, yy, z + 1.1)]
                if side > 0:
                    corners.reverse()
                if RANDOM.random() < 0.45:
                    windows.quad(*corners)
                for a, b, c, d in ((yy - 0.06, yy + 0.86, z - 0.08, z), (yy - 0.06, yy + 0.86, z + 1.1, z + 1.16),
                                   (yy - 0.06, yy, z, z + 1.1), (yy + 0.8, yy + 0.86, z, z + 1.1),
                                   (yy + 0.385, yy + 0.415, z, z + 1.1), (yy, yy + 0.8, z + 0.62, z + 0.65)):
                    low, high = sorted((x, x - side * 0.06))
                    posts.box((low, a, c), (high, b, d))

# Garlands and lanterns across the street
y, k = 0.5, 0
while y < FAR:
    height = 3.55 + 0.25 * math.sin(k * 1.7)
    garland((-STREET - 2, y, height + 0.35), (STREET + 2, y + RANDOM.uniform(-0.8, 0.8), height + 0.3), 0.55, 0.11,
            PARTY if k % 2 else (WARM, WHITE))
    if k % 2 == 0:
        for i in range(5):
            x = -1.7 + 0.85 * i
            z = height - 0.62 + 0.13 * abs(i - 2) - 0.1 * (i % 2)
            posts.tube([(x, y + 0.5, height - 0.1), (x, y + 0.5, z + 0.2)], 0.006, 5)
            lantern(x, y + 0.5, z, (k + i) % len(LANTERNS), 0.8)
        garland((-STREET - 2, y + 0.5, height + 0.4), (STREET + 2, y + 0.5, height + 0.4), 0.5, 100, (WARM,))
    y += 2.3
    k += 1
for side in (-1, 1):  # along the houses
    for z in (2.98, 4.9):
        for i in range(7):
            garland((side * (STREET + 1.9), -5 + 5.2 * i, z + 0.3), (side * (STREET + 1.9), 0.2 + 5.2 * i, z + 0.3),
                    0.3, 0.19, (WARM, WHITE) if z < 4 else PARTY)

for name, mesh, bsdf in (("garlands", cables, "cable"), ("wood", boards, "boards"), ("frames", posts, "posts"),
                         ("houses", bricks, "bricks"), ("brass pots", brass, "brass"), ("steel pots", steel, "steel")):
    SCENE.mesh(name, mesh, f'<bsdf type="twosided">{ref(bsdf)}</bsdf>')
for i, mesh in enumerate(awnings):
    SCENE.mesh(f"awnings {i}", mesh, ref(f"awning {i}"))
for i, (mesh, colour) in enumerate(zip(lanterns, LANTERNS)):
    SCENE.mesh(f"lanterns {i}", mesh, ribbed(colour))
SCENE.mesh("windows", windows, light((0.8, 0.5, 0.2)))

ground = Mesh()
ground.quad((-12, -8, 0), (12, -8, 0), (12, FAR + 14, 0), (-12, FAR + 14, 0))
SCENE.mesh("street", ground, ref("wet stones"))

SCENE.write()
