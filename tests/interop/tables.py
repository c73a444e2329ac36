"""What judge.py has read from a run file, as the judge of what other programs read; and where a line of descent is."""
import json


class Judge:
    def __init__(self, folder):
        with open(f"{folder}/judge.json") as stream:
            read = json.load(stream)
        self.times, self.fragments, self.shapes, self.obstacles = (read[k] for k in ("times", "fragments", "shapes", "obstacles"))
        numbered = lambda frames: [{int(i): pose for i, pose in frame.items()} for frame in frames]
        # A frame each: number to (position, orientation w x y z).
        self.pieces, self.obstacle_poses = numbered(read["pieces"]), numbered(read["obstacle_poses"])
        # Of the three frames: 12 numbers a tet, and the fragment that has it.
        self.corners, self.holders = ({int(f): values for f, values in read[k].items()} for k in ("corners", "holders"))
        self.three = sorted(self.corners)
        parents = {fragment["parent"] for fragment in self.fragments}
        # Lines of descent by name, with the fragment that each ends with.
        self.leaves = {f"line_{f['line']}": i for i, f in enumerate(self.fragments) if i not in parents}

    def carrier(self, leaf, frame):
        """The fragment by which `leaf` moves at a frame: itself or the ancestor that lives."""
        while leaf >= 0 and leaf not in self.pieces[frame]:
            leaf = self.fragments[leaf]["parent"]
        return leaf

    def body(self, leaf, frame):
        """Where the centre of the fragment `leaf` is at a frame, and how it is turned."""
        carrier = self.carrier(leaf, frame)
        place, turn = self.pieces[frame][carrier]
        arm = rotate(turn, [a - b for a, b in zip(self.fragments[leaf]["pivot"], self.fragments[carrier]["pivot"])])
        return [p + a for p, a in zip(place, arm)], turn

    def moved(self, name, frame):
        """The corners of a line at a frame, moved as a rigid body."""
        place, turn = self.body(self.leaves[name], frame)
        return [[p + c for p, c in zip(place, rotate(turn, corner))] for corner in self.shapes[name]]

    def obstacle_reach(self, number, frame):
        """Half widths along the axes of an obstacle that is not turned; none of a plane."""
        obstacle = self.obstacles[number]
        place, turn = self.obstacle_poses[frame][number]
        half = [obstacle["radius"]] * 3 if obstacle["shape"] == "sphere" else [0.5 * s for s in obstacle["size"]]
        return None if obstacle["shape"] == "plane" or turn != [1, 0, 0, 0] else [[p - h for p, h in zip(place, half)], [p + h for p, h in zip(place, half)]]


def rotate(q, v):
    w, x, y, z = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]]


def box(a, b, c):
    """The determinant of three vectors."""
    return sum(a[k] * (b[k - 2] * c[k - 1] - b[k - 1] * c[k - 2]) for k in range(3))


def reach(points):
    """The ends of points along the axes."""
    return [[side(p[k] for p in points) for k in range(3)] for side in (min, max)]


def apart(a, b):
    """The largest difference of two lists of numbers, which may hold lists."""
    if isinstance(a, (int, float)):
        return abs(a - b)
    return max((apart(x, y) for x, y in zip(a, b, strict=True)), default=0.0)
