"""Running a program beside Blender: its progress, its messages, and its end."""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

from blender import program


class Processes(unittest.TestCase):

    def start(self, script):
        """A program of this shell script."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name) / "penumbra"
        path.write_text("#!/bin/bash\n" + script)
        path.chmod(0o755)
        with unittest.mock.patch.dict(os.environ, PENUMBRA=str(path)):
            process = program.Process(["render"])
        self.addCleanup(process.kill)
        return process

    def test_progress_is_the_newest_line(self):
        process = self.start('echo \'{"samples_done": 1}\'; echo no JSON; echo \'{"samples_done": 2}\'; exec sleep 60')
        self.assertTrue(program.wait_until(lambda: process.progress == {"samples_done": 2}, 10))
        self.assertIsNone(process.code())

    def test_a_failure_has_its_reason(self):
        process = self.start("echo reading >&2; echo 'a.xml:3: error: no such thing' >&2; echo done >&2; exit 2")
        self.assertTrue(process.wait(10))
        self.assertEqual(process.code(), 2)
        self.assertEqual(process.failure(), "a.xml:3: error: no such thing")
        self.assertEqual(process.messages()[-1], "done")

    def test_a_stop_lets_it_write(self):
        process = self.start("trap 'echo written >&2; exit 1' INT; echo '{}'; while true; do sleep 0.05; done")
        self.assertTrue(program.wait_until(lambda: process.progress is not None and process.code() is None, 10))
        time.sleep(0.3)  # until the trap is there
        process.stop(10)
        self.assertEqual(process.code(), 1)
        self.assertEqual(process.messages(), ["written"])

    def test_what_does_not_stop_is_killed_with_its_workers(self):
        process = self.start("trap '' INT; sleep 61 & echo $! >&2; wait; sleep 62")
        self.assertTrue(program.wait_until(process.messages, 10))
        worker = int(process.messages()[0])
        began = time.monotonic()
        process.stop(0.3)
        self.assertLess(time.monotonic() - began, 5)
        self.assertEqual(process.code(), -signal.SIGKILL)
        self.assertIn("killed", process.failure())
        self.assertTrue(program.wait_until(lambda: not is_alive(worker), 5))

    def test_blender_ends_it(self):
        code = ("from blender import program\n"
                "process = program.Process(['render'])\nprint(process._process.pid)")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name) / "penumbra"
        path.write_text("#!/bin/bash\nexec sleep 63\n")
        path.chmod(0o755)
        ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True,
                             env={**os.environ, "PENUMBRA": str(path)})
        self.assertTrue(program.wait_until(lambda: not is_alive(int(ran.stdout.split()[-1])), 5))

    def test_a_blender_that_crashes_ends_it(self):
        scene = pathlib.Path(__file__).resolve().parents[3] / "scenes/cornell-small/cornell-small.xml"
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        code = ("import time\nfrom blender import program\n"
                f"process = program.Process(['render', {str(scene)!r}, '--spp', '1000000', '-o', 'a.exr'])\n"
                "print(process._process.pid, flush=True)\ntime.sleep(60)")
        crashing = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, cwd=folder.name,
                                    env={**os.environ, "PENUMBRA": os.environ["PENUMBRA_PROGRAM"]})
        self.addCleanup(crashing.stdout.close)
        self.addCleanup(crashing.wait)
        renderer = int(crashing.stdout.readline())
        time.sleep(1)
        self.assertTrue(is_alive(renderer))
        crashing.kill()
        self.assertTrue(program.wait_until(lambda: not is_alive(renderer), 20))

    def test_a_program_that_cannot_run(self):
        with self.assertRaisesRegex(program.ProgramError, "does not run"):
            folder = tempfile.TemporaryDirectory()
            self.addCleanup(folder.cleanup)
            path = pathlib.Path(folder.name) / "penumbra"
            path.write_bytes(b"\x7fELF nonsense")
            path.chmod(0o755)
            with unittest.mock.patch.dict(os.environ, PENUMBRA=str(path)):
                program.Process(["render"])


def is_alive(number):
    """Whether a process runs; one that nobody has waited for does not."""
    try:
        return pathlib.Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


if __name__ == "__main__":
    unittest.main()
