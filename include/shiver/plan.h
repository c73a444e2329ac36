/* What a scene needs, and what to expect of it, before anything is run. */
#ifndef SHIVER_PLAN_H
#define SHIVER_PLAN_H

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where the mesh of an object must resolve cracks. */
typedef enum ShvBreaking {
    SHV_BREAKING_ANYWHERE,
    SHV_BREAKING_PLANE, /* beside facets on the plane that cracks keep to */
    SHV_BREAKING_TIPS   /* at edges that the body goes round by more than 300 degrees: tips of notches and cracks */
} ShvBreaking;
/* "anywhere", "plane", "tips". */
const char *shv_breaking_name(ShvBreaking breaking);

/* Physics of one object, SI. */
typedef struct ShvPreflight {
    const char *object, *material;
    ShvMaterialView cohesion; /* of its material; strength and energy in effect hold for the figures below */
    int32_t tets, nodes;
    double mass, volume; /* lumped mass, kg; m³ */
    double shortest_edge, mean_edge, longest_edge, smallest_altitude;
    double worst_aspect;      /* 3 × inradius / circumradius */
    double smallest_dihedral; /* degrees */
    double wall_share, wall_thickness,
        wall_edge;             /* of its surface, that is of walls thinner than three edges; their means, m */
    double wall_stiffness;     /* of such a wall in bending on this mesh, over what it should be; 1 without one */
    bool smoothed;             /* strain is averaged over the tets round each edge */
    bool ordered;              /* a box whose nodes stand in rank and file, and could stand without */
    bool improvable;           /* tets from elsewhere that `improve` has not bettered */
    double stable_step;        /* s, smallest exact element step */
    int32_t stable_element;    /* of the joint mesh: the tet that sets it */
    double stable_centroid[3]; /* m, world at the start */
    double step;               /* s: the step that will be used while nothing is cracking */
    double courant;            /* step / stable_step of this object */
    double bar_speed, dilatational_speed; /* m/s */
    bool breakable;
    double cohesive_zone; /* m: (π/8) E/(1−ν²) G/σ²; 5-10 elements resolve it */
    double snap_back;     /* m: 2 E G/σ²; elements longer than this snap back */
    ShvBreaking breaking; /* where it is expected to break; */
    int32_t breaking_tets;
    double breaking_mean_edge, breaking_longest_edge; /* m, there; the latter of all tets where cracks may run on */
    bool
        never_parts; /* bonds are to hold pieces together, and facets fail only when open by more than an edge, or never */
    double final_opening; /* m */
    double opening_speed; /* m/s: 2 σ/(ρ c₀), a free crack face under the strength */
    double cohesive_step; /* s: final opening / opening speed */
    double steps_to_open; /* cohesive_step / step */
    const char *nearest;  /* the object or obstacle whose surface is nearest at the start; NULL: there is none */
    bool nearest_is_obstacle;
    double clearance; /* m: from it, surface to surface; 0 where they touch or overlap */
    double
        impact_speed; /* m/s: the largest at which it would reach an obstacle, or the object nearest to it, straight on
                                   by the shortest way; of two objects both fall (NaN: it goes towards none) */
    double
        overshoot_each_step; /* growth of stress / strength in one step when it meets a rigid wall at that speed (NaN) */
    double centrifugal_stress;  /* Pa: at the start, estimated (3 × energy of rotation / volume) */
    bool wakes_by_spin;         /* that is enough to wake it */
    double bar_transit;         /* s: longest extent / bar speed */
    double bending_period;      /* s: of a free plate of its extents */
    double vibration_time;      /* s: for which it may vibrate before it rests (fracture.longest) */
    double flight_interval;     /* s: what an impact wakes stays in fracture mode to the end of one; 0: it need not */
    double extent[3];           /* m: bounding box at the start */
    const char *small_obstacle; /* the smallest that is smaller than a mean edge, NULL: none */
    double small_obstacle_size; /* m: its least extent */
} ShvPreflight;

/* Number of objects; fills `preflight` for one of them. */
int32_t shv_simulation_object_count(const ShvSimulation *simulation);
ShvStatus shv_simulation_preflight(const ShvSimulation *simulation, int32_t object, ShvPreflight *preflight,
                                   ShvError *error);

/* Two that overlap at the start, by their true surfaces. */
typedef struct ShvOverlap {
    const char *first, *second; /* an object, and another or an obstacle; or a free obstacle and another */
    bool obstacle;
    /* m: how far the deepest point tried lies inside: corners and middles of triangles of both, middles of edges that pass
       through, and, where none of these is inside, centroids of tets */
    double depth;
    double point[3]; /* m, world */
    /* Moved by `parting` (m; three digits, rounded up) the mover, one of the two objects, is out of the other. */
    const char *mover;
    double parting[3];
} ShvOverlap;

/* Overlaps deeper than a millionth of the smaller of the two, of a simulation that has not started; only a scene that keeps
   overlaps can have some. *count is how many there are, of which the `room` deepest are stored, deepest first. */
ShvStatus shv_simulation_overlaps(const ShvSimulation *simulation, ShvOverlap *overlaps, int32_t room, int32_t *count,
                                  ShvError *error);
/* What the run does about it. */
const char *shv_simulation_overlap_course(const ShvSimulation *simulation, const ShvOverlap *overlap);

/* One part of the program, on or off for this scene. */
typedef struct ShvPlanPart {
    const char *name;
    bool on;
    char reason[160];
    size_t bytes; /* held before the first crack; the parts' sum is the plan's */
} ShvPlanPart;

/* What a simulation did in a trial, and what that says of the whole run. Times of processor are those of the calling thread:
   the run time on a machine that has nothing else to do. */
typedef struct ShvTrial {
    double seconds, processor;      /* s: run time that the trial took, and of it processor time; 0: none was made */
    double time;                    /* s: the simulated time that it reached */
    bool finished;                  /* that is the scene's end */
    double first_wake, first_crack; /* s: simulated; NaN: not reached */
    double awake;                   /* s: simulated with a fragment in fracture mode */
    int64_t steps;                  /* of fracture mode */
    int32_t inserted, fragments;    /* cohesive facets; living fragments */
    int32_t untouched; /* bodies that can break and have not been in fracture mode yet: no bound knows of them */
    /* s of processor time, of the whole run without its file. `low`: no step costs more than the last ones, and what is awake
       rests as soon as its waves allow. `high`: steps go on getting dearer as they did, and it stays awake for the longest time
       that the quiet rule grants it; five times that where something has cracked, for what wakes again. `predicted`: steps
       cost what they did on the whole; bodies that carry too much vibration to rest stay for the longest time, others for the
       geometric mean of least and longest. What wakes later is in `high` alone. */
    double low, predicted, high;
} ShvTrial;

typedef struct ShvPlan {
    ShvPlanPart parts[16];
    int32_t part_count;
    size_t bytes;                 /* all, before the first crack */
    size_t bars;                  /* of them bars, held or to come */
    double step;                  /* s: of fracture mode, while nothing is cracking */
    double seconds_per_step;      /* measured now on this machine: one step of everything awake, without cracks */
    double steps_per_millisecond; /* of awake time */
    double first_contact; /* s: when the first bounding sphere meets an obstacle on its free path; infinity: never */
    double awake_time;    /* s: least awake time after that contact (the quiet rule's shortest window), or the whole
                                         duration for objects that conditions hold */
    /* s: how long a body may stay awake after its last crack until it rests whatever it carries (fracture.longest, or 20 transits of
       its bending wave; five times that where a crack in it holds); 0: nothing can crack */
    double longest_window;
    double predicted_steps;   /* of fracture mode, if it wakes once */
    double predicted_seconds; /* for those steps, if nothing cracks */
    int32_t frames;           /* of the animation grid */
    ShvTrial trial;
} ShvPlan;
/* From the simulation as it was made, which stays as it is. Bytes are those held now and those of bars to come. */
ShvStatus shv_simulation_plan(ShvSimulation *simulation, ShvPlan *plan, ShvError *error);
/* Runs a planned simulation, in memory, for about so many seconds of processor time (at most four times that of run time) or to
   its end, and fills the plan's `trial`. Its bytes become those held at the last time before the first crack; while that is
   not reached, bars to come are counted too. The simulation has left its start then: it can go on,
   but not with the bits of a run that nothing looked at in between. Its own `stop` is asked as ever. */
ShvStatus shv_simulation_try(ShvSimulation *simulation, double seconds, ShvPlan *plan, ShvError *error);

/* What is awake, and how long it is expected to stay so if nothing breaks or wakes again: for a guess of the run time to go. */
typedef struct ShvAwakeView {
    double load;  /* tets awake, and a tenth of all tets for costs that few tets have, too; 0: no steps are made */
    double ahead; /* s: of `load`, summed from now to the end of the scene or until all is expected to rest */
    double rest;  /* s: the time at which the last of it is expected to rest, or the scene's end */
    double step;  /* s: the last step of fracture mode; 0: none yet */
} ShvAwakeView;
/* Changes nothing, and may be asked from `stop`. It looks at every awake tet, as a step does. */
ShvAwakeView shv_simulation_awake(const ShvSimulation *simulation);

#ifdef __cplusplus
}
#endif
#endif
