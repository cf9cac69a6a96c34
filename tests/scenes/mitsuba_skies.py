"""Prints mitsuba_skies.inc: radiance and irradiance of Mitsuba 3.9.1's sunsky (llvm_ad_rgb), for sky_test.cpp.

    python3 tests/scenes/mitsuba_skies.py > tests/scenes/mitsuba_skies.inc
"""
import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
RADIUS = np.radians(0.5358 / 2)
ALBEDOS = ([0, 0, 0], [0.3, 0.3, 0.3], [1, 1, 1], [0.1, 0.5, 0.9])


def direction(elevation, azimuth):
    e, a = np.radians(elevation), np.radians(azimuth)
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def emitter(turbidity, albedo, elevation, **other):
    return mi.load_dict({"type": "sunsky", "turbidity": turbidity, "albedo": {"type": "rgb", "value": albedo},
                         "sun_direction": direction(elevation, 0).tolist(), **other})


def radiance(sky, directions):
    si = dr.zeros(mi.SurfaceInteraction3f, len(directions))
    si.wi = -mi.Vector3f(np.asarray(directions, np.float32).T)
    return np.array(sky.eval(si)).T


def row(*values):
    print("{" + ", ".join(f"{v:.7g}" for v in values) + "},")


def sky_rows():
    for k, turbidity in enumerate((1.0, 2.0, 3.5, 6.0, 10.0)):
        for i, elevation in enumerate((0.5, 5.0, 20.0, 45.0, 85.0)):
            albedo = ALBEDOS[(k + i) % 4]
            sky = emitter(turbidity, albedo, elevation, sun_scale=0.0)
            for e, a in ((1, 10), (15, 70), (40, 180), (88, 130)):
                row(turbidity, *albedo, elevation, e, a, *radiance(sky, [direction(e, a)])[0])


def sun_rows():
    for turbidity in (1.0, 2.5, 6.0, 10.0):
        for elevation in (1.0, 5.0, 8.0, 30.0, 85.0):
            middle = [direction(elevation, 0)]
            # At half the disk's radius, at the same elevation.
            beside = np.array([np.cos(np.arcsin(np.sin(RADIUS) / 2)), np.sin(RADIUS) / 2])
            e = np.radians(elevation)
            half = [[beside[0] * np.cos(e), beside[1], beside[0] * np.sin(e)]]
            plain = emitter(turbidity, ALBEDOS[0], elevation, sky_scale=0.0)
            dark = emitter(turbidity, ALBEDOS[0], elevation, sky_scale=0.0, complex_sun=True)
            row(turbidity, elevation, *radiance(plain, middle)[0], *radiance(dark, middle)[0],
                *radiance(dark, half)[0])


def irradiance_rows():
    """By the midpoint rule over 1024 x 1024 cells of the sky, and over the disk apart."""
    rows, columns = (np.arange(1024) + 0.5) / 1024 * np.pi / 2, (np.arange(1024) + 0.5) / 1024 * 2 * np.pi
    theta, phi = (grid.ravel() for grid in np.meshgrid(rows, columns))
    sphere = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    cells = np.sin(theta) * (np.pi / 2 / 1024) * (2 * np.pi / 1024)
    for turbidity in (1.0, 3.5, 10.0):
        for elevation in (0.5, 20.0, 85.0):
            light = radiance(emitter(turbidity, ALBEDOS[3], elevation, sun_scale=0.0), sphere)
            e = np.radians(elevation)
            k = np.arange(4096) + 0.5
            z = 1 - (1 - np.cos(RADIUS)) * k / 4096
            r, turn = np.sqrt(1 - z * z), np.pi * (3 - 5**0.5) * k
            x, y = r * np.cos(turn), r * np.sin(turn)
            disk = np.stack([z * np.cos(e) - x * np.sin(e), y, z * np.sin(e) + x * np.cos(e)], -1)
            sun = radiance(emitter(turbidity, ALBEDOS[3], elevation, sky_scale=0.0), disk)
            for normal in ([0, 0, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0]):
                of_sky = (light * (cells * np.maximum(sphere @ normal, 0))[:, None]).sum(0)
                cell = 2 * np.pi * (1 - np.cos(RADIUS)) / 4096
                of_sun = (sun * (cell * np.maximum(disk @ normal, 0))[:, None]).sum(0)
                row(turbidity, elevation, *normal, *of_sky, *of_sun)


print("// Written by mitsuba_skies.py. Directions are elevation and azimuth from the sun, in degrees.")
for name, text, rows in (
    ("kSkyRows", "Turbidity, albedo, the sun's elevation, a direction; radiance.", sky_rows),
    ("kSunRows", "Turbidity, elevation; radiance of the plain disk, of the complex one's middle and half-way.", sun_rows),
    ("kIrradianceRows", "Turbidity, elevation, normal (x to the sun, z up), albedo 0.1, 0.5, 0.9; sky's, sun's.",
     irradiance_rows),
):
    width = {"kSkyRows": 10, "kSunRows": 11, "kIrradianceRows": 11}[name]
    print(f"// {text}\nconstexpr double {name}[][{width}] = {{")
    rows()
    print("};")
