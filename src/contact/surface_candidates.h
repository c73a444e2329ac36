/* Which nodes may soon meet which facets, and which sharp edges each other. */
#ifndef SHV_CONTACT_SURFACE_CANDIDATES_H
#define SHV_CONTACT_SURFACE_CANDIDATES_H

#include "contact/surface_contact.h"

/* Sizes of facets: so near an obstacle nodes inside of a body are listed when all lists are rebuilt. */
#define SHV_SURFACE_INNER 4.0

/* Makes lists and candidates anew when they may no longer hold, and adds those of cracks that have separated. What it decides
   depends on the state at time n and the velocities before it alone, so that it does not matter how often it is called for
   one time. */
ShvStatus shv_surface_candidates_refresh(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                         ShvError *error);
/* Largest speeds against the frame of the nodes of candidates and of obstacles, m/s, into contact->speed. Twice a step: the way
   that was gone is that of the velocities after contact, the way to come that of those after the kick. */
void shv_surface_measure_speeds(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies);
/* One more candidate; the nodes of both sides that deform are watched. `distance`: how far both have to go at least, m. */
ShvStatus shv_surface_candidate_add(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                    const ShvSurfaceCandidate *candidate, double distance, ShvError *error);
/* Names the node, and the facet's tet and nodes, of the places in a candidate. */
void shv_surface_candidate_name(const ShvSurfaceList *list, ShvSurfaceCandidate *candidate);
/* Sum of the paths of both sides of what deforms, and obstacles, m: their distance has changed by no more. */
double shv_surface_candidate_path(const ShvSurfaceContact *contact, const ShvMotionBound *due);
/* Whether a side of it has looked for its candidates anew since. */
bool shv_surface_candidate_is_void(const ShvSurfaceContact *contact, const ShvSurfaceCandidate *candidate);

/* narrow_phase.c: the pairs that may meet within `step` from now, in the order of their numbers, whatever the candidates were.
   Between coupled bodies it looks once in contact->detection_interval steps, that far ahead. */
ShvStatus shv_narrow_phase(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error);

/* ---- parts of it ---- */

/* surface_speed.c: counts the step that led here, once, and returns whether candidates no longer hold (nodes and coupled bodies that
   leave their skin aside: contact->steps_to_check is 0). */
bool shv_surface_speed_count(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies);
/* Steps until coupled bodies are looked at together again: what flies past its neighbours is looked at more often. */
int32_t shv_surface_detection_interval(const ShvSurfaceContact *contact, double step);
/* Steps, up to a number, that a node may be left to itself for; 0: it may leave its skin in the next. */
int32_t shv_surface_speed_steps(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                const ShvSurfaceNode *node, double step, int32_t most);
/* Whether a coupled body may leave its skin before it is looked at next. */
bool shv_surface_speed_leaves(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t fragment,
                              double step);
/* The frame, skins and speed classes of all that is listed; of a node or facet that is where it is now. */
void shv_surface_speed_choose(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step);
void shv_surface_speed_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvSurfaceNode *node,
                            double step);
void shv_surface_speed_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet);
/* surface_grid.c: nodes and facets into their grids, all of them or one; how near nodes of a speed class must be to a facet to be its
   candidates, m. */
ShvStatus shv_surface_fill_grids(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error);
ShvStatus shv_surface_put_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                               ShvError *error);
ShvStatus shv_surface_put_facet(ShvSurfaceContact *contact, int32_t place, ShvError *error);
double shv_surface_reach(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet, int speed_class);
/* surface_pair.c: candidates of a facet, with all nodes; of a node, with all facets but those that look for theirs in the present
   rebuild; of both, with obstacles. */
ShvStatus shv_surface_pair_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                 ShvError *error);
ShvStatus shv_surface_pair_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                                ShvError *error);
ShvStatus shv_surface_pair_node_obstacles(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                                          ShvError *error);
ShvStatus shv_surface_pair_facet_obstacles(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                           ShvError *error);
/* surface_edge_pair.c: sharp edges of a facet, which have been marked, with all others where one of the two deforms. */
ShvStatus shv_surface_pair_edges(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                 ShvError *error);
/* surface_rebuild.c: nodes that are about to leave their skin, and those whose candidates are no longer all, look for their candidates
   anew from where they are. *many: so many that all should. */
ShvStatus shv_surface_rebuild_outdated(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                       bool *many, ShvError *error);
/* surface_follow.c: candidates go on after insertions, splits and coupled bodies that woke. *lost: they cannot. */
ShvStatus shv_surface_follow(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool *lost, ShvError *error);
/* Marks the fragments in which a crack runs, from one of the cohesive facets on. */
void shv_surface_mark_cracked(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t first);

#endif
