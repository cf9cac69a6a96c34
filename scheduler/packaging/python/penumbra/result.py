"""What a render gives: arrays, statistics and files."""

from __future__ import annotations

import functools
import json
import os
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import images
from .errors import Message, UsageError
from .options import words
from .program import answer
from .progress import in_notebook

if TYPE_CHECKING:
    from .images import Array


class Image:
    """An EXR file. Its arrays are read when they are asked for first.

    `path`: the file. `layers`: all layers by name as arrays with one row per row of pixels, the topmost first, of the
    shape (height, width) or (height, width, channels); of a crop the pixels of the crop. "albedo", "normal" (in the
    world) and "depth" (in the scene's unit) are means over the first hits, "samples" are numbers of samples, "variance"
    is that of the mean; scheduler/record/README.md has the others. `metadata`: the attributes of the header.
    """

    def __init__(self, path: Path, *, keep: object = None):
        self._path, self._keep = path, keep

    @property
    def path(self) -> Path:
        return self._path

    @functools.cached_property
    def _content(self) -> tuple[dict[str, Array], dict[str, Any]]:
        return images.read(self.path)

    def load(self) -> None:
        """Reads the file now, if it has not been read. Raises UsageError."""
        assert self._content

    @property
    def layers(self) -> dict[str, Array]:
        return self._content[0]

    @property
    def metadata(self) -> dict[str, Any]:
        return self._content[1]

    @property
    def image(self) -> Array:
        """Mean radiance, linear Rec. 709: (height, width, 3), float32."""
        return self.layers["beauty"]

    @property
    def command(self) -> str:
        """The command that renders the same, or the nearest one."""
        return str(self.metadata.get("penumbra:command", self.metadata.get("penumbra:nearest_command", "")))

    def png(self, layer: str | None = None, **options: Any) -> bytes:
        """A picture of a layer as a PNG file; options as those of `penumbra convert`: exposure, tonemap."""
        with tempfile.TemporaryDirectory(prefix="penumbra-") as folder:
            picture = Path(folder) / "picture.png"
            answer(["convert", self.path, picture, *words("convert", {"layer": layer, **options})])
            return picture.read_bytes()

    def show(self, layer: str | None = None, **options: Any) -> None:
        """Shows that picture: in a notebook there, else with matplotlib."""
        picture = self.png(layer, **options)
        if in_notebook():
            from IPython.display import Image as Picture
            from IPython.display import display

            display(Picture(picture))  # type: ignore[no-untyped-call, unused-ignore]
            return
        import io

        from matplotlib import pyplot

        pyplot.imshow(pyplot.imread(io.BytesIO(picture)))
        pyplot.axis("off")
        pyplot.show()

    def _repr_png_(self) -> bytes:
        return self.png()

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Copies it: the .exr file, a .png picture of it, or all layers as .npz (numpy.load)."""
        path = Path(path)
        if path.suffix == ".exr":
            shutil.copyfile(self.path, path)
        elif path.suffix == ".png":
            path.write_bytes(self.png())
        elif path.suffix == ".npz":
            import numpy

            numpy.savez(path, **self.layers)  # type: ignore[arg-type, unused-ignore]
        else:
            raise UsageError(f"'{path}' is no name of an image: .exr, .png or .npz")
        return path

    def __repr__(self) -> str:
        height, width = self.image.shape[:2]
        return f"<{type(self).__name__} {width} x {height}: {', '.join(self.layers)}>"


class Result(Image):
    """The image of a render, and what is known of the render.

    `statistics`: the JSON of scheduler/record/README.md. `warnings`: what the program warned of. `interrupted`: whether
    Ctrl-C ended it. `files`: all that was written; temporary ones are there as long as the result.
    """

    def __init__(
        self,
        files: Sequence[Path],
        statistics: dict[str, Any],
        warnings: Sequence[Message] = (),
        *,
        interrupted: bool = False,
        keep: object = None,
    ):
        self.files = [Path(file) for file in files]
        self.statistics, self.warnings, self.interrupted = statistics, list(warnings), interrupted
        exr = [file for file in self.files if file.suffix == ".exr"]
        super().__init__(exr[0] if exr else Path(), keep=keep)
        self._denoised = Image(exr[1], keep=keep) if len(exr) > 1 else None

    @property
    def path(self) -> Path:
        if not self._path.name:
            raise UsageError(
                f"there are no layers: only {', '.join(map(str, self.files)) or 'nothing'} was written; "
                "`out` that ends in .exr has them"
            )
        return self._path

    @property
    def variance(self) -> Array:
        """Variance of `image`, of each pixel and channel: the square of its standard error."""
        return self.layers["variance"]

    @property
    def denoised(self) -> Array:
        """The same shape and unit as `image`; with denoise="nfor" or another method."""
        if self._denoised is None:
            raise UsageError('nothing was denoised: render with denoise="nfor"')
        return self._denoised.image

    @property
    def complete(self) -> bool:
        """Whether all samples are there."""
        return bool(self.statistics.get("complete", not self.interrupted))

    @property
    def seconds(self) -> float:
        """Of rendering, with the transfer of the scene to the workers."""
        return float(self.statistics["seconds"]["render"])

    def _repr_png_(self) -> bytes:
        return next((file.read_bytes() for file in self.files if file.suffix == ".png"), None) or self.png()


def read(path: str | os.PathLike[str]) -> Image:
    """An EXR file; of a render with its statistics, if they are beside it."""
    path = Path(path)
    image = Image(path)
    image.load()
    statistics = path.with_suffix(".json")
    if not statistics.exists():
        return image
    return Result([path, *filter(Path.exists, [path.with_suffix(".png")])], json.loads(statistics.read_text()))
