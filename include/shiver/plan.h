/* What a scene needs, and what to expect of it, before anything is run. */
#ifndef SHIVER_PLAN_H
#define SHIVER_PLAN_H

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Physics of one object, SI. */
typedef struct ShvPreflight {
    const char *object, *material;
    ShvMaterialView cohesion; /* of its material; strength and energy in effect hold for the figures below */
    int32_t tets, nodes;
    double mass, volume; /* lumped mass, kg; m³ */
    double shortest_edge, mean_edge, longest_edge, smallest_altitude;
    double worst_aspect;                  /* 3 × inradius / circumradius */
    double stable_step;                   /* s, smallest exact element step */
    int32_t stable_element;               /* of the joint mesh: the tet that sets it */
    double stable_centroid[3];            /* m, world at the start */
    double step;                          /* s: the step that will be used while nothing is cracking */
    double courant;                       /* step / stable_step of this object */
    double bar_speed, dilatational_speed; /* m/s */
    bool breakable;
    double cohesive_zone;       /* m: (π/8) E/(1−ν²) G/σ²; 5-10 elements resolve it */
    double snap_back;           /* m: 2 E G/σ²; elements longer than this snap back */
    double final_opening;       /* m */
    double opening_speed;       /* m/s: 2 σ/(ρ c₀), a free crack face under the strength */
    double cohesive_step;       /* s: final opening / opening speed */
    double steps_to_open;       /* cohesive_step / step */
    double overshoot_each_step; /* growth of stress / strength in one step when the object meets a rigid wall at its
                                                 own speed of the first contact (NaN: nothing to meet) */
    double bar_transit;         /* s: longest extent / bar speed */
    double bending_period;      /* s: of a free plate of its extents */
    double extent[3];           /* m: bounding box at the start */
} ShvPreflight;

/* Number of objects; fills `preflight` for one of them. */
int32_t shv_simulation_object_count(const ShvSimulation *simulation);
ShvStatus shv_simulation_preflight(const ShvSimulation *simulation, int32_t object, ShvPreflight *preflight,
                                   ShvError *error);

/* One part of the program, on or off for this scene. */
typedef struct ShvPlanPart {
    const char *name;
    bool on;
    char reason[160];
    size_t bytes; /* held before the first crack */
} ShvPlanPart;

typedef struct ShvPlan {
    ShvPlanPart parts[16];
    int32_t part_count;
    size_t bytes;                 /* all, before the first crack */
    double step;                  /* s: of fracture mode, while nothing is cracking */
    double seconds_per_step;      /* measured now on this machine: one step of everything awake */
    double steps_per_millisecond; /* of awake time */
    double first_contact;         /* s: when the first fragment meets an obstacle on its free path; infinity: never */
    double awake_time;        /* s: least awake time after that contact (the quiet rule's shortest window), or the whole
                                         duration for objects that conditions hold */
    double predicted_steps;   /* of fracture mode, if it wakes once */
    double predicted_seconds; /* for those steps */
    int32_t frames;           /* of the animation grid */
} ShvPlan;
ShvStatus shv_simulation_plan(ShvSimulation *simulation, ShvPlan *plan, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
