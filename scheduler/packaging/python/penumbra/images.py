"""EXR files as numpy arrays."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy

from .errors import UsageError

if TYPE_CHECKING:
    Array = numpy.ndarray[Any, numpy.dtype[Any]]

_ORDER = {name: i for i, name in enumerate("RGBAXYZWUV")}  # of the channels of a layer


def read(path: str | os.PathLike[str]) -> tuple[dict[str, Array], dict[str, Any]]:
    """Layers and metadata of an EXR file.

    Arrays have one row per row of pixels, the topmost first: (height, width), or (height, width, channels) for layers
    of several channels. The layer without a name is "beauty"; its alpha is "alpha".
    """
    import OpenEXR  # type: ignore[import-not-found, import-untyped, unused-ignore]

    try:
        with OpenEXR.File(os.fspath(path), separate_channels=True) as file:
            metadata = dict(file.header())
            channels = {name: channel.pixels for part in file.parts for name, channel in part.channels.items()}
    except (OSError, RuntimeError, ValueError) as error:
        raise UsageError(f"cannot read {os.fspath(path)}: {error}") from error
    groups: dict[str, list[str]] = {}
    for name in channels:
        layer = name.rpartition(".")[0] or ("alpha" if name == "A" else "beauty")
        groups.setdefault(layer, []).append(name)
    layers = {}
    for layer, names in groups.items():
        names.sort(key=lambda name: (_ORDER.get(name.rpartition(".")[2], len(_ORDER)), name))
        arrays = [numpy.asarray(channels[name]) for name in names]
        layers[layer] = arrays[0] if len(arrays) == 1 else numpy.stack(arrays, axis=-1)
    return layers, metadata


def write(path: str | os.PathLike[str], image: Array, layers: Mapping[str, Array] | None = None) -> None:
    """Writes (height, width) or (height, width, 3) values as the image of an EXR file, with further layers of that
    size."""
    import OpenEXR

    channels = {}
    for name, array in {"": image, **(layers or {})}.items():
        array = numpy.ascontiguousarray(array, numpy.float32)
        if array.ndim == 2:
            array = array[..., None].repeat(3, axis=2)
        if array.ndim != 3 or array.shape[2] != 3 or 0 in array.shape:
            raise UsageError(f"an image has the shape (height, width) or (height, width, 3), not {numpy.shape(image)}")
        for i, channel in enumerate("RGB"):
            channels[f"{name}.{channel}" if name else channel] = numpy.ascontiguousarray(array[..., i])
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, channels).write(os.fspath(path))


def no_option(path: Path) -> Path:
    """The same file, whose name does not begin like an option."""
    return path.absolute() if str(path).startswith("-") else path


def path_of(image: Any, folder: Path, name: str) -> Path:
    """The file of an image: of a result, a path, or an array, which is written into the folder."""
    if isinstance(image, (str, os.PathLike)):
        return no_option(Path(image))
    if hasattr(image, "path"):
        return Path(image.path)
    path = folder / f"{name}.exr"
    write(path, numpy.asarray(image))
    return path
