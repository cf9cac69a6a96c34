# SPDX-License-Identifier: GPL-3.0-or-later
"""Render passes: which ones a view layer asks for, which layers of Penumbra's EXR they take, and how they differ."""

import dataclasses
import struct
from typing import Callable

import numpy as np

NOTHING_DEPTH = 1e10  # what Blender's depth pass has where nothing is
RANKS_PER_PASS = 2  # of Cryptomatte: a pass has two pairs of ID and coverage


@dataclasses.dataclass(frozen=True)
class Pass:
    """A pass: Blender's name, letters of its channels, its kind for the compositor; the layer that `penumbra` must be
    asked for, or None; and its values from an exr.Image: (height, width, channels), None where the file lacks them."""

    name: str
    channels: str
    kind: str
    values: Callable
    layer: str | None = None


def _stack(*names):
    return lambda image: image.stack(names)


def combined(image):
    """(height, width, 4); opaque where the file has no alpha."""
    rgb = image.stack("RGB")
    alpha = image.channels.get("A")
    alpha = np.ones(rgb.shape[:2], np.float32) if alpha is None else alpha.astype(np.float32)
    return np.concatenate([rgb, alpha[..., None]], axis=-1)


def _depth(image):
    depth = image.stack(["depth.Z"])
    if depth is None:
        return None
    return np.where(depth > 0, depth, np.float32(NOTHING_DEPTH))


def _uv(image):
    uv = image.stack(["uv.U", "uv.V"])
    return None if uv is None else np.concatenate([uv, np.ones_like(uv[..., :1])], axis=-1)


def _vector(image):
    """Penumbra counts rows downwards, and both pairs point from the pixel; Blender's second pair points to it."""
    motion = image.stack(["motion.X", "motion.Y", "motion.Z", "motion.W"])
    return None if motion is None else motion * np.float32([1, -1, -1, 1])


COMBINED = Pass("Combined", "RGBA", "COLOR", combined)
NOISY = Pass("Noisy Image", "RGBA", "COLOR", combined)
ALBEDO = ("albedo.R", "albedo.G", "albedo.B")
NORMAL = ("normal.X", "normal.Y", "normal.Z")
_SWITCHES = [  # attribute of the view layer, pass
    ("use_pass_z", Pass("Depth", "Z", "VALUE", _depth)),
    ("use_pass_position", Pass("Position", "XYZ", "VECTOR", _stack("position.X", "position.Y", "position.Z"),
                               "position")),
    ("use_pass_normal", Pass("Normal", "XYZ", "VECTOR", _stack(*NORMAL))),
    ("use_pass_vector", Pass("Vector", "XYZW", "VECTOR", _vector, "motion")),
    ("use_pass_uv", Pass("UV", "UVA", "VECTOR", _uv, "uv")),
]
_OWN_SWITCHES = [  # attribute of view_layer.penumbra, pass
    ("use_pass_light", Pass("Direct", "RGB", "COLOR", _stack("direct.R", "direct.G", "direct.B"), "direct")),
    ("use_pass_light", Pass("Indirect", "RGB", "COLOR", _stack("indirect.R", "indirect.G", "indirect.B"), "indirect")),
    ("use_pass_albedo", Pass("Denoising Albedo", "RGB", "COLOR", _stack(*ALBEDO))),
    ("use_pass_albedo", Pass("Denoising Normal", "XYZ", "VECTOR", _stack(*NORMAL))),
    ("use_pass_variance", Pass("Variance", "RGB", "COLOR", _stack("variance.R", "variance.G", "variance.B"))),
    ("use_pass_samples", Pass("Debug Sample Count", "X", "VALUE", _stack("samples.Y"))),
]
_MATTES = [("use_pass_cryptomatte_object", "CryptoObject"), ("use_pass_cryptomatte_material", "CryptoMaterial")]
_MISSING = {  # what Blender can ask for, and Penumbra does not render
    "use_pass_mist": "Mist", "use_pass_object_index": "Object Index", "use_pass_material_index": "Material Index",
    "use_pass_shadow": "Shadow", "use_pass_ambient_occlusion": "Ambient Occlusion", "use_pass_emit": "Emission",
    "use_pass_environment": "Environment", "use_pass_diffuse_direct": "Diffuse Direct",
    "use_pass_diffuse_indirect": "Diffuse Indirect", "use_pass_diffuse_color": "Diffuse Color",
    "use_pass_glossy_direct": "Glossy Direct", "use_pass_glossy_indirect": "Glossy Indirect",
    "use_pass_glossy_color": "Glossy Color", "use_pass_transmission_direct": "Transmission Direct",
    "use_pass_transmission_indirect": "Transmission Indirect", "use_pass_transmission_color": "Transmission Color",
    "use_pass_subsurface_direct": "Subsurface Direct", "use_pass_subsurface_indirect": "Subsurface Indirect",
    "use_pass_subsurface_color": "Subsurface Color", "use_pass_cryptomatte_asset": "Cryptomatte Asset",
}
def passes_of(view_layer, is_denoised):
    """The passes of a view layer, besides Combined."""
    own = getattr(view_layer, "penumbra", None)
    passes = [entry for switch, entry in _SWITCHES if getattr(view_layer, switch)]
    passes += [entry for switch, entry in _OWN_SWITCHES if getattr(own, switch, False)]
    passes += [NOISY] if is_denoised else []
    count = (view_layer.pass_cryptomatte_depth + RANKS_PER_PASS - 1) // RANKS_PER_PASS
    for switch, name in _MATTES:
        for number in range(count if getattr(view_layer, switch) else 0):
            matte = f"{name}{number:02d}"
            passes.append(Pass(matte, "RGBA", "COLOR", _stack(*(f"{matte}.{channel}" for channel in "RGBA"))))
    return passes


def missing_passes(view_layer):
    """Names of passes that the view layer asks for in vain."""
    return [name for switch, name in _MISSING.items() if getattr(view_layer, switch, False)]


def options_for(passes):
    """The options of `penumbra render` that these passes need."""
    layers = sorted({entry.layer for entry in passes if entry.layer is not None})
    options = ["--layers", ",".join(layers)] if layers else []
    return options + (["--cryptomatte"] if any(entry.name.startswith("Crypto") for entry in passes) else [])


def cryptomatte_metadata(image, view_layer):
    """Names and hashes of the file's Cryptomatte layers, as Blender has them in a render result: its layers are named
    VIEWLAYER.CryptoObject."""
    fields = {}
    for key, value in image.metadata.items():
        if not key.startswith("cryptomatte/") or not key.endswith("/name"):
            continue
        name = f"{view_layer}.{value}"
        old, new = key[:-len("name")], f"cryptomatte/{name_hash(name) >> 4:07x}/"
        for field in ("conversion", "hash", "manifest"):
            if old + field in image.metadata:
                fields[new + field] = image.metadata[old + field]
        fields[new + "name"] = name
    return fields


def name_hash(text, seed=0):
    """MurmurHash3_x86_32 of a name, by which Cryptomatte 1.2.0 identifies layers."""
    data = text.encode("utf-8")
    mask, value = 0xFFFFFFFF, seed

    def mixed(block):
        block = block * 0xCC9E2D51 & mask
        block = (block << 15 | block >> 17) & mask
        return block * 0x1B873593 & mask

    whole = len(data) // 4 * 4
    for block, in struct.iter_unpack("<I", data[:whole]):
        value ^= mixed(block)
        value = (value << 13 | value >> 19) & mask
        value = (value * 5 + 0xE6546B64) & mask
    value ^= mixed(int.from_bytes(data[whole:], "little"))
    value ^= len(data)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35), (16, 1)):
        value = (value ^ value >> shift) * factor & mask
    return value
