# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes whose values are computed from those of their inputs."""


import numpy

from . import maths
from .fields import LUMINANCE, NotFolded, combine, constant
from .nodes import Input
from .values import folds

_TABLE = 256  # entries of Cycles' tables of colour ramps and curves


def _stack(*channels):
    return numpy.concatenate(numpy.broadcast_arrays(*channels), axis=-1)


def _inputs(values, source):
    """The fields of the node's active inputs, in order."""
    return [values.fold(Input(socket, source.groups)) for socket in source.node.inputs if socket.enabled]


def _clamped(function, is_clamped):
    return (lambda *data: numpy.clip(function(*data), 0, 1)) if is_clamped else function


@folds("ShaderNodeValue", "ShaderNodeRGB")
def own_output(values, source):
    value = source.node.outputs[0].default_value
    return constant(value if isinstance(value, float) else list(value)[:3])


@folds("ShaderNodeMath")
def math(values, source):
    node = source.node
    function = maths.MATH.get(node.operation)
    if function is None:
        raise NotFolded(node, f"operation {node.operation}")
    fields = _inputs(values, source)
    zeros = (0.0,) * (3 - len(fields))
    return combine(_clamped(lambda *data: function(*data, *zeros), node.use_clamp), *fields, node=node)


@folds("ShaderNodeVectorMath")
def vector_math(values, source):
    node = source.node
    function = maths.VECTOR_MATH.get(node.operation)
    if function is None:
        raise NotFolded(node, f"operation {node.operation}")
    fields = [values.fold(Input(socket, source.groups)) for socket in node.inputs]
    result = combine(function, *fields, node=node)
    is_number = node.operation in maths.VECTOR_NUMBERS
    return result if is_number == (source.socket.type == "VALUE") else constant(0.0 if not is_number else [0.0] * 3)


@folds("ShaderNodeMix")
def mix(values, source):
    node = source.node
    if node.data_type == "ROTATION":
        raise NotFolded(node, "it mixes rotations")
    factor, first, second = _inputs(values, source)
    function = maths.MIX[node.blend_type if node.data_type == "RGBA" else "MIX"]

    def mixed(t, a, b):
        result = function(a, b, numpy.clip(t, 0, 1) if node.clamp_factor else t)
        return numpy.clip(result, 0, 1) if node.data_type == "RGBA" and node.clamp_result else result

    return combine(mixed, factor, first, second, node=node)


@folds("ShaderNodeMixRGB")
def mix_of_before_3_4(values, source):
    node = source.node
    function = maths.MIX[node.blend_type]
    return combine(_clamped(lambda t, a, b: function(a, b, numpy.clip(t, 0, 1)), node.use_clamp),
                   *_inputs(values, source), node=node)


@folds("ShaderNodeValToRGB")
def colour_ramp(values, source):
    ramp = source.node.color_ramp
    table = numpy.array([ramp.evaluate(i / (_TABLE - 1)) for i in range(_TABLE)])
    table = table[:, 3:] if source.socket.identifier == "Alpha" else table[:, :3]
    return combine(lambda place: maths.looked_up(table, place, ramp.interpolation != "CONSTANT"),
                   values.input(source, "Fac"), node=source.node)


def _curve_table(mapping, curves):
    """The curves, one after another, as a table over [least, most], and these two."""
    mapping.initialize()
    ends = [point.location[0] for curve in mapping.curves for point in (curve.points[0], curve.points[-1])]
    least, most = min(ends), max(ends)
    at = least + numpy.arange(_TABLE) / (_TABLE - 1) * (most - least)
    for curve in curves:
        at = numpy.array([mapping.evaluate(curve, x) for x in at])
    return at[:, None], least, most


def _through_curves(mapping, curves, value):
    """Each channel through its list of curves, as Cycles does: linear between entries and, where the mapping says so,
    beyond the ends."""
    channels = []
    for index, each in enumerate(curves):
        table, least, most = _curve_table(mapping, each)
        place = (value[..., index:index + 1] - least) / max(most - least, 1e-20)
        result = maths.looked_up(table, place)
        if mapping.extend == "EXTRAPOLATED":
            steps = _TABLE - 1
            result = numpy.where(place < 0, table[0] + place * (table[1] - table[0]) * steps, result)
            result = numpy.where(place > 1, table[-1] + (place - 1) * (table[-1] - table[-2]) * steps, result)
        channels.append(result)
    return _stack(*channels)


@folds("ShaderNodeRGBCurve", "ShaderNodeVectorCurve", "ShaderNodeFloatCurve")
def curves(values, source):
    mapping = source.node.mapping
    each = mapping.curves
    lists = {"ShaderNodeRGBCurve": lambda: [(each[3], each[i]) for i in range(3)],
             "ShaderNodeVectorCurve": lambda: [(each[i],) for i in range(3)],
             "ShaderNodeFloatCurve": lambda: [(each[0],)]}[source.node.bl_idname]()
    return combine(lambda t, value: value + (_through_curves(mapping, lists, value) - value) * t,
                   *_inputs(values, source), node=source.node)


@folds("ShaderNodeMapRange")
def map_range(values, source):
    node = source.node
    fields = _inputs(values, source)
    steps = fields.pop() if node.interpolation_type == "STEPPED" else constant(4.0)

    def mapped(value, from_min, from_max, to_min, to_max, steps):
        result = maths.map_range(node.interpolation_type, value, from_min, from_max, to_min, to_max, steps)
        clamps = node.clamp and node.interpolation_type in {"LINEAR", "STEPPED"}
        return maths.within(result, to_min, to_max) if clamps else result

    return combine(mapped, *fields, steps, node=node)


@folds("ShaderNodeClamp")
def clamp(values, source):
    is_range = source.node.clamp_type == "RANGE"
    return combine(lambda value, low, high: maths.within(value, low, high) if is_range
                   else numpy.minimum(numpy.maximum(value, low), high), *_inputs(values, source), node=source.node)


@folds("ShaderNodeGamma")
def gamma(values, source):
    return combine(lambda colour, power: numpy.where(colour > 0, numpy.power(numpy.where(colour > 0, colour, 1), power),
                                                     colour), *_inputs(values, source), node=source.node)


@folds("ShaderNodeInvert")
def invert(values, source):
    return combine(lambda t, colour: colour + (1 - 2 * colour) * t, *_inputs(values, source), node=source.node)


@folds("ShaderNodeHueSaturation")
def hue_saturation(values, source):
    names = ["Color", "Hue", "Saturation", "Value", "Fac"]
    return combine(maths.hue_saturation, *(values.input(source, name) for name in names), node=source.node)


@folds("ShaderNodeBrightContrast")
def bright_contrast(values, source):
    return combine(lambda colour, bright, contrast: numpy.maximum(colour * (1 + contrast) + bright - contrast / 2, 0),
                   *_inputs(values, source), node=source.node)


@folds("ShaderNodeRGBToBW")
def luminance(values, source):
    return combine(lambda colour: (colour @ LUMINANCE)[..., None], *_inputs(values, source), node=source.node)


@folds("ShaderNodeCombineColor", "ShaderNodeCombineXYZ", "ShaderNodeCombineRGB", "ShaderNodeCombineHSV")
def joined(values, source):
    mode = _mode(source.node)
    change = {"HSV": maths.from_hsv, "HSL": maths.from_hsl}.get(mode, lambda channels: channels)
    return combine(lambda *channels: change(_stack(*channels)), *_inputs(values, source), node=source.node)


@folds("ShaderNodeSeparateColor", "ShaderNodeSeparateXYZ", "ShaderNodeSeparateRGB", "ShaderNodeSeparateHSV")
def separated(values, source):
    mode = _mode(source.node)
    change = {"HSV": maths.to_hsv, "HSL": maths.to_hsl}.get(mode, lambda channels: channels)
    channel = list(source.node.outputs).index(source.socket)
    result = combine(lambda colour: change(colour)[..., channel:channel + 1], *_inputs(values, source), node=source.node)
    return result


def _mode(node):
    return "HSV" if node.bl_idname.endswith("HSV") else getattr(node, "mode", "RGB")
