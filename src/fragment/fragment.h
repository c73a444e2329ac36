/* Fragments: connected parts of the objects. Two tets hang together when they share a node (which they do across intact facets)
   or when a cohesive facet between them still bonds; under `connectivity: nodes` only the former. Inserting facets therefore
   splits nothing: a fragment comes apart in the step in which its last bond fails. Tets that meet in a vertex or an edge of the
   mesh only, with no facet between them, hang together until a facet is inserted there: nothing else carries traction.
   An id is never used again: a split ends the parent and starts all its children; a crack without a split keeps the id. */
#ifndef SHV_FRAGMENT_FRAGMENT_H
#define SHV_FRAGMENT_FRAGMENT_H

#include "cohesive/cohesive.h"
#include "model/state.h"

typedef enum ShvMode {
    SHV_MODE_FLIGHT,
    SHV_MODE_FRACTURE,
    SHV_MODE_DEAD,
    SHV_MODE_BINNED /* alive, but out of motion and contact for good */
} ShvMode;

typedef struct ShvFragment {
    int32_t id, parent; /* parent −1: an object's first fragment; id = index in ShvFragments */
    int32_t object;
    double birth, death; /* s; death NaN while alive */
    ShvMode mode;
    int32_t element_count, node_count;
    int32_t element_begin;    /* into ShvFragments.elements */
    int32_t node_begin;       /* into ShvFragments.nodes */
    double mass;              /* Σ ρV of its elements in element order, kg */
    double volume, surface;   /* m³, m² to other fragments and to the outside, cracks in it left out; reference */
    double loss_factor;       /* mean over its mass */
    ShvVec3 reference_centre; /* of the lumped masses at reference positions, m */
    /* of the lumped masses at reference positions, about the centre, kg m²: the one inertia used on both sides of a
       hand-over, so that L is continuous */
    ShvMat3 inertia;
    double sides[3];                    /* of the solid box with that inertia, longest first, m */
    double radius;                      /* farthest node from the reference centre, m */
    ShvVec3 low, high;                  /* box of the nodes about the reference centre, reference axes, m */
    ShvVec3 position;                   /* centre of mass, m */
    ShvQuat orientation;                /* reference axes → world */
    ShvVec3 velocity, angular_velocity; /* m/s, rad/s, world */
    double
        last_insertion;  /* s: time of the last facet inserted in it (or when what woke it closes, maybe yet to come) */
    double strength;     /* Pa: weakest facet; infinity: nothing can break */
    int32_t quiet;       /* checks in a row without insertion; children inherit */
    int64_t searched;    /* number + 1 of the step in which it was last searched for parts; 0: never */
    bool cracked;        /* a facet of it has been inserted; children inherit */
    double load;         /* N: contact force under which it woke last */
    double borne;        /* N: largest such force that did not break it */
    double impact;       /* m/s: severity of the impact that woke it last, 0 once a facet has been inserted since */
    double borne_impact; /* m/s: largest severity that inserted none */
    double borne_spin;   /* Pa: centrifugal stress, estimated, when it came to rest */
    /* It stays rigid, but whoever advances the awake moves it in their steps: the backend leaves its pose, and changes its
       velocities by the impulses of what meets it in flight. */
    bool coupled;
    bool touches_coupled; /* in the backend's last step it met a coupled body */
    bool fixed;           /* in flight, but supports hold it (supported.c) */
    /* Of the contact that woke it (waking_contact.c); children inherit. */
    int32_t contact_obstacle, contact_other; /* the other side; −1: none of that kind */
    double contact_speed;                    /* m/s: with which it closed */
    ShvVec3 contact_arm,
        contact_normal; /* of the point, about the centre in the fragment's axes, m; world, to the fragment */
    double touched;     /* s: when it was touched last, or, before the first time, when it should be at the latest */
    double growth_time, growth_sum; /* s, J: what its cohesive facets had dissipated then (rest.c) */
    double
        last_crack; /* s: when a facet was inserted, a bond failed or damage was seen to grow last; −∞: not since it woke */
    double
        last_pressed; /* s: when an obstacle that moves, or what one pressed, pressed it last (squeeze.c); −∞: not since it woke */
    double last_approach,
        approach_severity; /* s: when something was to strike it last, which supports hold; m/s: severity of the hardest such blow */
    double woken_transit; /* s: of the bar wave through what woke; children inherit */
    double cut_time,
        cut_energy; /* s, J: work of opening its minimum cut, as it was then or, before that, at its last rest (rest.c) */
    double
        wake_energy; /* J/kg: kinetic energy a mass when it (or its ancestor) woke, or that of the blow (wake.c); children inherit */
    bool audited;  /* an impact that the wake rule takes for harmless woke it, and nothing has broken in it since */
    bool squeezed; /* between obstacles that leave it no room, and that has been told */
    bool dust;     /* in flight for good, meets obstacles alone */
    /* Its nodes stand deformed, in the pose that it had when it went to rest, and carry that strain energy (J). */
    bool deformed;
    ShvVec3 rest_position;
    ShvQuat rest_orientation;
    double strain;
    /* convex pieces that stand for it in flight, as the backend made them last, and where they are off, m³
       (ShvConvexPieces); 0 where it makes none */
    int32_t hulls;
    double hull_outside, hull_missing;
} ShvFragment;

typedef struct ShvFragments {
    ShvMemory *memory;
    const ShvCohesive *bonds; /* whose bonded facets join tets; NULL: shared nodes alone do */
    ShvFragment *items;
    int32_t count, capacity; /* all that ever lived */
    int32_t alive;
    int32_t *elements; /* element_count: permutation, elements of each living fragment together, increasing */
    int32_t *nodes;    /* node lists of the living fragments, increasing; rebuilt with the components */
    int32_t node_capacity;
    int32_t node_end;  /* lists are appended here; those of the dead are dropped when the capacity is reached */
    uint8_t *boundary; /* per element: bit k where face k is on the surface; NULL where the model has an adjacency */
    /* scratch, per node: only entries of the fragment at work are ever touched */
    int32_t *root, *label;
    int32_t *found; /* 0 between searches (severed.c) */
    int32_t scratch_capacity;
} ShvFragments;

/* One fragment per connected component of the start, in flight, with infinite strength; labels state->element_fragment.
   On failure `fragments` is zeroed and owns nothing. */
ShvStatus shv_fragments_create(ShvFragments *fragments, const ShvModel *model, ShvState *state, ShvError *error);
void shv_fragments_release(ShvFragments *fragments);

/* Finds the components of one living fragment after nodes were duplicated. One component: node lists and inertia are
   refreshed, the id stays. Several: the fragment dies, its children start, in the order of their lowest element, with
   mode and rotation of the parent; the last `parts` items are the children. Returns the number of components in `parts`.
   Relabels state->element_fragment. Costs work in proportion to this fragment only. On failure nothing changed. */
ShvStatus shv_fragments_split(ShvFragments *fragments, const ShvModel *model, ShvState *state, int32_t fragment,
                              int32_t *parts, ShvError *error);

/* What has changed since a fragment's lists were made: nodes from `first_copy` on were split off it (shv_cohesive_insert), and
   these cohesive facets have lost their bond. */
typedef struct ShvConnectivityChange {
    int32_t first_copy;
    const int32_t *failed;
    int32_t failed_count;
} ShvConnectivityChange;

/* The same as shv_fragments_split from what has changed alone: searches from there, and no farther than the smaller part goes. */
ShvStatus shv_fragments_split_by(ShvFragments *fragments, const ShvModel *model, ShvState *state, int32_t fragment,
                                 const ShvConnectivityChange *change, int32_t *parts, ShvError *error);
/* How many pieces there would be if a facet bonded above another share of its normal strength (shv_cohesive_residual): how
   sharp the number of fragments is. Counts across facets alone. */
ShvStatus shv_fragments_count_at(ShvFragments *fragments, const ShvCohesive *cohesive, const ShvState *state,
                                 double limit, int32_t *count, ShvError *error);
/* The tet that a bonded facet joins to an element across one of its faces, −1: none. */
int32_t shv_fragments_bonded_neighbour(const ShvFragments *fragments, int32_t element, int32_t face);

/* Mass, volume, surface, centre, inertia and radius from the fragment's element and node lists. */
void shv_fragment_measure(ShvFragment *fragment, const ShvFragments *fragments, const ShvModel *model,
                          const ShvState *state);
/* m²: of the faces to other fragments and to the outside. */
double shv_fragment_surface_area(const ShvFragment *fragment, const ShvFragments *fragments, const ShvModel *model,
                                 const ShvState *state);
/* Nodes on the fragment's surface, faces of cracks without bond included, increasing; the caller releases *nodes (SHV_PART_RIGID). The
   lists must be those of the present connectivity (shv_fragments_split after the last duplication). */
ShvStatus shv_fragment_surface(const ShvFragments *fragments, const ShvModel *model, const ShvState *state,
                               int32_t fragment, int32_t **nodes, int32_t *count, ShvError *error);
/* The faces of that surface, 4 × element + face, and those of cracks whose nodes were split, with a bond or not; the caller
   releases *faces (SHV_PART_RIGID). */
ShvStatus shv_fragment_faces(const ShvFragments *fragments, const ShvState *state, int32_t fragment, int32_t **faces,
                             int32_t *count, ShvError *error);

/* Rigid motion of a deforming fragment: centre of mass, best-fit rotation (polar factor of Σ m x Xᵀ; what the nodes do
   not determine, as about the line of collinear nodes, stays as it was), velocity P/m, and the angular velocity that gives
   the rigid fragment in that pose the same L (`inertia` turned; pseudo-inverse when degenerate). Velocities as they stand:
   the caller gives those of the present time. */
void shv_fragment_fit(ShvFragment *fragment, const ShvFragments *fragments, const ShvState *state);
/* Writes positions and velocities of the rigid motion to the fragment's nodes. */
void shv_fragment_scatter(const ShvFragment *fragment, const ShvFragments *fragments, ShvState *state);
/* Turns and moves the nodes of a deformed fragment from the pose at rest to that of the record, with the velocities of a rigid
   motion that has the record's momentum and angular momentum. What the deformation does to the inertia changes the kinetic
   energy in proportion to the strain. */
void shv_fragment_unfold(const ShvFragment *fragment, const ShvFragments *fragments, ShvState *state);
/* Momentum and angular momentum (about the origin) of the fragment's nodes, kinetic energy of them. */
void shv_fragment_momentum(const ShvFragment *fragment, const ShvFragments *fragments, const ShvState *state,
                           ShvVec3 *momentum, ShvVec3 *angular_momentum, double *kinetic);
/* Where a node of a rigid fragment stands about the centre, in the fragment's axes, m: in the shape at the start, or in that in
   which it came to rest. */
ShvVec3 shv_fragment_shape_position(const ShvFragment *fragment, const ShvState *state, int32_t node);
/* Inertia about the centre in world axes. */
ShvMat3 shv_fragment_world_inertia(const ShvFragment *fragment);
/* Kinetic energy of its rotation about its centre, J. */
double shv_fragment_rotational(const ShvFragment *fragment);
/* Kinetic energy of the rigid motion, J. */
double shv_fragment_kinetic(const ShvFragment *fragment);
/* Of the rigid motion, at a point in space. */
/* Neither come apart nor out of the scene. */
static inline bool shv_fragment_is_present(const ShvFragment *fragment)
{
    return fragment->mode == SHV_MODE_FLIGHT || fragment->mode == SHV_MODE_FRACTURE;
}

static inline ShvVec3 shv_fragment_velocity(const ShvFragment *fragment, ShvVec3 point)
{
    return shv_velocity_at(fragment->velocity, fragment->angular_velocity, shv_sub(point, fragment->position));
}

#endif
