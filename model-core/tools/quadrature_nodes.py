# /// script
# requires-python = ">=3.10"
# dependencies = ["mpmath==1.3.0"]
# ///
"""Writes model-core/src/dhrf/nodes.rs: Gauss-Legendre and Gauss-Hermite rules, from their definition, in 40 digits.

    uv run model-core/tools/quadrature_nodes.py > model-core/src/dhrf/nodes.rs

(or: pip install mpmath==1.3.0, then python with the same arguments.)

Every rule is symmetric: only the nodes >= 0 are written, the smallest first; the central node of an odd order is an
exact 0. Orders follow each other from 1, so that order n starts at entry floor(n^2 / 4).
"""
import mpmath as mp

mp.mp.dps = 40
LEGENDRE_ORDERS = 64
HERMITE_ORDERS = 16


def legendre(n):
    """Zeros of P_n and weights 2 / ((1 - x^2) P_n'(x)^2), by Newton's method."""
    rule = []
    for k in range(n // 2 + 1, n + 1):
        x = -mp.cos(mp.pi * (k - mp.mpf(1) / 4) / (n + mp.mpf(1) / 2))
        if 2 * k == n + 1:
            x = mp.mpf(0)
        for _ in range(60):
            p0, p1 = mp.mpf(1), x
            for j in range(2, n + 1):
                p0, p1 = p1, ((2 * j - 1) * x * p1 - (j - 1) * p0) / j
            slope = n * (x * p1 - p0) / (x * x - 1)
            step = p1 / slope
            x = x - step
            if abs(step) < mp.mpf(10) ** -36:
                break
        if 2 * k == n + 1:
            x = mp.mpf(0)
        rule.append((x, 2 / ((1 - x * x) * slope**2)))
    return rule


def hermite(n):
    """Zeros of H_n and weights for exp(-x^2): Golub and Welsch's eigenvalue problem, in 40 digits."""
    j = mp.zeros(n)
    for i in range(1, n):
        j[i - 1, i] = j[i, i - 1] = mp.sqrt(mp.mpf(i) / 2)
    values, vectors = mp.eigsy(j)
    rule = []
    for k in range(n):
        x = values[k]
        if abs(x) < mp.mpf(10) ** -30:
            x = mp.mpf(0)
        if x >= 0:
            rule.append((x, mp.sqrt(mp.pi) * vectors[0, k] ** 2))
    return sorted(rule)


def check(rule, n, moments):
    """A rule of n points integrates every power below 2n."""
    for power in range(0, 2 * n, 2):
        total = sum((1 if x == 0 else 2) * w * x**power for x, w in rule)
        assert abs(total / moments(power) - 1) < mp.mpf(10) ** -30, (n, power)


def write(name, weight, rules):
    nodes = [pair for rule in rules for pair in rule]
    print(f"/// {name.capitalize()} rules of the orders 1 to {len(rules)}, weight function {weight}: node and weight.")
    print("#[rustfmt::skip]")
    print(f"pub(super) static {name.upper()}: [[f64; 2]; {len(nodes)}] = [")
    for n, rule in enumerate(rules, 1):
        print(f"    // order {n}")
        for x, w in rule:
            # the shortest digits that give the same double
            print(f"    [{float(x)!r}, {float(w)!r}],")
    print("];")


legendre_rules = [legendre(n) for n in range(1, LEGENDRE_ORDERS + 1)]
hermite_rules = [hermite(n) for n in range(1, HERMITE_ORDERS + 1)]
for n, rule in enumerate(legendre_rules, 1):
    check(rule, n, lambda p: mp.mpf(2) / (p + 1))
for n, rule in enumerate(hermite_rules, 1):
    check(rule, n, lambda p: mp.gamma(mp.mpf(p + 1) / 2))
print("//! Nodes and weights of the one-dimensional rules. Written by `tools/quadrature_nodes.py`; do not edit.")
print("//!")
print("//! Symmetric rules: only the nodes ≥ 0. Order n starts at entry ⌊n²/4⌋ and has ⌈n/2⌉ entries.")
print("//! Read while compiling only (`table.rs`): the statics themselves are not linked.")
print()
print("// √½ is a node of the second Hermite rule")
print("#![allow(clippy::approx_constant)]")
print()
write("legendre", "1 on [−1, 1]", legendre_rules)
print()
# the walk multiplies every node by the Gaussian itself
scaled_rules = [[(x, w * mp.exp(x * x)) for x, w in rule] for rule in hermite_rules]
write("hermite", "exp(−x²), by which the weights are divided", scaled_rules)
