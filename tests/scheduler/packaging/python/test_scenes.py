"""Scenes from dicts: the same images as those of files, and errors for arrays that cannot be rendered."""

import numpy
import penumbra
import pytest

SQUARE = numpy.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
FACES = numpy.array([[0, 1, 2], [0, 2, 3]])


def square(**shape):
    return {"type": "ply", "vertices": SQUARE, "faces": FACES, **shape}


def scene(**entries):
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 3},
        "sensor": {
            "type": "perspective",
            "fov": 40.0,
            "to_world": penumbra.look_at((0, 0, 4), (0, 0, 0)),
            "film": {"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": 64},
        },
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}},
        **entries,
    }


def cornell_dict(size=32):
    """scenes/cornell-small."""
    t, s, r, transform = penumbra.translate, penumbra.scale, penumbra.rotate, penumbra.transform
    x, y = (1, 0, 0), (0, 1, 0)
    colours = {
        "white": [0.725, 0.71, 0.68],
        "red": [0.63, 0.065, 0.05],
        "green": [0.14, 0.45, 0.091],
        "black": [0, 0, 0],
    }
    shapes = [
        ("floor", "rectangle", [r(x, -90)], "white"),
        ("ceiling", "rectangle", [r(x, 90), t(0, 2, 0)], "white"),
        ("back-wall", "rectangle", [t(0, 1, -1)], "white"),
        ("left-wall", "rectangle", [r(y, 90), t(-1, 1, 0)], "red"),
        ("right-wall", "rectangle", [r(y, -90), t(1, 1, 0)], "green"),
        ("short-block", "cube", [s(0.3), r(y, -17), t(0.33, 0.3, 0.37)], "white"),
        ("tall-block", "cube", [s(0.3, 0.6, 0.3), r(y, 19), t(-0.335, 0.6, -0.29)], "white"),
        ("light", "rectangle", [s(0.235, 0.19, 1), r(x, 90), t(0, 1.98, 0)], "black"),
    ]
    result = {
        "type": "scene",
        "integrator": {"type": "path"},
        "sensor": {
            "type": "perspective",
            "fov": 19.5,
            "to_world": penumbra.look_at((0, 1, 6.8), (0, 1, 0)),
            "sampler": {"type": "sobol", "sample_count": 16},
            "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
        },
    }
    for name, colour in colours.items():
        result[name] = {"type": "diffuse", "reflectance": {"type": "rgb", "value": colour}}
    for name, kind, steps, bsdf in shapes:
        result[name] = {"type": kind, "to_world": transform(*steps), "bsdf": {"type": "ref", "id": bsdf}}
    result["light"]["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": [17, 12, 4]}}
    return result


def test_a_dict_renders_as_its_file(cornell):
    """Up to the rounding of matrices: a sample in a thousand may hit another surface. The standard error of the
    difference of two independent images would be over 5 % of the mean."""
    ours = penumbra.render(cornell_dict()).image
    truth = penumbra.render(cornell, defines={"resolution": 32}, spp=16).image
    assert (abs(ours - truth) < 1e-4 + 1e-3 * truth).mean() > 0.99
    assert abs(ours.mean() / truth.mean() - 1) < 0.002


def mitsuba_variant(name):
    """Raises ImportError where Mitsuba 3, or what the variant needs, is missing."""
    import mitsuba

    mitsuba.set_variant(name)
    return mitsuba


def for_mitsuba(mitsuba, described):
    """The same dict with Mitsuba's matrices and a sampler that it has."""
    theirs = {key: dict(value) if isinstance(value, dict) else value for key, value in described.items()}
    for value in theirs.values():
        if isinstance(value, dict) and "to_world" in value:
            value["to_world"] = mitsuba.ScalarTransform4f(value["to_world"])
    theirs["sensor"]["sampler"] = {"type": "independent"}
    return theirs


def test_a_dict_renders_as_in_mitsuba():
    """Student's t of each of 768 values: 16 images of Mitsuba's against one of ours, whose variance is known better.
    The limit is exceeded with a chance of 1e-5 each."""
    try:
        mitsuba = mitsuba_variant("scalar_rgb")
    except ImportError as missing:
        pytest.skip(f"Mitsuba 3 is not installed: {missing}")
    described = cornell_dict(16)
    theirs = for_mitsuba(mitsuba, described)
    images = numpy.array([mitsuba.render(mitsuba.load_dict(theirs), spp=128, seed=seed) for seed in range(16)])
    ours = penumbra.render(described, spp=1024, sampler="independent", seed=1)
    error = numpy.sqrt(images.var(axis=0, ddof=1) / len(images) + ours.variance)
    t_of_15 = 6.5  # two-sided, 15 degrees of freedom
    assert (abs(images.mean(axis=0) - ours.image) <= t_of_15 * error + 1e-5).all()


def test_meshes_and_textures_are_arrays():
    """Under a white sky a diffuse square has the radiance of its texture."""
    texture = numpy.zeros((2, 2, 3), numpy.float32)
    texture[1, :] = [0.25, 0.5, 0.75]  # the first row is at v = 0, here below
    lit = square(
        texcoords=SQUARE[:, :2] / 2 + 0.5,
        normals=numpy.tile([0, 0, 1], (4, 1)),
        bsdf={
            "type": "diffuse",
            "reflectance": {"type": "bitmap", "data": texture, "raw": True, "filter_type": "nearest"},
        },
    )
    result = penumbra.render(scene(square=lit))
    assert abs(result.layers["albedo"][6, 8] - [0.25, 0.5, 0.75]).max() < 1e-6 and result.image[10, 8].max() == 0
    assert (abs(result.image[6, 8] - [0.25, 0.5, 0.75]) < 5 * numpy.sqrt(result.variance[6, 8])).all()
    eight_bit = numpy.array([[[188, 188, 188]]], numpy.uint8)
    lit["bsdf"] = {"type": "diffuse", "reflectance": {"type": "bitmap", "data": eight_bit}}
    linear = ((188 / 255 + 0.055) / 1.055) ** 2.4
    assert abs(penumbra.render(scene(square=lit)).layers["albedo"][8, 8] - linear).max() < 1e-5


def test_a_volume_is_an_array():
    """Beer's law through a cube of width 2 of constant extinction."""
    medium = {
        "type": "heterogeneous",
        "albedo": {"type": "rgb", "value": 0.0},
        "sigma_t": {
            "type": "gridvolume",
            "data": numpy.full((2, 2, 2), 0.5),
            "filter_type": "nearest",
            "to_world": penumbra.transform(penumbra.scale(2), penumbra.translate(-1, -1, -1)),
        },
    }
    cube = {"type": "cube", "bsdf": {"type": "null"}, "interior": medium}
    result = penumbra.render(scene(integrator={"type": "volpath"}, cube=cube), spp=4096, crop=(7, 7, 9, 9))
    error = 5 * numpy.sqrt(result.variance.max() / 4)  # of the mean of four pixels; nearly parallel to the axis
    assert abs(result.image.mean() - numpy.exp(-1)) < error + 0.005


@pytest.mark.parametrize(
    "entry, message",
    [
        (square(vertices=SQUARE * [1, numpy.nan, 1]), r"vertices\[0, 1\] is nan"),
        (square(vertices=SQUARE[:, :2]), r"vertices has the shape \(4, 2\)"),
        (square(vertices=[["a"]]), "no array of numbers"),
        (square(faces=FACES.astype(float)), "faces are integers"),
        (square(faces=FACES + 2), "numbers from 2 to 5 of 4 vertices"),
        (square(faces=FACES[:0]), "faces are integers"),
        (square(normals=SQUARE[:2]), r"normals has the shape \(2, 3\), not \(4, 3\)"),
        ({"type": "ply", "vertices": SQUARE}, "vertices and faces"),
        (square(to_world=numpy.full((4, 4), numpy.inf)), "not finite"),
        (square(to_world=numpy.eye(3)), r"shape \(3, 3\)"),
        (square(bsdf={"type": "diffuse", "reflectance": {"type": "rgb", "value": [1, 2]}}), "2 values"),
        (square(bsdf={"reflectance": 1.0}), "without 'type'"),
        (
            square(bsdf={"type": "diffuse", "reflectance": {"type": "bitmap", "data": numpy.zeros(3)}}),
            "a bitmap has the shape",
        ),
        ({"type": "sphere", "radius": float("nan")}, "radius"),
        ({"type": "spere"}, "spere"),
    ],
)
def test_bad_arrays_are_errors(entry, message):
    with pytest.raises(penumbra.PenumbraError, match=message):
        penumbra.render(scene(entry=entry), spp=1)


def test_dicts_are_scenes_everywhere(tmp_path):
    shapes = [scene(entry=square()), scene(entry=square(vertices=SQUARE * 0.5))]
    assert [result.image.shape for result in penumbra.render_all(shapes, spp=1)] == [(16, 16, 3)] * 2
    assert penumbra.info(shapes[0])["triangles"] == 2
    for expected in ("done", "unchanged"):
        rows = penumbra.sweep(shapes[0], {"spp": [1, 2]}, out=tmp_path)
        assert list(rows["state"] if hasattr(rows, "columns") else [row["state"] for row in rows]) == [expected] * 2
    with penumbra.Session() as session:
        assert session.render(shapes[1], spp=1).image.shape == (16, 16, 3)
