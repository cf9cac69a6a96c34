"""Scenes from dicts, as those of Mitsuba 3's load_dict, written as Mitsuba XML with numpy arrays in files beside it."""

from __future__ import annotations

import functools
import os
import struct
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy

from . import images
from .errors import UsageError
from .options import description

if TYPE_CHECKING:
    from .images import Array

_VALUES = {"rgb", "spectrum"}  # elements of their own
_MESH = {"vertices", "faces", "normals", "texcoords", "colors"}


def transform(*steps: Array) -> Array:
    """The product of 4 x 4 matrices, of which the first is applied first."""
    product = numpy.eye(4)
    for step in steps:
        product = numpy.asarray(step, float) @ product
    return product


def translate(x: float, y: float, z: float) -> Array:
    """4 x 4 matrix of a translation."""
    matrix = numpy.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def scale(x: float, y: float | None = None, z: float | None = None) -> Array:
    """4 x 4 matrix; of one number in all directions."""
    return numpy.diag([x, x if y is None else y, x if z is None else z, 1.0])


def rotate(axis: Sequence[float], degrees: float) -> Array:
    """4 x 4 matrix of a rotation about an axis through the origin, counter-clockwise seen from its tip (Rodrigues)."""
    x, y, z = numpy.asarray(axis, float) / numpy.linalg.norm(axis)
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = numpy.radians(degrees)
    matrix = numpy.eye(4)
    matrix[:3, :3] += numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * (cross @ cross)
    return matrix


def look_at(origin: Sequence[float], target: Sequence[float], up: Sequence[float] = (0, 1, 0)) -> Array:
    """4 x 4 matrix `to_world` of a camera at `origin` that looks along +z, as Mitsuba's, at `target`."""
    forward = numpy.subtract(target, origin, dtype=float)
    forward /= numpy.linalg.norm(forward)
    left = numpy.cross(up, forward)
    if not numpy.linalg.norm(left) > 0:
        raise UsageError(f"look_at: up={tuple(up)} is the direction of view")
    left /= numpy.linalg.norm(left)
    matrix = numpy.eye(4)
    matrix[:3] = numpy.column_stack([left, numpy.cross(forward, left), forward, origin])
    return matrix


def write_ply(
    path: Path, vertices: Any, faces: Any, normals: Any = None, texcoords: Any = None, colors: Any = None
) -> None:
    """Writes a mesh: vertices (n, 3), triangles or quads (m, 3 or 4) of their numbers; of each vertex normals (n, 3),
    texture coordinates (n, 2), colours (n, 3), linear Rec. 709. Raises UsageError for other shapes, NaN and numbers
    out of range."""
    columns: list[tuple[list[str], Array]] = []
    for name, array, width, properties in (
        ("vertices", vertices, 3, "x y z"),
        ("normals", normals, 3, "nx ny nz"),
        ("texcoords", texcoords, 2, "u v"),
        ("colors", colors, 3, "r g b"),
    ):
        if array is None:
            continue
        values = _finite(name, array)
        rows = columns[0][1].shape[0] if columns else values.shape[0]
        if values.ndim != 2 or values.shape != (rows, width) or rows == 0:
            raise UsageError(f"{name} has the shape {values.shape}, not ({rows if columns else 'n'}, {width})")
        columns.append((properties.split(), values))
    corners = numpy.asarray(faces)
    if corners.ndim != 2 or corners.shape[1] not in (3, 4) or corners.dtype.kind not in "iu" or not len(corners):
        raise UsageError(f"faces are integers of the shape (m, 3) or (m, 4), not {corners.dtype} {corners.shape}")
    count = columns[0][1].shape[0]
    if corners.min() < 0 or corners.max() >= count:
        raise UsageError(f"faces has numbers from {corners.min()} to {corners.max()} of {count} vertices")
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
    header += [f"property float {name}" for names, _ in columns for name in names]
    header += [f"element face {len(corners)}", "property list uchar int vertex_indices", "end_header", ""]
    record = numpy.zeros(len(corners), [("n", "u1"), ("corners", "<i4", (corners.shape[1],))])
    record["n"], record["corners"] = corners.shape[1], corners
    with path.open("wb") as file:
        file.write("\n".join(header).encode())
        file.write(numpy.hstack([values for _, values in columns]).astype("<f4").tobytes())
        file.write(record.tobytes())


def _write_png(path: Path, data: Array) -> None:
    """8-bit (height, width) or (height, width, 3 or 4)."""
    colour = {1: 0, 3: 2, 4: 6}[data.shape[2]]
    rows = numpy.hstack([numpy.zeros((data.shape[0], 1), numpy.uint8), data.reshape(data.shape[0], -1)]).tobytes()

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    size = struct.pack(">IIBBBBB", data.shape[1], data.shape[0], 8, colour, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", size) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    )


def _write_volume(path: Path, data: Array) -> None:
    """Mitsuba's .vol: (z, y, x) or (z, y, x, channels) floats."""
    channels = data.shape[3] if data.ndim == 4 else 1
    if data.ndim not in (3, 4) or channels not in (1, 3) or 0 in data.shape:
        raise UsageError(f"a volume has the shape (z, y, x) or (z, y, x, 3), not {data.shape}")
    depth, height, width = data.shape[:3]
    head = b"VOL\x03" + struct.pack("<5i6f", 1, width, height, depth, channels, 0, 0, 0, 1, 1, 1)
    path.write_bytes(head + data.astype("<f4").tobytes())


def _finite(name: str, array: Any) -> Array:
    try:
        values = numpy.asarray(array, numpy.float32)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name} is no array of numbers: {error}") from None
    bad = numpy.argwhere(~numpy.isfinite(values))
    if len(bad):
        raise UsageError(
            f"{name}{bad[0].tolist()} is {values[tuple(bad[0])]}, one of {len(bad)} values that are not finite"
        )
    return values


def _numbers(values: Any) -> str:
    return " ".join(repr(float(value)) for value in numpy.ravel(values))


class _Writer:
    def __init__(self, folder: Path):
        self._folder, self._files = folder, 0

    def _file(self, ending: str) -> Path:
        self._files += 1
        return self._folder / f"array-{self._files}.{ending}"

    def object(self, parent: ElementTree.Element, name: str | None, plugin: Mapping[str, Any]) -> None:
        """Adds an object, of which `name` is the parameter."""
        if not isinstance(plugin.get("type"), str):
            raise UsageError(f"{name or 'the scene'} is a dict without 'type'")
        kind = plugin["type"]
        parameters = {key: value for key, value in plugin.items() if key not in ("type", "id")}
        attributes = {} if name is None else {"name": name}
        if kind == "ref":
            ElementTree.SubElement(parent, "ref", {**attributes, "id": str(plugin["id"])})
            return
        if kind in _VALUES:
            ElementTree.SubElement(parent, kind, {**attributes, "value": self._spectrum(name, kind, parameters)})
            return
        if kind in ("ply", "mesh") and _MESH & set(parameters):
            kind, path = "ply", self._file("ply")
            arrays = {key: parameters.pop(key) for key in _MESH & set(parameters)}
            if not {"vertices", "faces"} <= set(arrays):
                raise UsageError(f"{name}: a mesh has vertices and faces")
            write_ply(path, **arrays)
            parameters["filename"] = path.name
        if kind == "bitmap" and "data" in parameters:
            parameters["filename"] = self._bitmap(parameters.pop("data")).name
        if kind == "gridvolume" and "data" in parameters:
            path = self._file("vol")
            _write_volume(path, _finite("data", parameters.pop("data")))
            parameters["filename"] = path.name
        tag = _tag(kind, name)
        element = ElementTree.SubElement(parent, tag, {"type": kind})
        # The key of what belongs to the scene itself is its id.
        identity = plugin.get("id", name if parent.tag == "scene" else None)
        if identity is not None:
            element.set("id", str(identity))
        if parent.tag != "scene" and (
            tag in ("texture", "medium", "volume", "phase") or (tag, parent.tag) == ("bsdf", "bsdf")
        ):
            element.attrib.update(attributes)
        for key, value in parameters.items():
            self.parameter(element, key, value)

    def _spectrum(self, name: str | None, kind: str, parameters: Mapping[str, Any]) -> str:
        value = parameters.get("value")
        if isinstance(value, Sequence) and value and isinstance(value[0], Sequence):
            return ", ".join(f"{float(wavelength)!r}:{float(amount)!r}" for wavelength, amount in value)
        values = _finite(f"{name} ({kind})", value)
        if values.size not in (1, 3):
            raise UsageError(f"{name} ({kind}) has {values.size} values, not 1 or 3")
        return _numbers(values)

    def _bitmap(self, data: Any) -> Path:
        array = numpy.asarray(data)
        array = array[..., None] if array.ndim == 2 else array
        if array.ndim != 3 or 0 in array.shape:
            raise UsageError(f"a bitmap has the shape (height, width) or (height, width, channels), not {array.shape}")
        if array.dtype == numpy.uint8:
            if array.shape[2] not in (1, 3, 4):
                raise UsageError(f"an 8-bit bitmap has 1, 3 or 4 channels, not {array.shape[2]}")
            path = self._file("png")
            _write_png(path, array)
            return path
        path = self._file("exr")
        images.write(path, _finite("bitmap", array if array.shape[2] == 3 else array[..., 0]))
        return path

    def parameter(self, parent: ElementTree.Element, name: str, value: Any) -> None:
        """Adds a parameter of the Python type."""

        def add(tag: str, **attributes: str) -> None:
            ElementTree.SubElement(parent, tag, {"name": name, **attributes})

        if isinstance(value, Mapping):
            self.object(parent, name, value)
        elif hasattr(value, "write_ply"):  # a mesh of Mitsuba's
            path = self._file("ply")
            value.write_ply(str(path))
            self.object(parent, name, {"type": "ply", "filename": path.name})
        elif isinstance(value, (bool, numpy.bool_)):
            add("boolean", value="true" if value else "false")
        elif isinstance(value, (int, numpy.integer)):
            add("integer", value=str(int(value)))
        elif isinstance(value, (float, numpy.floating)):
            add("float", value=_numbers(_finite(name, value)))
        elif isinstance(value, (str, os.PathLike)):
            text = os.fspath(value)
            own = text if (self._folder / text).exists() or text.startswith("$") else os.path.abspath(text)
            add("string", value=own if name == "filename" else text)
        else:
            array = _finite(name, getattr(value, "matrix", value))
            if array.shape == (4, 4):
                element = ElementTree.SubElement(parent, "transform", {"name": name})
                ElementTree.SubElement(element, "matrix", {"value": _numbers(array)})
            elif array.shape == (3,):
                add("vector" if name in ("direction", "up") else "point", value=_numbers(array))
            else:
                raise UsageError(f"{name} has the shape {array.shape}: it is neither a point nor a 4 x 4 matrix")


def _tag(kind: str, name: str | None) -> str:
    """The tag of a plugin, by the program's list of plugins; of a name that plugins of several kinds have, by its
    place."""
    tags = _tags().get(kind, [])
    if name is not None:
        place = name.rstrip("0123456789_-")
        for tag, names in {"medium": ("medium", "interior", "exterior"), "bsdf": ("bsdf",)}.items():
            if place in names and (tag in tags or not tags):
                return tag
    return tags[0] if tags else "shape"  # of an unknown one the program says what is wrong


@functools.cache
def _tags() -> dict[str, list[str]]:
    tags: dict[str, list[str]] = {}
    for plugin in description()["plugins"]:
        for name in (plugin["name"], *plugin["aliases"], *plugin["replaces"]):
            tags.setdefault(name, []).append(plugin["kind"])
    return tags


def write_scene(scene: Mapping[str, Any], folder: str | os.PathLike[str], name: str = "scene") -> Path:
    """Writes a scene into a folder as NAME.xml with the files of its arrays, and returns its path.

    The dict is that of Mitsuba 3's load_dict; matrices may be numpy arrays. Besides, {"type": "ply", "vertices": …,
    "faces": …, "normals": …, "texcoords": …, "colors": …} is a mesh, {"type": "bitmap", "data": array} a texture
    (8-bit: sRGB; floats: linear) and {"type": "gridvolume", "data": array} a volume. Raises UsageError for arrays of
    other shapes and for values that are not finite.
    """
    if scene.get("type") != "scene":
        raise UsageError("the dict of a scene has 'type': 'scene'")
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    root = ElementTree.Element("scene", {"version": "3.0.0"})
    writer = _Writer(place)
    # What others refer to comes first.
    entries = [(key, value) for key, value in scene.items() if key not in ("type", "id")]
    entries.sort(key=lambda entry: not (isinstance(entry[1], Mapping) and _is_referred_to(entry[1])))
    for key, value in entries:
        writer.parameter(root, key, value)
    ElementTree.indent(root)
    path = place / f"{name}.xml"
    ElementTree.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)
    return path


def _is_referred_to(plugin: Mapping[str, Any]) -> bool:
    return _tag(str(plugin.get("type")), None) in ("bsdf", "texture", "medium")
