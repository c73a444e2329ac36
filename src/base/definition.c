#include "shiver/definition.h"

#include <math.h>

/* NaN marks a number that the user must give, or one whose absence has a meaning of its own (see the header). */
static const double unset = (double)NAN;

ShvMaterialDefinition shv_material_default(void)
{
    return (ShvMaterialDefinition){.cookie = SHV_DEFINITION_COOKIE,
                                   .density = unset,
                                   .youngs_modulus = unset,
                                   .poissons_ratio = unset,
                                   .kinematics = SHV_GREEN_STRAIN,
                                   .breakable = true,
                                   .law = SHV_PPR,
                                   .fracture_energy = unset,
                                   .cohesive_strength = unset,
                                   .fracture_energy_shear = unset,
                                   .cohesive_strength_shear = unset,
                                   .ppr_shape = 2.0,
                                   .ppr_shape_shear = unset,
                                   .loss_factor = 0.0,
                                   .face_restitution = 0.0,
                                   .friction_angle_degrees = 0.0,
                                   .zone_edges = 5.0};
}

ShvMeshDefinition shv_mesh_default(void)
{
    return (ShvMeshDefinition){
        .cookie = SHV_DEFINITION_COOKIE, .kind = SHV_MESH_BOX, .notch_growth = 0.3, .scale = 1.0, .layers = 1};
}

/* At the origin, unturned, at rest; the axis is a valid one, so that an angle alone turns about z. */
static ShvPlacement placement_default(void)
{
    return (ShvPlacement){.rotation_axis = {0.0, 0.0, 1.0}};
}

ShvObjectDefinition shv_object_default(void)
{
    return (ShvObjectDefinition){
        .cookie = SHV_DEFINITION_COOKIE, .mesh = shv_mesh_default(), .placement = placement_default()};
}

ShvConditionDefinition shv_condition_default(void)
{
    return (ShvConditionDefinition){
        .cookie = SHV_DEFINITION_COOKIE, .kind = SHV_CONDITION_SUPPORT, .end = (double)INFINITY};
}

ShvObstacleDefinition shv_obstacle_default(void)
{
    return (ShvObstacleDefinition){.cookie = SHV_DEFINITION_COOKIE,
                                   .shape = SHV_OBSTACLE_PLANE,
                                   .scale = 1.0,
                                   .motion = SHV_OBSTACLE_FIXED,
                                   .placement = placement_default()};
}

ShvProbeDefinition shv_probe_default(void)
{
    return (ShvProbeDefinition){.cookie = SHV_DEFINITION_COOKIE};
}

ShvEventDefinition shv_event_default(void)
{
    return (ShvEventDefinition){.cookie = SHV_DEFINITION_COOKIE};
}

static ShvRigidDefinition rigid_default(void)
{
    return (ShvRigidDefinition){.engine = SHV_RIGID_BULLET,
                                .time_step = 1e-3,
                                .wake = SHV_WAKE_STRESS,
                                .wake_fraction = 0.5,
                                .wake_factor = 6.0,
                                .friction = 0.5,
                                .bullet = {true, true, true, true, true, true}};
}

static ShvFractureDefinition fracture_default(void)
{
    return (ShvFractureDefinition){.enabled = true,
                                   .time_step = unset,
                                   .safety = 0.9,
                                   .check_every = 0,
                                   .threshold = 1.0,
                                   .criterion = SHV_CRITERION_FORCE,
                                   .activation = SHV_ACTIVATION_TRACTION,
                                   .regularisation = 0.005,
                                   .connectivity = SHV_CONNECTIVITY_BONDS,
                                   .quiet_checks = 20,
                                   .longest = 0.0,
                                   .energy_bound = 0.05};
}

ShvSceneDefinition shv_scene_default(void)
{
    return (ShvSceneDefinition){.cookie = SHV_DEFINITION_COOKIE,
                                .overlaps = SHV_OVERLAPS_REFUSE,
                                .gravity = {0.0, 0.0, -9.81},
                                .rigid = rigid_default(),
                                .pbd = {.stiffness = 1.0, .iterations = 4, .damping = 1.0},
                                .bullet_plain = {.unit = 1.0, .margin = 0.04},
                                .fracture = fracture_default(),
                                .audit = {(double)INFINITY, (double)INFINITY, (double)INFINITY},
                                .output = {.rate = 240.0,
                                           .probe_every = 1,
                                           .nodes_within = {.to = HUGE_VAL,
                                                            .every = 1,
                                                            .box = {.kind = SHV_SELECT_BOX,
                                                                    .box_min = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
                                                                    .box_max = {HUGE_VAL, HUGE_VAL, HUGE_VAL}}}},
                                .survival = {.broken = 0.95},
                                .duration = unset};
}

const char *shv_rigid_engine_name(ShvRigidEngine engine)
{
    static const char *const names[] = {"analytic", "pbd", "bullet", "bullet_plain"};
    return names[engine];
}

bool shv_nodes_limited(const ShvNodesWithin *within)
{
    bool limited = within->from > 0.0 || !isinf(within->to) || within->every > 1;
    for (int k = 0; k < 3; k++) limited |= !isinf(within->box.box_min[k]) || !isinf(within->box.box_max[k]);
    return limited;
}
