# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of `penumbra render` and `penumbra submit` for a scene's settings."""


def sampling_options(settings):
    """What the picture depends on, and its denoising."""
    return ["--spp", str(settings.samples), "--seed", str(settings.seed), *options_beside_scene(settings)]


def options_beside_scene(settings):
    """Of these, what no scene file holds."""
    options = []
    if settings.time_budget > 0:
        options += ["--time-budget", f"{settings.time_budget:g}"]
    if settings.target_error > 0:
        options += ["--target-error", f"{settings.target_error:.6g}"]
    if settings.denoise != "off":
        options.append(f"--denoise={settings.denoise}")
    return options


def worker_options(settings):
    """Where it is rendered on this machine."""
    options = ["--workers", str(settings.workers), "--backend", settings.backend]
    return options + (["--threads", str(settings.threads)] if settings.threads else [])


def farm_options(settings):
    """The farm that the settings name; otherwise the environment does."""
    options = ["--to", settings.farm_address] if settings.farm_address else []
    return options + (["--keys", settings.farm_keys] if settings.farm_keys else [])
