#!/usr/bin/python3
"""Controls: does a map follow what it must, and nothing else? (numpy only; run by hand)

  controls.py --bin build/release/crosspatch --data FOLDER [--control reflection,...] [--sets SET,...] [--limit N]
              [--threads N] > controls.csv

Each control changes a pair of the data set in a way whose effect on the map is known, runs `crosspatch map` and compares:

  reflection  The target is mirrored in space and its triangles are turned, so that they face outwards again. The mirror image
              is the same surface with the opposite orientation. A map that keeps orientation must therefore become the truth
              followed by the exchange of left and right: the error against the mirrored truth must be less than that against the truth
              itself. Sets without a mirrored truth get theirs from the map of the target to its own mirror image, which is
              the exchange; how far it is from being its own inverse is printed as `involution`.
  similarity  Both are turned, scaled and moved, each in its own way.
  relabel     Vertices, faces and corners of both are numbered anew.
  swap        The map is sought from target to source, and its inverse is scored.
  subdivide   Every triangle of both becomes four.
  flips       A fifth of the edges of both is flipped, where the surface stays as it is but for a slight fold.
  noise       Vertices of both move along their normals by a tenth of the mean edge (standard deviation).

similarity, relabel and swap may change the mean error by 0.5 (in hundredths of the square root of the target's area), the
others by 1.0, and none may change the side, left or right, that the map is on.

Rows: pair, set, control, error before and after (`before` is empty for the reflection), error against the mirrored truth after, side
before and after, seconds, and whether the control holds. The error is the mean over --points points of the truth (seed 0) of the
distance along edges and across single edges of the (changed) target. A summary goes to standard error.
"""
import argparse, csv, heapq, os, re, subprocess, sys, tempfile, time
import numpy as np

SET = re.compile(r'^(s07_[a-z]+|[A-Za-z0-9]+(?:_r)?)_')
ALLOWED = {'similarity': .5, 'relabel': .5, 'swap': .5, 'subdivide': 1., 'flips': 1., 'noise': 1.}


def read_off(path):
    words = open(path).read().split()
    vertices, faces = int(words[1]), int(words[2])
    V = np.array(words[4:4 + 3 * vertices], float).reshape(-1, 3)
    F = np.array(words[4 + 3 * vertices:4 + 3 * vertices + 4 * faces], int).reshape(-1, 4)
    if words[0] != 'OFF' or (F[:, 0] != 3).any():
        sys.exit(path + ': not an OFF file of triangles')
    return V, F[:, 1:]


def write_off(path, V, F):
    with open(path, 'w') as file:
        file.write('OFF\n%d %d 0\n' % (len(V), len(F)))
        np.savetxt(file, V, '%.17g')
        np.savetxt(file, np.c_[np.full(len(F), 3), F], '%d')


# A change takes a mesh and a seed and gives the mesh and the new number of every old vertex.

def same(V, F, seed):
    return V, F, np.arange(len(V))


def reflection(V, F, seed):
    return V * [-1, 1, 1], F[:, ::-1], np.arange(len(V))


def similarity(V, F, seed):
    rng = np.random.default_rng(seed)
    Q, R = np.linalg.qr(rng.normal(size=(3, 3)))
    Q = Q * np.sign(np.diag(R))
    if np.linalg.det(Q) < 0: Q[:, 0] *= -1
    return rng.uniform(.1, 10) * V @ Q.T + rng.normal(size=3) * np.ptp(V), F, np.arange(len(V))


def relabel(V, F, seed):
    rng = np.random.default_rng(seed)
    place = rng.permutation(len(V))
    moved = np.empty_like(V)
    moved[place] = V
    G = place[F[rng.permutation(len(F))]]
    turn = rng.integers(3, size=len(G))
    return moved, np.stack([G[np.arange(len(G)), (k + turn) % 3] for k in range(3)], 1), place


def subdivide(V, F, seed):
    ends = np.sort(np.stack([F, np.roll(F, -1, 1)], 2).reshape(-1, 2), 1)
    edges, which = np.unique(ends, axis=0, return_inverse=True)
    a, b, c = F.T
    ab, bc, ca = (which.reshape(-1, 3) + len(V)).T
    G = np.stack([np.c_[a, ab, ca], np.c_[ab, b, bc], np.c_[ca, bc, c], np.c_[ab, bc, ca]], 1).reshape(-1, 3)
    return np.r_[V, V[edges].mean(1)], G, np.arange(len(V))


def normal(V, f):
    n = np.cross(V[f[1]] - V[f[0]], V[f[2]] - V[f[0]])
    return n / max(np.linalg.norm(n), 1e-300)


def flips(V, F, seed):
    F = F.copy()
    face = {(F[i, k], F[i, (k + 1) % 3]): i for i in range(len(F)) for k in range(3)}
    edges = sorted(e for e in face if e[0] < e[1] and e[::-1] in face)
    left = len(edges) // 5
    for i in np.random.default_rng(seed).permutation(len(edges)):
        u, v = edges[i]
        if left == 0: break
        if (u, v) not in face or (v, u) not in face: continue
        f, g = face[u, v], face[v, u]
        p, q = (next(w for w in F[x] if w not in (u, v)) for x in (f, g))
        if (p, q) in face or (q, p) in face: continue
        new = (q, v, p), (p, u, q)
        # Both new triangles face as the old ones do, within some 25 degrees.
        if min(normal(V, n) @ normal(V, o) for n in new for o in (F[f], F[g])) < .9: continue
        for e in ((u, v), (v, u)): del face[e]
        for x, n in zip((f, g), new):
            F[x] = n
            for k in range(3): face[n[k], n[(k + 1) % 3]] = x
        left -= 1
    return V, F, np.arange(len(V))


def noise(V, F, seed):
    N = np.zeros_like(V)
    n = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    for k in range(3): np.add.at(N, F[:, k], n)
    N /= np.maximum(np.linalg.norm(N, axis=1, keepdims=True), 1e-300)
    edge = np.linalg.norm(V[F] - V[np.roll(F, -1, 1)], axis=2).mean()
    return V + N * np.random.default_rng(seed).normal(0, .1 * edge, (len(V), 1)), F, np.arange(len(V))


CHANGES = {f.__name__: f for f in (similarity, relabel, subdivide, flips, noise)}
CHANGES['swap'] = same


class Target:
    """Distances on a mesh, over the square root of its area."""

    def __init__(self, V, F):
        n = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
        self.V, self.F = V / np.sqrt(np.linalg.norm(n, axis=1).sum() / 2), F
        V = self.V
        self.near = [dict() for _ in V]
        opposite = {}
        for f in F:
            for k in range(3):
                i, j, o = int(f[k]), int(f[(k + 1) % 3]), int(f[(k + 2) % 3])
                self.join(i, j, np.linalg.norm(V[i] - V[j]))
                opposite[i, j] = o
        for (i, j), o in opposite.items():
            p = opposite.get((j, i))
            if i > j or p is None: continue
            # The straight line from o to p across the edge, unfolded, if it meets the edge.
            e = V[j] - V[i]
            length = np.linalg.norm(e)
            x = [(V[w] - V[i]) @ e / length for w in (o, p)]
            h = [np.sqrt(max(np.sum((V[w] - V[i])**2) - y * y, 0)) for w, y in zip((o, p), x)]
            if sum(h) > 0 and 0 < (x[0] * h[1] + x[1] * h[0]) / sum(h) < length:
                self.join(o, p, np.hypot(x[0] - x[1], sum(h)))

    def join(self, i, j, d):
        for a, b in ((i, j), (j, i)):
            self.near[a][b] = min(d, self.near[a].get(b, np.inf))

    def distance(self, vertex, image):
        """From a vertex to a point `face b0 b1 b2`; stops when the corners of its face are known."""
        if image[0] < 0: return np.nan
        corners = [int(c) for c in self.F[int(image[0])]]
        point = np.asarray(image[1:]) @ self.V[corners]
        known, front = {}, [(0., int(vertex))]
        while front and not all(c in known for c in corners):
            d, v = heapq.heappop(front)
            if v in known: continue
            known[v] = d
            for w, length in self.near[v].items():
                if w not in known: heapq.heappush(front, (d + length, w))
        return min(known[c] + np.linalg.norm(self.V[c] - point) for c in corners if c in known)


class Failure(Exception):
    pass


def run_map(args, source, target, swapped=False):
    """-> the image of each source vertex (n x 4) and seconds."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [os.path.join(folder, name) for name in ('source.off', 'target.off', 'map.txt', 'inverse.txt')]
        for path, mesh in zip(paths, (source, target)): write_off(path, *mesh)
        start = time.monotonic()
        ends = paths[1::-1] if swapped else paths[:2]
        done = subprocess.run([args.bin, 'map', *ends, '--output', paths[2], '--inverse', paths[3], '--quiet', '--threads',
                               str(args.threads)], capture_output=True, text=True)
        if done.returncode not in (0, 1): raise Failure('exit %d: %s' % (done.returncode, done.stderr.strip()))
        return np.loadtxt(paths[3 if swapped else 2]), time.monotonic() - start


def nearest(target, images):
    return target.F[images[:, 0].astype(int), images[:, 1:].argmax(1)]


def errors(target, images, truth):
    return 100 * np.nanmean([target.distance(t, images[s]) for s, t in truth])


class Pair:
    def __init__(self, args, row):
        path = lambda key: os.path.join(args.data, row[key])
        self.id, self.set = row['id'], SET.match(row['id'])[1]
        self.source, self.target = read_off(path('source')), read_off(path('target'))
        load = lambda key: np.loadtxt(path(key), dtype=int, ndmin=2) if row[key] else None
        truth, mirrored = load('gt'), load('gt_sym')
        some = np.sort(np.random.default_rng(0).choice(len(truth), min(len(truth), args.points), False))
        self.truth = truth[some]
        # A mirrored truth of as many rows speaks of the same source vertices, else of its own landmarks.
        self.mirrored = None if mirrored is None else mirrored[some] if len(mirrored) == len(truth) else mirrored

    def score(self, images, target, source_place, target_place):
        """-> error against the truth and against the mirrored truth (nan without one)."""
        to = lambda truth: np.c_[source_place[truth[:, 0]], target_place[truth[:, 1]]]
        direct = errors(target, images, to(self.truth))
        return direct, errors(target, images, to(self.mirrored)) if self.mirrored is not None else np.nan


def side(direct, mirrored):
    return '' if np.isnan(mirrored) else 'truth' if direct < mirrored else 'mirror'


def reflect(args, pair):
    """The reflection control -> row. The mirrored target keeps the numbers of its vertices."""
    V, F, place = reflection(*pair.target, 0)
    target = Target(V, F)
    involution = ''
    if pair.mirrored is None:
        exchange, _ = run_map(args, pair.target, (V, F))
        twin = nearest(target, exchange)
        involution = '%.2f' % (100 * np.mean([target.distance(v, exchange[twin[v]]) for v in pair.truth[:, 1]]))
        pair.mirrored = np.c_[pair.truth[:, 0], twin[pair.truth[:, 1]]]
    images, seconds = run_map(args, pair.source, (V, F))
    direct, mirrored = pair.score(images, target, np.arange(len(pair.source[0])), place)
    return {'after': direct, 'mirrored_after': mirrored, 'side_after': side(direct, mirrored), 'seconds': seconds,
            'involution': involution, 'holds': int(mirrored < direct)}


def compare(args, pair, control, before):
    """Any other control -> row."""
    seed = abs(hash_of(pair.id))
    V, F, source_place = CHANGES[control](*pair.source, seed)
    W, G, target_place = CHANGES[control](*pair.target, seed + 1)
    images, seconds = run_map(args, (V, F), (W, G), control == 'swap')
    direct, mirrored = pair.score(images, Target(W, G), source_place, target_place)
    holds = abs(direct - before[0]) <= ALLOWED[control] and side(direct, mirrored) == side(*before)
    return {'before': before[0], 'after': direct, 'mirrored_after': mirrored, 'side_before': side(*before),
            'side_after': side(direct, mirrored), 'seconds': seconds, 'holds': int(holds)}


def hash_of(text):
    return sum(ord(c) * 31**(i % 5) for i, c in enumerate(text))


def selection(args):
    with open(os.path.join(args.data, 'pairs.csv')) as file:
        rows = [r for r in csv.DictReader(file) if r['gt_kind'] in ('dense', 'landmarks')]
    for name in args.sets.split(','):
        group = [r for r in rows if SET.match(r['id'])[1] == name]
        for i in np.unique(np.linspace(0, len(group) - 1, min(args.limit, len(group))).round().astype(int)):
            yield group[i]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--bin', required=True)
    p.add_argument('--data', default=os.environ.get('CROSSPATCH_DATA', '../shared/data'))
    p.add_argument('--control', default='reflection,' + ','.join(ALLOWED))
    p.add_argument('--sets', default='tosca5k,smal_r,s07_fourleg,faust5k')
    p.add_argument('--limit', type=int, default=10, help='pairs of a set, spread over it')
    p.add_argument('--points', type=int, default=300)
    p.add_argument('--threads', type=int, default=1)
    args = p.parse_args()
    controls = args.control.split(',')
    fields = ['pair', 'set', 'control', 'before', 'after', 'mirrored_after', 'side_before', 'side_after', 'involution',
              'seconds', 'holds', 'said']
    out = csv.DictWriter(sys.stdout, fields, lineterminator='\n')
    out.writeheader()
    held = {}
    for row in selection(args):
        pair, before = Pair(args, row), None
        for control in controls:
            result = {'holds': 0}
            try:
                if control != 'reflection' and before is None:
                    images, seconds = run_map(args, pair.source, pair.target)
                    before = pair.score(images, Target(*pair.target), *(np.arange(len(m[0])) for m in (pair.source, pair.target)))
                result = reflect(args, pair) if control == 'reflection' else compare(args, pair, control, before)
            except Failure as failure:
                result['said'] = str(failure)
            held.setdefault((pair.set, control), []).append(result['holds'])
            shown = {k: '%.2f' % v if isinstance(v, float) else v for k, v in result.items()}
            out.writerow({'pair': pair.id, 'set': pair.set, 'control': control, **shown})
            sys.stdout.flush()
    for (name, control), holds in sorted(held.items(), key=lambda x: (controls.index(x[0][1]), x[0][0])):
        print('%-12s %-12s %d of %d' % (control, name, sum(holds), len(holds)), file=sys.stderr)


if __name__ == '__main__':
    main()
