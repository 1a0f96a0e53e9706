"""A tool and 1,000 poses that cut a model from several sides: for the pictures like figures 9 and 10 of the paper on
three dexel grids.

usage: dexel_cuts.py INFO.json TOOL.off POSES.txt

INFO.json is what `restroke dexel info MODEL --json INFO.json` wrote. TOOL.off becomes a prism over a five-pointed star,
about its own middle; POSES.txt gets a pose a line, a 4 x 4 matrix row by row, the tool's size included.
"""
import json
import math
import sys


def star(points=5, inner=0.45, half=1.0):
    rim = [(r * math.cos(math.pi * k / points), r * math.sin(math.pi * k / points))
           for k in range(2 * points) for r in [1.0 if k % 2 == 0 else inner]]
    n = len(rim)
    vertices = [(x, y, z) for z in (-half, half) for x, y in rim] + [(0, 0, -half), (0, 0, half)]
    faces = []
    for k in range(n):
        a, b = k, (k + 1) % n
        faces += [(2 * n, b, a), (2 * n + 1, n + a, n + b), (a, b, n + b), (a, n + b, n + a)]
    return vertices, faces


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def pose(place, axis, turn, size):
    """The star's axis along `axis`, turned about it by `turn`."""
    w = unit(axis)
    u = unit(cross([0, 1, 0] if abs(w[1]) < 0.9 else [1, 0, 0], w))
    v = cross(w, u)
    c, s = math.cos(turn), math.sin(turn)
    x = [c * a + s * b for a, b in zip(u, v)]
    y = [c * b - s * a for a, b in zip(u, v)]
    rows = [[size * x[i], size * y[i], size * w[i], place[i]] for i in range(3)] + [[0, 0, 0, 1]]
    return " ".join("%.17g" % number for row in rows for number in row)


def paths(low, high):
    """Three cuts as lists of (place, axis, turn, size)."""
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    extent = [b - a for a, b in zip(low, high)]
    longest = max(extent)
    sideways = min((0, 2), key=lambda i: extent[i])  # the thinner of the two level directions
    along = 2 - sideways

    def at(a, up, s):
        place = [0, 0, 0]
        place[along], place[1], place[sideways] = (middle[along] + a * extent[along], middle[1] + up * extent[1],
                                                   middle[sideways] + s * extent[sideways])
        return place

    through = [0, 0, 0]
    through[sideways] = 1
    ahead = [0, 0, 0]
    ahead[along] = 1
    # Through the body from side to side, turning.
    drill = [(at(-0.16, -0.12, -0.8 + 1.6 * t), through, 2 * t, 0.085 * longest) for t in steps(300)]
    # A groove over the back, along a wave.
    groove = [(at(-0.6 + 1.2 * t, 0.02 - 0.03 * math.sin(9 * t), -0.05 + 0.08 * math.sin(11 * t)), ahead, 5 * t,
               0.06 * longest) for t in steps(400)]
    # Up one side, from a leg to the head.
    side = [(at(0.14 + 0.1 * math.sin(7 * t), -0.45 + 0.8 * t, -0.3 + 0.2 * t), [0, 1, 0], 3 * t, 0.06 * longest)
            for t in steps(300)]
    return drill + groove + side


def steps(n):
    return [k / (n - 1) for k in range(n)]


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        low, high = json.load(file)["bounds"]
    vertices, faces = star()
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("OFF\n%d %d 0\n" % (len(vertices), len(faces)))
        file.writelines("%.9g %.9g %.9g\n" % v for v in vertices)
        file.writelines("3 %d %d %d\n" % f for f in faces)
    with open(sys.argv[3], "w", encoding="utf-8") as file:
        file.write("# 1,000 poses: through the body, over the back, down the side\n")
        file.writelines(pose(*p) + "\n" for p in paths(low, high))


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main()
