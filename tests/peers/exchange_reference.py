"""Light exchanged between squares, in 50-digit arithmetic: tests/data/exchange_squares.csv.

    python exchange_reference.py > ../data/exchange_squares.csv

Closed forms of area times form factor of rectangles, by inclusion and exclusion of the corner function (J. R. Howell, "A catalog of radiation
heat transfer configuration factors", C-13 and C-15; J. R. Ehlert and T. F. Smith, "View factors for perpendicular and parallel rectangular
plates", J. Thermophys. Heat Transfer 7, 1993). Coordinates are taken as the f64 numbers that they are written as.
"""

from mpmath import atan, log, mp, mpf, pi, sqrt

mp.dps = 50


def parallel(x, y, h):
    """Kernel of rectangles in parallel planes: the double antiderivative of the exchange in both x and y."""
    u, v = sqrt(x * x + h * h), sqrt(y * y + h * h)
    value = y * u * atan(y / u) + x * v * atan(x / v) - h * h / 2 * log(x * x + y * y + h * h)
    return value / (2 * pi)


def perpendicular(x, e, y):
    """The same for perpendicular planes at distances x and e from their common line, y along it."""
    c = sqrt(x * x + e * e)
    square = x * x + e * e + y * y
    value = (y * c * atan(y / c) if c else 0) - ((c * c - y * y) * log(square) if square else 0) / 4
    return value / (2 * pi)


def exchange(kernel, a, b, c, d):
    """Σ (−1)^(i+j+k+l) kernel over the corners of [a] × [b] and [c] × [d]."""
    total = mpf(0)
    for i in range(2):
        for j in range(2):
            for k in range(2):
                for l in range(2):
                    total += (-1) ** (i + j + k + l) * kernel(i, j, k, l)
    return total


def opposite(h):
    """Unit squares above each other."""
    return exchange(lambda i, j, k, l: parallel(mpf(i) - k, mpf(j) - l, h), *range(4))


def upright(gap):
    """Unit squares in perpendicular planes, `gap` from the planes' common line each."""
    return exchange(lambda i, j, k, l: perpendicular(gap + i, gap + k, mpf(j) - l), *range(4))


def main():
    print("# Unit squares: area times form factor in 50-digit arithmetic, written by tests/peers/exchange_reference.py.")
    print("# kind, distance or gap, exchange")
    for h in ["1e-3", "3e-3", "0.01", "0.03", "0.1", "0.3", "0.7", "1", "1.5", "2", "3", "4", "5", "5.5", "6", "7", "8", "9", "10", "12", "15", "20", "30", "50", "70", "100"]:
        print(f"parallel, {h}, {mp.nstr(opposite(mpf(float(h))), 25)}")
    for gap in ["0", "1e-9", "1e-6", "1e-3", "3e-3", "0.01", "0.03", "0.1", "0.3", "1", "2", "3", "5", "7", "8", "10", "12", "20", "50", "100"]:
        print(f"perpendicular, {gap}, {mp.nstr(upright(mpf(float(gap))), 25)}")


if __name__ == "__main__":
    main()
