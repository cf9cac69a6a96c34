# SPDX-License-Identifier: GPL-3.0-or-later
"""Where things are while the shutter is open."""

import dataclasses
from xml.etree import ElementTree

from .elements import add_matrix, matrix_text, number


@dataclasses.dataclass(frozen=True)
class Blur:
    """What an object's settings in Cycles say. keys: at so many times its place is known, 1 if it stands still.
    deforms: whether its shape may change."""
    keys: int
    deforms: bool


def blur_of(obj, parent=None):
    """The Blur of an evaluated object, or of an instance of it that the parent makes."""
    settings = [getattr(each, "cycles", None) for each in (obj, parent) if each is not None]
    if not all(getattr(each, "use_motion_blur", True) for each in settings):
        return Blur(1, False)
    steps = max(max(1, getattr(each, "motion_steps", 1)) for each in settings)
    return Blur((2 << (steps - 1)) + 1, all(getattr(each, "use_deform_motion", True) for each in settings))


class Shutter:
    """frames: the times of keys in frames, ascending; one if nothing moves. seconds: the same in seconds."""

    def __init__(self, scene, keys):
        render = scene.render
        frame = scene.frame_current
        self.is_open = keys > 1 and render.use_motion_blur and render.motion_blur_shutter > 0
        rate = render.fps / render.fps_base
        if not self.is_open:
            self.frames = [float(frame)]
        else:
            start = frame - {"START": 0.0, "CENTER": 0.5, "END": 1.0}[render.motion_blur_position] * \
                render.motion_blur_shutter
            self.frames = [start + render.motion_blur_shutter * key / (keys - 1) for key in range(keys)]
        self.seconds = [time / rate for time in self.frames]

    @property
    def middle(self):
        """In frames: what is not blurred is as it is then, as in Cycles."""
        return self.frames[len(self.frames) // 2]

    def some(self, values, keys):
        """Of one value a key of the shutter, those of something with so many keys, not 1. All counts are a power of two
        and one."""
        return values[::(len(self.frames) - 1) // (keys - 1)] if self.is_open else values


class Place:
    """A matrix for each of its keys, or one."""

    def __init__(self, shutter, matrices):
        self.shutter = shutter
        self.matrices = matrices

    def then(self, change):
        """The Place with change(matrix) at each time."""
        return Place(self.shutter, [change(matrix) for matrix in self.matrices])

    @property
    def now(self):
        """In the middle of the shutter's time."""
        return self.matrices[len(self.matrices) // 2]

    @property
    def moves(self):
        return any(matrix != self.matrices[0] for matrix in self.matrices[1:])

    def add_to(self, parent):
        """Adds the element's to_world."""
        if not self.moves:
            add_matrix(parent, self.matrices[0])
            return
        animation = ElementTree.SubElement(parent, "animation", {"name": "to_world"})
        for time, matrix in zip(self.shutter.some(self.shutter.seconds, len(self.matrices)), self.matrices):
            transform = ElementTree.SubElement(animation, "transform", {"time": number(time)})
            ElementTree.SubElement(transform, "matrix", {"value": matrix_text(matrix)})
