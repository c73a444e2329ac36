/* Which nodes may soon meet which facets, and which sharp edges each other. */
#ifndef SHV_CONTACT_SURFACE_CANDIDATES_H
#define SHV_CONTACT_SURFACE_CANDIDATES_H

#include "contact/surface_contact.h"

/* Makes lists and candidates anew when they may no longer hold, and adds those of cracks that have parted. What it decides
   depends on the state at time n and the velocities before it alone, so that it does not matter how often it is called for
   one time. */
ShvStatus shv_surface_candidates_refresh(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                         double gravity, ShvError *error);
/* ---- parts of it ---- */

/* surface_speed.c: counts the step that led here, once, and returns whether candidates no longer hold (nodes that leave their skin aside:
   contact->rest is 0); the frame, skins
   and speed classes of all that is listed; of a node or facet that has come later. */
bool shv_surface_speed_count(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double gravity);
/* Steps, up to a number, that a node may be left to itself for; 0: it may leave its skin in the next. */
int32_t shv_surface_speed_steps(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                const ShvSurfaceNode *node, double step, double gravity, int32_t most);
void shv_surface_speed_choose(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step);
void shv_surface_speed_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvSurfaceNode *node,
                            double step);
void shv_surface_speed_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet);
/* Room per fragment. */
ShvStatus shv_surface_reserve_fragments(ShvSurfaceContact *contact, int32_t count, ShvError *error);
/* surface_grid.c: nodes and facets into their grids; how near nodes of a speed class must be to a facet to be its candidates, m. */
ShvStatus shv_surface_fill_grids(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error);
double shv_surface_reach(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet, int speed_class);
/* surface_pair.c: candidates of a facet, as all are chosen anew; of one that is new, or moved, since; of a node that is new, with
   the first so many facets, but for those that leave their skin just now; of an obstacle. */
ShvStatus shv_surface_pair_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                 const ShvSurfaceFacet *facet, ShvError *error);
ShvStatus shv_surface_pair_late_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                      const ShvSurfaceFacet *facet, ShvError *error);
ShvStatus shv_surface_pair_late_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                                     int32_t facets, ShvError *error);
ShvStatus shv_surface_pair_obstacle(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t obstacle,
                                    ShvError *error);
/* surface_edge_pair.c: sharp edges of a facet, which have been marked, with all others where one of the two deforms, as all candidates
   are chosen anew; of one that is new, or moved, since, with those of the first so many facets; of one whose body has woken. */
ShvStatus shv_surface_pair_edges(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                 ShvError *error);
ShvStatus shv_surface_pair_late_edges(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                      int32_t facets, ShvError *error);
ShvStatus shv_surface_pair_woken_edges(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                       ShvError *error);
/* surface_skin.c: nodes that are about to leave their skin get a new one from where they are, and their candidates are
   chosen anew. *many: so many that all should be. */
ShvStatus shv_surface_renew_out_of_skin(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                        double gravity, bool *many, ShvError *error);
/* surface_follow.c: candidates go on after insertions, splits and coupled bodies that woke. *lost: they cannot. */
ShvStatus shv_surface_follow(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool *lost, ShvError *error);
/* One more candidate; the nodes of both sides that deform are watched. */
ShvStatus shv_surface_candidate_append(ShvSurfaceContact *contact, ShvSurfaceCandidates *list,
                                       const ShvSurfaceCandidate *candidate, double due, uint8_t movers,
                                       ShvError *error);
ShvStatus shv_surface_candidate_watch(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                      const ShvSurfaceCandidate *candidate, ShvError *error);
/* The same, to the list it belongs to: `own` and `other` are the movers of both sides, `distance` how far they have to go, m. */
ShvStatus shv_surface_candidate_add(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                    const ShvSurfaceCandidate *candidate, int own, int other, double distance,
                                    ShvError *error);
/* Largest speeds against the frame of the nodes of candidates and of obstacles, m/s, into contact->speed. */
void shv_surface_candidates_advance(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies);

#endif
