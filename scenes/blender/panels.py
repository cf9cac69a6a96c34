# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels, in the places where Cycles has its own, and the preferences of the extension."""

import bpy
from bpy.props import StringProperty

from . import engine, program

ENGINE = engine.PenumbraRenderEngine.bl_idname
# Blender's panels of every engine, without those that Penumbra has itself or does not need.
NOT_ADOPTED = {"DATA_PT_light", "VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes"}
# EEVEE's panels of what the export reads.
ADOPTED = {"DATA_PT_EEVEE_light", "EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface",
           "EEVEE_MATERIAL_PT_volume", "EEVEE_MATERIAL_PT_displacement", "EEVEE_WORLD_PT_surface",
           "EEVEE_WORLD_PT_volume"}


class PenumbraPreferences(bpy.types.AddonPreferences):
    """Of the user, for all files."""

    bl_idname = __package__

    program: StringProperty(name="Program", description="The program penumbra. Empty: the environment's PENUMBRA, or "
                            "the one in PATH", subtype="FILE_PATH")

    def draw(self, context):
        self.layout.prop(self, "program")
        self.layout.operator("penumbra.check_program")


class PENUMBRA_OT_check_program(bpy.types.Operator):
    bl_idname = "penumbra.check_program"
    bl_label = "Check"
    bl_description = "Find the program, and run it"

    def execute(self, context):
        try:
            path = program.find_program()
            version = program.version_of(path)
        except program.ProgramError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{path} is Penumbra {version}")
        return {"FINISHED"}


class _Panel:
    """A panel in the properties editor that is there for this engine alone."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        self.draw_settings(self.layout, context)


class PENUMBRA_RENDER_PT_sampling(_Panel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw_settings(self, layout, context):
        layout.prop(context.scene.penumbra, "integrator")


class PENUMBRA_RENDER_PT_sampling_viewport(_Panel, bpy.types.Panel):
    bl_label = "Viewport"
    bl_parent_id = "PENUMBRA_RENDER_PT_sampling"

    def draw_settings(self, layout, context):
        layout.prop(context.scene.penumbra, "preview_samples")


class PENUMBRA_RENDER_PT_sampling_render(_Panel, bpy.types.Panel):
    bl_label = "Render"
    bl_parent_id = "PENUMBRA_RENDER_PT_sampling"

    def draw_settings(self, layout, context):
        settings = context.scene.penumbra
        row = layout.row(heading="Noise Threshold", align=True)
        row.prop(settings, "use_target_error", text="")
        value = row.row()
        value.active = settings.use_target_error
        value.prop(settings, "target_error", text="")
        layout.prop(settings, "samples")
        layout.prop(settings, "time_budget")


class PENUMBRA_RENDER_PT_denoise(_Panel, bpy.types.Panel):
    bl_label = "Denoise"
    bl_parent_id = "PENUMBRA_RENDER_PT_sampling"

    def draw_settings(self, layout, context):
        layout.prop(context.scene.penumbra, "denoise")


class PENUMBRA_RENDER_PT_sampling_advanced(_Panel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_parent_id = "PENUMBRA_RENDER_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_settings(self, layout, context):
        row = layout.row(align=True)
        row.prop(context.scene.penumbra, "seed")
        row.prop(context.scene.penumbra, "animate_seed", text="", icon="TIME")


class PENUMBRA_RENDER_PT_light_paths(_Panel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_settings(self, layout, context):
        layout.prop(context.scene.penumbra, "max_bounces")


class PENUMBRA_RENDER_PT_film(_Panel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_settings(self, layout, context):
        layout.prop(context.scene.penumbra, "filter_width")
        layout.prop(context.scene.render, "film_transparent", text="Transparent")


class PENUMBRA_RENDER_PT_motion_blur(_Panel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw_settings(self, layout, context):
        layout.active = context.scene.render.use_motion_blur
        layout.prop(context.scene.render, "motion_blur_position")
        layout.prop(context.scene.render, "motion_blur_shutter")


class PENUMBRA_RENDER_PT_performance(_Panel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_settings(self, layout, context):
        for name in ("backend", "workers", "threads", "texture_size"):
            layout.prop(context.scene.penumbra, name)


class PENUMBRA_UL_shots(bpy.types.UIList):
    """The user's shots on the farm."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        row = layout.split(factor=0.6)
        row.label(text=f"{item.number}  {item.name}")
        row.label(text=f"{item.state}  {item.done * 100:.0f} %" if item.state == "rendering" else item.state)


class PENUMBRA_RENDER_PT_farm(_Panel, bpy.types.Panel):
    bl_label = "Farm"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_settings(self, layout, context):
        settings, farm = context.scene.penumbra, context.window_manager.penumbra_farm
        for name in ("farm_address", "farm_keys", "farm_name", "farm_priority"):
            layout.prop(settings, name)
        row = layout.row(align=True)
        row.operator("penumbra.send_to_farm", text="Send Animation").animation = True
        row.operator("penumbra.send_to_farm", text="Send Frame").animation = False
        layout.template_list("PENUMBRA_UL_shots", "", farm, "shots", farm, "active", rows=3)
        row = layout.row(align=True)
        row.operator("penumbra.farm_refresh", icon="FILE_REFRESH")
        row.operator("penumbra.farm_cancel")
        row.operator("penumbra.farm_fetch")
        if farm.active < len(farm.shots):
            layout.label(text=farm.shots[farm.active].text)
        if farm.problem:
            layout.label(text=farm.problem, icon="ERROR")


class PENUMBRA_VIEWLAYER_PT_passes(_Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw_settings(self, layout, context):
        layer = context.view_layer
        column = layout.column(heading="Data")
        for name, text in (("z", "Z"), ("position", "Position"), ("normal", "Normal"), ("vector", "Vector"),
                           ("uv", "UV")):
            column.prop(layer, f"use_pass_{name}", text=text)
        column = layout.column(heading="Light")
        column.prop(layer.penumbra, "use_pass_light")
        column = layout.column(heading="Denoising Data")
        column.prop(layer.penumbra, "use_pass_albedo", text="Albedo and Normal")
        column.prop(layer.penumbra, "use_pass_variance")
        column.prop(layer.penumbra, "use_pass_samples")


class PENUMBRA_VIEWLAYER_PT_cryptomatte(_Panel, bpy.types.Panel):
    bl_label = "Cryptomatte"
    bl_context = "view_layer"
    bl_parent_id = "PENUMBRA_VIEWLAYER_PT_passes"

    def draw_settings(self, layout, context):
        layer = context.view_layer
        column = layout.column(heading="Include")
        column.prop(layer, "use_pass_cryptomatte_object", text="Object")
        column.prop(layer, "use_pass_cryptomatte_material", text="Material")
        layout.prop(layer, "pass_cryptomatte_depth", text="Levels")


CLASSES = [
    PenumbraPreferences, PENUMBRA_OT_check_program, PENUMBRA_RENDER_PT_sampling, PENUMBRA_RENDER_PT_sampling_viewport,
    PENUMBRA_RENDER_PT_sampling_render, PENUMBRA_RENDER_PT_denoise, PENUMBRA_RENDER_PT_sampling_advanced,
    PENUMBRA_RENDER_PT_light_paths, PENUMBRA_RENDER_PT_film, PENUMBRA_RENDER_PT_motion_blur,
    PENUMBRA_RENDER_PT_performance, PENUMBRA_UL_shots, PENUMBRA_RENDER_PT_farm, PENUMBRA_VIEWLAYER_PT_passes,
    PENUMBRA_VIEWLAYER_PT_cryptomatte,
]


def adopted_panels():
    """Blender's panels that Penumbra shows too."""
    def is_meant(panel):
        is_of_all = "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ())
        return panel.__name__ in ADOPTED or (
            is_of_all and panel.__name__ not in NOT_ADOPTED and not panel.__module__.endswith("freestyle"))

    return [panel for panel in bpy.types.Panel.__subclasses__() if is_meant(panel)]


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for panel in adopted_panels():  # a set of its own each, since panels may share theirs with others
        panel.COMPAT_ENGINES = panel.COMPAT_ENGINES | {ENGINE}


def unregister():
    for panel in adopted_panels():
        panel.COMPAT_ENGINES = panel.COMPAT_ENGINES - {ENGINE}
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
