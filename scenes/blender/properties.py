# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a scene and its view layers: how they are stored, and how the other parts read them."""

import dataclasses

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

# Files store the numbers of items, so these never change.
INTEGRATORS = [
    ("auto", "Automatic", "Path tracing, with volumes where the scene has some", 0),
    ("path_mis", "Path Tracing", "All light between surfaces", 1),
    ("volpathmis", "Volumetric Path Tracing", "All light between surfaces and in volumes", 2),
    ("direct", "Direct Light", "Light that reaches surfaces without a detour", 3),
    ("whitted", "Whitted", "Direct light, with mirrors and glass", 4),
    ("ao", "Ambient Occlusion", "How open to the sky each point is", 5),
    ("normals", "Normals", "Shading normals as colours", 6),
    ("photonmapper", "Photon Map", "For caustics; blurs light", 7),
    ("sppm", "Progressive Photon Map", "For caustics; the blur shrinks with the samples", 8),
]
DENOISERS = [
    ("off", "None", "", 0),
    ("nfor", "NFOR", "First-order regression with albedo, normal and depth", 1),
    ("nlmeans", "Non-Local Means", "Compares patches of pixels", 2),
    ("oidn", "Open Image Denoise", "Needs a Penumbra that was built with it", 3),
]
# Edges of a path beyond its bounces: the first from the camera, and the last to a light.
EDGES_BEYOND_BOUNCES = 2


@dataclasses.dataclass(frozen=True)
class Settings:
    """What a scene is rendered with. Counts of samples are per pixel, times in seconds."""

    samples: int = 128
    preview_samples: int = 32
    seed: int = 0  # with the frame added, where that is asked for
    integrator: str = "auto"  # a value of Penumbra's integrator.type, or "auto": volpathmis where there are media
    max_depth: int = 14  # edges of the longest path, as in Mitsuba: 2 is direct light
    filter_width: float = 1.5  # radius of the pixel filter in pixels; Cycles' number for the same blur
    time_budget: float = 0.0  # 0: none
    target_error: float = 0.0  # relative, as in 0.02; 0: none
    denoise: str = "off"
    texture_size: int = 1024  # pixels on a side of a baked texture
    workers: int = 1
    threads: int = 0  # of each worker; 0: all cores
    backend: str = "native"
    farm_address: str = ""
    farm_keys: str = ""
    farm_priority: int = 0
    farm_name: str = ""


class PenumbraSettings(bpy.types.PropertyGroup):
    """Settings of a scene."""

    samples: IntProperty(name="Max Samples", description="Samples per pixel of a render", default=128, min=1,
                         soft_max=16384, max=1 << 24)
    preview_samples: IntProperty(name="Max Samples", description="Samples per pixel of the viewport", default=32,
                                 min=1, soft_max=1024, max=1 << 24)
    seed: IntProperty(name="Seed", description="Renders of another seed have other noise", default=0, min=0)
    animate_seed: BoolProperty(name="Animate Seed", description="Add the frame to the seed, so that noise changes")
    integrator: EnumProperty(name="Integrator", items=INTEGRATORS, default="auto")
    max_bounces: IntProperty(name="Max Bounces", description="Surfaces and particles that may scatter light on its "
                             "way from the first one seen to a lamp. 0 is direct light", default=12, min=0,
                             max=1 << 16)
    filter_width: FloatProperty(name="Filter Width", description="Width of the pixel filter, as of Cycles' "
                                "Blackman-Harris filter", default=1.5, min=0.01, max=10.0, subtype="PIXEL")
    time_budget: FloatProperty(name="Time Limit", description="Begin no tile after so many seconds of a frame; "
                               "0 is no limit", default=0.0, min=0.0, step=100, unit="TIME_ABSOLUTE")
    use_target_error: BoolProperty(name="Noise Threshold", description="Sample each tile until its relative error is "
                                   "small enough, or the samples are done")
    target_error: FloatProperty(name="Noise Threshold", description="Relative error of a tile at which it is done",
                                default=0.02, min=1e-5, max=1.0, precision=4)
    denoise: EnumProperty(name="Denoise", items=DENOISERS, default="off")
    texture_size: EnumProperty(
        name="Baked Textures", description="Pixels on a side of textures that nodes are baked to", default="1024",
        items=[(str(size), f"{size} px", "", size) for size in (256, 512, 1024, 2048, 4096, 8192)])
    workers: IntProperty(name="Workers", description="Processes that render, each with a copy of the scene. More than "
                         "one survive each other's crashes", default=1, min=1, soft_max=16, max=1024)
    threads: IntProperty(name="Threads", description="Threads of each worker; 0 uses all cores", default=0, min=0,
                         max=1024)
    backend: EnumProperty(name="Device", default="native", items=[
        ("native", "CPU", "The processors of this machine", 0),
        ("opencl", "OpenCL", "An OpenCL device", 1),
        ("auto", "Automatic", "A GPU with the same bits as the CPU, where there is one", 2)])
    farm_address: StringProperty(name="Address", description="Where penumbra serve listens: unix:/path, or HOST:PORT. "
                                 "Empty: that of the environment, PENUMBRA_SERVICE")
    farm_keys: StringProperty(name="Keys", description="Folder of the farm's keys for users, for HOST:PORT with TLS. "
                              "Empty: PENUMBRA_KEYS, or the token in PENUMBRA_TOKEN", subtype="DIR_PATH")
    farm_priority: IntProperty(name="Priority", description="The highest is rendered first", default=0,
                               min=-1000000, max=1000000)
    farm_name: StringProperty(name="Name", description="Name of the shot. Empty: that of the .blend file")


class PenumbraViewLayer(bpy.types.PropertyGroup):
    """Passes that Blender has no switch for."""

    use_pass_light: BoolProperty(name="Direct and Indirect", description="Light of at most one bounce, and the rest")
    use_pass_albedo: BoolProperty(name="Albedo", description="Colour of surfaces, as for a denoiser")
    use_pass_variance: BoolProperty(name="Variance", description="Variance of each pixel's mean")
    use_pass_samples: BoolProperty(name="Sample Count", description="Samples in each pixel")


def settings_of(scene):
    """The scene's settings. Where the extension is not enabled they are what the file has stored, else those of Cycles
    that mean the same."""
    group = getattr(scene, "penumbra", None)
    if isinstance(group, PenumbraSettings):
        return _settings_of_group(scene, group)
    stored = _stored_values(scene)
    if stored is not None:
        return _settings_of_group(scene, stored)
    return _settings_of_cycles(scene)


def _settings_of_group(scene, group):
    return Settings(
        samples=group.samples,
        preview_samples=group.preview_samples,
        seed=group.seed + (max(0, scene.frame_current) if group.animate_seed else 0),
        integrator=group.integrator,
        max_depth=group.max_bounces + EDGES_BEYOND_BOUNCES,
        filter_width=_short(group.filter_width),
        time_budget=_short(group.time_budget),
        target_error=_short(group.target_error) if group.use_target_error else 0.0,
        denoise=group.denoise,
        texture_size=int(group.texture_size),
        workers=group.workers,
        threads=group.threads,
        backend=group.backend,
        farm_address=group.farm_address,
        farm_keys=group.farm_keys,
        farm_priority=group.farm_priority,
        farm_name=group.farm_name,
    )


def _short(value):
    """The decimal number that was entered, of which Blender keeps a 32-bit float."""
    return float(f"{value:.6g}")


class _Stored:
    """Values as a file stores them, with the defaults of those that nobody has changed."""

    def __init__(self, values):
        self._values = values

    def __getattr__(self, name):
        declared = PenumbraSettings.__annotations__[name]
        value = self._values.get(name, declared.keywords["default"] if "default" in declared.keywords else None)
        if declared.function is EnumProperty and isinstance(value, int):
            return next(item[0] for item in declared.keywords["items"] if item[3] == value)
        return value if value is not None else {BoolProperty: False, StringProperty: ""}[declared.function]


def _stored_values(scene):
    if hasattr(scene, "bl_system_properties_get"):  # Blender >= 5.0
        properties = scene.bl_system_properties_get()
    else:
        properties = scene
    values = properties.get("penumbra") if properties is not None else None
    return _Stored(values) if values is not None else None


def _settings_of_cycles(scene):
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return Settings()
    return Settings(
        samples=cycles.samples,
        preview_samples=max(1, cycles.preview_samples),
        seed=max(0, cycles.seed) + (max(0, scene.frame_current) if cycles.use_animated_seed else 0),
        max_depth=cycles.max_bounces + EDGES_BEYOND_BOUNCES,
        filter_width=_short(cycles.filter_width),
        time_budget=_short(cycles.time_limit),
    )


CLASSES = [PenumbraSettings, PenumbraViewLayer]


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.penumbra = PointerProperty(type=PenumbraSettings)
    bpy.types.ViewLayer.penumbra = PointerProperty(type=PenumbraViewLayer)


def unregister():
    del bpy.types.ViewLayer.penumbra
    del bpy.types.Scene.penumbra
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
