"""Penumbra from Python: renders scenes with the program's workers, and gives numpy arrays.

result = penumbra.render("scene.xml", spp=64, integrator="path", settings={"film.width": 320})
result.image, result.variance, result.layers["albedo"]
"""

from .errors import Message, PenumbraError, ProgramError, RenderError, SceneError, UsageError
from .options import description
from .rendering import estimate, pixel, render, render_all
from .result import Image, Result, read
from .scenes import look_at, rotate, scale, transform, translate, write_scene
from .service import Job, Service
from .session import Session
from .sweeping import sweep
from .tools import compare, denoise, info, merge, report

__all__ = [
    "Image",
    "Job",
    "Message",
    "PenumbraError",
    "ProgramError",
    "RenderError",
    "Result",
    "SceneError",
    "Service",
    "Session",
    "UsageError",
    "compare",
    "denoise",
    "description",
    "estimate",
    "info",
    "look_at",
    "merge",
    "pixel",
    "read",
    "render",
    "render_all",
    "report",
    "rotate",
    "scale",
    "sweep",
    "transform",
    "translate",
    "write_scene",
]

from . import signatures as _signatures

try:
    _signatures.document_all()
except ProgramError:  # each function says so when it is called
    pass
