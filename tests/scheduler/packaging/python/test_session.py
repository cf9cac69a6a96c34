"""Many renders with the same workers: bytes, time, memory, and what happens when processes die."""

import _thread
import gc
import os
import shutil
import signal
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy
import penumbra
import pytest
from conftest import descendants
from test_render import CtrlC
from test_scenes import cornell_dict, for_mitsuba, mitsuba_variant

CORNELL = {"defines": {"resolution": 64}, "spp": 1}


@pytest.fixture
def session():
    with penumbra.Session() as session:
        yield session


def test_bytes_are_those_of_the_command_line(session, cornell, command_line, tmp_path):
    result = session.render(cornell, seed=5, denoise="nfor", settings={"integrator.max_depth": 3}, **CORNELL)
    command_line(
        "render",
        cornell,
        "-D",
        "resolution=64",
        "--spp",
        1,
        "--seed",
        5,
        "--denoise",
        "--set",
        "integrator.max_depth=3",
        "-o",
        f"{result.path.stem}.exr",
    )
    assert result.path.read_bytes() == (tmp_path / result.path.name).read_bytes()
    assert result.denoised.shape == (64, 64, 3) and result.statistics["complete"]


def seconds_of(render):
    times = []
    for seed in range(11):
        begin = time.perf_counter()
        render(seed)
        times.append(time.perf_counter() - begin)
    return times


@pytest.mark.slow
def test_times_of_small_renders_are_told(session, cornell, capsys):
    def render(seed):
        return session.render(cornell, seed=seed, settings={"integrator.max_depth": 2 + seed}, **CORNELL).image

    render(0)
    ours = seconds_of(render)
    told = [("ours", ours)]
    try:
        mitsuba = mitsuba_variant("llvm_ad_rgb")
        scene = mitsuba.load_dict(for_mitsuba(mitsuba, cornell_dict(64)))
        told.append(("mi.render", seconds_of(lambda seed: numpy.array(mitsuba.render(scene, spp=1, seed=seed)))))
    except ImportError:
        pass
    with capsys.disabled():
        print(
            "".join(
                f"\n{name}: {1000 * min(times):.0f} ms, median {1000 * statistics.median(times):.0f} ms"
                for name, times in told
            )
        )


def test_scenes_stay_until_their_files_change(session, cornell, tmp_path):
    copy = tmp_path / "scene.xml"
    text = Path(cornell).read_text()
    copy.write_text(text)
    for depth in (2, 3, 2):
        options = {**CORNELL, "settings": {"integrator.max_depth": depth}}
        assert (session.render(copy, **options).image == penumbra.render(cornell, **options).image).all()
    copy.write_text(text.replace('"fov" value="19.5"', '"fov" value="25"'))
    assert (session.render(copy, **CORNELL).image == penumbra.render(copy, **CORNELL).image).all()
    assert (session.render(copy, **CORNELL).image != penumbra.render(cornell, **CORNELL).image).any()


def test_a_dead_submitter_is_replaced(session, cornell):
    session.render(cornell, **CORNELL)
    for process in descendants(os.getpid()):
        if b"submit" in Path(f"/proc/{process}/cmdline").read_bytes():
            os.kill(process, signal.SIGKILL)
    with pytest.raises(penumbra.ProgramError, match="submit ended"):
        session.render(cornell, **CORNELL)
    assert session.render(cornell, **CORNELL).complete


def held():
    """Open files of this process; resident bytes of it and those below."""
    pages = sum(
        int(Path(f"/proc/{each}/statm").read_text().split()[1]) for each in [os.getpid(), *descendants(os.getpid())]
    )
    return (
        len(os.listdir("/proc/self/fd")),
        sum(len(os.listdir(f"/proc/{each}/fd")) for each in descendants(os.getpid())),
        pages * os.sysconf("SC_PAGE_SIZE"),
    )


@pytest.mark.slow
def test_nothing_grows(session, cornell):
    """After a hundred renders, the next two hundred take no descriptor, and one of these hundreds no more than 4 MiB:
    what is lost with each render is lost in both. A film with its layers has 0.3 MiB: one kept of each would be
    30 MiB."""
    helds = []
    for seed in range(300):
        assert session.render(cornell, seed=seed, **CORNELL).image.max() > 0
        if seed % 100 == 99:
            gc.collect()
            helds.append(held())
    before, between, after = helds
    assert after[0] <= before[0] and after[1] <= before[1]
    assert min(between[2] - before[2], after[2] - between[2]) < (4 << 20)


def test_errors_leave_it_alive(session, cornell):
    with pytest.raises(penumbra.UsageError, match="did you mean 'spp'"):
        session.render(cornell, sp=1)
    with pytest.raises(penumbra.UsageError, match="max_depth"):
        session.render(cornell, settings={"integrator.max_dept": 1})
    with pytest.raises(penumbra.PenumbraError, match="nothere"):
        session.render("nothere.xml")
    assert session.render(cornell, **CORNELL).complete


def test_ctrl_c_while_nothing_is_shown(session, cornell):
    timer = threading.Timer(1, _thread.interrupt_main)
    timer.start()
    assert session.render(cornell, spp=10**6).interrupted


def test_ctrl_c_returns_what_is_there(session, cornell):
    result = session.render(cornell, spp=10**6, progress=CtrlC())
    assert result.interrupted and not result.complete and result.image.max() > 0
    assert session.render(cornell, **CORNELL).complete


def test_progress_is_told(session, cornell):
    told = []
    session.render(cornell, defines={"resolution": 64}, spp=64, progress=told.append)
    assert told[-1]["samples_done"] == told[-1]["samples_total"] == 64 * 64 * 64


def test_a_dead_worker_is_replaced(session, cornell):
    session.render(cornell, **CORNELL)
    for process in descendants(os.getpid()):
        if b"penumbra-worker" in Path(f"/proc/{process}/cmdline").read_bytes():
            os.kill(process, signal.SIGKILL)
    assert session.render(cornell, seed=1, **CORNELL).complete


def test_a_killed_scheduler_is_an_error(cornell):
    with penumbra.Session() as session:
        job = session.submit(cornell, spp=10**6)
        os.kill(descendants(os.getpid())[0], signal.SIGKILL)
        with pytest.raises(penumbra.ProgramError, match="service ended"):
            job.fetch()
        with pytest.raises(penumbra.ProgramError):
            session.render(cornell)
    with pytest.raises(penumbra.ProgramError, match="closed"):
        session.render(cornell)


def test_missing_workers_are_an_error(tmp_path, monkeypatch):
    copy = tmp_path / "penumbra"  # without its worker beside it
    shutil.copy(penumbra.program.find(), copy)
    libraries = Path(penumbra.__file__).parents[1] / "penumbra_render.libs"  # the wheel's
    monkeypatch.setenv("LD_LIBRARY_PATH", str(libraries))
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setenv("PENUMBRA_PROGRAM", str(copy))
    with pytest.raises(penumbra.PenumbraError, match="penumbra-worker"):
        penumbra.Session()


def test_it_ends_with_python(cornell, tmp_path):
    """Also when that is killed."""
    script = (
        "import penumbra, sys, time; s = penumbra.Session(); s.render(sys.argv[1], spp=1, defines={'resolution': 8});"
        "print(s.address, flush=True); time.sleep(60)"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    process = subprocess.Popen(
        [sys.executable, "-c", script, cornell], stdout=subprocess.PIPE, text=True, env=environment
    )
    assert process.stdout.readline().startswith("unix:")
    children = descendants(process.pid)
    assert len(children) >= 2
    process.kill()
    process.wait()
    process.stdout.close()
    until = time.monotonic() + 30
    while any(os.path.exists(f"/proc/{child}") for child in children):
        assert time.monotonic() < until, "they live on"
        time.sleep(0.05)


def test_a_service_has_jobs(session, cornell):
    service = penumbra.Service(session.address)
    job = service.submit(cornell, priority=3, **CORNELL)
    result = job.fetch()
    state = service.job(job.number).state()
    assert state["state"] == "done" and state["priority"] == 3
    assert (result.image == penumbra.render(cornell, **CORNELL).image).all()
    endless = service.submit(cornell, spp=10**6)
    endless.cancel()
    with pytest.raises(penumbra.PenumbraError):
        endless.fetch()
    with pytest.raises(penumbra.ProgramError, match="nowhere"):
        penumbra.Service("unix:/nowhere/socket").status()


def test_no_file_is_kept(session, cornell):
    """Neither images nor scenes, of which each seed has its own."""
    for seed in range(3):
        session.render(cornell, seed=seed, **CORNELL)
    spool = Path(session.address.removeprefix("unix:")).parent / "spool"
    assert not any((spool / "scenes").iterdir()) and not any((spool / "jobs").iterdir())
