#include "bullet_bridge/rigid_gjk.hpp"

namespace
{
enum { most_rounds = 64 };
// Of the squared distance: an improvement by less is none (a direction off by 1e-6). Of the largest squared corner: the origin
// is reached.
const btScalar converged = 1e-12, reached = 1e-24;

// A vertex of first − second, and where it comes from.
struct Corner {
    btVector3 place, first, second;
};

// Corners, and their shares in the point of the simplex nearest to the origin.
struct Simplex {
    Corner corners[4];
    btScalar shares[4] = {1, 0, 0, 0};
    int count = 0;
};

// Which corners of a simplex hold its nearest point, with what shares.
struct Feature {
    int corners[3] = {0, 0, 0}, count = 0;
    btScalar shares[3] = {1, 0, 0};
};

btVector3 farthest(const ShvCore &core, const btVector3 &direction)
{
    const btVector3 *best = nullptr;
    btScalar most = -BT_LARGE_FLOAT;
    for (const btVector3 &vertex : core.vertices) {
        const btScalar along = direction.dot(vertex);
        if (along > most) {
            most = along;
            best = &vertex;
        }
    }
    return best ? core.centre + core.share * (*best - core.centre) : core.centre;
}

Feature point(int a)
{
    Feature feature;
    feature.corners[0] = a;
    feature.count = 1;
    return feature;
}

Feature edge(int a, int b, btScalar share)
{
    Feature feature;
    feature.corners[0] = a;
    feature.corners[1] = b;
    feature.shares[0] = 1 - share;
    feature.shares[1] = share;
    feature.count = 2;
    return feature;
}

Feature nearest_of_edge(const Simplex &simplex, int a, int b)
{
    const btVector3 &from = simplex.corners[a].place, way = simplex.corners[b].place - from;
    const btScalar along = -from.dot(way), length = way.length2();
    if (along <= 0) return point(a);
    if (along >= length) return point(b);
    return edge(a, b, along / length);
}

// By the Voronoi regions of the triangle (Ericson 2005, 5.1.5).
Feature nearest_of_triangle(const Simplex &simplex, int ia, int ib, int ic)
{
    const btVector3 &a = simplex.corners[ia].place, &b = simplex.corners[ib].place, &c = simplex.corners[ic].place;
    const btVector3 ab = b - a, ac = c - a;
    const btScalar d1 = -ab.dot(a), d2 = -ac.dot(a);
    if (d1 <= 0 && d2 <= 0) return point(ia);
    const btScalar d3 = -ab.dot(b), d4 = -ac.dot(b);
    if (d3 >= 0 && d4 <= d3) return point(ib);
    const btScalar vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return edge(ia, ib, d1 / (d1 - d3));
    const btScalar d5 = -ab.dot(c), d6 = -ac.dot(c);
    if (d6 >= 0 && d5 <= d6) return point(ic);
    const btScalar vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return edge(ia, ic, d2 / (d2 - d6));
    const btScalar va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) return edge(ib, ic, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    const btScalar sum = va + vb + vc;
    if (!(sum > 0)) return nearest_of_edge(simplex, ia, ib);
    Feature feature;
    feature.corners[0] = ia;
    feature.corners[1] = ib;
    feature.corners[2] = ic;
    feature.shares[1] = vb / sum;
    feature.shares[2] = vc / sum;
    feature.shares[0] = 1 - feature.shares[1] - feature.shares[2];
    feature.count = 3;
    return feature;
}

btVector3 place_of(const Simplex &simplex, const Feature &feature)
{
    btVector3 sum(0, 0, 0);
    for (int i = 0; i < feature.count; i++) sum += simplex.corners[feature.corners[i]].place * feature.shares[i];
    return sum;
}

// Of the faces that have the origin on their outer side the nearest; none: the origin is inside.
Feature nearest_of_tetrahedron(const Simplex &simplex)
{
    static const int faces[4][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}, {1, 3, 2, 0}}; // the last is opposite
    Feature best;
    btScalar least = BT_LARGE_FLOAT;
    for (const int *face : faces) {
        const btVector3 &a = simplex.corners[face[0]].place;
        const btVector3 normal = (simplex.corners[face[1]].place - a).cross(simplex.corners[face[2]].place - a);
        if (-normal.dot(a) * normal.dot(simplex.corners[face[3]].place - a) > 0) continue;
        const Feature candidate = nearest_of_triangle(simplex, face[0], face[1], face[2]);
        const btScalar distance = place_of(simplex, candidate).length2();
        if (distance >= least) continue;
        least = distance;
        best = candidate;
    }
    return best;
}

Feature nearest_of(const Simplex &simplex)
{
    switch (simplex.count) {
    case 1:
        return point(0);
    case 2:
        return nearest_of_edge(simplex, 0, 1);
    case 3:
        return nearest_of_triangle(simplex, 0, 1, 2);
    default:
        return nearest_of_tetrahedron(simplex);
    }
}

// Keeps the corners of a feature only.
void keep(Simplex *simplex, const Feature &feature)
{
    int order[3] = {feature.corners[0], feature.corners[1], feature.corners[2]};
    btScalar shares[3] = {feature.shares[0], feature.shares[1], feature.shares[2]};
    for (int i = 1; i < feature.count; i++) // ascending, so that no corner is overwritten before it has moved
        for (int k = i; k > 0 && order[k - 1] > order[k]; k--) {
            btSwap(order[k - 1], order[k]);
            btSwap(shares[k - 1], shares[k]);
        }
    for (int i = 0; i < feature.count; i++) {
        if (order[i] != i) simplex->corners[i] = simplex->corners[order[i]];
        simplex->shares[i] = shares[i];
    }
    simplex->count = feature.count;
}

bool contains(const Simplex &simplex, const btVector3 &place)
{
    for (int i = 0; i < simplex.count; i++)
        if (simplex.corners[i].place == place) return true;
    return false;
}

ShvNearest answer(const Simplex &simplex, const btVector3 &nearest)
{
    ShvNearest result;
    result.apart = true;
    result.normal = nearest.normalized();
    for (int i = 0; i < simplex.count; i++)
        result.middle += (simplex.corners[i].first + simplex.corners[i].second) * (simplex.shares[i] / 2);
    return result;
}
} // namespace

ShvNearest shv_nearest(const ShvCore &first, const ShvCore &second, const btMatrix3x3 &axes, const btVector3 &origin,
                       const btVector3 &guess, btScalar far)
{
    ShvNearest none;
    Simplex simplex;
    btVector3 nearest = guess;
    btScalar distance2 = BT_LARGE_FLOAT, largest2 = 0;
    for (int round = 0; round < most_rounds; round++) {
        Corner &corner = simplex.corners[simplex.count];
        corner.first = farthest(first, -nearest);
        corner.second = origin + axes * farthest(second, nearest * axes);
        corner.place = corner.first - corner.second;
        const btScalar along = nearest.dot(corner.place);
        if (along > 0 && along * along > nearest.length2() * far * far) {
            none.far = true;
            return none;
        }
        if (distance2 - along <= converged * distance2 || contains(simplex, corner.place)) break;
        largest2 = btMax(largest2, corner.place.length2());
        simplex.count++;
        const Feature feature = nearest_of(simplex);
        if (feature.count == 0) return none;
        const btVector3 nearer = place_of(simplex, feature);
        const btScalar nearer2 = nearer.length2();
        if (nearer2 <= reached * largest2) return none;
        if (nearer2 >= distance2) { // round-off
            simplex.count--;
            break;
        }
        keep(&simplex, feature);
        nearest = nearer;
        distance2 = nearer2;
    }
    return simplex.count > 0 ? answer(simplex, nearest) : none;
}
