#!/usr/bin/env python3
"""check_mesh.py - checks a MEDIT mesh of several materials, with nothing of sinew in it.

    python3 tests/check_mesh.py FILE.mesh ...

For each file one line: "PATH: tets N, materials M, volume V, ok", or what is wrong. Exit status 0 when all are ok.

Checked are: every tet has a positive volume (exactly, where doubles cannot tell); no face has more than two tets; the
volumes of the tets add up to what the outer surface encloses, to 1e-9; the surface of each material, and that of all
together, is a manifold: two triangles at each edge, once each way, and one fan at each vertex; the section Triangles holds
the faces between materials and to the outside, each once, turned away from the lower ref and with that ref."""

import array
import math
import sys
from fractions import Fraction

VOLUME_REL = 1e-9
UNSURE_REL = 1e-12  # of the product of edge lengths: below, the sign of a volume is settled with fractions
WHOLE = 0           # material that stands for all of them: refs count from 1


class Bad(Exception):
    pass


# ---- reading ----

def read_words(path):
    with open(path, "rb") as f:
        text = f.read()
    if b"#" in text:  # comments run to the end of the line
        text = b"\n".join(line.partition(b"#")[0] for line in text.split(b"\n"))
    return text.split()


def read_section(words, at, width, kind, what):
    """The count at words[at] and as many rows; returns them flat, and where the next keyword is."""
    n = int(words[at])
    end = at + 1 + n * width
    if n < 0 or end > len(words):
        raise Bad("%s: %d promised, the file ends before" % (what, n))
    return array.array(kind, map(float if kind == "d" else int, words[at + 1:end])), end


def read_mesh(path):
    words = read_words(path)
    if len(words) < 4 or words[0] != b"MeshVersionFormatted":
        raise Bad("no MEDIT mesh")
    section = {b"Vertices": (4, "d"), b"Triangles": (4, "q"), b"Tetrahedra": (5, "q")}
    found = {}
    at = 2
    while at < len(words) and words[at] != b"End":
        word = words[at]
        if word == b"Dimension":
            if words[at + 1] != b"3":
                raise Bad("dimension %s, need 3" % words[at + 1].decode())
            at += 2
        elif word in section and word not in found:
            width, kind = section[word]
            found[word], at = read_section(words, at + 1, width, kind, word.decode())
        else:
            raise Bad("unexpected '%s'" % word.decode(errors="replace"))
    for word in section:
        if word not in found:
            raise Bad("no section %s" % word.decode())
    return found[b"Vertices"], found[b"Triangles"], found[b"Tetrahedra"]


# ---- tets ----

def exact_volume(a, b, c, d):
    a, b, c, d = ([Fraction(x) for x in p] for p in (a, b, c, d))
    u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, c, d))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
            u[2] * (v[0] * w[1] - v[1] * w[0])) / 6


def check_volumes(point, tet):
    """Sum of the volumes."""
    volume = []
    for t in range(0, len(tet), 5):
        a, b, c, d = corner = (point[tet[t]], point[tet[t + 1]], point[tet[t + 2]], point[tet[t + 3]])
        ax, ay, az = a
        ux, uy, uz = b[0] - ax, b[1] - ay, b[2] - az
        vx, vy, vz = c[0] - ax, c[1] - ay, c[2] - az
        wx, wy, wz = d[0] - ax, d[1] - ay, d[2] - az
        det = ux * (vy * wz - vz * wy) - uy * (vx * wz - vz * wx) + uz * (vx * wy - vy * wx)
        size = (abs(ux) + abs(uy) + abs(uz)) * (abs(vx) + abs(vy) + abs(vz)) * (abs(wx) + abs(wy) + abs(wz))
        if not det > UNSURE_REL * size and not exact_volume(*corner) > 0:
            raise Bad("tet %d has volume %g, need > 0" % (t // 5 + 1, det / 6))
        volume.append(det)
    return math.fsum(volume) / 6


def border_faces(tet, n_vert):
    """The faces that are not between two tets of one material: a dict of (lower ref, 0 for outside the other ref, corners
    turned away from the lower ref), by a number made of the sorted corners."""
    n = n_vert + 1
    open_face = {}  # number: index of the tet, or -1 when it has met its second
    border = {}
    faces = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # outwards
    for t in range(0, len(tet), 5):
        ref = tet[t + 4]
        for i, j, k in faces:
            v = (tet[t + i], tet[t + j], tet[t + k])
            a, b, c = sorted(v)
            key = (a * n + b) * n + c
            other = open_face.get(key)
            if other is None:
                open_face[key] = t
            elif other < 0:
                raise Bad("face %d %d %d has more than two tets" % (a, b, c))
            else:
                open_face[key] = -1
                other_ref = tet[other + 4]
                if ref < other_ref:
                    border[key] = (ref, other_ref, v)
                elif ref > other_ref:
                    border[key] = (other_ref, ref, (v[0], v[2], v[1]))
    for key, t in open_face.items():
        if t < 0:
            continue
        c, a, b = key % n, key // n // n, key // n % n
        for i, j, k in faces:
            v = (tet[t + i], tet[t + j], tet[t + k])
            if sorted(v) == [a, b, c]:
                border[key] = (tet[t + 4], 0, v)
    return border


# ---- surfaces ----

def check_manifold(border, n_vert):
    """Around each vertex of a material, its triangles make one closed fan. The edge of the fan that leaves `a` for `b` at v
    is follow[material, v, a] = b; each edge of the surface is then seen from both its ends."""
    n = n_vert + 1
    follow = {}

    def add(material, v):
        base = material * n
        for k in range(3):
            key = (base + v[k]) * n + v[k - 2]
            if key in follow:
                raise Bad("surface of material %d: edge %d %d has more than two triangles" % (material, v[k], v[k - 2]))
            follow[key] = v[k - 1]

    for low, high, v in border.values():
        add(low, v)
        turned = (v[0], v[2], v[1])
        if high:
            add(high, turned)
        else:
            add(WHOLE, v)
    seen = set()
    while follow:
        key, first = follow.popitem()
        center, start = divmod(key, n)
        material, v = divmod(center, n)
        if center in seen:
            raise Bad("surface of material %d: vertex %d has two fans" % (material, v))
        seen.add(center)
        at = first
        while at != start:
            after = follow.pop(center * n + at, None)
            if after is None:
                raise Bad("surface of material %d: edge %d %d has one triangle" % (material, v, at))
            at = after


def enclosed_volume(point, border):
    """By the divergence theorem, about a point of the surface so that far coordinates cost nothing."""
    part = []
    ox = oy = oz = None
    for low, high, v in border.values():
        if high:
            continue
        a, b, c = point[v[0]], point[v[1]], point[v[2]]
        if ox is None:
            ox, oy, oz = a
        ax, ay, az = a[0] - ox, a[1] - oy, a[2] - oz
        bx, by, bz = b[0] - ox, b[1] - oy, b[2] - oz
        cx, cy, cz = c[0] - ox, c[1] - oy, c[2] - oz
        part.append(ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx))
    return math.fsum(part) / 6


def check_triangles(triangle, border, n_vert):
    n = n_vert + 1
    seen = set()
    for t in range(0, len(triangle), 4):
        v = (triangle[t], triangle[t + 1], triangle[t + 2])
        a, b, c = sorted(v)
        key = (a * n + b) * n + c
        want = border.get(key)
        if want is None:
            raise Bad("triangle %d %d %d lies between no two materials" % v)
        if key in seen:
            raise Bad("triangle %d %d %d comes twice" % v)
        seen.add(key)
        if triangle[t + 3] != want[0]:
            raise Bad("triangle %d %d %d has ref %d, need %d" % (v + (triangle[t + 3], want[0])))
        w = want[2]
        if w not in (v, (v[1], v[2], v[0]), (v[2], v[0], v[1])):
            raise Bad("triangle %d %d %d is turned towards material %d" % (v + (want[0],)))
    if len(seen) != len(border):
        raise Bad("%d triangles, but %d faces between materials and to the outside" % (len(seen), len(border)))


# ---- all ----

def check_indices(flat, width, corners, n_vert, what):
    for k in range(corners):
        column = flat[k::width]
        if column and not (min(column) >= 1 and max(column) <= n_vert):
            raise Bad("%s: a vertex number is not in 1..%d" % (what, n_vert))


def check(path):
    vertex, triangle, tet = read_mesh(path)
    n_vert, n_tet = len(vertex) // 4, len(tet) // 5
    if n_tet == 0:
        raise Bad("no tets")
    if not all(map(math.isfinite, vertex)):
        raise Bad("a coordinate is not finite")
    check_indices(tet, 5, 4, n_vert, "Tetrahedra")
    check_indices(triangle, 4, 3, n_vert, "Triangles")
    if min(tet[4::5]) < 1:
        raise Bad("a tet has ref %d, need 1 or more" % min(tet[4::5]))
    point = [None] + list(zip(vertex[0::4], vertex[1::4], vertex[2::4]))
    volume = check_volumes(point, tet)
    border = border_faces(tet, n_vert)
    check_triangles(triangle, border, n_vert)
    enclosed = enclosed_volume(point, border)
    if not abs(enclosed - volume) <= VOLUME_REL * volume:
        raise Bad("tets have volume %.17g, their surface encloses %.17g" % (volume, enclosed))
    check_manifold(border, n_vert)
    return "tets %d, materials %d, volume %.9g, ok" % (n_tet, len(set(tet[4::5])), volume)


def main(paths):
    if not paths:
        sys.exit(__doc__)
    status = 0
    for path in paths:
        try:
            print("%s: %s" % (path, check(path)))
        except (Bad, OSError, ValueError, IndexError) as problem:
            print("%s: %s" % (path, problem))
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
