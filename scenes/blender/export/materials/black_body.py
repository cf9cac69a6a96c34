# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of black bodies, as Cycles has it in volumes."""

import numpy

# Chebyshev coefficients over 1 / T, of the colour by Planck's law with the observer of CIE 1931 (2 degrees, CIE 015),
# in linear Rec. 709 and of luminance 1: within 0.01.
_COOLEST, _HOTTEST = 800.0, 12000.0  # kelvins; colours beyond are those
_COLOURS = ((3.17085, 2.36271, -0.076, -0.06737, 0.01866, -0.00499, 0.00189, -0.0008),
            (0.42733, -0.63887, -0.01826, 0.03873, -0.01193, 0.00292, -0.00065, 5e-05),
            (0.279, -0.63029, 0.40476, -0.18519, 0.06326, -0.01424, 0.00084, 0.00185))
_STEFAN_BOLTZMANN = 5.670374e-8  # W / (m² K⁴)


def black_body_colour(kelvins):
    """Colours of luminance 1 for temperatures (…, 1): (…, 3). What Rec. 709 lacks is cut off."""
    inverse = 1 / numpy.clip(kelvins[..., 0], _COOLEST, _HOTTEST)
    first, last = 1 / _HOTTEST, 1 / _COOLEST
    at = (inverse - first) / (last - first) * 2 - 1
    return numpy.maximum(numpy.stack([numpy.polynomial.chebyshev.chebval(at, c) for c in _COLOURS], axis=-1), 0)


def black_body_emission(kelvins, intensity):
    """Radiance per unit of length that the Principled Volume of Cycles emits: a millionth of the radiance of a black
    body by the law of Stefan and Boltzmann at intensity 1, and of 1 K at 0. kelvins, intensity: (…, 1)."""
    mixed = 1 + (numpy.maximum(kelvins, 0) ** 4 - 1) * intensity
    return _STEFAN_BOLTZMANN * 1e-6 / numpy.pi * mixed * black_body_colour(kelvins)
