"""Renders scenes with Mitsuba 3 for differential_test, one after the other, in one process.

Standard input has a job on each line: scene file, image file, batches, samples per pixel of a batch, first seed, all
separated by tabs. The image holds the batches one below the other; one that is called x.alpha.exr, their alpha. The first
line of the answer is `ready VERSION`; then each job is answered by `done` or `failed MESSAGE`.
"""

import math
import os
import sys

import drjit as dr
import mitsuba as mi

# What Mitsuba prints must not get between the answers.
answers = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)


def answer(text):
    answers.write(" ".join(text.split()) + "\n")


mi.set_variant("llvm_ad_rgb")
dr.eval(mi.Float(1) + 1)  # an error here if there is no LLVM
dr.set_thread_count(2)  # 1 waits for ever
mi.set_log_level(mi.LogLevel.Error)


class Phong(mi.BSDF):
    """The normalised Phong model of Mitsuba 0.5, which version 3 no longer has: kd / pi + ks (n + 2) / (2 pi) cos^n."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.diffuse = props.get_texture("diffuse_reflectance", 0.5)
        self.specular = props.get_texture("specular_reflectance", 0.2)
        self.exponent = float(props.get("exponent", 30.0))
        front = mi.BSDFFlags.FrontSide
        self.m_components = [mi.BSDFFlags.GlossyReflection | front, mi.BSDFFlags.DiffuseReflection | front]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def lobe_cosine(self, si, wo):
        return dr.maximum(dr.dot(wo, mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)), 0)

    def eval(self, ctx, si, wo, active=True):
        lobe = dr.power(self.lobe_cosine(si, wo), self.exponent) * ((self.exponent + 2) / (2 * math.pi))
        value = self.diffuse.eval(si, active) / math.pi + self.specular.eval(si, active) * lobe
        cos_o = mi.Frame3f.cos_theta(wo)
        return value * cos_o & (active & (mi.Frame3f.cos_theta(si.wi) > 0) & (cos_o > 0))

    def pdf(self, ctx, si, wo, active=True):
        lobe = dr.power(self.lobe_cosine(si, wo), self.exponent) * ((self.exponent + 1) / (2 * math.pi))
        cos_o = mi.Frame3f.cos_theta(wo)
        pdf = 0.5 * (lobe + mi.warp.square_to_cosine_hemisphere_pdf(wo))
        return dr.select(active & (mi.Frame3f.cos_theta(si.wi) > 0) & (cos_o > 0), pdf, 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def sample(self, ctx, si, sample1, sample2, active=True):
        cos_lobe = dr.power(sample2.x, 1 / (self.exponent + 1))
        sin_lobe = dr.safe_sqrt(1 - cos_lobe * cos_lobe)
        phi = 2 * math.pi * sample2.y
        mirror = mi.Frame3f(mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z))
        in_lobe = mirror.to_world(mi.Vector3f(sin_lobe * dr.cos(phi), sin_lobe * dr.sin(phi), cos_lobe))
        bs = mi.BSDFSample3f()
        bs.wo = dr.select(sample1 < 0.5, in_lobe, mi.warp.square_to_cosine_hemisphere(sample2))
        bs.eta = 1
        bs.sampled_type = dr.select(sample1 < 0.5, mi.UInt32(+mi.BSDFFlags.GlossyReflection), mi.UInt32(+mi.BSDFFlags.DiffuseReflection))
        bs.sampled_component = dr.select(sample1 < 0.5, mi.UInt32(0), mi.UInt32(1))
        bs.pdf = self.pdf(ctx, si, bs.wo, active)
        active = active & (bs.pdf > 0)
        return bs, (self.eval(ctx, si, bs.wo, active) / bs.pdf) & active

    def to_string(self):
        return "Phong[]"


class Sides(mi.BSDF):
    """The BSDF inside as Penumbra understands it on a surface with vertex normals: the geometric normal says which side
    is seen, it takes over where the shading normal faces away, and what is beneath it is in shadow. Mitsuba itself goes
    by the shading normal alone, so that rims are black or show the other side, and light gets through sheets."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        (self.inner,) = [props[name] for name in props if isinstance(props[name], mi.BSDF)]
        self.m_components = [self.inner.flags(k) for k in range(self.inner.component_count())]
        self.m_flags = self.inner.flags()

    def seen(self, si):
        """The interaction in the frame that counts, that frame, and the geometric normal towards the viewer."""
        n = si.to_local(si.n)
        n = dr.select(n.z < 0, -n, n)  # a mirror image's faces are wound against its vertex normals
        front = dr.dot(n, si.wi) > 0
        faces = (si.wi.z > 0) == front
        frame = mi.Frame3f(dr.select(faces, mi.Normal3f(0, 0, 1), mi.Normal3f(n)))
        inside = mi.SurfaceInteraction3f(si)
        inside.wi = frame.to_local(si.wi)
        return inside, frame, dr.select(front, n, -n)

    def eval(self, ctx, si, wo, active=True):
        inside, frame, geometric = self.seen(si)
        return self.inner.eval(ctx, inside, frame.to_local(wo), active) & (active & (dr.dot(geometric, wo) > 0))

    def pdf(self, ctx, si, wo, active=True):
        inside, frame, geometric = self.seen(si)
        return self.inner.pdf(ctx, inside, frame.to_local(wo), active)

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def sample(self, ctx, si, sample1, sample2, active=True):
        inside, frame, geometric = self.seen(si)
        bs, weight = self.inner.sample(ctx, inside, sample1, sample2, active)
        bs.wo = frame.to_world(bs.wo)
        return bs, weight & (active & (dr.dot(geometric, bs.wo) > 0))

    def to_string(self):
        return "Sides[]"


mi.register_bsdf("phong", Phong)
mi.register_bsdf("sides", Sides)


def render(scene_file, image_file, batches, spp, seed):
    scene = mi.load_file(scene_file, optimize=False)  # it would merge what cannot be merged
    images = []
    for batch in range(int(batches)):
        image = scene.integrator().render(scene, scene.sensors()[0], seed=int(seed) + batch, spp=int(spp))
        if image_file.endswith(".alpha.exr"):
            alpha = image[:, :, 3]
            image = mi.TensorXf(alpha.array, shape=(*alpha.shape, 1))
        dr.eval(image)
        images.append(image)
    values = dr.concat([image.array for image in images])
    height, width, channels = images[0].shape
    stack = mi.TensorXf(values, shape=(height * len(images), width, channels))
    mi.Bitmap(stack).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False).write(image_file)


answer("ready " + mi.__version__)
for line in sys.stdin:
    try:
        render(*line.rstrip("\n").split("\t"))
        answer("done")
    except Exception as error:
        answer("failed " + (str(error) or repr(error)))
