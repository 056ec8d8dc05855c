"""Least-squares fits of A exp[-(t / tau)^beta], as the program makes them (libed/src/analysis.cpp)."""

import math

STEPS = 500


def _solve(matrix, right):
    """Solution of three linear equations by Gauss's elimination; None if there is none."""
    rows = [[*row, value] for row, value in zip(matrix, right)]
    for k in range(3):
        pivot = max(range(k, 3), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        if rows[k][k] == 0:
            return None
        for i in range(k + 1, 3):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k])]
    x = [0.0] * 3
    for k in (2, 1, 0):
        x[k] = (rows[k][3] - sum(rows[k][j] * x[j] for j in range(k + 1, 3))) / rows[k][k]
    return x


def _residuals(points, p):
    """Residuals and their derivatives by A, ln tau and beta."""
    residuals, derivatives = [], []
    for t, y in points:
        log_x = math.log(t) - p[1]
        power = math.exp(min(p[2] * log_x, 100))
        decay = math.exp(-power)
        residuals.append(p[0] * decay - y)
        derivatives.append((decay, p[0] * decay * power * p[2], -p[0] * decay * power * log_x))
    return residuals, derivatives


def stretched_exponential(points):
    """A, tau and beta of the fit to (t, y) by Levenberg and Marquardt; None for fewer than four points or without 0.1 < beta < 3."""
    if len(points) < 4:
        return None
    fallen = [t for t, y in points if y < points[0][1] / math.e]
    p, damping = [points[0][1], math.log(fallen[0] if fallen else points[-1][0]), 1.0], 1e-3
    residuals, derivatives = _residuals(points, p)
    error = sum(r * r for r in residuals)
    for _ in range(STEPS):
        normal = [[sum(d[i] * d[j] for d in derivatives) * (1 + damping * (i == j)) for j in range(3)] for i in range(3)]
        gradient = [-sum(d[i] * r for d, r in zip(derivatives, residuals)) for i in range(3)]
        step = _solve(normal, gradient)
        if step is None or not all(math.isfinite(s) and abs(s) < 50 for s in step):
            damping *= 10
            if damping > 1e12:
                break
            continue
        tried = [a + s for a, s in zip(p, step)]
        new_residuals, new_derivatives = _residuals(points, tried)
        new_error = sum(r * r for r in new_residuals)
        if new_error < error:
            done = error - new_error <= 1e-14 * error
            p, residuals, derivatives, error, damping = tried, new_residuals, new_derivatives, new_error, damping / 10
            if done:
                break
        elif damping > 1e12:
            break
        else:
            damping *= 10
    return (p[0], math.exp(p[1]), p[2]) if 0.1 < p[2] < 3 and p[1] < 50 else None
