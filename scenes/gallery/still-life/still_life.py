"""Glass, wine and metal on a wooden table, in centimetres. Usage: python3 still_life.py FOLDER"""

import math
import os
import random
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from modelling import Mesh, Scene, numbers, ref, spline

SCENE = Scene("still-life")
RANDOM = random.Random(7)

SCENE.add("""
<default name="spp" value="640"/>
<default name="width" value="800"/>
<default name="height" value="450"/>
<integrator type="ppm"><integer name="max_depth" value="24"/><boolean name="caustics_only" value="true"/></integrator>
<sensor type="perspective">
  <float name="fov" value="42"/>
  <transform name="to_world"><lookat origin="-5, -80, 46" target="-0.6, -2, 6.3" up="0, 0, 1"/></transform>
  <sampler type="sobol"><integer name="sample_count" value="$spp"/></sampler>
  <film type="hdrfilm">
    <integer name="width" value="$width"/><integer name="height" value="$height"/><rfilter type="gaussian"/>
  </film>
</sensor>
<bsdf type="dielectric" id="glass"><float name="int_ior" value="1.52"/></bsdf>
<bsdf type="dielectric" id="liquid surface"><float name="int_ior" value="1.34"/></bsdf>
<bsdf type="dielectric" id="liquid in glass">
  <float name="int_ior" value="1.34"/><float name="ext_ior" value="1.52"/>
</bsdf>
<bsdf type="conductor" id="gold"><string name="material" value="Au"/></bsdf>
<bsdf type="roughconductor" id="silver"><string name="material" value="Ag"/><float name="alpha" value="0.02"/></bsdf>
<bsdf type="conductor" id="copper"><string name="material" value="Cu"/></bsdf>
<bsdf type="roughplastic" id="pear skin">
  <texture type="noise" name="diffuse_reflectance">
    <rgb name="color0" value="0.42, 0.4, 0.06"/><rgb name="color1" value="0.6, 0.3, 0.05"/>
    <integer name="octaves" value="5"/><transform name="to_uv"><scale x="14" y="6"/></transform>
  </texture>
  <float name="alpha" value="0.25"/>
</bsdf>
<bsdf type="diffuse" id="stem"><rgb name="reflectance" value="0.09, 0.05, 0.02"/></bsdf>
<bsdf type="diffuse" id="wall">
  <texture type="noise" name="reflectance">
    <rgb name="color0" value="0.10, 0.13, 0.13"/><rgb name="color1" value="0.18, 0.22, 0.21"/>
    <integer name="octaves" value="6"/><transform name="to_uv"><scale x="0.05" y="0.05"/></transform>
  </texture>
</bsdf>
""")


def absorbing(name, sigma):
    SCENE.add(f'<medium type="homogeneous" id="{name}"><rgb name="sigma_a" value="{numbers(sigma)}"/>'
              '<rgb name="sigma_s" value="0"/></medium>')


absorbing("wine", (0.02, 0.42, 0.34))
absorbing("brandy", (0.012, 0.085, 0.36))
absorbing("blue glass", (0.9, 0.3, 0.03))
absorbing("green glass", (0.7, 0.06, 0.5))
absorbing("red glass", (0.05, 0.8, 0.7))


def at_level(line, level):
    """The point of a line that goes down, and the index of the first point below it."""
    for i in range(len(line) - 1):
        (r0, z0), (r1, z1) = line[i], line[i + 1]
        if z0 >= level > z1:
            t = (z0 - level) / (z0 - z1)
            return (r0 + t * (r1 - r0), level), i + 1
    raise ValueError("no such level")


def vessel(name, x, y, outer, inner, level=None, medium=None, flutes=lambda angle, r, z: r, segments=160):
    """Glass between an outer line that goes up to the lip and an inner one that goes down, with a liquid in it. Glass,
    liquid and air meet in three surfaces, each between two of them."""
    centre = (x, y, 0.02)
    end = len(inner)
    if level is not None:
        edge, end = at_level(inner, level)
    mesh = Mesh()
    mesh.lathe(list(outer) + list(inner[1:end]) + ([edge] if level is not None else []), centre, segments, flutes)
    SCENE.mesh(name, mesh, ref("glass"))
    if level is None:
        return
    inside = f'<ref id="{medium}" name="interior"/>' if medium else ""
    mesh = Mesh()
    mesh.lathe([*reversed(inner[end:]), edge], centre, segments)
    SCENE.mesh(f"{name} liquid", mesh, ref("liquid in glass") + inside)
    mesh = Mesh()
    mesh.lathe([(edge[0] * (8 - i) / 8, level) for i in range(9)], centre, segments)
    SCENE.mesh(f"{name} liquid surface", mesh, ref("liquid surface") + inside)


def bottom(r, rim=0.12):
    """A flat base of radius r with a rounded edge."""
    return [(0, 0), (r * 0.5, 0),
            (r - rim, 0)] + [(r - rim + rim * math.sin(a), rim - rim * math.cos(a)) for a in (0.4, 0.8, 1.2, 1.57)]


# A goblet of red wine
outer = spline([(0, 0.05), (2.0, 0.05), (3.35, 0), (3.5, 0.1), (3.4, 0.24), (2.2, 0.45), (0.95, 0.8), (0.5, 1.5),
                (0.45, 2.4), (0.8, 3.2), (2.3, 4.1), (3.75, 5.6), (4.4, 7.8), (4.35, 10.2), (3.85, 13), (3.5, 15),
                (3.46, 15.1), (3.38, 15.12), (3.33, 15.05)], 8)
inner = spline([(3.33, 15.05), (3.68, 13), (4.17, 10.2), (4.22, 7.8), (3.55, 5.7), (2.1, 4.35), (0.8, 3.85), (0, 3.75)],
               12)
vessel("goblet", -9.5, 6, outer, inner, 9.2, "wine")

# A carafe of brandy
outer = spline(
    bottom(5.2, 0.5) + [(6.4, 2.2), (6.9, 4.4), (6.2, 7.2), (4.0, 9.8), (2.2, 11.8), (1.6, 13.8), (1.6, 16),
                        (2.0, 18.2), (2.9, 19.9), (2.92, 20.05), (2.85, 20.1), (2.74, 20.05)], 7)
inner = spline([(2.74, 20.05), (1.8, 18.3), (1.38, 16), (1.38, 13.8), (1.96, 11.7), (3.75, 9.7), (5.92, 7.1),
                (6.6, 4.4), (6.1, 2.4), (4.8, 1.3), (2, 1.05), (0, 1.0)], 10)
vessel("carafe", 10.5, 11.5, outer, inner, 8.2, "brandy", segments=192)

# A fluted tumbler of water
outer = spline(
    bottom(3.1, 0.25) + [(3.3, 2.2), (3.6, 5.5), (3.85, 9), (3.85, 9.12), (3.78, 9.2), (3.7, 9.2), (3.62, 9.1)], 9)
inner = spline([(3.62, 9.1), (3.35, 5.5), (3.02, 2.2), (2.6, 1.45), (1.2, 1.3), (0, 1.3)], 14)


def flutes(angle, r, z):
    inside = 3.02 + (z - 2.2) * 0.09 + 0.1
    if r < inside or not 0.5 < z < 7.6:
        return r
    fade = min(1, (z - 0.5) / 0.6, (7.6 - z) / 0.8)
    return r * (1 + 0.05 * fade * (abs(math.cos(8 * angle)) - 0.6))


vessel("tumbler", 0.6, 2, outer, inner, 6.2, None, flutes, segments=384)


def torus(name, x, y, radius, thickness, bsdf, height=1.0):
    """A ring on the table."""
    profile = [(radius + thickness * math.cos(a), thickness * height * (1 + math.sin(a)))
               for a in (2 * math.pi * i / 48 for i in range(48))]
    mesh = Mesh()
    mesh.lathe(profile + profile[:1], (x, y, 0.01), 256)
    SCENE.mesh(name, mesh, ref(bsdf))


torus("gold ring", -17.5, -12.5, 2.2, 0.2, "gold", 2.2)
torus("small gold ring", 1.2, -19.5, 1.4, 0.15, "gold", 1.5)
torus("silver ring", 17, -6.5, 2.9, 0.2, "silver", 3.0)

for x, y, radius, medium in ((-18.0, -3.5, 1.0, "blue glass"), (-6.5, -17.2, 1.1, "green glass"),
                             (8.0, -14.6, 2.4, None), (4.4, -20.0, 0.9, "red glass"), (-11.0, -20.0, 0.75, None)):
    SCENE.sphere((x, y, radius + 0.01), radius,
                 ref("glass") + (f'<ref id="{medium}" name="interior"/>' if medium else ""))

# Pears
pear = spline([(0, 0.35), (0.5, 0.12), (1.4, 0), (2.7, 0.7), (3.45, 2.4), (3.2, 4.4), (2.3, 6.2), (1.6, 7.7),
               (1.25, 8.8), (0.8, 9.45), (0.3, 9.5), (0, 9.3)], 8)
for name, x, y, phase in (("pear", -22.5, 8.5, 0.4), ("pear behind", -17.0, 16, 2.0)):
    mesh = Mesh()
    mesh.lathe(pear, (x, y, 0), 96, lambda angle, r, z: r *
               (1 + 0.03 * math.sin(angle + phase) + 0.02 * math.sin(2 * angle + z * 0.4)))
    SCENE.mesh(name, mesh, ref("pear skin"))
    mesh = Mesh()
    mesh.tube(spline([(x, y, 9.2), (x + 0.1, y, 10.2), (x + 0.5 * math.cos(phase), y, 11.2)], 6), 0.16)
    SCENE.mesh(f"{name} stem", mesh, f'<bsdf type="twosided">{ref("stem")}</bsdf>')

# The table: planks from left to right
WIDTH, GAP = 8.3, 0.07
for i in range(10):
    y = -46 + i * WIDTH
    tint = RANDOM.uniform(0.8, 1.15)
    mesh = Mesh()
    mesh.box((-75, y, -3), (75, y + WIDTH - GAP, 0), (RANDOM.uniform(0, 300), RANDOM.uniform(0, 300)))
    dark, bright = [0.13 * tint, 0.058 * tint, 0.026 * tint], [0.37 * tint, 0.2 * tint, 0.105 * tint]
    SCENE.mesh(
        f"plank {i}", mesh,
        f"""<bsdf type="diffuse"><texture type="noise" name="reflectance"><integer name="octaves" value="6"/>
    <rgb name="color0" value="{numbers(dark)}"/><rgb name="color1" value="{numbers(bright)}"/>
    <float name="persistence" value="0.62"/><transform name="to_uv"><scale x="0.045" y="1.1"/></transform>
  </texture></bsdf>""")
mesh = Mesh()
mesh.quad((-260, 130, -60), (260, 130, -60), (260, 130, 200), (-260, 130, 200))
SCENE.mesh("back wall", mesh, ref("wall"))


def spot(origin, target, colour, cutoff):
    SCENE.add(f"""<emitter type="spot"><rgb name="intensity" value="{numbers(colour)}"/>
  <float name="cutoff_angle" value="{cutoff}"/><float name="beam_width" value="{cutoff * 0.6}"/>
  <transform name="to_world"><lookat origin="{numbers(origin)}" target="{numbers(target)}" up="0, 0, 1"/></transform>
</emitter>""")


def panel(origin, target, width, height, colour):
    SCENE.add(f"""<shape type="rectangle"><transform name="to_world"><scale x="{width / 2}" y="{height / 2}"/>
  <lookat origin="{numbers(origin)}" target="{numbers(target)}" up="0, 0, 1"/></transform>
  <emitter type="area"><rgb name="radiance" value="{numbers(colour)}"/></emitter></shape>""")


spot((30, 84, 60), (-2, -2, 2), (190000, 154000, 112000), 17)
spot((-78, 44, 44), (0, -2, 3), (11000, 18000, 29000), 17)

# A window of four panes, and a strip of light, for reflections
for i in range(2):
    for j in range(2):
        panel((-85, -28 + 24 * i, 38 + 30 * j), (-20, -28 + 24 * i, 26 + 30 * j), 21, 27, (2.2, 2.6, 3.1))
panel((80, -5, 55), (0, 0, 5), 12, 70, (1.3, 1.15, 0.9))

SCENE.write()
