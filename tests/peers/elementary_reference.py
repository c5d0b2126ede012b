#!/usr/bin/env python3
"""Elementary functions at 34 digits, against which the accuracy table's own arithmetic is tested.

    python3 tests/peers/elementary_reference.py > tests/data/elementary.csv

Needs mpmath. Arguments are doubles, printed exactly (17 digits); values are given as a double and what it lacks, so that
108 bits of them can be read without arithmetic.
"""

import random

from mpmath import mp, mpf

mp.dps = 60
RANDOM = random.Random(2026)


def arguments(low, high, special=()):
    spread = [low + (high - low) * RANDOM.random() for _ in range(12)]
    return [float(x) for x in (*special, *spread)]


def logarithmic(low, high, special=()):
    spread = [low * (high / low) ** RANDOM.random() for _ in range(12)]
    return [float(x) for x in (*special, *spread)]


UNARY = [
    ("sqrt", mp.sqrt, logarithmic(1e-30, 1e30, (2.0, 1.0))),
    ("cbrt", mp.cbrt, logarithmic(1e-30, 1e30, (2.0, 27.0))),
    ("exp", mp.exp, arguments(-300, 300, (1.0, 1e-10, -1.0))),
    ("exp_m1", mp.expm1, arguments(-3, 3, (1e-20, -1e-8, 0.39999, 0.40001))),
    ("ln", mp.log, logarithmic(1e-30, 1e30, (1.0000000001, 0.9, 1.1, 2.0)) + arguments(0.8, 1.2)),
    ("sin", mp.sin, arguments(-100, 100, (1.0, 1e-10, 3.141592653589793, 1e6))),
    ("cos", mp.cos, arguments(-100, 100, (1.0, 1e-10, 1.5707963267948966, 1e6))),
    ("tan", mp.tan, arguments(-100, 100, (1.0, 1e-10, 1.5707963267948966))),
    ("asin", mp.asin, arguments(-1, 1, (1.0, 1e-10, 0.9999999999999999))),
    ("acos", mp.acos, arguments(-1, 1, (-1.0, 1e-10, 0.9999999999999999))),
    ("atan", mp.atan, arguments(-10, 10, (1.0, 1e-10, 1e10))),
]
BINARY = [
    ("atan2", mp.atan2, [(1.0, -1.0), (1e-10, -1.0), (-1e-10, -1.0), (1.0, 1e-20)]),
    ("hypot", mp.hypot, [(3.0, 4.0), (1e-10, 1.0), (1e200, 2e200), (1e-200, 1e-200)]),
    ("powf", mp.power, [(2.0, 0.5), (0.001, 2.4), (1e3, -4.7), (1.0000001, 1e3)]),
]


def row(name, x, y, value):
    high = float(value)
    low = float(value - mpf(high))
    print(f"{name},{x!r},{y!r},{high!r},{low!r}")


print("# Values of elementary functions by mpmath, as doubles and what these lack; see tests/peers/elementary_reference.py.")
print("function,x,y,high,low")
for name, function, points in UNARY:
    for x in points:
        row(name, x, 0.0, function(mpf(x)))
for name, function, special in BINARY:
    for x, y in special + [(10 * RANDOM.random(), 10 * RANDOM.random()) for _ in range(8)]:
        row(name, x, y, function(mpf(x), mpf(y)))
