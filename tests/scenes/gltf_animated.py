"""Writes animated.glb and prints gltf_animated.inc: the poses that Blender 5.0 itself computes, for gltf_poses_test.cpp.

    python3 tests/scenes/gltf_animated.py > tests/scenes/gltf_animated.inc    # with the package bpy
"""
import contextlib
import math
import pathlib
import sys

import bpy
import numpy as np

RATE = 24
FRAMES = (0, 6, 12, 17, 24)
DIRECTIONS = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1],
                       [1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
UP_IS_Y = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], dtype=float)  # glTF's axes from Blender's


def keys(owner, path, *values):
    for frame, value in values:
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)


def carried_cube():
    """Turns below a parent that moves, and that stretches until it mirrors."""
    bpy.ops.object.empty_add()
    carrier = bpy.context.object
    keys(carrier, "location", (0, (0, 0, 0)), (12, (1, 0.5, 2)), (24, (0, 2, 1)))
    keys(carrier, "scale", (0, (1, 1, 1)), (24, (-1.5, 0.5, 2)))
    bpy.ops.mesh.primitive_cube_add(size=1)
    cube = bpy.context.object
    cube.parent, cube.location = carrier, (1, 0, 0.3)
    keys(cube, "rotation_euler", (0, (0, 0, 0)), (24, (1, 2, 3)))
    return cube


def morphing_sheet():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3, size=2, location=(0, -3, 0))
    sheet = bpy.context.object
    sheet.shape_key_add(name="Basis")
    wave, twist = sheet.shape_key_add(name="wave"), sheet.shape_key_add(name="twist")
    for point in wave.data:
        point.co.z += 0.5 * math.sin(2 * point.co.x)
    for point in twist.data:
        x, y = point.co.x, point.co.y
        point.co.x += 0.3 * y
        point.co.z -= 0.2 * x * y
    keys(wave, "value", (0, 0.0), (12, 1.0), (24, 0.25))
    keys(twist, "value", (0, 0.2), (24, 1.0))
    return sheet


def skinned_arm():
    """Three bones, of which the lowest grows, below an object that scales as well."""
    bpy.ops.object.armature_add(location=(3, 0, 0))
    rig = bpy.context.object
    rig.scale, rig.rotation_euler = (1.5, 1.5, 1.5), (0.2, 0.1, 0.4)
    bpy.ops.object.mode_set(mode="EDIT")
    bones = rig.data.edit_bones
    low = bones[0]
    low.name, low.head, low.tail = "low", (0, 0, 0), (0, 0, 1)
    for name, parent, tail in (("middle", "low", (0, 0, 2)), ("high", "middle", (0, 0.2, 3))):
        bone = bones.new(name)
        bone.parent = bones[parent]
        bone.head, bone.tail = bone.parent.tail, tail
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.mesh.primitive_cylinder_add(vertices=6, radius=0.3, depth=3, location=(0, 0, 1.5))
    arm = bpy.context.object
    bpy.ops.object.transform_apply(location=True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=2)
    bpy.ops.object.mode_set(mode="OBJECT")
    groups = [arm.vertex_groups.new(name=name) for name in ("low", "middle", "high")]
    for vertex in arm.data.vertices:
        shares = [max(0.05, 1 - abs(vertex.co.z - middle)) for middle in (0.5, 1.5, 2.5)]
        for group, share in zip(groups, shares):
            group.add([vertex.index], share / sum(shares), "REPLACE")
    arm.parent = rig
    arm.modifiers.new("rig", "ARMATURE").object = rig
    pose = rig.pose.bones
    for bone in pose:
        bone.rotation_mode = "XYZ"
    keys(pose["low"], "scale", (0, (1, 1, 1)), (24, (1.3, 1.3, 1.3)))
    keys(pose["middle"], "rotation_euler", (0, (0, 0, 0)), (12, (0.8, 0, 0)), (24, (0, 0.5, 0.9)))
    keys(pose["high"], "rotation_euler", (0, (0, 0, 0)), (24, (1.2, 0.3, 0)))
    return arm


def camera():
    bpy.ops.object.camera_add(location=(0, -10, 3), rotation=(1.3, 0, 0))
    result = bpy.context.scene.camera = bpy.context.object
    keys(result, "location", (0, (0, -10, 3)), (24, (4, -8, 3)))
    keys(result, "rotation_euler", (0, (1.3, 0, 0)), (24, (1.2, 0, 0.5)))
    keys(result.data, "lens", (0, 50.0), (24, 80.0))
    return result


def light():
    bpy.ops.object.light_add(type="SPOT", location=(0, 0, 6))
    result = bpy.context.object
    keys(result, "location", (0, (0, 0, 6)), (24, (2, 1, 5)))
    keys(result, "rotation_euler", (0, (0, 0, 0)), (24, (0.5, 0.2, 0)))
    return result


def positions(thing, graph):
    shown = thing.evaluated_get(graph)
    points = np.array([list(v.co) + [1] for v in shown.to_mesh().vertices], dtype=float)
    return points @ np.array(shown.matrix_world, dtype=float).T[:, :3] @ UP_IS_Y.T


def row(*numbers):
    print("{" + ", ".join(f"{n:.9g}" for n in numbers) + "},")


bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps, scene.frame_start, scene.frame_end = RATE, FRAMES[0], FRAMES[-1]
meshes = {"cube": carried_cube(), "sheet": morphing_sheet(), "arm": skinned_arm()}
for name, thing in meshes.items():
    thing.name = name
eye, lamp = camera(), light()
with contextlib.redirect_stdout(sys.stderr):
    bpy.ops.export_scene.gltf(
        filepath=str(pathlib.Path(__file__).parent / "animated.glb"), export_format="GLB",
        export_animation_mode="SCENE", export_anim_scene_split_object=False, export_cameras=True,
        export_lights=True, export_pointer_animation=True, export_texcoords=False, export_materials="NONE",
        export_optimize_animation_size=False)

print("// Written by gltf_animated.py: what Blender 5.0 shows. Axes are those of glTF.")
print("// Frame; how far the mesh reaches along each of kDirections.")
print("constexpr double kDirections[10][3] = {")
for direction in DIRECTIONS:
    row(*direction)
print("};\nstruct Reach { const char* mesh; int frame; double reach[10]; };\nconstexpr Reach kReaches[] = {")
places = []
for frame in FRAMES:
    scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    for name, thing in meshes.items():
        reach = (positions(thing, graph) @ DIRECTIONS.T).max(0)
        print(f'{{"{name}", {frame}, {{' + ", ".join(f"{r:.9g}" for r in reach) + "}},")
    # The film is wider than high, so the camera's angle is that of its width.
    aspect = scene.render.resolution_y / scene.render.resolution_x
    fov = np.degrees(2 * np.arctan(np.tan(eye.data.angle_x / 2) * aspect))
    view, beam = (UP_IS_Y @ np.array(thing.evaluated_get(graph).matrix_world, dtype=float)[:3]
                  for thing in (eye, lamp))
    places.append((frame, fov, *view[:, 3], *-view[:, 2], *view[:, 1], *beam[:, 3], *-beam[:, 2]))
print("};\n// Frame; the camera's angle along y, place, view and upper direction; the spot's place and direction.")
print("constexpr double kViews[][17] = {")
for place in places:
    row(*place)
print("};")
