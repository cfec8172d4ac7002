"""Laws to draw beside measured fields. Pure functions; the equations are those of "Examination of the microscopic
definition for granular fluidity" and of the mu(I) rheology."""
from __future__ import annotations

import numpy as np

from .arrays import Array

#: Parameters (A, B, C, D) of (3), the law of 004 for friction 0.4 in its first form.
FLUIDITY_3 = (2.0, 0.58, 1.54e-4, 0.048)
#: Parameters (mu_0, mu_inf, I_0) of mu(I).
INERTIAL = (0.12, 0.55, 0.2)


def fluidity(phi: Array, a: float, b: float, c: float, d: float) -> Array:
    """g d/δv = A - [(φ-B) + sqrt((φ-B)² + C)]/D  (A20), dimensionless."""
    x = np.asarray(phi) - b
    return a - (x + np.sqrt(x * x + c)) / d


def friction(inertial: Array, mu_0: float, mu_inf: float, inertial_0: float) -> Array:
    """μ(I) = μ₀ + (μ_∞ - μ₀)/(I₀/I + 1), dimensionless; I > 0."""
    return mu_0 + (mu_inf - mu_0) / (inertial_0 / np.asarray(inertial) + 1)


def friction_text(mu_0: float, mu_inf: float, inertial_0: float) -> str:
    """μ(I) with its parameters, for a legend."""
    return f"μ(I) = {mu_0:.3g} … {mu_inf:.3g}, I₀ = {inertial_0:.3g}"
