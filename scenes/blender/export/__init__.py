# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes Blender's evaluated scene as Mitsuba 3 XML with binary PLY, in the form that Penumbra reads."""
