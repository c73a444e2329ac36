/* A simulation driven live: to any time, with pushes, bodies that come and go, and events told as they happen. Time goes on past the
   scene's duration. Every call brings the frame view (shv_simulation_frame) to the present time. */
#ifndef SHIVER_LIVE_H
#define SHIVER_LIVE_H

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Goes on to `until`, s; not before the present time. After SHV_DIVERGED or SHV_INTERRUPTED the frame shows the last consistent
   state. */
ShvStatus shv_simulation_step(ShvSimulation *simulation, double until, ShvError *error);

/* Calls `listener` for every event of a step, in their order, at the end of that step; NULL: nobody. */
typedef void (*ShvListener)(void *data, const ShvEventView *event);
void shv_simulation_listen(ShvSimulation *simulation, ShvListener listener, void *data);

/* What the time line of a scene can do, now; the event's own time does not count. A force F over a step of Δt is the impulse F Δt. */
ShvStatus shv_simulation_apply(ShvSimulation *simulation, const ShvEventDefinition *event, ShvError *error);
/* An impulse, N s, at a world point, on one fragment that flies or deforms. */
ShvStatus shv_simulation_push(ShvSimulation *simulation, int32_t fragment, const double impulse[3],
                              const double point[3], ShvError *error);

/* Brings an object or a free obstacle that waits (`waits` in its definition, or it has left) to a place, with a velocity; an
   object must be whole. Refused where it would stand in another: corners and centroids of tets are tried against tets and
   obstacles. */
ShvStatus shv_simulation_enter(ShvSimulation *simulation, const char *name, const ShvPlacement *placement,
                               ShvError *error);
/* Takes out all that is left of an object, or a free obstacle; and one fragment. What is in fracture mode cannot leave. */
ShvStatus shv_simulation_leave(ShvSimulation *simulation, const char *name, ShvError *error);
ShvStatus shv_simulation_remove(ShvSimulation *simulation, int32_t fragment, ShvError *error);

/* Size in bytes of a public struct by name ("ShvFrameView"); 0: none of that name. For programs in other languages, which repeat
   the structs: they find out whether they repeat those of this library. */
size_t shv_struct_size(const char *name);

#ifdef __cplusplus
}
#endif
#endif
