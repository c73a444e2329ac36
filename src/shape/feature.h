/* What of an obstacle meets the facets and edges of a body between their nodes: vertices and convex edges of boxes and
   meshes, and small spheres about their centres. A facet against a plane or the flat of a face is met by its nodes alone, and
   a sphere of more than SHV_FEATURE_FLAT edges' radius, too: a facet dips into it by no more than a twelfth of an edge. */
#ifndef SHV_SHAPE_FEATURE_H
#define SHV_SHAPE_FEATURE_H

#include "shape/obstacle.h"

/* The middle of a regular facet whose corners are on a sphere of radius R is h²/(6 R) below its surface. */
#define SHV_FEATURE_FLAT 2.0

/* A vertex, whose ends are equal, or an edge. */
struct ShvFeature {
    ShvVec3 ends[2]; /* in the obstacle's axes */
    ShvVec3 outward; /* of an edge: sum of the normals of both its faces; zero: a vertex */
    double size;     /* m: of the shortest edge at it; a sphere's radius */
};

/* A facet of a body. */
typedef struct ShvFacetShape {
    ShvVec3 corners[3], apex; /* apex: of its tet, on the inside */
    uint8_t free;             /* bits: the tet's face opposite to corner k bounds the body, too */
} ShvFacetShape;

/* Where they meet: the facet's point Σ wᵢ xᵢ stands at point + gap · normal. */
typedef struct ShvFeaturePoint {
    double gap;            /* m; negative: they overlap */
    ShvVec3 point, normal; /* on the obstacle; outward; world */
    double weights[3];     /* of the facet's corners */
} ShvFeaturePoint;

/* Finds the features of an obstacle whose shape has been made; a plane has none. */
ShvStatus shv_features_create(ShvObstacle *obstacle, ShvMemory *memory, ShvError *error);

/* Those of obstacle->features that a facet may come to: from `first` to before `end`, those of them that are within `reach` of its
   `centre`. */
typedef struct ShvFeatureRange {
    int32_t first, end;
    ShvVec3 centre;
    double reach;
} ShvFeatureRange;
/* When the facet and the obstacle come closer by `margin`, m, at most. False: to none. */
bool shv_features_about(const ShvObstacle *obstacle, const ShvFacetShape *facet, double margin, ShvFeatureRange *range);
bool shv_feature_is_edge(const ShvFeature *feature); /* or a vertex, or a sphere's centre */
bool shv_feature_is_near(const ShvObstacle *obstacle, const ShvFeature *feature, ShvVec3 point, double reach);
/* Whether facets of at most such a radius, within `reach` of a point, may meet the obstacle between their nodes. */
bool shv_features_matter(const ShvObstacle *obstacle, double facet_radius, ShvVec3 point, double reach);

/* How far a point below the facet is outside of the body, beyond another free face of the tet, m; 0: it is not. Beyond inner faces
   lie neighbours, in whose corners next to the facet the point may be. */
double shv_facet_beyond_free_face(const ShvFacetShape *facet, ShvVec3 x);

/* Centre, and distance of the farthest corner, m. */
ShvVec3 shv_facet_centre(const ShvFacetShape *facet, double *radius);

/* Where facet and feature meet with a gap below `limit`: the facet's inside, or the inside of its edges, against a
   point of the obstacle whose outward normals include that of the contact. Not where a node of the facet meets it.
   Returns how many points there are. */
int shv_feature_meet(const ShvObstacle *obstacle, const ShvFeature *feature, const ShvFacetShape *facet, double limit,
                     ShvFeaturePoint points[3]);
/* The edge of the facet on which such a point is, from its corner of this number to the next; −1: it is inside. */
int shv_feature_point_edge(const ShvFeaturePoint *point);
/* A push asks that the body is behind the plane through the point it acts on. Whether what lies by `way` from there is before that
   plane by more than a share of its distance: next to a node, which flat faces bend by little; next to an edge, where a body that
   drapes over an obstacle has its next nodes lower. */
#define SHV_BEFORE_NODE 0.1
#define SHV_BEFORE_EDGE 0.5
static inline bool shv_is_before(ShvVec3 normal, ShvVec3 way, double share)
{
    return shv_dot(normal, way) < -share * shv_norm(way);
}
/* Distance of both, m; no point of shv_feature_meet has a smaller gap unless they overlap. */
double shv_feature_distance(const ShvObstacle *obstacle, const ShvFeature *feature, const ShvFacetShape *facet);

#endif
