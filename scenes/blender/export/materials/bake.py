# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that are neither constant nor images, baked by Cycles in a Blender process of its own (bake_process.py)."""

import atexit
import hashlib
import json
import os
import pathlib
import subprocess
import tempfile
import weakref

import bpy
import numpy

from ..context import own_blender
from .dependencies import fingerprint, is_painted, pixels_of
from .fields import Field, Placement, constant


MARK = "penumbra bake: "  # bake_process.py has the same


class BakeError(Exception):
    """A bake failed; says why."""


class Process:
    """The other Blender. It starts with the first job, and ends with this one."""

    def __init__(self):
        self._process = None
        atexit.register(self.close)

    def run(self, job):
        """Does a job; see bake_process.py. Raises BakeError."""
        if self._process is None or self._process.poll() is not None:
            command = own_blender(pathlib.Path(__file__).with_name("bake_process.py"))
            self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                             stderr=subprocess.DEVNULL, text=True, encoding="utf-8")
        try:
            self._process.stdin.write(json.dumps(job) + "\n")
            self._process.stdin.flush()
            for line in self._process.stdout:
                if line.startswith(MARK):
                    answer = json.loads(line[len(MARK):])
                    if "error" in answer:
                        raise BakeError(answer["error"])
                    return
        except OSError as error:
            raise BakeError(f"the Blender that bakes has ended ({error})") from error
        raise BakeError("the Blender that bakes has ended")

    def close(self):
        """Ends it."""
        if self._process is not None:
            self._process.stdin.close()
            self._process.stdout.close()
            self._process.wait()
            self._process = None


_processes = weakref.WeakKeyDictionary()  # by Context


def process_of(context):
    """The process of an export."""
    if context not in _processes:
        _processes[context] = Process()
        weakref.finalize(context, _processes[context].close)
    return _processes[context]


class Bakes:
    """The bakes of one material on one object.

    mesh: the MeshToBake of the faces that show it, made on demand.
    """

    def __init__(self, material, mesh, uv_bounds, context):
        self.material, self.context = material, context
        self._make_mesh, self._uv_bounds = mesh, uv_bounds
        self._mesh = None

    @property
    def mesh(self):
        if self._mesh is None:
            self._mesh = self._make_mesh()
        return self._mesh

    def uvs(self):
        """Coordinates of the mesh's loops without overlaps, made for bakes: (loops of the MeshToBake, 2)."""
        return self._array(hashlib.sha256(b"unwrapped" + self.mesh.key).digest(),
                           lambda folder: [{"unwrap": True, "mesh": self._write_mesh(folder)}])[0]

    def constant(self, at, dependencies):
        """The value where it depends on nothing, as a Field."""
        values = self._baked(at, dependencies, b"constant", lambda folder: {"bounds": [0, 0, 1, 1], "uv_map": None}, 1,
                             signed=True)
        return constant(values[0, 0])

    def over_uvs(self, at, dependencies, uv_map, signed=False):
        """The value as an image over the rectangle of a UV map (by its name) that the faces cover."""
        low, high = self._uv_bounds(uv_map)
        size = numpy.where(high > low, high - low, 1.0)
        bounds = [*low, *(low + size)]
        values = self._baked(at, dependencies, repr((uv_map, bounds)).encode(),
                             lambda folder: {"bounds": bounds, "uv_map": uv_map}, self.context.texture_size,
                             signed=signed)
        rows = ((1 / size[0], 0.0, -low[0] / size[0]), (0.0, 1 / size[1], -low[1] / size[1]))
        return Field(values, Placement(uv_map, rows, "EXTEND"))

    def over_mesh(self, at, dependencies, kind="EMIT", signed=False):
        """The value as an image over uvs(); NORMAL and DISPLACEMENT: normals, in tangent space, by such an input."""
        uvs = self.uvs()

        def place(folder):
            numpy.save(os.path.join(folder, "uvs.npy"), uvs)
            return {"mesh": self._write_mesh(folder), "uvs": os.path.join(folder, "uvs.npy")}

        values = self._baked(at, dependencies, b"mesh" + self.mesh.key, place, self.context.texture_size, kind, signed)
        return Field(values, Placement(None, extension="EXTEND"))

    def _baked(self, at, dependencies, where, place, size, kind="EMIT", signed=False):
        """The values; signed: they may be negative, and need a second bake."""
        frame = self.context.depsgraph.scene.frame_current
        key = hashlib.sha256(fingerprint(at, dependencies) + where + repr((size, kind, signed)).encode()).digest()

        def jobs(folder):
            material = self.material.original
            blend = os.path.join(folder, "material.blend")
            bpy.data.libraries.write(blend, {material}, path_remap="ABSOLUTE", fake_user=True)
            images = {getattr(node, "image", None) for node, _ in dependencies.nodes} - {None}
            painted = {}
            for image in filter(is_painted, images):
                painted[image.name] = os.path.join(folder, f"image {len(painted)}.npy")
                numpy.save(painted[image.name], pixels_of(image))
            for sign in (1.0, -1.0) if signed else (1.0,):
                yield {"blend": blend, "material": material.name, "groups": [group.name for group in at.groups],
                       "node": at.node.name, "socket": at.socket.identifier, "kind": kind, "sign": sign,
                       "is_number": at.socket.type == "VALUE", "width": size, "height": size, "frame": frame,
                       "painted": painted,
                       **place(folder)}

        parts = self._array(key, jobs)
        values = parts[0].astype(float) - (parts[1] if len(parts) > 1 else 0)
        return values[..., :1] if at.socket.type == "VALUE" else values

    def _array(self, key, jobs):
        """The results of jobs(folder) one after another, kept in the export's folder by the key of their content."""
        def write(path):
            with tempfile.TemporaryDirectory() as folder:
                results = []
                for number, job in enumerate(jobs(folder)):
                    job["to"] = os.path.join(folder, f"{number}.npy")
                    process_of(self.context).run(job)
                    results.append(numpy.load(job["to"]))
                with open(path, "wb") as file:
                    numpy.save(file, numpy.stack(results))
        return numpy.load(self.context.folder / self.context.file("bakes", ".npy", key, write))

    def _write_mesh(self, folder):
        path = os.path.join(folder, "mesh.npz")
        numpy.savez(path, names=self.mesh.names, **self.mesh.arrays)
        return path
