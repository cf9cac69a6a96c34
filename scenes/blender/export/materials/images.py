# SPDX-License-Identifier: GPL-3.0-or-later
"""Image Texture nodes and colour attributes as fields."""

import pathlib

import bpy
import numpy

from .coordinates import affine_uv, is_plain_mapping
from .fields import Field, NotFolded, Placement, constant
from .nodes import source_of
from .values import folds

_DATA = {"Non-Color", "Raw", "Generic Data"}
_LINEAR = {"Linear Rec.709", "Linear", *_DATA}
# Files that the program reads in every build, and those of them whose numbers are linear.
_READ = {".png", ".jpg", ".jpeg", ".exr", ".hdr"}
_FLOATS = {".exr", ".hdr"}


def srgb_to_linear(values):
    """IEC 61966-2-1."""
    positive = numpy.maximum(values, 0)
    return numpy.where(values < 0.04045, positive / 12.92, ((positive + 0.055) / 1.055) ** 2.4)


@folds("ShaderNodeTexImage")
def image_texture(values, source):
    node = source.node
    image = node.image
    if image is None:
        raise NotFolded(node, "it has no image")
    if node.projection != "FLAT" or not is_plain_mapping(node.texture_mapping):
        raise NotFolded(node, "its image is not laid flat on the UV map")
    if image.source in {"TILED", "MOVIE"} or image.type == "MULTILAYER":
        raise NotFolded(node, "its image has tiles, layers or frames")
    vector = source.input("Vector")
    feed = source_of(vector)
    if feed is None or feed.is_constant:
        uv_map, matrix = None, numpy.diag([1.0, 1.0, 0.0])
    else:
        uv_map, matrix = affine_uv(values, vector)
    placement = Placement(uv_map, tuple(map(tuple, matrix[:2].tolist())), node.extension, node.interpolation == "Closest")
    is_alpha = source.socket.identifier == "Alpha"
    uses_alpha = next(socket for socket in node.outputs if socket.identifier == "Alpha").is_linked
    return values.images.field(image, node, placement, is_alpha, uses_alpha)


def file_of(image, node=None):
    """The image's files that exist: of one, or of all tiles."""
    if image.source not in {"FILE", "SEQUENCE", "TILED", "MOVIE"}:
        return []
    if image.source == "TILED":
        names = [image.filepath_raw.replace("<UDIM>", str(tile.number)) for tile in image.tiles]
    else:
        names = [image.filepath_from_user(image_user=node.image_user) if node is not None else image.filepath_from_user()]
    paths = [pathlib.Path(bpy.path.abspath(name, library=image.library)) for name in names]
    return [path for path in paths if path.is_file()]


class Images:
    """The images of an export as texels and files."""

    def __init__(self, context):
        self.context = context
        self._texels = {}

    def field(self, image, node, placement, is_alpha, uses_alpha):
        """The Field of the colours or of the alpha of an image."""
        texels = self.texels(image, node)
        alpha = texels[..., 3:]
        if is_alpha:
            if image.alpha_mode == "NONE" or numpy.all(alpha == 1):
                return constant(1.0)
            return Field(alpha, placement)
        space = image.colorspace_settings.name
        if not image.is_float and space not in _LINEAR | {"sRGB"}:
            raise NotFolded(node, f"its colour space is {space}")
        colours = texels[..., :3]
        is_associated = space not in _DATA and image.alpha_mode not in {"NONE", "CHANNEL_PACKED"}
        changes = is_associated and not numpy.all(alpha == 1)
        # Cycles multiplies by alpha where the node's alpha is unused, and in the image's own colour space.
        if changes and image.is_float:
            if uses_alpha:
                colours = numpy.divide(colours, alpha, out=colours.copy(), where=alpha > 0)
        elif changes and not uses_alpha:
            colours = colours * alpha
        if not image.is_float and space == "sRGB":
            colours = srgb_to_linear(colours)
        # Of a float image the file holds what Blender holds, if that is linear.
        return Field(colours, placement, None if changes else self.file(image, node, space))

    def texels(self, image, node):
        """(height, width, 4) from the top row down, as Blender holds them: of whole numbers in the image's colour space,
        else linear."""
        key = (image.name_full, node.image_user.frame_current if image.source == "SEQUENCE" else 0)
        if key not in self._texels:
            width, height = image.size
            if not image.has_data and width == 0:
                raise NotFolded(node, "its image cannot be read")
            values = numpy.empty(width * height * 4, numpy.float32)
            image.pixels.foreach_get(values)
            if not values.size:
                raise NotFolded(node, "its image cannot be read")
            self._texels[key] = values.reshape(height, width, 4)[::-1]
        return self._texels[key]

    def file(self, image, node, space):
        """(path in the folder, whether it is raw, channel) of the image's own file, or None."""
        if image.source not in {"FILE", "SEQUENCE"} or image.is_dirty:
            return None
        paths = file_of(image, node)
        suffix = pathlib.Path(image.filepath_from_user(image_user=node.image_user)).suffix.lower()
        if suffix not in _READ or (suffix in _FLOATS and space not in _LINEAR):
            return None
        if image.packed_file is not None:
            content = image.packed_file.data
        elif paths:
            content = paths[0].read_bytes()
        else:
            return None
        return (self.context.file("textures", suffix, content, lambda to: to.write_bytes(content)), space in _LINEAR, None)


@folds("ShaderNodeVertexColor")
def vertex_colour(values, source):
    if source.socket.identifier != "Color":
        raise NotFolded(source.node, "the alpha of a colour attribute")
    return values.attribute(source.node, source.node.layer_name)


@folds("ShaderNodeAttribute")
def attribute(values, source):
    node = source.node
    if node.attribute_type != "GEOMETRY" or source.socket.identifier not in {"Color", "Vector"}:
        raise NotFolded(node, "an attribute that is no colour")
    return values.attribute(node, node.attribute_name)
