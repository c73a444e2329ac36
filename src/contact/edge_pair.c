#include "contact/edge_pair.h"

#include "shape/segment.h"

/* Of the shorter edge: what overlaps by less has just met; what overlaps by more is not for edges to part. */
static const double just_met = 1e-3, deepest = 0.1;
/* Of the way of what overlaps and is not for edges to part: normal cones may change before it has gone as far as it overlaps. */
static const double share_of_overlap = 0.25;
/* Edges cross as such at least so far from their ends: shares of the edge, and times their depth. Nearer to a node the node meets
   the facets, before the edges are as deep as it is far. What a node of an edge has gone into is its own to leave, too: such an edge
   crosses others next to the node, in directions that have nothing to do with how the node came in. Shares larger than this let edges
   through where their nodes are beside the other body. */
static const double rim = 1e-3, clear_of_node = 10.0;
/* Sine of the angle by which a normal may be out of a normal cone, and a way out of a wedge: where an edge lies on a facet up to the
   facet's rim, as of a box on a box, it is on the rim of both, and facets bend under load. */
static const double normal_cone = 0.087; /* 5 degrees */

/* An edge with the wedge of its two facets. */
typedef struct Wedge {
    ShvVec3 start, way;  /* m */
    ShvVec3 opposite[2]; /* m: from the edge to the facets' other nodes */
    ShvVec3 normals[2];  /* of the facets, outward */
    double heights[2];   /* m: of the facets over the edge */
    double length;       /* m */
} Wedge;

static Wedge wedge_of(const ShvEdge *edge)
{
    Wedge wedge = {.start = edge->places[edge->edge]};
    wedge.way = shv_sub(edge->places[(edge->edge + 1) % 3], wedge.start);
    wedge.length = shv_norm(wedge.way);
    wedge.opposite[0] = shv_sub(edge->places[(edge->edge + 2) % 3], wedge.start);
    wedge.opposite[1] = shv_sub(edge->opposite, wedge.start);
    for (int k = 0; k < 2; k++) {
        const ShvVec3 area = k == 0 ? shv_cross(wedge.way, wedge.opposite[0]) : shv_cross(wedge.opposite[1], wedge.way);
        const double size = shv_norm(area);
        wedge.normals[k] = shv_scale(area, 1.0 / size);
        wedge.heights[k] = size / wedge.length;
    }
    return wedge;
}

/* `normal`: across the edge. Whether both facets fall away from the plane through the edge. */
static bool in_cone(const Wedge *wedge, ShvVec3 normal)
{
    for (int k = 0; k < 2; k++)
        if (!(shv_dot(normal, wedge->opposite[k]) <= normal_cone * wedge->heights[k])) return false;
    return true;
}

/* Whether a way from the edge goes in behind both facets, or along them. */
static bool points_inward(const Wedge *wedge, ShvVec3 way)
{
    return shv_dot(way, wedge->normals[0]) < normal_cone && shv_dot(way, wedge->normals[1]) < normal_cone;
}

/* Whether both cross clear of their nodes. */
static bool cross(const Wedge wedges[2], const ShvSegmentPoints *at, double depth)
{
    for (int k = 0; k < 2; k++) {
        const double share = fmin(at->shares[k], 1.0 - at->shares[k]);
        if (!(share >= rim) || !(share * wedges[k].length >= clear_of_node * depth)) return false;
    }
    return at->inside;
}

/* Gap and contact normal; false where they do not meet as edges. Where two wedges are acute a negative gap along a normal near the rim
   of their cones is no overlap. */
static bool meet(const Wedge wedges[2], const ShvSegmentPoints *at, double *gap, ShvVec3 *normal)
{
    const double size = fmin(wedges[0].length, wedges[1].length);
    *normal = shv_unit(shv_cross(wedges[0].way, wedges[1].way));
    const ShvVec3 outward = shv_add(wedges[1].normals[0], wedges[1].normals[1]);
    if (shv_dot(*normal, outward) < 0.0) *normal = shv_scale(*normal, -1.0);
    *gap = -shv_dot(*normal, at->between);
    if (!in_cone(&wedges[1], *normal) || !in_cone(&wedges[0], shv_scale(*normal, -1.0))) return false;
    if (!cross(wedges, at, -*gap)) return false;
    if (*gap >= -just_met * size) return true;
    return *gap >= -deepest * size && points_inward(&wedges[1], shv_scale(*normal, -1.0)) &&
           points_inward(&wedges[0], *normal);
}

bool shv_edge_pair_detect(const ShvSurfaceBodies *bodies, const ShvEdge *own, const ShvEdge *other, double step,
                          double reach, ShvFacetPair *pair, double *distance)
{
    const Wedge wedges[2] = {wedge_of(own), wedge_of(other)};
    const ShvSegmentPoints at = shv_segments_closest(wedges[0].start, wedges[0].way, wedges[1].start, wedges[1].way);
    const double size = fmin(wedges[0].length, wedges[1].length);
    ShvFacetPlane plane;
    ShvVec3 normal;
    double gap;
    *distance = shv_norm(at.between);
    if (*distance > fmax(reach, deepest * size)) return false;
    const bool met = meet(wedges, &at, &gap, &normal) && gap <= reach;
    if (gap < 0.0) *distance *= share_of_overlap;
    if (met || *distance < just_met * size) *distance = 0.0;
    if (!met || !shv_facet_plane_make(other->places, &plane)) return false;
    *pair = (ShvFacetPair){.nodes = {own->corners[own->edge], own->corners[(own->edge + 1) % 3]},
                           .node_count = 2,
                           .shares = {1.0 - at.shares[0], at.shares[0]},
                           .element = other->element,
                           .face = other->face,
                           .edge = other->edge,
                           .fragments = {own->fragment, other->fragment},
                           .corners = {other->corners[0], other->corners[1], other->corners[2]},
                           .step = step,
                           .gap = gap,
                           .point = shv_madd(wedges[0].start, at.shares[0], wedges[0].way),
                           .normal = normal};
    shv_facet_pair_stand(pair, &plane);
    shv_facet_pair_weigh(pair, bodies);
    return true;
}
