#!/usr/bin/env python3
"""Whole renders beside Mitsuba 3 and Cycles: who has less error for the same processor time?

Each program renders the same scene, camera, light and path lengths with several seeds, in turns. The scatter of the seeds is the mean squared error of one
picture (relative to the square of the picture's mean, since programs may differ by a percent in brightness), and

    efficiency = 1 / (processor seconds x MSE)

does not depend on the number of samples, and little on other work of the machine. Loading, building and compiling are left out: what a picture of one
sample takes is subtracted. The three material models are not the same to the last digit; the pictures are kept in --out to be looked at.

    python3 -m venv venv && venv/bin/pip install mitsuba bpy pillow numpy
    npm install @gltf-transform/core @gltf-transform/extensions meshoptimizer
    node bench/peers/plain_gltf.mjs hotel-room/scene.glb hotel.glb
    venv/bin/python bench/peers/renders.py --kajo target/release/kajo --scene cornell
    venv/bin/python bench/peers/renders.py --kajo target/release/kajo --scene helmet --gltf FlightHelmet.gltf --env sky.hdr
    venv/bin/python bench/peers/renders.py --kajo target/release/kajo --scene hotel --gltf hotel.glb

Mitsuba's `llvm_ad_rgb` needs a libLLVM (DRJIT_LIBLLVM_PATH). Each program runs in processes of its own.
"""

import argparse
import base64
import json
import os
import pathlib
import resource
import subprocess
import sys
import time

import numpy as np

BOUNCES = 7
THREADS = 2
# Eye, target, vertical field of view in degrees; `scale` takes the file to metres; `lamp` is a square of light that shines down.
SCENES = {
    "cornell": dict(size=(256, 256), spp=64),
    "helmet": dict(size=(256, 256), spp=32, eye=(0.35, 0.45, 0.95), target=(0.0, 0.36, 0.0), fov=38.0, scale=1.0),
    "hotel": dict(size=(320, 180), spp=64, eye=(9.2, 1.3, -10.6), target=(10.6, 0.8, -6.0), fov=60.0, scale=0.001,
                  lamp=dict(centre=(10.0, 1.95, -8.0), side=1.2, radiance=12.0)),
}


class Kajo:
    """`kajo render` on the built-in box or on a scene file written here."""

    def __init__(self, args, scene):
        self.args, self.scene, self.file = args, scene, args.out / "kajo.exr"
        self.reference = "builtin:cornell"
        if args.scene != "cornell":
            self.reference = args.out / "scene.kajo.toml"
            self.reference.write_text(self.scene_file())
        self.picture(0, 1)

    def scene_file(self):
        scene, args = self.scene, self.args
        tables = [f'[[asset]]\nfile = "{args.gltf.resolve()}"\nscale = {scene["scale"]}']
        tables += [f'[environment]\nfile = "{args.env.resolve()}"'] if args.env else []
        tables += [f'[[camera]]\nposition = {list(scene["eye"])}\ntarget = {list(scene["target"])}\nyfov_deg = {scene["fov"]}']
        if lamp := scene.get("lamp"):
            # A mesh and not a [[light]], whose back lets light through.
            (args.out / "lamp.gltf").write_text(json.dumps(lamp_gltf(lamp["side"] / 2, lamp["radiance"])))
            tables += [f'[[asset]]\nfile = "lamp.gltf"\ntranslate = {list(lamp["centre"])}']
        return "\n".join(tables) + "\n"

    def picture(self, seed, spp):
        import mitsuba as mi

        width, height = self.scene["size"]
        words = [self.args.kajo, "render", self.reference, "-o", self.file, "--size", f"{width}x{height}", "--spp", spp, "--seed", seed, "--quiet"]
        words += ["--filter", "box", "--max-depth", BOUNCES, "--threads", THREADS, *self.args.kajo_arguments.split()]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([str(word) for word in words], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        if mi.variant() is None:
            mi.set_variant("scalar_rgb")
        return rgb(mi.Bitmap(str(self.file))), seconds


def lamp_gltf(half, radiance):
    """A square that shines down, as a document."""
    corners = np.array([(-half, 0, -half), (half, 0, -half), (half, 0, half), (-half, 0, half)], "<f4")
    data = corners.tobytes() + np.array([0, 1, 2, 0, 2, 3], "<u4").tobytes()
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "emissiveFactor": [1, 1, 1],
                       "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": radiance}}}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-half, 0, -half], "max": [half, 0, half]},
                      {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"}],
    }


class Mitsuba:
    """Its own Cornell box, or the glTF file as meshes with its `principled` material."""

    def __init__(self, args, scene):
        import mitsuba as mi

        mi.set_variant(args.mitsuba_variant)
        self.mi = mi
        width, height = scene["size"]
        if args.scene == "cornell":
            world = mi.cornell_box()
        else:
            world = {"type": "scene", "sensor": {"type": "perspective", "fov": scene["fov"], "fov_axis": "y", "film": {"type": "hdrfilm"},
                     "to_world": mi.ScalarTransform4f().look_at(list(scene["eye"]), list(scene["target"]), [0, 1, 0])}}
            self.add_meshes(world, args, scene)
        world["integrator"] = {"type": "path", "max_depth": BOUNCES + 1, "rr_depth": args.mitsuba_rr}
        world["sensor"]["film"].update(width=width, height=height, rfilter={"type": "box"}, pixel_format="rgb")
        self.scene = mi.load_dict(world)
        self.picture(0, 1)
        self.picture(0, scene["spp"])  # compile

    def add_meshes(self, world, args, scene):
        from gltf import Gltf

        mi, turn = self.mi, self.mi.ScalarTransform4f()
        if args.env:
            # Its u is 0 where Kajo's is one half.
            world["sky"] = {"type": "envmap", "filename": str(args.env), "to_world": turn.rotate([0, 1, 0], 180)}
        if lamp := scene.get("lamp"):
            place = turn.translate(list(lamp["centre"])).rotate([1, 0, 0], 90).scale(lamp["side"] / 2)
            world["lamp"] = {"type": "rectangle", "to_world": place, "emitter": {"type": "area", "radiance": {"type": "rgb", "value": lamp["radiance"]}}}
        file = Gltf(args.gltf)
        for number, (triangles, positions, normals, uv, material) in enumerate(file.primitives()):
            props = mi.Properties()
            props["bsdf"] = mi.load_dict(self.material(file, material))
            mesh = mi.Mesh(f"mesh {number}", len(positions), len(triangles), has_vertex_normals=True, has_vertex_texcoords=True, props=props)
            values = mi.traverse(mesh)
            values["vertex_positions"] = np.ravel(positions * scene["scale"]).astype("f4")
            values["vertex_normals"] = np.ravel(normals).astype("f4")
            values["vertex_texcoords"] = np.ravel(uv).astype("f4")
            values["faces"] = np.ravel(triangles).astype("u4")
            values.update()
            world[f"mesh {number}"] = mesh

    def material(self, file, material):
        mi = self.mi
        surface = material.get("pbrMetallicRoughness", {})

        def texture(pixels, raw):
            return {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(pixels)), "raw": raw}

        base, rough = file.image(surface.get("baseColorTexture")), file.image(surface.get("metallicRoughnessTexture"))
        factor = surface.get("baseColorFactor", [1, 1, 1, 1])
        color = {"type": "rgb", "value": factor[:3]} if base is None else texture(base[..., :3], False)
        bsdf = {"type": "principled", "base_color": color, "specular": 0.5,
                "roughness": surface.get("roughnessFactor", 1.0) if rough is None else texture(rough[..., 1:2], True),
                "metallic": surface.get("metallicFactor", 1.0) if rough is None else texture(rough[..., 2:3], True)}
        bumps = file.image(material.get("normalTexture"))
        if bumps is not None:
            bsdf = {"type": "normalmap", "normalmap": texture(bumps[..., :3], True), "bsdf": bsdf}
        bsdf = {"type": "twosided", "bsdf": bsdf}
        if material.get("alphaMode") == "BLEND" and base is not None:
            bsdf = {"type": "mask", "opacity": texture(base[..., 3:4], True), "bsdf": bsdf}
        return bsdf

    def picture(self, seed, spp):
        start = time.process_time()
        picture = self.mi.render(self.scene, spp=spp, seed=seed + 1).numpy()
        return picture.astype(float), time.process_time() - start


class Cycles:
    """Blender's path tracer with its defaults, but without denoising, adaptive sampling and clamps."""

    def __init__(self, args, scene):
        import bpy

        self.bpy, self.file = bpy, args.out / "cycles.exr"
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.blender = blender = bpy.context.scene
        blender.world = bpy.data.worlds.new("world")
        blender.world.use_nodes = True
        blender.world.node_tree.nodes["Background"].inputs[0].default_value = (0, 0, 0, 1)
        if args.scene == "cornell":
            self.cornell()
            self.camera((0, 0, 3.9), (0, 0, 0), 39.3077, scene["size"])
        else:
            bpy.ops.import_scene.gltf(filepath=str(args.gltf))
            roots = [thing for thing in bpy.data.objects if thing.parent is None]
            for root in roots:
                root.scale = [scene["scale"] * s for s in root.scale]
                root.location = [scene["scale"] * x for x in root.location]
            self.camera(scene["eye"], scene["target"], scene["fov"], scene["size"])
            if args.env:
                self.sky(args.env)
            if lamp := scene.get("lamp"):
                half, (x, y, z) = lamp["side"] / 2, lamp["centre"]
                self.quad([(x - half, y, z - half), (x + half, y, z - half), (x + half, y, z + half), (x - half, y, z + half)], self.emission(lamp["radiance"]))
        cycles, render = blender.cycles, blender.render
        render.engine, cycles.device = "CYCLES", "CPU"
        cycles.use_adaptive_sampling = cycles.use_denoising = False
        cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = BOUNCES
        cycles.transparent_max_bounces = 32
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
        cycles.pixel_filter_type, cycles.use_auto_tile = "BOX", False
        render.threads_mode, render.threads = "FIXED", THREADS
        render.resolution_x, render.resolution_y = scene["size"]
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        render.filepath = str(self.file)
        self.picture(0, 1)

    def place(self, point):
        """glTF's axes (y up) to Blender's (z up)."""
        return (point[0], -point[2], point[1])

    def camera(self, eye, target, fov, size):
        from mathutils import Vector

        camera = self.bpy.data.cameras.new("camera")
        camera.sensor_fit, camera.angle = "VERTICAL", np.radians(fov)
        thing = self.bpy.data.objects.new("camera", camera)
        thing.location = self.place(eye)
        thing.rotation_euler = (Vector(self.place(target)) - Vector(self.place(eye))).to_track_quat("-Z", "Y").to_euler()
        self.blender.collection.objects.link(thing)
        self.blender.camera = thing

    def sky(self, file):
        nodes, links = self.blender.world.node_tree.nodes, self.blender.world.node_tree.links
        image, mapping, place = (nodes.new(kind) for kind in ("ShaderNodeTexEnvironment", "ShaderNodeMapping", "ShaderNodeTexCoord"))
        image.image = self.bpy.data.images.load(str(file))
        mapping.inputs["Rotation"].default_value[2] = -np.pi / 2
        links.new(place.outputs["Generated"], mapping.inputs["Vector"])
        links.new(mapping.outputs["Vector"], image.inputs["Vector"])
        links.new(image.outputs["Color"], nodes["Background"].inputs["Color"])

    def material(self, kind, **inputs):
        material = self.bpy.data.materials.new(kind)
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        shader, output = nodes.new(kind), nodes.new("ShaderNodeOutputMaterial")
        for name, value in inputs.items():
            shader.inputs[name].default_value = value
        material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
        return material

    def emission(self, radiance):
        """Light from the front side alone."""
        color = np.broadcast_to(np.asarray(radiance, float), 3)
        material = self.material("ShaderNodeEmission", Color=(*(color / color.max()), 1), Strength=float(color.max()))
        nodes, links = material.node_tree.nodes, material.node_tree.links
        place, front = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeMath")
        front.operation, front.inputs[0].default_value = "SUBTRACT", 1.0
        strength = nodes.new("ShaderNodeMath")
        strength.operation, strength.inputs[0].default_value = "MULTIPLY", float(color.max())
        links.new(place.outputs["Backfacing"], front.inputs[1])
        links.new(front.outputs[0], strength.inputs[1])
        links.new(strength.outputs[0], nodes["Emission"].inputs["Strength"])
        material.cycles.emission_sampling = "FRONT"
        return material

    def quad(self, corners, material):
        mesh = self.bpy.data.meshes.new("quad")
        mesh.from_pydata([self.place(corner) for corner in corners], [], [(0, 1, 2, 3)])
        mesh.materials.append(material)
        self.blender.collection.objects.link(self.bpy.data.objects.new("quad", mesh))

    def cornell(self):
        """The quads of Mitsuba's own box."""
        import mitsuba as mi

        mi.set_variant("scalar_rgb")
        world, side = mi.cornell_box(), [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
        faces = [np.roll(np.array(side) + (0, 0, s), shift, 1) for s in (-1, 1) for shift in range(3)]
        for thing in world.values():
            if not isinstance(thing, dict) or thing.get("type") not in ("rectangle", "cube"):
                continue
            matrix = np.array(thing["to_world"].matrix, float)
            bsdf = world[thing["bsdf"]["id"]] if "bsdf" in thing else None
            if "emitter" in thing:
                material = self.emission(thing["emitter"]["radiance"]["value"])
            else:
                material = self.material("ShaderNodeBsdfDiffuse", Color=(*bsdf["reflectance"]["value"], 1))
            for corners in [np.array(side)] if thing["type"] == "rectangle" else faces:
                self.quad([tuple((matrix @ (*corner, 1))[:3]) for corner in corners], material)

    def picture(self, seed, spp):
        import mitsuba as mi

        self.blender.cycles.samples, self.blender.cycles.seed = spp, seed
        start = time.process_time()
        self.bpy.ops.render.render(write_still=True)
        seconds = time.process_time() - start
        if mi.variant() is None:
            mi.set_variant("scalar_rgb")
        return rgb(mi.Bitmap(str(self.file))), seconds


PROGRAMS = {"kajo": Kajo, "mitsuba": Mitsuba, "cycles": Cycles}


def rgb(bitmap):
    """Red, green and blue of the first layer, `height x width x 3`."""
    names, pixels = [field.name for field in bitmap.struct_()], np.array(bitmap, dtype=float)
    prefix = "" if "R" in names else next(name for name in names if name.endswith(".R"))[:-1]
    return np.stack([pixels[..., names.index(prefix + channel)] for channel in "RGB"], -1)


def worker(args, scene):
    """One program: for every seed on standard input a picture and its seconds, less those of one sample."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # Blender talks on standard output
    program = PROGRAMS[args.worker](args, scene)
    print("ready", file=out, flush=True)
    for line in sys.stdin:
        seed = int(line)
        overhead = program.picture(seed, 1)[1]
        picture, seconds = program.picture(seed, scene["spp"])
        np.save(args.out / f"{args.worker}.{seed}.npy", picture)
        print(json.dumps((seconds - overhead) * scene["spp"] / (scene["spp"] - 1)), file=out, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kajo", type=pathlib.Path, default="target/release/kajo", help="the program to test")
    parser.add_argument("--kajo-arguments", default="", help="more words for `kajo render`")
    parser.add_argument("--scene", choices=SCENES, default="cornell")
    parser.add_argument("--gltf", type=pathlib.Path, help="file of the scene, without mesh compression")
    parser.add_argument("--env", type=pathlib.Path, help="latitude-longitude environment")
    parser.add_argument("--seeds", type=int, default=4, help="pictures of each program")
    parser.add_argument("--programs", nargs="+", choices=PROGRAMS, default=list(PROGRAMS))
    parser.add_argument("--mitsuba-variant", default="llvm_ad_rgb")
    parser.add_argument("--mitsuba-rr", type=int, default=5, help="Mitsuba's rr_depth; 5 is its default")
    parser.add_argument("--out", type=pathlib.Path, default="peers-out", help="folder for pictures")
    parser.add_argument("--worker", choices=PROGRAMS, help=argparse.SUPPRESS)
    args = parser.parse_args()
    scene = SCENES[args.scene]
    args.out = args.out.resolve()
    args.out.mkdir(parents=True, exist_ok=True)
    if args.worker:
        return worker(args, scene)
    if args.scene != "cornell" and not args.gltf:
        parser.error(f"--scene {args.scene} needs --gltf")

    workers = {}
    for name in args.programs:
        command = [sys.executable, *sys.argv, "--worker", name]
        workers[name] = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        if workers[name].stdout.readline().strip() != "ready":
            sys.exit(f"{name} did not start; try: {' '.join(map(str, command))} < /dev/null")
    seconds, pictures = {name: [] for name in workers}, {name: [] for name in workers}
    for seed in range(1, args.seeds + 1):
        for name, process in workers.items():
            print(seed, file=process.stdin, flush=True)
            seconds[name].append(json.loads(process.stdout.readline()))
            pictures[name].append(np.load(args.out / f"{name}.{seed}.npy"))

    efficiency = {}
    print(f"{args.scene}, {scene['size'][0]} x {scene['size'][1]} px, {scene['spp']} spp, {BOUNCES} bounces, {args.seeds} seeds in turns")
    print(f"{'':10}{'CPU s':>9}{'mean':>10}{'MSE':>12}{'rel. MSE':>12}{'efficiency':>12}")
    for name in workers:
        stack = np.stack(pictures[name])
        mean, variance = stack.mean(), stack.var(axis=0, ddof=1)
        relative = (variance / (stack.mean(axis=0) ** 2 + 0.01)).mean()
        time_of_one = min(seconds[name])
        efficiency[name] = mean**2 / (time_of_one * variance.mean()), 1 / (time_of_one * relative)
        print(f"{name:10}{time_of_one:9.2f}{mean:10.5f}{variance.mean():12.3e}{relative:12.3e}{efficiency[name][0]:12.4g}")
    for name in workers:
        if "kajo" in workers and name != "kajo":
            by_mse, by_relative = (ours / theirs for ours, theirs in zip(efficiency["kajo"], efficiency[name]))
            print(f"efficiency, Kajo over {name}: {by_mse:.2f} by MSE, {by_relative:.2f} by relative MSE")
    for process in workers.values():
        process.stdin.close()


if __name__ == "__main__":
    main()
