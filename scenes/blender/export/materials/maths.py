# SPDX-License-Identifier: GPL-3.0-or-later
"""The operations of Blender's Math, Vector Math, Mix and colour nodes on arrays, as its manual defines them.

Numbers have arrays of shape (..., 1), colours and vectors (..., 3); shapes are broadcast.
"""

import numpy


def _divide(a, b):
    a, b = numpy.broadcast_arrays(a, b)
    return numpy.divide(a, b, out=numpy.zeros(a.shape), where=b != 0)


def _power(a, b):
    a, b = numpy.broadcast_arrays(a, b)
    allowed = (a > 0) | ((a < 0) & (b == numpy.trunc(b)))
    with numpy.errstate(over="ignore"):
        result = numpy.power(a, b, out=numpy.zeros(a.shape), where=allowed)
    return numpy.where(b == 0, 1.0, result)


def _logarithm(a, b):
    a, b = numpy.broadcast_arrays(a, b)
    allowed = (a > 0) & (b > 0)
    one = numpy.ones(a.shape)
    return _divide(numpy.log(numpy.where(allowed, a, one)), numpy.log(numpy.where(allowed, b, one)))


def _floored_modulo(a, b):
    return numpy.where(b != 0, a - numpy.floor(_divide(a, b)) * b, 0.0)


def _modulo(a, b):
    return numpy.where(b != 0, a - numpy.trunc(_divide(a, b)) * b, 0.0)


def _wrap(a, most, least):
    size = most - least
    return numpy.where(size != 0, a - size * numpy.floor(_divide(a - least, size)), least)


def _ping_pong(a, b):
    fraction = _divide(a - b, 2 * b)
    return numpy.where(b != 0, numpy.abs((fraction - numpy.floor(fraction)) * b * 2 - b), 0.0)


def _smooth_minimum(a, b, distance):
    h = _divide(numpy.maximum(distance - numpy.abs(a - b), 0), distance)
    return numpy.minimum(a, b) - h ** 3 * distance / 6


def _inverse_square_root(a):
    return numpy.where(a > 0, 1 / numpy.sqrt(numpy.where(a > 0, a, 1)), 0.0)


MATH = {
    "ADD": lambda a, b, c: a + b, "SUBTRACT": lambda a, b, c: a - b, "MULTIPLY": lambda a, b, c: a * b,
    "DIVIDE": lambda a, b, c: _divide(a, b), "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": lambda a, b, c: _power(a, b), "LOGARITHM": lambda a, b, c: _logarithm(a, b),
    "SQRT": lambda a, b, c: numpy.sqrt(numpy.maximum(a, 0)),
    "INVERSE_SQRT": lambda a, b, c: _inverse_square_root(a),
    "ABSOLUTE": lambda a, b, c: numpy.abs(a), "EXPONENT": lambda a, b, c: numpy.exp(a),
    "MINIMUM": lambda a, b, c: numpy.minimum(a, b), "MAXIMUM": lambda a, b, c: numpy.maximum(a, b),
    "LESS_THAN": lambda a, b, c: (a < b) * 1.0, "GREATER_THAN": lambda a, b, c: (a > b) * 1.0,
    "SIGN": lambda a, b, c: numpy.sign(a),
    "COMPARE": lambda a, b, c: (numpy.abs(a - b) <= numpy.maximum(c, numpy.finfo(numpy.float32).eps)) * 1.0,
    "SMOOTH_MIN": _smooth_minimum, "SMOOTH_MAX": lambda a, b, c: -_smooth_minimum(-a, -b, c),
    "ROUND": lambda a, b, c: numpy.floor(a + 0.5), "FLOOR": lambda a, b, c: numpy.floor(a),
    "CEIL": lambda a, b, c: numpy.ceil(a), "TRUNC": lambda a, b, c: numpy.trunc(a),
    "FRACT": lambda a, b, c: a - numpy.floor(a), "MODULO": lambda a, b, c: _modulo(a, b),
    "FLOORED_MODULO": lambda a, b, c: _floored_modulo(a, b), "WRAP": _wrap,
    "SNAP": lambda a, b, c: numpy.floor(_divide(a, b)) * b, "PINGPONG": lambda a, b, c: _ping_pong(a, b),
    "SINE": lambda a, b, c: numpy.sin(a), "COSINE": lambda a, b, c: numpy.cos(a), "TANGENT": lambda a, b, c: numpy.tan(a),
    "ARCSINE": lambda a, b, c: numpy.arcsin(numpy.clip(a, -1, 1)),
    "ARCCOSINE": lambda a, b, c: numpy.arccos(numpy.clip(a, -1, 1)), "ARCTANGENT": lambda a, b, c: numpy.arctan(a),
    "ARCTAN2": lambda a, b, c: numpy.arctan2(a, b), "SINH": lambda a, b, c: numpy.sinh(a),
    "COSH": lambda a, b, c: numpy.cosh(a), "TANH": lambda a, b, c: numpy.tanh(a),
    "RADIANS": lambda a, b, c: numpy.radians(a), "DEGREES": lambda a, b, c: numpy.degrees(a)}


def _dot(a, b):
    return (a * b).sum(axis=-1, keepdims=True)


def _length(a):
    return numpy.sqrt(_dot(a, a))


# function(a, b, c, scale); those that give a number are in VECTOR_NUMBERS.
VECTOR_MATH = {
    "ADD": lambda a, b, c, s: a + b, "SUBTRACT": lambda a, b, c, s: a - b, "MULTIPLY": lambda a, b, c, s: a * b,
    "DIVIDE": lambda a, b, c, s: _divide(a, b), "MULTIPLY_ADD": lambda a, b, c, s: a * b + c,
    "CROSS_PRODUCT": lambda a, b, c, s: numpy.cross(a, b),
    "PROJECT": lambda a, b, c, s: _divide(_dot(a, b), _dot(b, b)) * b,
    "DOT_PRODUCT": lambda a, b, c, s: _dot(a, b), "DISTANCE": lambda a, b, c, s: _length(a - b),
    "LENGTH": lambda a, b, c, s: _length(a), "SCALE": lambda a, b, c, s: a * s,
    "NORMALIZE": lambda a, b, c, s: _divide(a, _length(a)), "ABSOLUTE": lambda a, b, c, s: numpy.abs(a),
    "MINIMUM": lambda a, b, c, s: numpy.minimum(a, b), "MAXIMUM": lambda a, b, c, s: numpy.maximum(a, b),
    "FLOOR": lambda a, b, c, s: numpy.floor(a), "CEIL": lambda a, b, c, s: numpy.ceil(a),
    "FRACTION": lambda a, b, c, s: a - numpy.floor(a), "MODULO": lambda a, b, c, s: _modulo(a, b),
    "WRAP": lambda a, b, c, s: _wrap(a, b, c), "SNAP": lambda a, b, c, s: numpy.floor(_divide(a, b)) * b,
    "SINE": lambda a, b, c, s: numpy.sin(a), "COSINE": lambda a, b, c, s: numpy.cos(a),
    "TANGENT": lambda a, b, c, s: numpy.tan(a)}
VECTOR_NUMBERS = {"DOT_PRODUCT", "DISTANCE", "LENGTH"}


def to_hsv(colour):
    """(..., 3) red, green, blue as hue, saturation and value."""
    colour = numpy.asarray(colour, dtype=float)
    most, least = colour.max(axis=-1), colour.min(axis=-1)
    range_ = most - least
    saturation = numpy.where(most != 0, _divide(range_, most), 0.0)
    with numpy.errstate(divide="ignore", invalid="ignore"):
        c = (most[..., None] - colour) / range_[..., None]
    red, green, blue = c[..., 0], c[..., 1], c[..., 2]
    hue = numpy.where(colour[..., 0] == most, blue - green,
                      numpy.where(colour[..., 1] == most, 2 + red - blue, 4 + green - red)) / 6
    hue = numpy.where(saturation != 0, hue - numpy.floor(hue), 0.0)
    return numpy.stack([hue, saturation, most], axis=-1)


def from_hsv(hsv):
    """The inverse of to_hsv."""
    hue, saturation, value = hsv[..., :1], hsv[..., 1:2], hsv[..., 2:]
    place = (hue * 6 + numpy.array([0.0, 4.0, 2.0])) % 6
    return value * (1 - saturation * (1 - numpy.clip(numpy.abs(place - 3) - 1, 0, 1)))


def to_hsl(colour):
    """(..., 3) red, green, blue as hue, saturation and lightness."""
    hsv = to_hsv(colour)
    most, least = numpy.max(colour, axis=-1), numpy.min(colour, axis=-1)
    lightness = numpy.minimum((most + least) / 2, 1)
    saturation = numpy.where(lightness > 0.5, _divide(most - least, 2 - most - least), _divide(most - least, most + least))
    return numpy.stack([hsv[..., 0], saturation, lightness], axis=-1)


def from_hsl(hsl):
    """The inverse of to_hsl."""
    hue, saturation, lightness = hsl[..., :1], hsl[..., 1:2], hsl[..., 2:]
    pure = from_hsv(numpy.concatenate([hue, numpy.ones_like(hue), numpy.ones_like(hue)], axis=-1))
    return (pure - 0.5) * ((1 - numpy.abs(2 * lightness - 1)) * saturation) + lightness


def _dodge(a, b, t):
    rest = 1 - t * b
    return numpy.where(a == 0, a, numpy.where(rest <= 0, 1.0, numpy.minimum(_divide(a, rest), 1)))


def _burn(a, b, t):
    share = 1 - t + t * b
    return numpy.where(share <= 0, 0.0, numpy.clip(1 - _divide(1 - a, share), 0, 1))


def _in_hsv(change, needs):
    """A blend of hues and the like: change(hsv of a, hsv of b, t) -> (hsv, whether t mixes it with a); it counts where
    the saturation of b (needs 1) or of a (needs 0) is above 0."""
    def blend(a, b, t):
        a, b, t = numpy.broadcast_arrays(a, b, t)
        first, second = to_hsv(a), to_hsv(b)
        hsv, mixes = change(first, second, t[..., :1])
        changed = from_hsv(hsv)
        changed = a + (changed - a) * t if mixes else changed
        counts = True if needs is None else ((first, second)[needs][..., 1:2] != 0)
        return numpy.where(counts, changed, a)
    return blend


def _join(*parts):
    return numpy.concatenate(parts, axis=-1)


def _lerp(a, b, t):
    return a + (b - a) * t


MIX = {
    "MIX": _lerp, "ADD": lambda a, b, t: a + b * t, "MULTIPLY": lambda a, b, t: _lerp(a, a * b, t),
    "SUBTRACT": lambda a, b, t: a - b * t, "DARKEN": lambda a, b, t: _lerp(a, numpy.minimum(a, b), t),
    "LIGHTEN": lambda a, b, t: _lerp(a, numpy.maximum(a, b), t), "DIFFERENCE": lambda a, b, t: _lerp(a, numpy.abs(a - b), t),
    "EXCLUSION": lambda a, b, t: numpy.maximum(_lerp(a, a + b - 2 * a * b, t), 0),
    "SCREEN": lambda a, b, t: 1 - (1 - t + t * (1 - b)) * (1 - a),
    "OVERLAY": lambda a, b, t: numpy.where(a < 0.5, a * (1 - t + 2 * t * b), 1 - (1 - t + 2 * t * (1 - b)) * (1 - a)),
    "DIVIDE": lambda a, b, t: numpy.where(b != 0, _lerp(a, _divide(a, b), t), a), "DODGE": _dodge, "BURN": _burn,
    "SOFT_LIGHT": lambda a, b, t: (1 - t) * a + t * ((1 - a) * b * a + a * (1 - (1 - b) * (1 - a))),
    "LINEAR_LIGHT": lambda a, b, t: a + t * (2 * b - 1),
    "HUE": _in_hsv(lambda a, b, t: (_join(b[..., :1], a[..., 1:]), True), 1),
    "SATURATION": _in_hsv(lambda a, b, t: (_join(a[..., :1], _lerp(a[..., 1:2], b[..., 1:2], t), a[..., 2:]), False), 0),
    "VALUE": _in_hsv(lambda a, b, t: (_join(a[..., :2], _lerp(a[..., 2:], b[..., 2:], t)), False), None),
    "COLOR": _in_hsv(lambda a, b, t: (_join(b[..., :2], a[..., 2:]), True), 1)}


def smoothstep(a):
    """3 a^2 - 2 a^3 of a within [0, 1]."""
    a = numpy.clip(a, 0, 1)
    return a * a * (3 - 2 * a)


def smootherstep(a):
    """6 a^5 - 15 a^4 + 10 a^3 of a within [0, 1]."""
    a = numpy.clip(a, 0, 1)
    return a ** 3 * (a * (a * 6 - 15) + 10)


def map_range(interpolation, value, from_min, from_max, to_min, to_max, steps):
    """The Map Range node, without its clamping."""
    place = _divide(value - from_min, from_max - from_min)
    if interpolation == "STEPPED":
        place = _divide(numpy.floor(place * (steps + 1)), steps)
    elif interpolation == "SMOOTHSTEP":
        place = smoothstep(place)
    elif interpolation == "SMOOTHERSTEP":
        place = smootherstep(place)
    return numpy.where(from_max != from_min, to_min + place * (to_max - to_min), 0.0)


def within(value, least, most):
    """Clamped, with ends in any order."""
    return numpy.minimum(numpy.maximum(value, numpy.minimum(least, most)), numpy.maximum(least, most))


def looked_up(table, place, interpolates=True):
    """table: (n, channels) over [0, 1]; place: (..., 1), clamped. Between entries it is linear, as in Cycles."""
    at = numpy.clip(place[..., 0], 0, 1) * (len(table) - 1)
    first = numpy.minimum(at.astype(int), len(table) - 1)
    value = table[first]
    if not interpolates:
        return value
    return value + (table[numpy.minimum(first + 1, len(table) - 1)] - value) * (at - first)[..., None]


def hue_saturation(colour, hue, saturation, value, factor):
    """The Hue/Saturation/Value node."""
    hsv = to_hsv(colour)
    moved = _join(*numpy.broadcast_arrays((hsv[..., :1] + hue + 0.5) % 1, numpy.clip(hsv[..., 1:2] * saturation, 0, 1),
                                          hsv[..., 2:] * value))
    return numpy.maximum(_lerp(colour, from_hsv(moved), factor), 0)
