"""A room, what its furniture is made of, and its light."""

import os
import random

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


def placed(position, axis=(0, 0, 1), angle=0.0):
    """Of a shape: turned by degrees about an axis, then moved."""
    (x, y, z), (px, py, pz) = axis, position
    return (f'<transform name="to_world"><rotate x="{x}" y="{y}" z="{z}" angle="{angle:.6g}"/>'
            f'<translate x="{px:.6g}" y="{py:.6g}" z="{pz:.6g}"/></transform>')


def twosided(bsdf):
    return f'<bsdf type="twosided">{bsdf}</bsdf>'


GLASS = '<bsdf type="dielectric"><string name="int_ior" value="bk7"/></bsdf>'
THIN = '<bsdf type="thindielectric"/>'
WATER = '<bsdf type="dielectric"><string name="int_ior" value="water"/></bsdf>'


def frosted(alpha):
    return f'<bsdf type="roughdielectric"><float name="alpha" value="{alpha}"/><string name="int_ior" value="bk7"/></bsdf>'


def tinted(colour, alpha=0.0):
    """Glass that takes its colour from the light at each surface."""
    return (f'<bsdf type="{"roughdielectric" if alpha else "dielectric"}"><string name="int_ior" value="bk7"/>' +
            (f'<float name="alpha" value="{alpha}"/>' if alpha else "") +
            f'<rgb name="specular_transmittance" value="{numbers(colour)}"/></bsdf>')


def medium(identifier, sigma, albedo, g=0.0):
    most = max(sigma)  # Mitsuba reads colours up to 1
    return (
        f'<medium type="homogeneous" id="{identifier}"><rgb name="sigma_t" value="{numbers(x / most for x in sigma)}"/>'
        f'<float name="scale" value="{most}"/><rgb name="albedo" value="{numbers(albedo)}"/>'
        f'<phase type="hg"><float name="g" value="{g}"/></phase></medium>')
