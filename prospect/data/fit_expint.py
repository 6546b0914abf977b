"""Polynomials of src/expint.rs: Chebyshev interpolation in 60 digits, printed as Rust arrays (highest power first).

    python -m venv v && v/bin/pip install mpmath && v/bin/python fit_expint.py
"""

from mpmath import cos, exp, expint, log, mp, mpf, nstr, pi

mp.dps = 60


def interpolate(f, degree):
    """Monomial coefficients in z on [-1, 1] of the polynomial through the Chebyshev nodes."""
    m = degree + 1
    values = [f(cos(pi * (2 * k + 1) / (2 * m))) for k in range(m)]
    c = [2 * sum(values[k] * cos(j * pi * (2 * k + 1) / (2 * m)) for k in range(m)) / m for j in range(m)]
    c[0] /= 2
    before, now = [mpf(1)], [mpf(0), mpf(1)]
    out = [mpf(0)] * m
    out[0] += c[0]
    out[1] += c[1]
    for j in range(2, m):
        following = [mpf(0)] + [2 * x for x in now]
        for i, x in enumerate(before):
            following[i] -= x
        for i, x in enumerate(following):
            out[i] += c[j] * x
        before, now = now, following
    return out


def worst(f, coefficients):
    error = mpf(0)
    for k in range(200):
        z = cos(pi * (k + mpf("0.37")) / 200)
        value = mpf(0)
        for a in reversed(coefficients):
            value = value * z + a
        error = max(error, abs(value / f(z) - 1))
    return error


def show(name, comment, f, degree):
    coefficients = interpolate(f, degree)
    print(f"/// {comment}")
    print(f"/// Relative truncation error {nstr(worst(f, coefficients), 2)}.")
    print(f"const {name}: [f64; {degree + 1}] = [")
    for a in reversed(coefficients):
        print(f"    {float(a)!r},")
    print("];\n")


def tail(order, first, shift):
    def f(z):
        x = 2 * (first + shift) / (z + 1) - shift
        return exp(x) * (x + shift) * expint(order, x)

    return f


show("E1_THIN", "(E₁(x) + ln x) on 0 ≤ x ≤ 1, in z = 2x − 1.", lambda z: expint(1, (z + 1) / 2) + log((z + 1) / 2), 13)
show("E1_THICK", "eˣ (x + 2) E₁(x) on x ≥ 1, in z = 6/(x + 2) − 1.", tail(1, mpf(1), mpf(2)), 24)


def thin(z):
    x = z + 1
    return (1 - 2 * expint(3, x) - x * x * log(x)) / x


show("ABSORBED_THIN", "((1 − 2 E₃(x))/x − x ln x) on 0 ≤ x ≤ 2, in z = x − 1.", thin, 14)
show("E2_THIN", "(E₂(x) − x ln x) on 0 ≤ x ≤ 2, in z = x − 1.", lambda z: expint(2, z + 1) - (z + 1) * log(z + 1), 14)
show("E3_THICK", "eˣ (x + 3.5) E₃(x) on x ≥ 2, in z = 11/(x + 3.5) − 1.", tail(3, mpf(2), mpf("3.5")), 18)
