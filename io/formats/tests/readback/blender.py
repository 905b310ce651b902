"""Blender imports the animations and the mesh; numpy has the trajectory."""
import sys
import bpy
import numpy as np

usd, glb, pc2, obj, trajectory = sys.argv[1:]
data = np.load(trajectory)
times, places = data["t"], data["x"]


def fresh():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def the_mesh(name=None):
    (found,) = [o for o in bpy.context.scene.objects if o.type == "MESH" and name in (None, o.name)]
    return found


def positions(sheet):
    evaluated = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    x = np.empty(3 * len(mesh.vertices))
    mesh.vertices.foreach_get("co", x)
    world = np.array(evaluated.matrix_world)
    return x.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]


def show(frame):
    whole = int(np.floor(frame + 1e-9))
    bpy.context.scene.frame_set(whole, subframe=min(max(frame - whole, 0.0), 0.999999))


def check(sheet, frames, name):
    for frame, x in zip(frames, places):
        show(frame)
        found = positions(sheet)
        assert found.shape == x.shape, (name, found.shape)
        assert np.allclose(found, x, atol=2e-5 * np.abs(places).max()), (name, frame, np.abs(found - x).max())


def check_bodies(frames, name):
    """A tetrahedron turns and moves, another one rests."""
    corners = np.array([[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])
    for frame, t in zip(frames, times):
        show(frame)
        turn = np.array([[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]])
        for body, x in [("obstacle_0", corners @ turn.T + [t, 0.5, 1]), ("obstacle_1", corners + [0, 0, -1])]:
            found = positions(the_mesh(body))
            assert np.allclose(found, x, atol=2e-5), (name, body, frame, found - x)


def check_uv(sheet, name):
    """The strip has the size 1 x 0.4, and a printed picture keeps its shape."""
    mesh = sheet.data
    uv = mesh.uv_layers[0].data
    for loop in mesh.loops:
        assert np.allclose(uv[loop.index].uv, places[0][loop.vertex_index][:2], atol=1e-6), name


fresh()
bpy.ops.wm.usd_import(filepath=usd)
scene = bpy.context.scene
rate = scene.render.fps / scene.render.fps_base
check(the_mesh("sheet"), times * rate, "usd")
check_bodies(times * rate, "usd")
check_uv(the_mesh("sheet"), "usd")

fresh()
bpy.ops.import_scene.gltf(filepath=glb)
scene = bpy.context.scene
rate = scene.render.fps / scene.render.fps_base
check(the_mesh("sheet"), times * rate, "glb")
check_bodies(times * rate, "glb")
check_uv(the_mesh("sheet"), "glb")

fresh()
bpy.ops.wm.obj_import(filepath=obj, forward_axis="Y", up_axis="Z")
sheet = the_mesh()
check_uv(sheet, "obj")
cache = sheet.modifiers.new("cache", "MESH_CACHE")
cache.cache_format = "PC2"
cache.filepath = pc2
cache.forward_axis = "POS_Y"
cache.up_axis = "POS_Z"
cache.frame_start = 0.0
check(sheet, np.arange(len(times)), "pc2")
