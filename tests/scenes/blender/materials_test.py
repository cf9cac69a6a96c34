"""Folded node maths against Cycles' own; what a bake leaves as it was; what the report names."""

import itertools
import pathlib
import sys
import tempfile
import unittest
from xml.etree import ElementTree

import bpy
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scenes"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from blender.export.context import Context  # noqa: E402
from blender.export.materials import bake, export_material, maths  # noqa: E402
from blender.export.materials.dependencies import Dependencies  # noqa: E402
from blender.export.materials.nodes import Input  # noqa: E402
from blender.export.materials.reading import Reading  # noqa: E402
from material_scenes import add_node, add_shape, link, material  # noqa: E402

SIZE = 16
ROUNDING = 2e-4  # of values about 1 in Cycles' single precision, with its table of 256 entries


def random_image(seed, low=0.0, high=1.0):
    """A float image without filtering: some texels have equal channels, 0 or 1."""
    # Cycles keeps images as half numbers.
    values = numpy.random.default_rng(seed).uniform(low, high, (SIZE, SIZE, 4)).astype(numpy.float16).astype(numpy.float32)
    values[0, :4, :3] = numpy.array([0, 1, 0.5, 0.25])[:, None]
    values[..., 3] = 1
    image = bpy.data.images.new(f"random {seed}", SIZE, SIZE, float_buffer=True, is_data=True)
    image.pixels.foreach_set(values.ravel())
    image.pack()
    return image


class Materials(unittest.TestCase):

    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def context(self):
        return Context(self.folder.name, bpy.context.evaluated_depsgraph_get(), texture_size=SIZE)

    def plane(self, made):
        return add_shape(bpy.ops.mesh.primitive_plane_add, made, size=2)

    def export(self, made, obj, context=None):
        context = context or self.context()
        evaluated = obj.evaluated_get(context.depsgraph)
        return export_material(evaluated.material_slots[0].material, evaluated, context), context


class FoldedMaths(Materials):
    """Nodes fed by two images, folded, and baked by Cycles over the same texels."""

    def feed(self, made, node, seeds):
        for seed, socket in zip(seeds, [socket for socket in node.inputs if socket.enabled]):
            image = add_node(made, "ShaderNodeTexImage", interpolation="Closest")
            image.image = bpy.data.images.get(f"random {seed}") or random_image(seed, *((-2, 2) if seed > 9 else (0, 1)))
            link(made, image.outputs["Color"], socket)

    def check_nodes(self, name, makers, seeds):
        """makers: {name: function(material) -> (node, output)}."""
        context, process = None, None
        for case, maker in makers.items():
            with self.subTest(f"{name} {case}"):
                made, shader, _ = material("material", "ShaderNodeEmission")
                node, output = maker(made)
                self.feed(made, node, seeds)
                link(made, output(node), shader.inputs["Color"])
                obj = self.plane(made)
                context = context or self.context()
                context.depsgraph = bpy.context.evaluated_depsgraph_get()
                evaluated = obj.evaluated_get(context.depsgraph)
                slot = evaluated.material_slots[0].material
                reading = Reading(slot, evaluated, context)
                shader = slot.node_tree.get_output_node("CYCLES").inputs["Surface"].links[0].from_node
                at = Input(shader.inputs["Color"])
                folded = reading.values.fold(at).data
                needed = Dependencies(evaluated.data)
                needed.add(at)
                baked = reading.bakes.over_uvs(at, needed, "UVMap", signed=True).data
                self.assertEqual(baked.shape, (SIZE, SIZE, 3))
                scale = numpy.maximum(1, numpy.abs(baked))
                error = numpy.abs(numpy.broadcast_to(folded, baked.shape) - baked) / scale
                # At steps rounding decides.
                self.assertLess(numpy.quantile(error, 0.98), ROUNDING, f"greatest error {error.max()}")

    def simple(self, bl_idname, output=0, **properties):
        def maker(made):
            node = add_node(made, bl_idname, **properties)
            return node, lambda each: ([socket for socket in each.outputs if socket.enabled] or list(each.outputs))[output]
        return maker

    def test_math(self):
        self.check_nodes("Math", {name: self.simple("ShaderNodeMath", operation=name) for name in maths.MATH}, (11, 12, 1))

    def test_vector_math(self):
        self.check_nodes("Vector Math", {name: self.simple("ShaderNodeVectorMath", operation=name)
                                         for name in maths.VECTOR_MATH}, (11, 12, 1, 2))

    def test_mix(self):
        makers = {f"{name} {clamps}": self.simple("ShaderNodeMix", data_type="RGBA", blend_type=name, clamp_result=clamps)
                  for name, clamps in itertools.product(maths.MIX, (False,))}
        makers["MIX clamped"] = self.simple("ShaderNodeMix", data_type="RGBA", blend_type="ADD", clamp_result=True)
        makers["numbers"] = self.simple("ShaderNodeMix", data_type="FLOAT")
        makers["vectors"] = self.simple("ShaderNodeMix", data_type="VECTOR", factor_mode="NON_UNIFORM")
        makers["of before 3.4"] = self.simple("ShaderNodeMixRGB", blend_type="MULTIPLY")
        self.check_nodes("Mix", makers, (1, 2, 3))

    def test_ranges(self):
        makers = {f"{kind} {clamps}": self.simple("ShaderNodeMapRange", interpolation_type=kind, clamp=clamps)
                  for kind in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP") for clamps in (True, False)}
        self.check_nodes("Map Range", makers, (11,))
        self.check_nodes("Clamp", {kind: self.simple("ShaderNodeClamp", clamp_type=kind) for kind in ("MINMAX", "RANGE")},
                         (11, 12, 1))

    def test_colours(self):
        makers = {name: self.simple(f"ShaderNode{name}") for name in ("Gamma", "BrightContrast", "RGBToBW", "CombineXYZ")}
        for mode in ("RGB", "HSV", "HSL"):
            makers[f"combine {mode}"] = self.simple("ShaderNodeCombineColor", mode=mode)
            for channel in range(3):
                makers[f"separate {mode} {channel}"] = self.simple("ShaderNodeSeparateColor", channel, mode=mode)
        self.check_nodes("colour", makers, (1, 2, 3))
        self.check_nodes("hue", {"node": self.simple("ShaderNodeHueSaturation")}, (1, 2, 3, 4, 5))
        self.check_nodes("invert", {"node": self.simple("ShaderNodeInvert")}, (1, 2))

    def test_ramps_and_curves(self):
        def ramp(kind):
            def maker(made):
                node = add_node(made, "ShaderNodeValToRGB")
                node.color_ramp.interpolation = kind
                node.color_ramp.elements.new(0.3).color = (0.9, 0.2, 0.4, 0.5)
                return node, lambda each: each.outputs["Color"]
            return maker

        def curve(bl_idname, extend):
            def maker(made):
                node = add_node(made, bl_idname)
                for number, each in enumerate(node.mapping.curves):
                    each.points.new(0.4, 0.2 + 0.15 * number)
                node.mapping.extend = extend
                node.mapping.update()
                return node, lambda each: each.outputs[0]
            return maker

        self.check_nodes("ramp", {kind: ramp(kind) for kind in ("LINEAR", "EASE", "CONSTANT", "B_SPLINE")}, (1,))
        self.check_nodes("curves", {f"{name} {extend}": curve(name, extend) for extend in ("HORIZONTAL", "EXTRAPOLATED")
                                    for name in ("ShaderNodeRGBCurve", "ShaderNodeVectorCurve", "ShaderNodeFloatCurve")},
                         (1, 11))


class Exports(Materials):

    def test_default(self):
        surface = export_material(None, None, self.context())
        self.assertEqual(surface.bsdf.find(".//rgb").get("value"), "0.8, 0.8, 0.8")

    def test_groups_and_muted_nodes(self):
        """A colour through a reroute, a muted node and nested groups."""
        inner = bpy.data.node_groups.new("inner", "ShaderNodeTree")
        for way in ("INPUT", "OUTPUT"):
            inner.interface.new_socket("Color", in_out=way, socket_type="NodeSocketColor")
        start, end = inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")
        invert = inner.nodes.new("ShaderNodeInvert")
        muted = inner.nodes.new("ShaderNodeInvert")
        muted.mute = True
        inner.links.new(start.outputs[0], muted.inputs["Color"])
        inner.links.new(muted.outputs[0], invert.inputs["Color"])
        inner.links.new(invert.outputs[0], end.inputs[0])
        made, shader, _ = material("material", "ShaderNodeBsdfDiffuse")
        group = add_node(made, "ShaderNodeGroup", node_tree=inner)
        reroute = add_node(made, "NodeReroute")
        group.inputs[0].default_value = (0.1, 0.2, 0.75, 1)
        link(made, group.outputs[0], reroute.inputs[0])
        link(made, reroute.outputs[0], shader.inputs["Color"])
        surface, context = self.export(made, self.plane(made))
        colour = [float(x) for x in surface.bsdf.find(".//rgb").get("value").split(",")]
        numpy.testing.assert_allclose(colour, [0.9, 0.8, 0.25], atol=1e-6)
        self.assertEqual(context.report.lines, [])

    def noise_plane(self):
        made, shader, _ = material("material", "ShaderNodeBsdfDiffuse")
        link(made, add_node(made, "ShaderNodeTexNoise").outputs["Color"], shader.inputs["Color"])
        return made, self.plane(made)

    def test_bake_changes_nothing_and_is_kept(self):
        made, obj = self.noise_plane()
        other = add_shape(bpy.ops.mesh.primitive_cube_add, made, size=1)
        bpy.context.scene.render.engine = "BLENDER_WORKBENCH"

        def state():
            return (bpy.context.active_object, list(bpy.context.selected_objects), bpy.context.scene.render.engine,
                    [[each.name for each in getattr(bpy.data, kind)]
                     for kind in ("meshes", "objects", "images", "materials")],
                    [node.name for node in made.node_tree.nodes], [uv.name for uv in obj.data.uv_layers])

        before = state()
        first, _ = self.export(made, obj)
        self.assertEqual(state(), before)
        self.assertEqual(before[0], other)
        self.assertEqual(first.uvs.shape, (4, 2))
        run, jobs = bake.Process.run, []
        bake.Process.run = lambda self, job: jobs.append(job) or run(self, job)
        try:
            again, _ = self.export(made, obj)
            self.assertEqual(jobs, [])
            made.node_tree.nodes["Noise Texture"].inputs["Scale"].default_value = 9
            changed, _ = self.export(made, obj)
            self.assertEqual(len(jobs), 1)
        finally:
            bake.Process.run = run
        texts = [ElementTree.tostring(surface.bsdf) for surface in (first, again, changed)]
        self.assertEqual(texts[0], texts[1])
        self.assertNotEqual(texts[0], texts[2])

    def test_normals_of_coats(self):
        """Which layers the maps of base, coat and displacement bend."""
        def maps(normal, coat, weight=1.0, displaced=False):
            made, shader, output = material("paint", None, {"Coat Weight": weight})
            feeds = {}
            for name, wanted in (("normal", normal), ("coat", coat)):
                if wanted and wanted not in feeds:
                    node, image = add_node(made, "ShaderNodeNormalMap"), add_node(made, "ShaderNodeTexImage")
                    image.image = random_image(len(feeds) + 50)
                    link(made, image.outputs["Color"], node.inputs["Color"])
                    feeds[wanted] = node.outputs[0]
                if wanted:
                    link(made, feeds[wanted], shader.inputs["Normal" if name == "normal" else "Coat Normal"])
            if displaced:
                image, node = add_node(made, "ShaderNodeTexImage"), add_node(made, "ShaderNodeDisplacement")
                image.image = random_image(60)
                link(made, image.outputs["Color"], node.inputs["Height"])
                link(made, node.outputs[0], output.inputs["Displacement"])
            surface, context = self.export(made, self.plane(made))
            self.assertNotIn("coat", "\n".join(context.report.lines))
            found = []
            for element in surface.bsdf.iter("bsdf"):
                layers = element.find("string[@name='layers']")
                if element.get("type") in {"normalmap", "bumpmap"}:
                    found.append((element.get("type"), "all" if layers is None else layers.get("value")))
            return found

        self.assertEqual(maps("a", None), [("normalmap", "base")])
        self.assertEqual(maps("a", None, weight=0.0), [("normalmap", "all")])
        self.assertEqual(maps(None, "a"), [("normalmap", "coat")])
        self.assertEqual(maps("a", "b"), [("normalmap", "coat"), ("normalmap", "base")])
        self.assertEqual(maps("a", "a"), [("normalmap", "all")])
        self.assertEqual(maps(None, None, displaced=True), [("bumpmap", "all")])
        self.assertEqual(maps("a", None, displaced=True), [("bumpmap", "coat"), ("normalmap", "base")])
        self.assertEqual(maps(None, "a", displaced=True), [("normalmap", "coat"), ("bumpmap", "base")])

    def test_report_names_object_material_and_node(self):
        made, shader, output = material("paint", "ShaderNodeBsdfDiffuse")
        mixer, path = add_node(made, "ShaderNodeMixShader"), add_node(made, "ShaderNodeLightPath")
        link(made, path.outputs["Is Camera Ray"], mixer.inputs["Fac"])
        link(made, add_node(made, "ShaderNodeBsdfToon").outputs[0], mixer.inputs[1])
        link(made, shader.outputs[0], mixer.inputs[2])
        link(made, mixer.outputs[0], output.inputs["Surface"])
        _, context = self.export(made, self.plane(made))
        text = "\n".join(context.report.lines)
        self.assertIn('object "Plane", material "paint", node "Light Path"', text)
        self.assertIn('node "Toon BSDF": shader \'Toon BSDF\' is not exported', text)

    def test_unread_blender(self):
        """Where the other Blender does not start, the value of the socket counts, and the report says so."""
        made, obj = self.noise_plane()
        run = bake.Process.run

        def fail(self, job):
            raise bake.BakeError("it does not start")

        bake.Process.run = fail
        try:
            surface, context = self.export(made, obj)
        finally:
            bake.Process.run = run
        self.assertIsNotNone(surface.bsdf)
        self.assertIn("it does not start", "\n".join(context.report.lines))


if __name__ == "__main__":
    unittest.main()
