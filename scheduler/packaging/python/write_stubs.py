"""Writes options.json and the stubs to a folder, for the build of the wheel."""

import pathlib
import sys

from penumbra.signatures import write_all

write_all(pathlib.Path(sys.argv[1]))
