"""One render: arrays, options, errors, progress, Ctrl-C."""

import _thread
import os
import shutil
import time

import numpy
import penumbra
import pytest

SMALL = {"defines": {"resolution": 32}, "spp": 16}


def test_arrays_are_those_of_the_file(cornell, command_line, tmp_path):
    result = penumbra.render(
        cornell,
        defines={"resolution": 32},
        settings={"film.width": 48},
        spp=16,
        seed=3,
        layers=["uv", "shape"],
        cryptomatte=True,
        denoise="nfor",
        device="native",
        workers=2,
    )
    assert result.image.shape == result.variance.shape == result.denoised.shape == (32, 48, 3)
    assert result.image.dtype == numpy.float32 and result.complete and not result.interrupted
    shapes = {name: array.shape[2:] for name, array in result.layers.items()}
    assert (
        shapes["albedo"] == shapes["normal"] == (3,) and shapes["depth"] == shapes["shape"] == shapes["samples"] == ()
    )
    assert shapes["uv"] == (2,) and shapes["CryptoObject00"] == (4,)
    assert (result.layers["samples"] == 16).all()
    square = penumbra.render(cornell, defines={"resolution": 32}, spp=16)
    # The floor is below, the left wall red.
    assert abs(square.layers["normal"][30, 8] - [0, 1, 0]).max() < 1e-4
    assert abs(square.layers["albedo"][16, 1] - [0.63, 0.065, 0.05]).max() < 1e-4

    command_line(
        "render",
        cornell,
        "-D",
        "resolution=32",
        "--set",
        "film.width=48",
        "--spp",
        16,
        "--seed",
        3,
        "--layers",
        "uv,shape",
        "--cryptomatte",
        "--denoise",
        "-o",
        "a.exr",
    )
    assert result.path.read_bytes() == (tmp_path / "a.exr").read_bytes()
    assert result.files[1].read_bytes() in (
        (tmp_path / "a.png").read_bytes(),
        (tmp_path / "a-denoised.exr").read_bytes(),
    )
    assert result.statistics["samples"]["total"] == 32 * 48 * 16
    assert "--seed 3" in result.command


def test_files_are_where_they_are_asked_for(cornell, tmp_path):
    result = penumbra.render(cornell, out=tmp_path / "a.exr", **SMALL)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.exr", "a.json", "a.png"]
    again = penumbra.read(tmp_path / "a.exr")
    assert (again.image == result.image).all() and again.statistics == result.statistics
    picture = penumbra.render(cornell, out=tmp_path / "b.png", no_statistics=True, **SMALL)
    assert not (tmp_path / "b.json").exists() and not (tmp_path / "b.exr").exists()
    assert picture._repr_png_() == (tmp_path / "b.png").read_bytes()
    with pytest.raises(penumbra.UsageError, match="no layers.*b.png"):
        picture.load()


def test_temporary_files_end_with_the_result(cornell, tmp_path):
    result = penumbra.render(cornell, **SMALL)
    folder = result.path.parent
    for name in ("a.exr", "a.png", "a.npz"):
        result.save(tmp_path / name)
    assert (numpy.load(tmp_path / "a.npz")["variance"] == result.variance).all()
    assert result.png("normal", exposure=1)[:4] == b"\x89PNG"
    with pytest.raises(penumbra.UsageError, match="a.gif"):
        result.save(tmp_path / "a.gif")
    del result
    assert not folder.exists()


def test_a_crop_has_its_own_pixels(cornell):
    whole, crop = (penumbra.render(cornell, crop=crop, **SMALL).image for crop in (None, (4, 8, 20, 10)))
    assert (whole[8:10, 4:20] == crop).all()


def test_frames_scenes_and_job_files(cornell, tmp_path):
    frames = penumbra.render_all(cornell, frames=range(1, 3), seed_per_frame="frame", **SMALL)
    assert len(frames) == 2 and (frames[0].image != frames[1].image).any()
    (tmp_path / "jobs.toml").write_text(f'[[render]]\nscene = "{cornell}"\nspp = [1, 2]\nout = "{{spp}}.exr"')
    jobs = penumbra.render_all(tmp_path / "jobs.toml", defines={"resolution": 8})
    assert [job.statistics["settings"]["spp"] for job in jobs] == [1, 2] and jobs[0].image.shape == (8, 8, 3)
    (tmp_path / "bad.xml").write_text("<scene/>")
    with pytest.raises(penumbra.RenderError) as failed:
        penumbra.render_all([cornell, tmp_path / "bad.xml"], **SMALL)
    assert len(failed.value.results) == 1


def test_errors_say_where_and_what_is_right(cornell, tmp_path):
    bad = tmp_path / "bad.xml"
    bad.write_text(cornell.read_text().replace('"diffuse" id="white"', '"difuse" id="white"'))
    with pytest.raises(penumbra.SceneError) as caught:
        penumbra.render(bad)
    assert (caught.value.file, caught.value.line, caught.value.column) == (str(bad), 24, 17)
    assert caught.value.hint == "did you mean 'diffuse'?"
    for options, error in (
        ({"sp": 3}, "did you mean 'spp'"),
        ({"spp": 0}, "range from 1"),
        ({"spp": 1.5}, "no integer"),
        ({"spp": float("nan")}, "no integer"),
        ({"settings": {"integrator.max_dept": 3}}, "max_depth"),
        ({"crop": (0, 0)}, "crop"),
        ({"target_error": "x"}, "target-error"),
        ({"lenient": 3}, "lenient"),
        ({"integrator": "pth"}, "path"),
        ({"dialect": "a\0b"}, "null"),
        ({"isa": {"a": 1}}, "dict"),
        ({"device": "native", "backend": "native"}, "one or the other"),
        ({"time_budget": -1}, "above 0"),
    ):
        with pytest.raises(penumbra.UsageError, match=error):
            penumbra.render(cornell, **options)
    for scene in ("nothere.xml", "", "--help", tmp_path, "a\0b", 3, {"type": "bsdf"}):
        with pytest.raises(penumbra.PenumbraError):
            penumbra.render(scene)


def test_warnings_are_kept(cornell, tmp_path):
    odd = tmp_path / "odd.xml"
    odd.write_text(cornell.read_text().replace("<ref id", '<float name="oddity" value="3"/><ref id', 1))
    result = penumbra.render(odd, lenient=True, **SMALL)
    assert any("oddity" in str(warning) and warning.file == str(odd) for warning in result.warnings)


def test_what_was_written_elsewhere_is_told(cornell, tmp_path, monkeypatch):
    """Images whose folder is gone go to the folder of temporary files."""
    place = tmp_path / "place"
    place.mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path))

    def remove(state):
        if place.is_dir():
            shutil.rmtree(place)
            place.write_text("no folder any more")

    with pytest.raises(penumbra.RenderError, match="place") as failed:
        penumbra.render(cornell, out=place / "a.exr", progress=remove, **SMALL)
    (saved,) = tmp_path.glob("penumbra-image-*/*.exr")
    assert str(saved.parent) in str(failed.value)
    assert (penumbra.read(saved).image == penumbra.render(cornell, **SMALL).image).all()
    with pytest.raises(penumbra.PenumbraError, match="nowhere"):
        penumbra.render(cornell, out="/proc/nowhere/a.exr", **SMALL)


def test_what_failed_has_what_was_written(cornell, tmp_path):
    """Samples that overflow are an error with strict_numerics, but there is an image."""
    light = cornell.read_text().replace('value="17, 12, 4"', 'value="1e38, 1e38, 1e38"')
    (tmp_path / "bright.xml").write_text(light)
    with pytest.raises(penumbra.RenderError, match="infinite|NaN") as failed:
        penumbra.render(tmp_path / "bright.xml", strict_numerics=True, **SMALL)
    assert failed.value.result.statistics["samples"]["infinite"]["count"] > 0


def test_progress_is_told(cornell):
    told = []
    penumbra.render(cornell, progress=told.append, **SMALL)
    assert told[-1]["samples_done"] == told[-1]["samples_total"] == 32 * 32 * 16

    def fail(state):
        raise ZeroDivisionError("of the callback")

    begin = time.monotonic()
    with pytest.raises(ZeroDivisionError, match="of the callback"):
        penumbra.render(cornell, spp=10**6, progress=fail)
    assert time.monotonic() - begin < 30


class CtrlC:
    """A callback for the progress: Ctrl-C once, as soon as there are samples."""

    came = False

    def __call__(self, state):
        if state["samples_done"] > 0 and not self.came:
            self.came = True
            _thread.interrupt_main()


def test_ctrl_c_returns_what_is_there(cornell):
    result = penumbra.render(cornell, spp=10**6, progress=CtrlC())
    assert result.interrupted and not result.complete
    assert result.statistics["ended_by"] == "interrupt"
    assert 16 <= result.layers["samples"].max() < 10**6 and numpy.isfinite(result.image).all()


def test_a_time_budget_ends_it(cornell):
    result = penumbra.render(cornell, spp=10**6, time_budget=0.2)
    assert result.statistics["ended_by"] == "time_budget" and not result.complete and not result.interrupted


def test_the_program_is_needed(cornell, monkeypatch):
    monkeypatch.setenv("PENUMBRA_PROGRAM", "/nowhere/penumbra")
    with pytest.raises(penumbra.ProgramError, match="/nowhere/penumbra"):
        penumbra.render(cornell)


def test_a_killed_program_is_an_error(cornell):
    def kill(state):
        from conftest import descendants

        os.kill(descendants(os.getpid())[0], 9)

    with pytest.raises(penumbra.ProgramError, match="signal 9"):
        penumbra.render(cornell, spp=10**6, progress=kill)


def test_no_space_is_an_error(cornell, monkeypatch, tmp_path):
    """A file size limit stands for a full disk."""
    import resource

    result = penumbra.render(cornell, **SMALL)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, hard))
    try:
        with pytest.raises(penumbra.RenderError):
            penumbra.render(cornell, **SMALL)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert penumbra.render(cornell, **SMALL).path.read_bytes() == result.path.read_bytes()


def test_tools(cornell, tmp_path):
    one, two = (penumbra.render(cornell, seed=seed, denoise="layers", **SMALL) for seed in (1, 2))
    assert penumbra.info(cornell, defines={"resolution": 32})["film"]["width"] == 32
    error = penumbra.compare(one, two)
    own = numpy.mean((one.image.astype(float) - two.image) ** 2)
    assert abs(error["mse"] / own - 1) < 1e-5 and error["passed"]
    assert abs(penumbra.compare(one.image, two.path)["mse"] / own - 1) < 1e-5
    assert not penumbra.compare(one, two, fail_above={"mse": own / 2})["passed"]
    with pytest.raises(penumbra.UsageError, match="shape"):
        penumbra.compare(numpy.zeros((2, 3, 4, 5)), two)
    with pytest.raises(penumbra.PenumbraError):
        penumbra.compare(numpy.zeros((2, 3, 3)), two)
    truth = penumbra.render(cornell, defines={"resolution": 32}, spp=1024, seed=9)
    assert penumbra.compare(penumbra.denoise(one), truth)["mse"] < penumbra.compare(one, truth)["mse"]
    assert penumbra.denoise(one.image, variance=one.variance, method="nlmeans").image.shape == (32, 32, 3)
    both = penumbra.merge([one, two])
    assert (both.layers["samples"] == 32).all() and abs(both.image - (one.image + two.image) / 2).max() < 1e-4
    point = penumbra.pixel(cornell, 5, 6, seed=1, **SMALL)
    assert point["samples"] == 16 and numpy.float32(point["radiance"]).tolist() == one.image[6, 5].tolist()
    assert penumbra.estimate(cornell, **SMALL)["plan"]["samples"] == 32 * 32 * 16
