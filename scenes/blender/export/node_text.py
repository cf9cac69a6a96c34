# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees as text: equal trees have equal text, in every run and every Blender of one version."""

import hashlib
import os

import bpy

_OF_EDITORS = {"rna_type", "name", "label", "location", "location_absolute", "width", "width_hidden", "height",
               "dimensions", "select", "hide", "parent", "color", "use_custom_color", "inputs", "outputs",
               "internal_links", "color_tag", "warning_propagation"}
_LISTS = {"elements", "curves", "points"}


def image_text(image):
    """What an image is: its file with size and time, or its packed bytes, or how it was generated."""
    settings = (image.source, image.colorspace_settings.name, image.alpha_mode, tuple(image.size))
    if image.packed_file is not None:
        return repr((settings, hashlib.sha256(image.packed_file.data).hexdigest()))
    path = bpy.path.abspath(image.filepath, library=image.library)
    if image.source in {"FILE", "SEQUENCE", "MOVIE", "TILED"} and os.path.isfile(path):
        status = os.stat(path)
        return repr((settings, os.path.abspath(path), status.st_size, status.st_mtime_ns))
    return repr((settings, image.name_full, path, tuple(image.generated_color), image.generated_type))


def _value_text(owner, prop, level):
    value = getattr(owner, prop.identifier)
    if prop.type == "COLLECTION":
        return [_struct_text(item, level + 1) for item in value] if prop.identifier in _LISTS else None
    if prop.type != "POINTER":
        return list(value) if getattr(prop, "is_array", False) else value
    if value is None:
        return None
    if isinstance(value, bpy.types.Image):
        return image_text(value)
    if isinstance(value, bpy.types.NodeTree):
        return tree_text(value)
    if isinstance(value, bpy.types.ID):
        return (value.bl_rna.identifier, value.name_full)
    return _struct_text(value, level + 1) if level < 3 else None


def _struct_text(struct, level=0):
    hidden = _OF_EDITORS if level == 0 else {"rna_type", "select"}
    return repr([(prop.identifier, _value_text(struct, prop, level)) for prop in struct.bl_rna.properties
                 if prop.identifier not in hidden and not prop.identifier.startswith(("show_", "bl_"))])


def _socket_text(socket):
    value = getattr(socket, "default_value", None)
    return (socket.identifier, list(value) if hasattr(value, "__len__") and not isinstance(value, str) else str(value))


def tree_text(tree):
    """The tree's nodes, values and links."""
    nodes = [(node.name, node.bl_idname, _struct_text(node), [_socket_text(socket) for socket in node.inputs],
              [_socket_text(socket) for socket in node.outputs]) for node in tree.nodes]
    links = [(link.from_node.name, link.from_socket.identifier, link.to_node.name, link.to_socket.identifier)
             for link in tree.links]
    return repr((sorted(nodes), sorted(links)))
