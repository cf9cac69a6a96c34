# SPDX-License-Identifier: GPL-3.0-or-later
"""Where things are while the shutter is open."""

from xml.etree import ElementTree

from .elements import add_matrix, matrix_text, number

_KEYS = 3  # times at which Cycles looks, too, unless an object asks for more


class Shutter:
    """frames: the times of keys in frames, ascending; one if nothing moves. seconds: the same in seconds."""

    def __init__(self, scene, may_open=True, keys=_KEYS):
        render = scene.render
        frame = scene.frame_current
        self.is_open = may_open and render.use_motion_blur and render.motion_blur_shutter > 0
        rate = render.fps / render.fps_base
        if not self.is_open:
            self.frames = [float(frame)]
        else:
            start = frame - {"START": 0.0, "CENTER": 0.5, "END": 1.0}[render.motion_blur_position] * \
                render.motion_blur_shutter
            self.frames = [start + render.motion_blur_shutter * key / (keys - 1) for key in range(keys)]
        self.seconds = [time / rate for time in self.frames]


class Place:
    """A matrix for each key of the shutter."""

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
        return len(self.matrices) > 1 and any(matrix != self.matrices[0] for matrix in self.matrices[1:])

    def add_to(self, parent):
        """Adds the element's to_world."""
        if not self.moves:
            add_matrix(parent, self.matrices[0])
            return
        animation = ElementTree.SubElement(parent, "animation", {"name": "to_world"})
        for time, matrix in zip(self.shutter.seconds, self.matrices):
            transform = ElementTree.SubElement(animation, "transform", {"time": number(time)})
            ElementTree.SubElement(transform, "matrix", {"value": matrix_text(matrix)})
