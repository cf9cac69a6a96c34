"""Sunlight through tall windows into a hall full of haze, in metres. Usage: python3 hall.py FOLDER"""

import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from modelling import Mesh, Scene, light, ref, spline

SCENE = Scene("hall")

BAYS, BAY = 5, 6.0  # along y, the first behind the camera
WALL = 6.0  # the walls are at x = -WALL and WALL
SPRING, CROWN = 8.4, 14.0  # of the vault
START, END = -BAY, (BAYS - 1) * BAY

SCENE.add("""
<default name="spp" value="96"/>
<default name="width" value="800"/>
<default name="height" value="450"/>
<integrator type="ppm"><integer name="photon_count" value="60000"/><float name="initial_radius" value="0.4"/></integrator>
<medium type="homogeneous" id="haze">
  <rgb name="sigma_t" value="0.03"/><float name="albedo" value="0.97"/>
  <phase type="hg"><float name="g" value="0.15"/></phase>
</medium>
<sensor type="perspective">
  <float name="fov" value="62"/>
  <transform name="to_world"><lookat origin="-4.1, -4.2, 2.4" target="1.1, 12, 4.1" up="0, 0, 1"/></transform>
  <sampler type="sobol"><integer name="sample_count" value="$spp"/></sampler>
  <film type="hdrfilm">
    <integer name="width" value="$width"/><integer name="height" value="$height"/><rfilter type="gaussian"/>
  </film>
  <ref id="haze" name="medium"/>
</sensor>
<bsdf type="twosided" id="stone"><bsdf type="diffuse">
  <texture type="noise" name="reflectance">
    <rgb name="color0" value="0.40, 0.36, 0.30"/><rgb name="color1" value="0.62, 0.57, 0.49"/>
    <integer name="octaves" value="6"/><float name="persistence" value="0.6"/>
    <transform name="to_uv"><scale x="0.6" y="1.1"/></transform>
  </texture></bsdf></bsdf>
<bsdf type="twosided" id="plaster"><bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.45, 0.38"/></bsdf></bsdf>
<bsdf type="roughconductor" id="bronze">
  <string name="material" value="Cu"/><float name="alpha" value="0.35"/>
  <rgb name="specular_reflectance" value="0.6, 0.66, 0.6"/>
</bsdf>
<bsdf type="diffuse" id="black iron"><rgb name="reflectance" value="0.05, 0.05, 0.05"/></bsdf>
<bsdf type="diffuse" id="wood">
  <texture type="noise" name="reflectance">
    <rgb name="color0" value="0.17, 0.085, 0.04"/><rgb name="color1" value="0.42, 0.24, 0.12"/>
    <integer name="octaves" value="5"/><transform name="to_uv"><scale x="1.2" y="14"/></transform>
  </texture>
</bsdf>
<bsdf type="diffuse" id="tiles">
  <texture type="checkerboard" name="reflectance">
    <rgb name="color0" value="0.12, 0.11, 0.11"/><rgb name="color1" value="0.5, 0.46, 0.4"/>
    <transform name="to_uv"><rotate z="1" angle="45"/><scale x="0.55" y="0.55"/></transform>
  </texture>
</bsdf>
""")


def place(x, y, z, axis):
    """A point of a wall in the plane of x or of y: along it, its depth, its height."""
    return (x, y, z) if axis == "y" else (y, x, z)


def pointed(width, height, steps=14):
    """The line of a pointed arch over [-width / 2, width / 2], from the left to the right."""
    half = width / 2
    radius = (half * half + height * height) / (2 * half)  # both circles have their centres at the spring
    line = []
    for i in range(steps + 1):
        top = math.acos((radius - half) / radius)
        a = top * i / steps
        line.append((-half + radius - radius * math.cos(a), radius * math.sin(a)))
    return line + [(-x, z) for x, z in reversed(line[:-1])]


def arch_wall(mesh, axis, depth, thickness, start, end, opening, sill, spring, rise, top, bottom=0.0):
    """A wall from start to end with one pointed opening in its middle."""
    middle = (start + end) / 2
    line = [(middle + x, spring + z) for x, z in pointed(opening, rise)]
    left, right = line[0][0], line[-1][0]
    sides = (depth - thickness / 2, depth + thickness / 2)

    def flat(a, b, c, d, side):
        points = [place(x, side, z, axis) for x, z in (a, b, c, d)]
        mesh.quad(*points, uv=[(x, z) for x, z in (a, b, c, d)])

    for side in sides:
        flat((start, bottom), (left, bottom), (left, top), (start, top), side)
        flat((right, bottom), (end, bottom), (end, top), (right, top), side)
        if sill > bottom:
            flat((left, bottom), (right, bottom), (right, sill), (left, sill), side)
        for (x0, z0), (x1, z1) in zip(line, line[1:]):
            flat((x0, z0), (x1, z1), (x1, top), (x0, top), side)
    outline = [(left, sill), *line, (right, sill)]
    outline += [outline[0]] if sill > bottom else []
    for (x0, z0), (x1, z1) in zip(outline, outline[1:]):
        mesh.quad(*(place(x, y, z, axis)
                    for x, y, z in ((x0, sides[0], z0), (x1, sides[0], z1), (x1, sides[1], z1), (x0, sides[1], z0))))


def window_bars(mesh, axis, depth, middle, width, sill, spring, rise, columns, step):
    """A grid of iron in a pointed opening."""
    line = [(middle + x, spring + z) for x, z in pointed(width, rise, 40)]

    def height(x):
        for (x0, z0), (x1, z1) in zip(line, line[1:]):
            if x0 <= x <= x1:
                return z0 + (z1 - z0) * (x - x0) / (x1 - x0)
        return spring

    def bar(x0, x1, z0, z1, half):
        low, high = place(x0, depth - half, z0, axis), place(x1, depth + half, z1, axis)
        mesh.box(low, high)

    for i in range(1, columns):
        x = middle - width / 2 + width * i / columns
        bar(x - 0.05, x + 0.05, sill, height(x) + 0.02, 0.06)
    z = sill + step
    while z < spring + rise - 0.3:
        inside = [x for x, h in line if h > z] if z > spring else [middle - width / 2, middle + width / 2]
        bar(min(inside), max(inside), z - 0.025, z + 0.025, 0.03)
        z += step


GLOW = Mesh()


def window_glow(axis, depth, middle, width, sill, top, front):
    """The light of the sky in a window: it lets the sun pass."""
    a, b = middle - width / 2, middle + width / 2
    points = [place(x, depth, z, axis) for x, z in ((a, sill), (b, sill), (b, top), (a, top))]
    if (axis == "x") != (front > 0):
        points.reverse()
    GLOW.quad(*points)


walls, iron, shutters, ribs, columns, slabs = (Mesh() for _ in range(6))
profile = [(0.62, 0),
           (0.62, 0.25)] + spline([(0.6, 0.25), (0.62, 0.4), (0.5, 0.5),
                                   (0.46, 0.7)], 5) + [(0.42, 4),
                                                       (0.42, SPRING - 0.75)] + spline([(0.42, SPRING - 0.7),
                                                                                        (0.48, SPRING - 0.65),
                                                                                        (0.44, SPRING - 0.58),
                                                                                        (0.5, SPRING - 0.3),
                                                                                        (0.66, SPRING)], 5)
vault_line = [(x, SPRING + z) for x, z in pointed(2 * WALL, CROWN - SPRING, 20)]
for i in range(BAYS):
    y = START + i * BAY
    # The left wall is blind; the right one has windows with broad shutters in front of the camera.
    arch_wall(walls, "x", -WALL - 0.3, 0.6, y, y + BAY, 3.4, 2.0, 6.4, 2.2, SPRING + 0.6)
    walls.quad((-WALL - 0.35, y, 0), (-WALL - 0.35, y + BAY, 0), (-WALL - 0.35, y + BAY, 9), (-WALL - 0.35, y, 9))
    arch_wall(walls, "x", WALL + 0.3, 0.6, y, y + BAY, 3.4, 2.0, 6.4, 2.2, SPRING + 0.6)
    if i in (2, 4):
        window_bars(iron, "x", WALL + 0.3, y + BAY / 2, 3.4, 2.0, 6.4, 2.2, 4, 20)
        z = 2.55
        while z < 8.4:
            inside = [
                x for x, h in [(-1.7, 0)] + [(x, 6.4 + h) for x, h in pointed(3.4, 2.2, 40)] + [(1.7, 0)] if h > z
            ] if z > 6.4 else [-1.7, 1.7]
            shutters.box((WALL + 0.2, y + BAY / 2 + min(inside), z), (WALL + 0.3, y + BAY / 2 + max(inside), z + 0.5))
            z += 1.0
        window_glow("x", WALL + 0.5, y + BAY / 2, 3.4, 2.0, 8.6, -1)
    else:
        walls.quad((WALL + 0.35, y + BAY, 0), (WALL + 0.35, y, 0), (WALL + 0.35, y, 9), (WALL + 0.35, y + BAY, 9))
    ribs.tube([(x * 0.965, y, z - 0.1) for x, z in vault_line], 0.28, 12)
    for side in (-1, 1):
        x = side * (WALL - 0.2)
        columns.lathe(profile, (x, y, 0), 48)
        slabs.box((x - 0.7, y - 0.7, SPRING), (x + 0.7, y + 0.7, SPRING + 0.3))
        slabs.box((x - 0.7, y - 0.7, 0), (x + 0.7, y + 0.7, 0.18))

# The end wall, with three tall windows, and the wall behind the camera
for middle, half, opening, spring, rise in ((-3.4, 2.0, 1.6, 7.2, 1.8), (0, 1.4, 2.0, 9.0, 2.4), (3.4, 2.0, 1.6, 7.2,
                                                                                                  1.8)):
    arch_wall(walls, "y", END + 0.4, 0.8, middle - half, middle + half, opening, 3.4, spring, rise, CROWN + 1)
    window_bars(iron, "y", END + 0.4, middle, opening, 3.4, spring, rise, 3, 0.8)
    window_glow("y", END + 0.7, middle, opening, 3.4, spring + rise, -1)
for side in (-1, 1):
    low, high = sorted((side * 5.4, side * (WALL + 0.6)))
    walls.box((low, END, 0), (high, END + 0.8, CROWN + 1))
walls.box((-WALL - 0.6, START - 0.5, 0), (WALL + 0.6, START, CROWN + 1))
SCENE.mesh("walls", walls, ref("stone"))
SCENE.mesh("iron", iron, ref("black iron"))
SCENE.mesh("shutters", shutters, ref("wood"))
SCENE.mesh("ribs", ribs, ref("stone"))
SCENE.mesh("columns", columns, ref("stone"))
SCENE.mesh("slabs", slabs, ref("stone"))
vault = Mesh()
for (x0, z0), (x1, z1) in zip(vault_line, vault_line[1:]):
    vault.quad((x0, START, z0), (x1, START, z1), (x1, END, z1), (x0, END, z0))
for side in (-1, 1):
    low, high = sorted((side * WALL, side * (WALL + 0.6)))
    vault.box((low, START, SPRING + 0.2), (high, END, SPRING + 0.6))
SCENE.mesh("vault", vault, ref("plaster"))

# An urn in the light
urn = Mesh()
urn.lathe(
    spline([(0, 1.02), (0.3, 1.02), (0.32, 1.08), (0.14, 1.2), (0.12, 1.3), (0.34, 1.5), (0.52, 1.85), (0.5, 2.2),
            (0.3, 2.42), (0.26, 2.5), (0.4, 2.62), (0.4, 2.66), (0.33, 2.66), (0.2, 2.5), (0, 2.45)], 6),
    (-1.2, 8.6, 0), 64)
SCENE.mesh("urn", urn, ref("bronze"))
plinth = Mesh()
for half, low, high in ((0.5, 0, 0.16), (0.4, 0.16, 0.9), (0.46, 0.9, 1.02)):
    plinth.box((-1.2 - half, 8.6 - half, low), (-1.2 + half, 8.6 + half, high))
SCENE.mesh("plinth", plinth, ref("stone"))

# Benches
benches = Mesh()
for side in (-1, 1):
    y = 13.4
    while y < 19.5:
        x0, x1 = sorted((side * 0.9, side * 4.3))
        benches.box((x0, y - 0.22, 0.42), (x1, y + 0.22, 0.47), (y * 3.1, side))
        benches.box((x0, y + 0.2, 0.47), (x1, y + 0.25, 0.98), (y * 1.7, side))
        for x in (x0, x1):
            benches.box((x - 0.04, y - 0.25, 0), (x + 0.04, y + 0.28, 1.02), (y, x))
        y += 1.3
SCENE.mesh("benches", benches, ref("wood"))

floor = Mesh()
floor.quad((-9, START - 1, 0), (9, START - 1, 0), (9, END + 2, 0), (-9, END + 2, 0))
SCENE.mesh("floor", floor, ref("tiles"))

# The haze ends at a box around the hall.
SCENE.add(f"""<shape type="cube" id="box of haze"><transform name="to_world">
  <scale x="8" y="{(END - START) / 2 + 2}" z="9"/><translate x="0" y="{(START + END) / 2}" z="8.2"/></transform>
  <bsdf type="null"/><ref id="haze" name="interior"/></shape>""")

# The sun: a spot light that shines on the windows alone. The sky: a surface in each window that lets the sun pass.
SCENE.add("""<emitter type="spot"><rgb name="intensity" value="300000, 220000, 132000"/>
  <float name="cutoff_angle" value="8.2"/><float name="beam_width" value="8.1"/><transform name="to_world">
  <lookat origin="58, 16, 36" target="6, 15, 5.4" up="0, 0, 1"/></transform></emitter>""")
SCENE.mesh("sky in the windows", GLOW, '<bsdf type="null"/>' + light((1.3, 1.8, 2.5)))

SCENE.write()
