#include "scene/schema.h"

#include <math.h>

#define LENGTH_OF(array) ((int)(sizeof(array) / sizeof *(array)))
#define INFINITE         ((double)INFINITY)

static const ShvRange positive = {0.0, INFINITE, true, false}, not_negative = {0.0, INFINITE, false, false};
static const ShvRange share = {0.0, 1.0, false, false}, positive_share = {0.0, 1.0, true, false};
static const ShvRange open_share = {0.0, 1.0, true, true}, above_one = {1.0, INFINITE, true, false};
static const ShvRange at_least_one = {1.0, INFINITE, false, false}, poisson = {-1.0, 0.5, true, true};
static const ShvRange jitter = {0.0, 0.3, false, false}, copies = {1.0, 65535.0, false, false};
static const ShvRange growth = {0.0, 0.8, true, false}, friction_angle = {0.0, 90.0, false, true};
static const ShvRange version = {1.0, 1.0, false, false}, threads = {0.0, 1024.0, false, false};

/* An axis and an angle lie side by side in placements and keyframes; one table reads both. */
typedef struct Rotation {
    double axis[3], degrees;
} Rotation;
#define SAME_AS_ROTATION(type)                                                                                         \
    _Static_assert(offsetof(type, rotation_degrees) - offsetof(type, rotation_axis) == offsetof(Rotation, degrees),    \
                   "the rotation table fits " #type)
SAME_AS_ROTATION(ShvPlacement);
SAME_AS_ROTATION(ShvKeyframe);

/* Choices are written through int. */
_Static_assert(sizeof(ShvKinematics) == sizeof(int) && sizeof(ShvCohesiveLaw) == sizeof(int) &&
                   sizeof(ShvRigidEngine) == sizeof(int) && sizeof(ShvWake) == sizeof(int) &&
                   sizeof(ShvStabiliser) == sizeof(int) && sizeof(ShvCriterion) == sizeof(int) &&
                   sizeof(ShvActivation) == sizeof(int) && sizeof(ShvMeshKind) == sizeof(int) &&
                   sizeof(ShvSelectionKind) == sizeof(int) && sizeof(ShvObstacleShape) == sizeof(int) &&
                   sizeof(ShvEventKind) == sizeof(int) && sizeof(ShvProbeKind) == sizeof(int) &&
                   sizeof(ShvBarForm) == sizeof(int) && sizeof(ShvMeshPattern) == sizeof(int) &&
                   sizeof(ShvReferenceLaw) == sizeof(int) && sizeof(ShvDust) == sizeof(int) &&
                   sizeof(ShvDeformation) == sizeof(int) && sizeof(ShvUnresolved) == sizeof(int) &&
                   sizeof(ShvOverlapPolicy) == sizeof(int),
               "an enum has the size of int");

/* ---- pieces that several tables share ----------------------------------------------------------------- */

static const ShvKey rotation_keys[] = {
    {"axis", SHV_KEY_VECTOR, .flags = SHV_KEY_DIRECTION, .offset = offsetof(Rotation, axis),
     .sentence = "Axis through the origin of the mesh; need not be of unit length."},
    {"angle", SHV_KEY_NUMBER, SHV_DIMENSION_ANGLE, SHV_KEY_REQUIRED, .offset = offsetof(Rotation, degrees),
     .sentence = "Angle, by the right-hand rule."},
};
#define ROTATION_TABLE(path, of)                                                                                       \
    {                                                                                                                  \
        .name = path ".rotation", .sentence = "Orientation of " of ".", .keys = rotation_keys,                         \
        .key_count = LENGTH_OF(rotation_keys)                                                                          \
    }
static const ShvTable object_rotation_table = ROTATION_TABLE("objects.<name>", "an object at the start");
static const ShvTable obstacle_rotation_table = ROTATION_TABLE("obstacles.<name>", "an obstacle at the start");
static const ShvTable keyframe_rotation_table =
    ROTATION_TABLE("obstacles.<name>.motion.<index>", "an obstacle at a keyframe");

#define POSITION_KEY(place, text)                                                                                      \
    {                                                                                                                  \
        "position", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, .offset = (place) + offsetof(ShvPlacement, position),        \
                                                          .sentence = text                                             \
    }
#define ROTATION_KEY(place, rotation)                                                                                  \
    {                                                                                                                  \
        "rotation", SHV_KEY_MAPPING, .table = &(rotation), .offset = (place) + offsetof(ShvPlacement, rotation_axis),  \
                                     .sentence = "Turns it about its own origin, before it is moved to `position`."    \
    }
#define VELOCITY_KEY(place)                                                                                            \
    {                                                                                                                  \
        "velocity", SHV_KEY_VECTOR, SHV_DIMENSION_VELOCITY, .offset = (place) + offsetof(ShvPlacement, velocity),      \
                                                            .sentence = "Velocity of the centre of mass at the start." \
    }
#define ANGULAR_VELOCITY_KEY(place)                                                                                    \
    {                                                                                                                  \
        "angular_velocity", SHV_KEY_VECTOR, SHV_DIMENSION_ANGULAR_VELOCITY,                                            \
            .offset = (place) + offsetof(ShvPlacement, angular_velocity),                                              \
            .sentence = "Angular velocity at the start, world axes, about the centre of mass."                         \
    }
#define FILE_KEY(key, member, text)                                                                                    \
    {                                                                                                                  \
        key, SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED | SHV_KEY_FILE, .offset = (member), .sentence = text              \
    }
#define SCALE_KEY(member)                                                                                              \
    {                                                                                                                  \
        "scale", SHV_KEY_NUMBER,                                                                                       \
            .range = &positive, .offset = (member),                                                                    \
            .sentence = "Multiplies every coordinate of the file: 0.001 for a file in millimetres."                    \
    }

/* ---- materials ---------------------------------------------------------------------------------------- */

#define MATERIAL(member) offsetof(ShvMaterialItem, definition.member)
static const ShvChoice kinematics_choices[] = {
    {"green", SHV_GREEN_STRAIN}, {"corotational", SHV_COROTATIONAL}, {NULL, 0}};
static const ShvChoice smoothing_choices[] = {{"none", SHV_SMOOTHING_NONE}, {"edges", SHV_SMOOTHING_EDGES}, {NULL, 0}};
static const ShvChoice law_choices[] = {{"ppr", SHV_PPR}, {"camacho_ortiz", SHV_CAMACHO_ORTIZ}, {NULL, 0}};
static const ShvKey weibull_keys[] = {
    {"modulus", SHV_KEY_NUMBER, .flags = SHV_KEY_REQUIRED, .range = &not_negative, .offset = MATERIAL(weibull_modulus),
     .sentence = "Weibull modulus: large means little scatter; 0 means none."},
    {"volume", SHV_KEY_NUMBER, SHV_DIMENSION_VOLUME, .range = &not_negative, .offset = MATERIAL(weibull_volume),
     .sentence = "Volume to which `cohesive_strength` belongs, of which a facet or a node of the surface has a part, "
                 "few flaws, and so "
                 "more strength; 0 gives all the same scatter, whatever their size."},
    {"area", SHV_KEY_NUMBER, SHV_DIMENSION_AREA, .range = &not_negative, .offset = MATERIAL(weibull_area),
     .sentence =
         "The same for a material whose flaws lie on its surface, as those of glass: the surface to which the strength "
         "belongs, in place of a volume."},
};
static const ShvTable weibull_table = {
    .name = "materials.<name>.weibull",
    .sentence =
        "Scatter of strength from facet to facet, and from node to node of a surface, drawn from the scene's seed.",
    .keys = weibull_keys,
    .key_count = LENGTH_OF(weibull_keys)};
static const ShvChoice unresolved_choices[] = {{"keep", SHV_UNRESOLVED_KEEP},
                                               {"scale_strength", SHV_UNRESOLVED_SCALE_STRENGTH},
                                               {"scale_energy", SHV_UNRESOLVED_SCALE_ENERGY},
                                               {"tip_strength", SHV_UNRESOLVED_TIP_STRENGTH},
                                               {NULL, 0}};
static const ShvKey material_keys[] = {
    {"library", SHV_KEY_TEXT, .offset = offsetof(ShvMaterialItem, library), .absent = "none",
     .sentence =
         "Name of a material of the program's own (docs/materials.md, `shiver materials`). It gives every number "
         "that is not given here."},
    {"density", SHV_KEY_NUMBER, SHV_DIMENSION_DENSITY, SHV_KEY_REQUIRED, &positive, .offset = MATERIAL(density),
     .sentence = "Mass density."},
    {"youngs_modulus", SHV_KEY_NUMBER, SHV_DIMENSION_PRESSURE, SHV_KEY_REQUIRED, &positive,
     .offset = MATERIAL(youngs_modulus), .sentence = "Young's modulus."},
    {"poissons_ratio", SHV_KEY_NUMBER, .flags = SHV_KEY_REQUIRED, .range = &poisson, .offset = MATERIAL(poissons_ratio),
     .sentence = "Poisson's ratio."},
    {"loss_factor", SHV_KEY_NUMBER, .range = &share, .offset = MATERIAL(loss_factor),
     .sentence =
         "Internal friction η: a vibration loses the share 2π η of its energy in a period. The slowest mode of each "
         "fragment in fracture mode does, reckoned from its size and the thickness of its walls; faster ones lose as "
         "much "
         "in the same time, less than they should. Flight and turning are not damped."},
    {"kinematics", SHV_KEY_CHOICE, .choices = kinematics_choices, .offset = MATERIAL(kinematics),
     .sentence = "Strain measure: Green strain with the St. Venant-Kirchhoff law, or linear elasticity in the rotated "
                 "frame of each element."},
    {"smoothing", SHV_KEY_CHOICE, .choices = smoothing_choices, .offset = MATERIAL(smoothing),
     .absent = "`edges` with `unresolved: tip_strength`, else `none`",
     .sentence =
         "`edges`: strain is averaged over the tetrahedra round each edge, so that walls about as thin as their edges "
         "bend, which linear tetrahedra make far too stiff (docs/walls.md). Elastic forces take about three times as "
         "long."},
    {"breakable", SHV_KEY_BOOLEAN, .offset = MATERIAL(breakable), .sentence = "Whether its facets can open."},
    {"law", SHV_KEY_CHOICE, .choices = law_choices, .offset = MATERIAL(law),
     .sentence = "Cohesive law: Park-Paulino-Roesler or Camacho-Ortiz."},
    {"fracture_energy", SHV_KEY_NUMBER, SHV_DIMENSION_SURFACE_ENERGY, .range = &not_negative,
     .offset = MATERIAL(fracture_energy), .absent = "required where breakable and of finite strength",
     .sentence = "Energy to open a unit of area in mode I."},
    {"cohesive_strength", SHV_KEY_NUMBER, SHV_DIMENSION_PRESSURE, SHV_KEY_INFINITE, &not_negative,
     .offset = MATERIAL(cohesive_strength), .absent = "required where breakable",
     .sentence = "Strength in mode I; `.inf` never opens."},
    {"fracture_energy_shear", SHV_KEY_NUMBER, SHV_DIMENSION_SURFACE_ENERGY, .range = &not_negative,
     .offset = MATERIAL(fracture_energy_shear), .absent = "`fracture_energy`",
     .sentence = "Energy to open a unit of area in mode II."},
    {"cohesive_strength_shear", SHV_KEY_NUMBER, SHV_DIMENSION_PRESSURE, SHV_KEY_INFINITE, &not_negative,
     .offset = MATERIAL(cohesive_strength_shear), .absent = "`cohesive_strength`", .sentence = "Strength in mode II."},
    {"ppr_shape", SHV_KEY_NUMBER, .range = &above_one, .offset = MATERIAL(ppr_shape),
     .sentence = "Shape α of the PPR softening curve in mode I: 2 is linear, above it brittle, below it plateau-like."},
    {"ppr_shape_shear", SHV_KEY_NUMBER, .range = &above_one, .offset = MATERIAL(ppr_shape_shear),
     .absent = "`ppr_shape`", .sentence = "Shape β in mode II."},
    {"weibull", SHV_KEY_MAPPING, .table = &weibull_table, .sentence = "Scatter of strength."},
    {"unresolved", SHV_KEY_CHOICE, .choices = unresolved_choices, .offset = MATERIAL(unresolved),
     .absent = "the library's word (docs/materials.md), else `keep`",
     .sentence =
         "What to do where the cohesive zone is shorter than `zone_edges` mean edges of the mesh. `keep`: nothing; "
         "crack tips are tougher than G. `scale_strength`: lower the strengths so far that the zone is so long; cracks "
         "cost G, but begin at less stress. `scale_energy`: raise the energies instead; cracks begin at the "
         "strength, but cost more. `tip_strength`: lower the strength only ahead of cracks, by so much that growth "
         "costs G; "
         "cracks begin at the strength and cost G (docs/glass.md); needs `fracture.criterion: force`. What is in "
         "effect "
         "is in every report."},
    {"face_restitution", SHV_KEY_NUMBER, .range = &share, .offset = MATERIAL(face_restitution),
     .sentence =
         "Of crack faces that have opened and close again: its square is the share of the energy of their impact that "
         "they give back when they part. 1: faces are elastic; 0: nothing comes back."},
    {"friction_angle", SHV_KEY_NUMBER, SHV_DIMENSION_ANGLE, .range = &friction_angle,
     .offset = MATERIAL(friction_angle_degrees),
     .sentence =
         "Angle φ of friction: under a pressure p facets bear p tan φ in shear besides the cohesion "
         "`cohesive_strength_shear`, which alone softens, and so do crack faces that are closed (docs/cohesive.md). "
         "0: pressure adds nothing. Not with `fracture.criterion: principal`, which judges tension alone."},
    {"zone_edges", SHV_KEY_NUMBER, .range = &at_least_one, .offset = MATERIAL(zone_edges),
     .sentence =
         "Mean edges that a resolved cohesive zone spans, of the coarsest object of the material; 5 to 10 are usual."},
};
static void start_material(void *item)
{
    *(ShvMaterialItem *)item = (ShvMaterialItem){.definition = shv_material_default()};
}
static const ShvTable material_table = {.name = "materials.<name>",
                                        .sentence = "A material.",
                                        .keys = material_keys,
                                        .key_count = LENGTH_OF(material_keys),
                                        .size = sizeof(ShvMaterialItem),
                                        .start = start_material};

/* ---- meshes ------------------------------------------------------------------------------------------- */

#define MESH(member) offsetof(ShvMeshDefinition, member)
#define EDGE_KEY                                                                                                       \
    {                                                                                                                  \
        "edge", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &positive,                                     \
            .offset = MESH(edge), .sentence = "Wanted edge length of the tetrahedra."                                  \
    }
#define RADIUS_KEY(text)                                                                                               \
    {                                                                                                                  \
        "radius", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &positive, .offset = MESH(radius),           \
                                                                                     .sentence = text                  \
    }
#define SIZE_KEY(text)                                                                                                 \
    {                                                                                                                  \
        "size", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &positive, .offset = MESH(size),               \
                                                                                   .sentence = text                    \
    }
#define MESH_TABLE(kind, text)                                                                                         \
    static const ShvTable kind##_table = {.name = "objects.<name>.mesh." #kind,                                        \
                                          .sentence = text,                                                            \
                                          .keys = kind##_keys,                                                         \
                                          .key_count = LENGTH_OF(kind##_keys)}

static const ShvChoice pattern_choices[] = {
    {"lattice", SHV_PATTERN_LATTICE}, {"bricks", SHV_PATTERN_BRICKS}, {NULL, 0}};
static const ShvChoice box_pattern_choices[] = {{"lattice", SHV_PATTERN_LATTICE},
                                                {"bricks", SHV_PATTERN_BRICKS},
                                                {"unstructured", SHV_PATTERN_UNSTRUCTURED},
                                                {NULL, 0}};
static const ShvKey box_keys[] = {
    SIZE_KEY("Edge lengths along x, y and z."),
    EDGE_KEY,
    {"pattern", SHV_KEY_CHOICE, .choices = box_pattern_choices, .offset = MESH(pattern),
     .sentence =
         "Tetrahedra of a body-centred lattice, or five in each brick of a grid, which have facets in planes across "
         "every axis, or tetrahedra in no order, made for `seed`, with at least two layers: nothing steers cracks."}};
MESH_TABLE(box, "A box, centred on its origin.");
static const ShvKey ball_keys[] = {RADIUS_KEY("Radius."), EDGE_KEY};
MESH_TABLE(ball, "A solid ball, centred on its origin.");
static const ShvKey hollow_ball_keys[] = {RADIUS_KEY("Outer radius."),
                                          {"thickness", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED,
                                           &positive, .offset = MESH(thickness),
                                           .sentence = "Thickness of the wall, less than the radius."},
                                          EDGE_KEY};
MESH_TABLE(hollow_ball, "A ball with a concentric hole, centred on its origin.");
static const ShvKey cylinder_keys[] = {
    RADIUS_KEY("Outer radius."),
    {"inner_radius", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, .range = &not_negative, .offset = MESH(inner_radius),
     .sentence = "Radius of a hole along the axis, less than the radius; 0 means solid."},
    {"height", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &positive, .offset = MESH(height),
     .sentence = "Height along z."},
    EDGE_KEY};
MESH_TABLE(cylinder, "A cylinder or tube along z, centred on its origin.");
static const ShvKey notched_beam_keys[] = {
    SIZE_KEY("Length along x, depth along y and height along z."),
    EDGE_KEY,
    {"notch_depth", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &positive, .offset = MESH(notch_depth),
     .sentence = "Depth of the notch from the lower face upwards, less than the height."},
    {"notch_offset", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, .offset = MESH(notch_offset),
     .sentence = "Where the notch is along x, from midspan."},
    {"notch_edge", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, .range = &not_negative, .offset = MESH(notch_edge),
     .sentence = "Edge length at the notch, graded to `edge` away from it; 0 means `edge`."},
    {"notch_growth", SHV_KEY_NUMBER, .range = &growth, .offset = MESH(notch_growth),
     .sentence = "How much the edge length grows per distance from the notch."},
    {"pattern", SHV_KEY_CHOICE, .choices = pattern_choices, .offset = MESH(pattern),
     .sentence =
         "Tetrahedra of a body-centred lattice, whose cells are halved towards the notch, or five in each brick "
         "of a grid, whose bricks grow thinner along x towards the notch."}};
MESH_TABLE(notched_beam, "A beam with a notch in its lower face, centred on its origin.");
#define IMPROVE_KEY                                                                                                    \
    {                                                                                                                  \
        "improve", SHV_KEY_BOOLEAN,                                                                                    \
            .offset = MESH(improve),                                                                                   \
            .sentence =                                                                                                \
                "Improves the tenth of the tets that is worst, which set the time step: other tets in the same "       \
                "room, other places of nodes, along smooth parts of the surface as well."                              \
    }

static const ShvKey gmsh_keys[] = {
    FILE_KEY("file", MESH(file), "File of tetrahedra: MSH 2.2 ASCII, or 4.1 ASCII or binary."), SCALE_KEY(MESH(scale)),
    IMPROVE_KEY};
MESH_TABLE(gmsh, "Tetrahedra of a Gmsh file.");
static const ShvKey tetgen_keys[] = {
    FILE_KEY("file", MESH(file), "Name of the .node file, or what .node and .ele files have in common."),
    SCALE_KEY(MESH(scale)), IMPROVE_KEY};
MESH_TABLE(tetgen, "Tetrahedra of TetGen's .node and .ele files.");
static const ShvKey shell_keys[] = {
    FILE_KEY("surface", MESH(file), "File of a closed triangle surface: OBJ, STL or PLY."),
    SCALE_KEY(MESH(scale)),
    {"thickness", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &positive, .offset = MESH(thickness),
     .sentence = "Thickness inwards from the surface, after scaling."},
    {"layers", SHV_KEY_INT32, .range = &at_least_one, .offset = MESH(layers),
     .sentence = "Layers of prisms, three tetrahedra each."},
    {"refine_to", SHV_KEY_INT64, .range = &not_negative, .offset = MESH(refine_to),
     .sentence = "Splits the longest edges until the surface has at least so many triangles; 0 leaves it."}};
MESH_TABLE(shell, "A shell, extruded from a surface.");

static const ShvKey stl_keys[] = {
    FILE_KEY("file", MESH(file),
             "File of a closed triangle surface (STL, OBJ, PLY), or of CAD that gmsh reads (STEP, IGES, BREP)."),
    SCALE_KEY(MESH(scale)), EDGE_KEY};
static const ShvKey memory_keys[] = {SCALE_KEY(MESH(scale)), IMPROVE_KEY};
MESH_TABLE(memory, "Tetrahedra that the calling program has (docs/library.md).");
MESH_TABLE(stl, "A body filled with tetrahedra by gmsh, which must be installed, each time that the scene is read.");

static const ShvKey corner_keys[] = {{"radius", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &not_negative,
                                      .offset = offsetof(ShvCornerItem, radius), .sentence = "Distance from the axis."},
                                     {"height", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED,
                                      .offset = offsetof(ShvCornerItem, height), .sentence = "Place along the axis."}};
static const ShvTable corner_table = {.name = "objects.<name>.mesh.turned.profile.<index>",
                                      .sentence = "A corner of a profile.",
                                      .keys = corner_keys,
                                      .key_count = LENGTH_OF(corner_keys),
                                      .size = sizeof(ShvCornerItem)};
/* The list lies in the object, behind its mesh. */
static const ShvKey turned_keys[] = {
    {"profile", SHV_KEY_LIST, .flags = SHV_KEY_REQUIRED, .table = &corner_table,
     .offset = offsetof(ShvObjectItem, profile) - offsetof(ShvObjectItem, definition.mesh),
     .sentence =
         "Corners of its profile in their order; the last joins the first, along the axis where both lie on it. "
         "Where it turns by 30° and more the body has an edge."},
    EDGE_KEY};
MESH_TABLE(turned, "What a closed profile sweeps when it is turned about z: an unstructured mesh, made for `seed`.");

#define MESH_KIND(kind, value, text)                                                                                   \
    {                                                                                                                  \
#kind, SHV_KEY_MAPPING, .flags = SHV_KEY_VARIANT, .table = &kind##_table, .variant = value, .sentence = text   \
    }
static const ShvKey mesh_keys[] = {
    MESH_KIND(box, SHV_MESH_BOX, "Makes a box."),
    MESH_KIND(ball, SHV_MESH_BALL, "Makes a solid ball."),
    MESH_KIND(hollow_ball, SHV_MESH_HOLLOW_BALL, "Makes a hollow ball."),
    MESH_KIND(cylinder, SHV_MESH_CYLINDER, "Makes a cylinder or tube."),
    MESH_KIND(notched_beam, SHV_MESH_NOTCHED_BEAM, "Makes a notched beam."),
    MESH_KIND(gmsh, SHV_MESH_GMSH, "Reads a Gmsh file."),
    MESH_KIND(tetgen, SHV_MESH_TETGEN, "Reads TetGen files."),
    MESH_KIND(shell, SHV_MESH_SHELL, "Extrudes a surface."),
    MESH_KIND(stl, SHV_MESH_STL, "Fills a surface, by gmsh."),
    MESH_KIND(turned, SHV_MESH_TURNED, "Turns a profile."),
    MESH_KIND(memory, SHV_MESH_MEMORY, "Takes what the calling program gives."),
    {"jitter", SHV_KEY_NUMBER, .range = &jitter, .offset = MESH(jitter),
     .sentence =
         "Random shift of nodes, as a share of the shortest edge that meets there, so that a regular mesh does not "
         "steer cracks. Surface nodes stay on the surface; the tenth of the tets that is worst then, which sets the "
         "step, is improved."},
    {"seed", SHV_KEY_UINT64, .offset = MESH(seed),
     .sentence = "Seed of the jitter, of an unstructured mesh, and of what `improve` tries."},
};
static const ShvTable mesh_table = {.name = "objects.<name>.mesh",
                                    .sentence =
                                        "The tetrahedra of an object: exactly one way to get them, and options.",
                                    .keys = mesh_keys,
                                    .key_count = LENGTH_OF(mesh_keys),
                                    .variants = true,
                                    .variant_offset = MESH(kind)};

/* ---- objects ------------------------------------------------------------------------------------------ */

#define OBJECT(member) offsetof(ShvObjectItem, definition.member)
static const ShvKey repeat_keys[] = {
    {"count", SHV_KEY_INT32, .flags = SHV_KEY_REQUIRED, .range = &copies,
     .offset = offsetof(ShvObjectItem, repeat_count), .absent = "",
     .sentence = "How many; they are named name_1, name_2, …"},
    {"offset", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, .offset = offsetof(ShvObjectItem, repeat_offset),
     .sentence = "From each to the next; the first is at `position`."},
    {"spread", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, .range = &not_negative,
     .offset = offsetof(ShvObjectItem, repeat_spread),
     .sentence = "Each is shifted at random, by up to half of this along each axis to either side."},
    {"turn", SHV_KEY_BOOLEAN, .offset = offsetof(ShvObjectItem, repeat_turn),
     .sentence = "Each is turned at random, all orientations alike."},
    {"seed", SHV_KEY_UINT64, .offset = offsetof(ShvObjectItem, repeat_seed),
     .sentence = "Seed of what is random here. What overlaps by it is refused: take another seed, or a larger offset."},
};
static const ShvTable repeat_table = {.name = "objects.<name>.repeat",
                                      .sentence = "A row or stack of equal objects.",
                                      .keys = repeat_keys,
                                      .key_count = LENGTH_OF(repeat_keys)};
/* ---- cracks that are there ---- */

#define SELECTION(member) offsetof(ShvSelection, member)
static const ShvKey select_box_keys[] = {
    {"min", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, .offset = SELECTION(box_min),
     .sentence = "Lower corner."},
    {"max", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, .offset = SELECTION(box_max),
     .sentence = "Upper corner, nowhere below the lower one."},
};
static const ShvKey select_plane_keys[] = {
    {"normal", SHV_KEY_VECTOR, .flags = SHV_KEY_REQUIRED | SHV_KEY_DIRECTION, .offset = SELECTION(plane_normal),
     .absent = "", .sentence = "Normal; need not be of unit length."},
    {"offset", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, .offset = SELECTION(plane_offset),
     .sentence = "Distance of the plane from the world's origin along its normal."},
    {"tolerance", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &not_negative, .offset = SELECTION(tolerance),
     .sentence = "How far from the plane still counts."},
};
static const ShvTable crack_plane_table = {.name = "objects.<name>.cracks.<index>.plane",
                                           .sentence = "The plane, in the world at the start.",
                                           .keys = select_plane_keys,
                                           .key_count = LENGTH_OF(select_plane_keys)};
static const ShvTable crack_box_table = {.name = "objects.<name>.cracks.<index>.box",
                                         .sentence = "The part of the plane that is cracked.",
                                         .keys = select_box_keys,
                                         .key_count = LENGTH_OF(select_box_keys)};
static const ShvKey crack_keys[] = {
    {"plane", SHV_KEY_MAPPING, .flags = SHV_KEY_REQUIRED, .table = &crack_plane_table,
     .offset = offsetof(ShvCrackItem, definition.plane), .sentence = "Facets with all corners near it."},
    {"box", SHV_KEY_MAPPING, .table = &crack_box_table, .offset = offsetof(ShvCrackItem, definition.box),
     .absent = "all of the plane", .sentence = "Those of them whose middle is in this box."},
};
static void start_crack(void *item)
{
    ShvCrackItem *crack = item;
    *crack = (ShvCrackItem){.definition.plane.kind = SHV_SELECT_PLANE, .definition.box.kind = SHV_SELECT_BOX};
    for (int k = 0; k < 3; k++) {
        crack->definition.box.box_min[k] = -HUGE_VAL;
        crack->definition.box.box_max[k] = HUGE_VAL;
    }
}
static const ShvTable crack_table = {.name = "objects.<name>.cracks.<index>",
                                     .sentence =
                                         "A crack that is there from the start: a slit of no width along facets of "
                                         "the mesh, whose lips have nodes of their own. One that meets no facet "
                                         "is an error.",
                                     .keys = crack_keys,
                                     .key_count = LENGTH_OF(crack_keys),
                                     .size = sizeof(ShvCrackItem),
                                     .start = start_crack};

static const ShvKey group_keys[] = {
    {"name", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = offsetof(ShvGroupItem, definition.name),
     .sentence = "Name of the physical volume, or its number."},
    {"material", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = offsetof(ShvGroupItem, definition.material),
     .sentence = "Name of its material."},
};
static const ShvTable group_table = {
    .name = "objects.<name>.groups.<index>",
    .sentence =
        "A physical volume that is of another material than the rest. It shares nodes and facets with the rest where "
        "the file "
        "does (gmsh: BooleanFragments), so that cracks pass; a facet between two materials has the law of the weaker "
        "one. When the object wakes and rests is judged by `material` of the object.",
    .keys = group_keys,
    .key_count = LENGTH_OF(group_keys),
    .size = sizeof(ShvGroupItem)};

static const ShvChoice axis_choices[] = {{"none", 0}, {"x", 1}, {"y", 2}, {"z", 3}, {NULL, 0}};
static const ShvKey object_keys[] = {
    {"mesh", SHV_KEY_MAPPING, .flags = SHV_KEY_REQUIRED, .table = &mesh_table, .offset = OBJECT(mesh),
     .sentence = "Its tetrahedra."},
    {"material", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = OBJECT(material),
     .sentence = "Name of its material; where there are `groups`, of all that is in none of them."},
    {"groups", SHV_KEY_LIST, .table = &group_table, .offset = offsetof(ShvObjectItem, groups),
     .sentence = "Parts of another material: physical volumes of the gmsh file, by name or number."},
    POSITION_KEY(OBJECT(placement), "Where the origin of the mesh is at the start."),
    ROTATION_KEY(OBJECT(placement), object_rotation_table),
    VELOCITY_KEY(OBJECT(placement)),
    ANGULAR_VELOCITY_KEY(OBJECT(placement)),
    {"stretch_rate", SHV_KEY_VECTOR, SHV_DIMENSION_FREQUENCY,
     .offset = OBJECT(placement) + offsetof(ShvPlacement, stretch_rate),
     .sentence =
         "Rates at which it stretches along the world axes at the start: adds rate × distance from the centre of mass "
         "to the velocity. Such an object starts in fracture mode."},
    {"repeat", SHV_KEY_MAPPING, .table = &repeat_table, .sentence = "Several of it."},
    {"cracks", SHV_KEY_LIST, .table = &crack_table, .offset = offsetof(ShvObjectItem, cracks),
     .sentence = "Patches of planes that are cracked from the start."},
    {"plane_strain", SHV_KEY_CHOICE, .choices = axis_choices, .offset = offsetof(ShvObjectItem, plane_strain),
     .absent = "none",
     .sentence =
         "World axis along which none of its nodes ever moves: a slice of a body that is long that way. The same "
         "as a support of all its nodes along that axis."},
    {"waits", SHV_KEY_BOOLEAN, .offset = OBJECT(waits),
     .sentence = "Whether it is not in the scene until a program brings it (shv_simulation_enter, docs/library.md)."},
};
static void start_object(void *item)
{
    *(ShvObjectItem *)item = (ShvObjectItem){.definition = shv_object_default()};
}
static const ShvTable object_table = {.name = "objects.<name>",
                                      .sentence = "A body of tetrahedra, which may break.",
                                      .keys = object_keys,
                                      .key_count = LENGTH_OF(object_keys),
                                      .size = sizeof(ShvObjectItem),
                                      .start = start_object};

/* ---- conditions --------------------------------------------------------------------------------------- */

#define SELECTION_TABLES(conditions, label)                                                                            \
    static const ShvTable conditions##_box_table = {.name = label ".on.box",                                           \
                                                    .sentence = "Nodes within a box of world coordinates.",            \
                                                    .keys = select_box_keys,                                           \
                                                    .key_count = LENGTH_OF(select_box_keys)};                          \
    static const ShvTable conditions##_plane_table = {.name = label ".on.plane",                                       \
                                                      .sentence = "Nodes near a plane.",                               \
                                                      .keys = select_plane_keys,                                       \
                                                      .key_count = LENGTH_OF(select_plane_keys)};                      \
    static const ShvKey conditions##_selection_keys[] = {                                                              \
        {"box", SHV_KEY_MAPPING, .flags = SHV_KEY_VARIANT, .table = &conditions##_box_table,                           \
         .variant = SHV_SELECT_BOX, .sentence = "Nodes within a box."},                                                \
        {"plane", SHV_KEY_MAPPING, .flags = SHV_KEY_VARIANT, .table = &conditions##_plane_table,                       \
         .variant = SHV_SELECT_PLANE, .sentence = "Nodes near a plane."},                                              \
    };                                                                                                                 \
    static const ShvTable conditions##_selection_table = {                                                             \
        .name = label ".on",                                                                                           \
        .sentence = "The nodes it acts on, judged once, on the placed mesh at the start.",                             \
        .keys = conditions##_selection_keys,                                                                           \
        .key_count = LENGTH_OF(conditions##_selection_keys),                                                           \
        .variants = true,                                                                                              \
        .variant_offset = SELECTION(kind)}
SELECTION_TABLES(supports, "supports.<name>");
SELECTION_TABLES(velocities, "imposed_velocities.<name>");
SELECTION_TABLES(tractions, "tractions.<name>");

#define CONDITION(member) offsetof(ShvConditionItem, definition.member)
#define CONDITION_OBJECT_KEY                                                                                           \
    {                                                                                                                  \
        "object", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = CONDITION(object),                                \
                                .sentence = "Name of the object."                                                      \
    }
#define CONDITION_ON_KEY(conditions, text)                                                                             \
    {                                                                                                                  \
        "on", SHV_KEY_MAPPING, .table = &conditions##_selection_table, .offset = CONDITION(selection),                 \
                               .sentence = text                                                                        \
    }
#define CONDITION_AXES_KEY(text)                                                                                       \
    {                                                                                                                  \
        "axes", SHV_KEY_AXES, .offset = CONDITION(axes), .sentence = text                                              \
    }
#define CONDITION_RAMP_KEY                                                                                             \
    {                                                                                                                  \
        "ramp_time", SHV_KEY_NUMBER, SHV_DIMENSION_TIME,                                                               \
            .range = &not_negative, .offset = CONDITION(ramp_time),                                                    \
            .sentence = "Time from `start` in which the value rises from zero; 0 means at once."                       \
    }
#define CONDITION_START_KEY                                                                                            \
    {                                                                                                                  \
        "start", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, .range = &not_negative, .offset = CONDITION(start),               \
                                                     .sentence = "When it begins."                                     \
    }
#define CONDITION_END_KEY                                                                                              \
    {                                                                                                                  \
        "end", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, SHV_KEY_INFINITE, &not_negative,                                    \
            .offset = CONDITION(end),                                                                                  \
            .sentence = "When it ends, after `start`; `.inf` means never. A `release` event ends it too."              \
    }
static const ShvKey support_keys[] = {
    CONDITION_OBJECT_KEY,
    CONDITION_ON_KEY(supports, "Which nodes; all of the object when it is left out."),
    CONDITION_AXES_KEY("World axes along which the nodes are held."),
    CONDITION_START_KEY,
    CONDITION_END_KEY,
};
static const ShvKey velocity_keys[] = {
    CONDITION_OBJECT_KEY,
    CONDITION_ON_KEY(velocities, "Which nodes; all of the object when it is left out."),
    CONDITION_AXES_KEY("World axes along which the velocity is imposed; the nodes are free along the others."),
    {"velocity", SHV_KEY_VECTOR, SHV_DIMENSION_VELOCITY, SHV_KEY_REQUIRED, .offset = CONDITION(value),
     .sentence = "The velocity."},
    CONDITION_RAMP_KEY,
    CONDITION_START_KEY,
    CONDITION_END_KEY,
};
static const ShvKey traction_keys[] = {
    CONDITION_OBJECT_KEY,
    CONDITION_ON_KEY(tractions,
                     "Boundary facets all of whose nodes are chosen; the whole surface when it is left out."),
    {"traction", SHV_KEY_VECTOR, SHV_DIMENSION_PRESSURE, SHV_KEY_REQUIRED, .offset = CONDITION(value),
     .sentence = "Force by area at the start, world axes."},
    CONDITION_RAMP_KEY,
    CONDITION_START_KEY,
    CONDITION_END_KEY,
};
static void start_condition(void *item, ShvConditionKind kind)
{
    ShvConditionItem *condition = item;
    *condition = (ShvConditionItem){.definition = shv_condition_default()};
    condition->definition.kind = kind;
    for (int axis = 0; axis < 3; axis++) condition->definition.axes[axis] = true;
}
static void start_support(void *item)
{
    start_condition(item, SHV_CONDITION_SUPPORT);
}
static void start_velocity(void *item)
{
    start_condition(item, SHV_CONDITION_VELOCITY);
}
static void start_traction(void *item)
{
    start_condition(item, SHV_CONDITION_TRACTION);
}
#define CONDITION_TABLE(prefix, label, text)                                                                           \
    static const ShvTable prefix##_table = {.name = label ".<name>",                                                   \
                                            .sentence = text,                                                          \
                                            .keys = prefix##_keys,                                                     \
                                            .key_count = LENGTH_OF(prefix##_keys),                                     \
                                            .size = sizeof(ShvConditionItem),                                          \
                                            .start = start_##prefix}
CONDITION_TABLE(support, "supports",
                "Nodes that are held at rest, and their copies where a body cracks. A piece that hangs by nodes alone, "
                "without a face "
                "whose nodes are all chosen, and can move, is let go when its longest time awake is over, unless no "
                "face is chosen there.");
CONDITION_TABLE(velocity, "imposed_velocities", "Nodes that move as told.");
CONDITION_TABLE(traction, "tractions", "A load on a part of the surface.");

/* ---- obstacles ---------------------------------------------------------------------------------------- */

#define OBSTACLE(member) offsetof(ShvObstacleItem, definition.member)
static const ShvKey plane_keys[] = {
    {"normal", SHV_KEY_VECTOR, .flags = SHV_KEY_REQUIRED | SHV_KEY_DIRECTION, .offset = OBSTACLE(plane_normal),
     .absent = "", .sentence = "Normal, out of the solid; need not be of unit length."},
    {"offset", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, .offset = OBSTACLE(plane_offset),
     .sentence = "Distance of the plane from the world's origin along its normal."},
};
static const ShvTable plane_table = {.name = "obstacles.<name>.plane",
                                     .sentence = "A half space, solid behind the plane. It is fixed.",
                                     .keys = plane_keys,
                                     .key_count = LENGTH_OF(plane_keys)};
static const ShvKey sphere_keys[] = {{"radius", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &positive,
                                      .offset = OBSTACLE(radius), .sentence = "Radius."}};
static const ShvTable sphere_table = {.name = "obstacles.<name>.sphere",
                                      .sentence = "A solid sphere, centred on its origin.",
                                      .keys = sphere_keys,
                                      .key_count = LENGTH_OF(sphere_keys)};
static const ShvKey block_keys[] = {{"size", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED, &positive,
                                     .offset = OBSTACLE(size), .sentence = "Edge lengths along x, y and z."}};
static const ShvTable block_table = {.name = "obstacles.<name>.box",
                                     .sentence = "A solid box, centred on its origin.",
                                     .keys = block_keys,
                                     .key_count = LENGTH_OF(block_keys)};
static const ShvKey surface_keys[] = {
    FILE_KEY("file", OBSTACLE(file), "File of a closed triangle surface: OBJ, STL or PLY."),
    SCALE_KEY(OBSTACLE(scale))};
static const ShvTable surface_table = {.name = "obstacles.<name>.mesh",
                                       .sentence = "The solid within a closed triangle surface.",
                                       .keys = surface_keys,
                                       .key_count = LENGTH_OF(surface_keys)};
static const ShvKey keyframe_keys[] = {
    {"time", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, SHV_KEY_REQUIRED, .offset = offsetof(ShvKeyframeItem, keyframe.time),
     .sentence = "When; later than the keyframe before."},
    {"position", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, SHV_KEY_REQUIRED,
     .offset = offsetof(ShvKeyframeItem, keyframe.position),
     .sentence = "Where the obstacle's origin is then; on a straight line in between."},
    {"rotation", SHV_KEY_MAPPING, .table = &keyframe_rotation_table,
     .offset = offsetof(ShvKeyframeItem, keyframe.rotation_axis),
     .sentence = "How it is turned then; by the shortest arc in between."},
};
static void start_keyframe(void *item)
{
    *(ShvKeyframeItem *)item = (ShvKeyframeItem){.keyframe = {.rotation_axis = {0.0, 0.0, 1.0}}};
}
static const ShvTable keyframe_table = {
    .name = "obstacles.<name>.motion.<index>",
    .sentence = "A keyframe of a scripted motion, which rests before the first and after the last.",
    .keys = keyframe_keys,
    .key_count = LENGTH_OF(keyframe_keys),
    .size = sizeof(ShvKeyframeItem),
    .start = start_keyframe};
#define OBSTACLE_SHAPE(name, shape, value, text)                                                                       \
    {                                                                                                                  \
        name, SHV_KEY_MAPPING, .flags = SHV_KEY_VARIANT, .table = &(shape), .variant = value, .sentence = text         \
    }
static const ShvKey obstacle_keys[] = {
    OBSTACLE_SHAPE("plane", plane_table, SHV_OBSTACLE_PLANE, "A half space."),
    OBSTACLE_SHAPE("sphere", sphere_table, SHV_OBSTACLE_SPHERE, "A sphere."),
    OBSTACLE_SHAPE("box", block_table, SHV_OBSTACLE_BOX, "A box."),
    OBSTACLE_SHAPE("mesh", surface_table, SHV_OBSTACLE_MESH, "A triangle mesh."),
    {"friction", SHV_KEY_NUMBER, .range = &not_negative, .offset = OBSTACLE(friction),
     .sentence = "Coulomb coefficient of friction."},
    {"restitution", SHV_KEY_NUMBER, .range = &share, .offset = OBSTACLE(restitution),
     .sentence =
         "Coefficient of restitution of rigid impacts. Deforming bodies rebound by their own elasticity, but an impact "
         "like one that a body has borne does not wake it again: it rebounds from the first by elasticity, and "
         "from the next by this."},
    {"waits", SHV_KEY_BOOLEAN, .offset = OBSTACLE(waits),
     .sentence = "Of one with a mass: it is not in the scene until a program brings it (shv_simulation_enter)."},
    {"mass", SHV_KEY_NUMBER, SHV_DIMENSION_MASS, .range = &positive, .offset = OBSTACLE(mass),
     .absent = "none: not free",
     .sentence = "Makes it a free, unbreakable rigid body with the inertia of a homogeneous solid."},
    {"motion", SHV_KEY_LIST, .table = &keyframe_table, .offset = offsetof(ShvObstacleItem, keyframes),
     .sentence = "Makes it move by script: a list of keyframes."},
    POSITION_KEY(OBSTACLE(placement), "Where its origin is at the start; not of planes and scripted obstacles."),
    ROTATION_KEY(OBSTACLE(placement), obstacle_rotation_table),
    VELOCITY_KEY(OBSTACLE(placement)),
    ANGULAR_VELOCITY_KEY(OBSTACLE(placement)),
};
static void start_obstacle(void *item)
{
    *(ShvObstacleItem *)item = (ShvObstacleItem){.definition = shv_obstacle_default()};
}
static const ShvTable obstacle_table = {.name = "obstacles.<name>",
                                        .sentence =
                                            "A rigid obstacle: fixed, free (with `mass`) or scripted (with `motion`). "
                                            "Exactly one shape.",
                                        .keys = obstacle_keys,
                                        .key_count = LENGTH_OF(obstacle_keys),
                                        .size = sizeof(ShvObstacleItem),
                                        .start = start_obstacle,
                                        .variants = true,
                                        .variant_offset = OBSTACLE(shape)};

/* ---- events ------------------------------------------------------------------------------------------- */

#define EVENT(member) offsetof(ShvEventItem, definition.member)
#define TARGET_KEY                                                                                                     \
    {                                                                                                                  \
        "target", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = EVENT(target),                                    \
                                .sentence = "Name of an object (all its fragments) or of a free obstacle."             \
    }
static const ShvKey set_velocity_keys[] = {
    TARGET_KEY,
    {"velocity", SHV_KEY_VECTOR, SHV_DIMENSION_VELOCITY, SHV_KEY_REQUIRED, .offset = EVENT(value),
     .sentence = "Velocity from now on."},
    {"angular_velocity", SHV_KEY_VECTOR, SHV_DIMENSION_ANGULAR_VELOCITY, .offset = EVENT(angular),
     .sentence = "Angular velocity from now on, of each fragment about its centre of mass."},
};
static const ShvTable set_velocity_table = {.name = "events.<index>.set_velocity",
                                            .sentence = "Gives a body another velocity.",
                                            .keys = set_velocity_keys,
                                            .key_count = LENGTH_OF(set_velocity_keys)};
static const ShvKey impulse_keys[] = {
    TARGET_KEY,
    {"impulse", SHV_KEY_VECTOR, SHV_DIMENSION_IMPULSE, SHV_KEY_REQUIRED, .offset = EVENT(value),
     .sentence = "Impulse, shared by mass over the fragments of an object."},
};
static const ShvTable impulse_table = {.name = "events.<index>.impulse",
                                       .sentence = "Pushes a body.",
                                       .keys = impulse_keys,
                                       .key_count = LENGTH_OF(impulse_keys)};
static const ShvKey event_keys[] = {
    {"at", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, SHV_KEY_REQUIRED, &not_negative, .offset = EVENT(time),
     .sentence = "When; not before the event above it."},
    {"release", SHV_KEY_TEXT, .flags = SHV_KEY_VARIANT, .variant = SHV_EVENT_RELEASE, .offset = EVENT(target),
     .sentence = "Name of a support, imposed velocity or traction that ends."},
    {"set_velocity", SHV_KEY_MAPPING, .flags = SHV_KEY_VARIANT, .table = &set_velocity_table,
     .variant = SHV_EVENT_SET_VELOCITY, .sentence = "Another velocity of a body."},
    {"impulse", SHV_KEY_MAPPING, .flags = SHV_KEY_VARIANT, .table = &impulse_table, .variant = SHV_EVENT_IMPULSE,
     .sentence = "A push."},
    {"gravity", SHV_KEY_VECTOR, SHV_DIMENSION_ACCELERATION, SHV_KEY_VARIANT, .variant = SHV_EVENT_GRAVITY,
     .offset = EVENT(value), .sentence = "Another gravity."},
};
static void start_event(void *item)
{
    *(ShvEventItem *)item = (ShvEventItem){.definition = shv_event_default()};
}
static const ShvTable event_table = {.name = "events.<index>",
                                     .sentence = "Something that happens at a time: exactly one thing an event.",
                                     .keys = event_keys,
                                     .key_count = LENGTH_OF(event_keys),
                                     .size = sizeof(ShvEventItem),
                                     .start = start_event,
                                     .variants = true,
                                     .variant_offset = EVENT(kind)};

/* ---- probes ------------------------------------------------------------------------------------------- */

#define PROBE(member) offsetof(ShvProbeItem, definition.member)
SELECTION_TABLES(probes, "probes.<name>.nodes");
static const ShvKey probe_nodes_keys[] = {
    {"object", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = PROBE(object), .sentence = "Name of the object."},
    {"on", SHV_KEY_MAPPING, .table = &probes_selection_table, .offset = PROBE(selection),
     .sentence = "Which nodes; all of the object when it is left out."},
};
static const ShvTable probe_nodes_table = {.name = "probes.<name>.nodes",
                                           .sentence = "Nodes of an object, and all copies that cracks make of them.",
                                           .keys = probe_nodes_keys,
                                           .key_count = LENGTH_OF(probe_nodes_keys)};
static const ShvKey probe_keys[] = {
    {"point", SHV_KEY_VECTOR, SHV_DIMENSION_LENGTH, SHV_KEY_VARIANT, .variant = SHV_PROBE_POINT, .offset = PROBE(point),
     .sentence = "A point of a body at the start, world coordinates: displacement, velocity and stress in its tet."},
    {"nodes", SHV_KEY_MAPPING, .flags = SHV_KEY_VARIANT, .variant = SHV_PROBE_NODES, .table = &probe_nodes_table,
     .sentence = "The mean of displacement and velocity (by mass) and of stress (by volume, tets at the nodes) over "
                 "nodes; the forces of obstacles and other bodies, and of supports and imposed velocities, on them."},
    {"obstacle", SHV_KEY_TEXT, .flags = SHV_KEY_VARIANT, .variant = SHV_PROBE_OBSTACLE, .offset = PROBE(obstacle),
     .sentence = "Name of an obstacle: its displacement and velocity, and the force of deforming bodies on it."},
    {"object", SHV_KEY_TEXT, .offset = PROBE(object), .absent = "the first that has the point",
     .sentence = "With `point`: name of the object that it belongs to."},
};
static void start_probe(void *item)
{
    *(ShvProbeItem *)item = (ShvProbeItem){.definition = shv_probe_default()};
}
static const ShvTable probe_table = {
    .name = "probes.<name>",
    .sentence =
        "A place that is watched: exactly one kind a probe. Samples are taken in fracture mode as `output.probe_every` "
        "or `output.probe_interval` says, and at the frames of `output.rate` while its body flies, then without stress "
        "and forces. Watching changes nothing. They are in the run file's `/probes` and in `shiver export csv`.",
    .keys = probe_keys,
    .key_count = LENGTH_OF(probe_keys),
    .size = sizeof(ShvProbeItem),
    .start = start_probe,
    .variants = true,
    .variant_offset = PROBE(kind)};

/* ---- the rest of the top level ------------------------------------------------------------------------ */

#define SCENE(member) offsetof(ShvSceneItem, definition.member)
static const ShvChoice engine_choices[] = {{"bullet", SHV_RIGID_BULLET},
                                           {"bullet_plain", SHV_RIGID_BULLET_PLAIN},
                                           {"analytic", SHV_RIGID_ANALYTIC},
                                           {"pbd", SHV_RIGID_PBD},
                                           {NULL, 0}};
static const ShvChoice wake_choices[] = {{"stress", SHV_WAKE_STRESS}, {"contact", SHV_WAKE_CONTACT}, {NULL, 0}};
static const ShvChoice dust_choices[] = {
    {"keep", SHV_DUST_KEEP}, {"particles", SHV_DUST_PARTICLE}, {"bin", SHV_DUST_BIN}, {NULL, 0}};
static const ShvKey rigid_keys[] = {
    {"engine", SHV_KEY_CHOICE, .choices = engine_choices, .offset = SCENE(rigid.engine),
     .sentence =
         "What moves bodies between impacts. `bullet`: convex pieces that meet obstacles and each other, by Bullet, "
         "with flight and free rotation in closed form. `bullet_plain`: the same pieces in a Bullet world as it comes, "
         "to "
         "compare with (docs/rigid_engines.md); it has no contact with bodies in fracture mode. `analytic`: flight in "
         "closed form, surfaces against obstacles, "
         "fragments do not see each other. `pbd`: nodes that bars hold together and damping makes rigid."},
    {"time_step", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, .range = &positive, .offset = SCENE(rigid.time_step),
     .sentence =
         "Time step of rigid flight; under `bullet` a tenth of it while something is in fracture mode, but not less "
         "than 16 of that mode's steps. What an impact wakes stays in fracture mode to the end of the step, unless it "
         "is whole and all that moves: for bodies of millimetres take it shorter, as `shiver check` says."},
    {"wake", SHV_KEY_CHOICE, .choices = wake_choices, .offset = SCENE(rigid.wake),
     .sentence =
         "Which contacts wake a body to fracture mode: those whose stress estimate is high, or every new one "
         "(under Bullet at most one in a rigid time step and body; what cannot break only with `fracture.enabled: "
         "false`). With `stress` what spins faster than it may bear wakes, too. What can break and scripted obstacles "
         "close on from both sides wakes in either case, and does not rest as long as they press it."},
    {"wake_fraction", SHV_KEY_NUMBER, .range = &positive, .offset = SCENE(rigid.wake_fraction),
     .sentence = "Share of the weakest facet's strength that the estimate must reach."},
    {"wake_factor", SHV_KEY_NUMBER, .range = &positive, .offset = SCENE(rigid.wake_factor),
     .sentence = "Factor K of the impact stress estimate K ρ c v."},
    {"friction", SHV_KEY_NUMBER, .range = &not_negative, .offset = SCENE(rigid.friction),
     .sentence =
         "Coefficient of friction between fragments, where they meet each other: with `engine: bullet`, in flight "
         "and in fracture mode; with `bullet_plain`, in flight."},
    {"restitution", SHV_KEY_NUMBER, .range = &share, .offset = SCENE(rigid.restitution),
     .sentence = "Coefficient of restitution between fragments in flight. In fracture mode they rebound by their own "
                 "elasticity."},
    {"dust", SHV_KEY_CHOICE, .choices = dust_choices, .offset = SCENE(rigid.dust),
     .sentence =
         "What becomes of pieces smaller than `dust_size` when they leave fracture mode. `keep`: rigid bodies like all "
         "others. `particles`: they fly for good and meet obstacles, but no other piece, and never break again. `bin`: "
         "they stay where they are, out of motion and contact, and their momentum is booked in the ledger's sums."},
    {"dust_size", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, .range = &not_negative, .offset = SCENE(rigid.dust_size),
     .sentence = "Diameter, about its centre of mass, below which a piece is dust."},
};
static const ShvTable rigid_table = {.name = "rigid",
                                     .sentence = "Bodies while nothing can break.",
                                     .keys = rigid_keys,
                                     .key_count = LENGTH_OF(rigid_keys)};
static const ShvChoice stabiliser_choices[] = {{"none", SHV_STABILISER_NONE}, {"bars", SHV_STABILISER_BARS}, {NULL, 0}};
static const ShvChoice criterion_choices[] = {{"force", SHV_CRITERION_FORCE},
                                              {"traction", SHV_CRITERION_TRACTION},
                                              {"principal", SHV_CRITERION_PRINCIPAL},
                                              {NULL, 0}};
static const ShvChoice activation_choices[] = {
    {"traction", SHV_ACTIVATION_TRACTION}, {"strength", SHV_ACTIVATION_STRENGTH}, {NULL, 0}};
static const ShvChoice connectivity_choices[] = {
    {"bonds", SHV_CONNECTIVITY_BONDS}, {"nodes", SHV_CONNECTIVITY_NODES}, {NULL, 0}};
static const ShvChoice deformation_choices[] = {
    {"drop", SHV_DEFORMATION_DROP}, {"keep", SHV_DEFORMATION_KEEP}, {NULL, 0}};
static const ShvTable fracture_plane_table = {
    .name = "fracture.plane",
    .sentence = "A plane that cracks keep to: facets with all nodes near it may open.",
    .keys = select_plane_keys,
    .key_count = LENGTH_OF(select_plane_keys)};
static const ShvKey fracture_keys[] = {
    {"enabled", SHV_KEY_BOOLEAN, .offset = SCENE(fracture.enabled),
     .sentence = "Whether facets open; bodies deform in any case."},
    {"plane", SHV_KEY_MAPPING, .table = &fracture_plane_table, .offset = SCENE(fracture.on),
     .sentence =
         "Confines cracks to a plane of the mesh, judged at the start: for a glued joint, or a crack on a known path."},
    {"stabiliser", SHV_KEY_CHOICE, .choices = stabiliser_choices, .offset = SCENE(fracture.stabiliser),
     .sentence =
         "What keeps large steps stable: `none` is explicit central difference, which refuses a `time_step` above "
         "the stable one; `bars` along all edges bear a few times that, and do work that is not the material's."},
    {"time_step", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, SHV_KEY_AUTOMATIC, &positive, .offset = SCENE(fracture.time_step),
     .absent = "auto",
     .sentence = "Time step of fracture mode; `auto` takes `safety` times the stable step, with bars as without them: "
                 "that of the tets as they are, where Green strain has stiffened them."},
    {"safety", SHV_KEY_NUMBER, .range = &positive_share, .offset = SCENE(fracture.safety),
     .sentence = "Share of the stable step that the automatic step takes."},
    {"check_every", SHV_KEY_INT32, .flags = SHV_KEY_AUTOMATIC, .range = &not_negative,
     .offset = SCENE(fracture.check_every), .absent = "auto",
     .sentence = "Steps between checks of the criterion; `auto` (or 0) checks often enough for an overshoot of at most "
                 "10 % while stress grows as it did. Where a body is struck, a wave front crosses a tet in a step or "
                 "two, and stress exceeds the strength severalfold (docs/cohesive.md)."},
    {"threshold", SHV_KEY_NUMBER, .range = &positive_share, .offset = SCENE(fracture.threshold),
     .sentence = "Share of the strength at which facets open."},
    {"criterion", SHV_KEY_CHOICE, .choices = criterion_choices, .offset = SCENE(fracture.criterion),
     .sentence =
         "Which facets open. `force`: the tets at a node part, across all facets of the weakest disk between them at "
         "once, where the force that these pass on exceeds what their laws hold; cracks localise. `traction`: each "
         "facet by "
         "its own traction. `principal`: a facet by the largest principal stress at its nodes."},
    {"activation", SHV_KEY_CHOICE, .choices = activation_choices, .offset = SCENE(fracture.activation),
     .sentence =
         "Where the cohesive law starts with `criterion: traction` and `principal`: at the traction that the facet "
         "carries, which makes no jump, or at the strength. With `force` it starts at what the criterion counted on."},
    {"regularisation", SHV_KEY_NUMBER, .range = &open_share, .offset = SCENE(fracture.regularisation),
     .sentence = "Openings below this share of the final one unload with bounded stiffness."},
    {"connectivity", SHV_KEY_CHOICE, .choices = connectivity_choices, .offset = SCENE(fracture.connectivity),
     .sentence = "What holds tets together as one fragment. `bonds`: intact facets, and cohesive ones with more than a "
                 "hundredth of "
                 "their normal strength left. `nodes`: shared nodes, so that a crack cuts as soon as it is inserted, "
                 "whatever it "
                 "still carries; for laws that never fail, as in the published method's scenes."},
    {"quiet_checks", SHV_KEY_INT32, .range = &at_least_one, .offset = SCENE(fracture.quiet_checks),
     .sentence = "Checks without insertion after which a body may leave fracture mode."},
    {"longest", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, SHV_KEY_AUTOMATIC, &not_negative, .offset = SCENE(fracture.longest),
     .absent = "auto",
     .sentence =
         "A body leaves fracture mode so long after its last crack (an insertion, a failed bond, damage that "
         "grew); `auto` (or 0) takes 20 transits of the slowest bending wave through it, 100 where a crack has "
         "moved since it woke and still holds, but no less than 20 of the bar wave through the body that woke."},
    {"deformation", SHV_KEY_CHOICE, .choices = deformation_choices, .offset = SCENE(fracture.deformation),
     .sentence =
         "What becomes of a body's deformation while it is rigid. `drop`: it goes back to its shape at the start, and "
         "the energy of strain and open cracks is dropped and booked; a body with a crack open by more than a "
         "hundredth of "
         "an edge is kept as it is. `keep`: every body wakes as deformed as it came to rest. "
         "With `rigid.engine: pbd` nodes fly as they are in any case; with `stabiliser: bars` they wake so, too, "
         "without it in their shape at the start."},
    {"energy_bound", SHV_KEY_NUMBER, .range = &positive, .offset = SCENE(fracture.energy_bound),
     .sentence =
         "The run stops when the residual of the energy ledger, and what changes of the step's length made, exceed "
         "this share of the largest energy together, or when contacts have given as much and what lifts all bodies by "
         "their radius, though no obstacle is driven, or cohesive tractions have given as much more than their law."},
};
static const ShvTable fracture_table = {.name = "fracture",
                                        .sentence = "Bodies while they may break.",
                                        .keys = fracture_keys,
                                        .key_count = LENGTH_OF(fracture_keys)};
static const ShvChoice form_choices[] = {{"edge", SHV_BARS_EDGE}, {"element", SHV_BARS_ELEMENT}, {NULL, 0}};
static const ShvKey pbd_keys[] = {
    {"stiffness", SHV_KEY_NUMBER, .range = &share, .offset = SCENE(pbd.stiffness),
     .sentence = "Share k of its error that a bar takes back whenever it is visited: 1 is stiffest, 0 leaves bars "
                 "without effect."},
    {"iterations", SHV_KEY_INT32, .range = &at_least_one, .offset = SCENE(pbd.iterations),
     .sentence = "Sweeps over all bars in every step; more of them, or a smaller step, make bodies stiffer."},
    {"form", SHV_KEY_CHOICE, .choices = form_choices, .offset = SCENE(pbd.form),
     .sentence = "What a sweep visits: every edge once, or every tetrahedron, and with it each edge once for every "
                 "tetrahedron around it, which is stiffer at the same k."},
    {"damping", SHV_KEY_NUMBER, .range = &share, .offset = SCENE(pbd.damping),
     .sentence =
         "Rigid mode: share of the deviation from rigid motion that a step takes from velocities: 1 leaves rigid "
         "motion alone, 0 takes nothing."},
    {"exact_rotation", SHV_KEY_BOOLEAN, .offset = SCENE(pbd.exact_rotation),
     .sentence =
         "Rigid mode: nodes turn along circles about the centre of mass, not along tangents, which drift outwards "
         "step by step."},
};
static const ShvTable pbd_table = {.name = "pbd",
                                   .sentence =
                                       "Position based dynamics: rigid bars along all edges and damping towards "
                                       "rigid motion. Serves `rigid.engine: pbd` and `fracture.stabiliser: bars`.",
                                   .keys = pbd_keys,
                                   .key_count = LENGTH_OF(pbd_keys)};
static const ShvKey bullet_keys[] = {
    {"exact_flight", SHV_KEY_BOOLEAN, .offset = SCENE(rigid.bullet.exact_flight),
     .sentence = "Between contacts a parabola, and free rotation that keeps angular momentum and energy; otherwise "
                 "steps of first order, as Bullet takes them."},
    {"times_of_impact", SHV_KEY_BOOLEAN, .offset = SCENE(rigid.bullet.times_of_impact),
     .sentence =
         "What closes fast meets at its own time of impact within a step and rebounds there; otherwise it is braked "
         "before the touch, and only what touches at the start of a step rebounds."},
    {"exact_contacts", SHV_KEY_BOOLEAN, .offset = SCENE(rigid.bullet.exact_contacts),
     .sentence = "Contacts are found on the hulls themselves, whole faces at once; otherwise by Bullet's algorithms."},
    {"settled_impulses", SHV_KEY_BOOLEAN, .offset = SCENE(rigid.bullet.settled_impulses),
     .sentence = "Impulses are swept to a tolerance, with mixed sweeps where masses differ much, and friction keeps "
                 "to the cone; otherwise Bullet's ten sweeps, friction in two directions by themselves."},
    {"touching_islands", SHV_KEY_BOOLEAN, .offset = SCENE(rigid.bullet.touching_islands),
     .sentence = "Bodies that touch are solved together; otherwise those whose boxes meet, as Bullet has it."},
    {"keep_overlaps", SHV_KEY_BOOLEAN, .offset = SCENE(rigid.bullet.keep_overlaps),
     .sentence = "Overlaps that a body comes with are let be, and shrink as the pair parts or slides; otherwise they "
                 "are undone at once."},
};
static const ShvTable bullet_table = {
    .name = "bullet",
    .sentence =
        "What departs from a Bullet world as it comes with `rigid.engine: bullet`. Each can be left out, to see "
        "what it is good for.",
    .keys = bullet_keys,
    .key_count = LENGTH_OF(bullet_keys)};
static const ShvKey bullet_plain_keys[] = {
    {"unit", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, .range = &positive, .offset = SCENE(bullet_plain.unit),
     .sentence =
         "What Bullet takes for a length of 1. Its thresholds are made for bodies of about that size: it bounces "
         "nothing slower than 0.2 units a second."},
    {"margin", SHV_KEY_NUMBER, .range = &not_negative, .offset = SCENE(bullet_plain.margin),
     .sentence =
         "Thickness, in those units, of the skin that Bullet lays round convex hulls: bodies meet earlier by it."},
    {"exact_flight", SHV_KEY_BOOLEAN, .offset = SCENE(bullet_plain.exact_flight),
     .sentence = "Between contacts a parabola, and free rotation that keeps angular momentum and energy, in place of "
                 "Bullet's integrator."},
    {"sharp_impacts", SHV_KEY_BOOLEAN, .offset = SCENE(bullet_plain.sharp_impacts),
     .sentence =
         "Contacts that rebound take part once they touch, not before, and overlaps are undone without leaving a "
         "velocity, however small they are."},
    {"sorted_pairs", SHV_KEY_BOOLEAN, .offset = SCENE(bullet_plain.sorted_pairs),
     .sentence = "Pairs are solved in the order of the bodies' numbers, whatever came and went before."},
    {"keep_overlaps", SHV_KEY_BOOLEAN, .offset = SCENE(bullet_plain.keep_overlaps),
     .sentence =
         "Overlaps that a body comes with are let be, and shrink as the pair parts; otherwise Bullet pushes it out."},
};
static const ShvTable bullet_plain_table = {
    .name = "bullet_plain",
    .sentence = "What departs from Bullet's defaults with `rigid.engine: bullet_plain`; each entry is an override by "
                "itself.",
    .keys = bullet_plain_keys,
    .key_count = LENGTH_OF(bullet_plain_keys)};
static const ShvKey audit_keys[] = {
    {"momentum", SHV_KEY_NUMBER, .flags = SHV_KEY_INFINITE, .range = &positive, .offset = SCENE(audit.momentum),
     .sentence = "Change of momentum and of angular momentum about the origin, as shares of Σ m|v| and Σ m|r||v| over "
                 "the body's nodes."},
    {"dropped_share", SHV_KEY_NUMBER, .flags = SHV_KEY_INFINITE, .range = &positive,
     .offset = SCENE(audit.dropped_share),
     .sentence = "Energy of vibration, strain and open cracks that is dropped when a body becomes rigid, as a share of "
                 "all that "
                 "it carries, potential energy aside, or of what it woke with, where that was more."},
    {"hull_error", SHV_KEY_NUMBER, .flags = SHV_KEY_INFINITE, .range = &positive, .offset = SCENE(audit.hull_error),
     .sentence = "Space in the convex pieces that no tet fills, and of tets in none of them, as a share of the body's "
                 "volume. Boxes and other convex bodies have none; only the engines `bullet` and `bullet_plain` make "
                 "convex pieces."},
};
static const ShvTable audit_table = {
    .name = "audit",
    .sentence =
        "Bounds on what the switch of a body between rigid and fracture mode may change. Every switch is in the "
        "run file's events with these figures; one above its bound ends the run as diverged. `.inf` is no bound.",
    .keys = audit_keys,
    .key_count = LENGTH_OF(audit_keys)};
static const ShvTable nodes_box_table = {.name = "output.nodes_within.box",
                                         .sentence = "A box of world coordinates, judged at the start.",
                                         .keys = select_box_keys,
                                         .key_count = LENGTH_OF(select_box_keys)};
static const ShvKey nodes_within_keys[] = {
    {"from", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, .range = &not_negative, .offset = SCENE(output.nodes_within.from),
     .sentence = "Of frames from this time on."},
    {"to", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, SHV_KEY_INFINITE, &not_negative, .offset = SCENE(output.nodes_within.to),
     .sentence = "Of frames up to this time."},
    {"every", SHV_KEY_INT64, .range = &at_least_one, .offset = SCENE(output.nodes_within.every),
     .sentence = "Of every so many frames of the run file, counted from its first."},
    {"box", SHV_KEY_MAPPING, .table = &nodes_box_table, .offset = SCENE(output.nodes_within.box), .absent = "all tets",
     .sentence = "Of tets with a corner in a box."},
};
static const ShvTable nodes_within_table = {
    .name = "output.nodes_within",
    .sentence = "Which node positions are recorded, to keep run files small. Everything else of a frame is recorded in "
                "any case, facet damage too. What is left out is shown undeformed, in the pose of its fragment.",
    .keys = nodes_within_keys,
    .key_count = LENGTH_OF(nodes_within_keys)};
static const ShvKey output_keys[] = {
    {"file", SHV_KEY_TEXT, .offset = SCENE(output.file), .absent = "from the name of the scene file",
     .sentence = "Run file, from the working directory."},
    {"rate", SHV_KEY_NUMBER, SHV_DIMENSION_FREQUENCY, .range = &positive, .offset = SCENE(output.rate),
     .sentence = "Frames a second. Rigid steps end at frames, and at most `rigid.time_step` long they are all equal in "
                 "between: another rate makes them others, and what breaks then differs within its scatter."},
    {"fracture_every", SHV_KEY_INT64, .range = &not_negative, .offset = SCENE(output.fracture_every),
     .sentence = "Also records a frame every so many steps of fracture mode; 0 records none."},
    {"nodes", SHV_KEY_BOOLEAN, .offset = SCENE(output.nodes),
     .sentence = "Whether node positions and facet damage are recorded."},
    {"nodes_within", SHV_KEY_MAPPING, .table = &nodes_within_table, .absent = "all of them",
     .sentence = "With `nodes`: positions of these frames and tets alone."},
    {"probe_every", SHV_KEY_INT64, .range = &at_least_one, .offset = SCENE(output.probe_every),
     .sentence = "Probes are sampled every so many steps of fracture mode."},
    {"probe_interval", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, .range = &not_negative,
     .offset = SCENE(output.probe_interval),
     .sentence = "Samples them by time instead: at the first step of fracture mode at or after every multiple of it; 0 "
                 "leaves it to `probe_every`."},
};
static const ShvTable output_table = {
    .name = "output", .sentence = "What is recorded.", .keys = output_keys, .key_count = LENGTH_OF(output_keys)};

static const ShvChoice law_of_motion_choices[] = {{"flight", SHV_REFERENCE_FLIGHT}, {"bounce", SHV_REFERENCE_BOUNCE},
                                                  {"slide", SHV_REFERENCE_SLIDE},   {"roll", SHV_REFERENCE_ROLL},
                                                  {"rest", SHV_REFERENCE_REST},     {NULL, 0}};
static const ShvKey reference_keys[] = {
    {"law", SHV_KEY_CHOICE, .flags = SHV_KEY_REQUIRED, .choices = law_of_motion_choices, .offset = SCENE(reference.law),
     .absent = "",
     .sentence =
         "`flight`: a parabola and torque-free rotation. `bounce`: straight down on to a plane, which it meets below "
         "its centre, and up again. `slide`: along a plane, or stuck to it, without turning. `roll`: a sphere that "
         "slips on a plane until it rolls. `rest`: nothing moves."},
    {"body", SHV_KEY_TEXT, .offset = SCENE(reference.body), .absent = "every one, with `flight` and `rest`",
     .sentence = "Name of the object or free obstacle that follows it."},
    {"on", SHV_KEY_TEXT, .offset = SCENE(reference.on), .absent = "none, with `flight` and `rest`",
     .sentence = "Name of the plane that it meets."},
};
static const ShvTable reference_table = {
    .name = "reference",
    .sentence = "A motion known in closed form that `shiver compare` measures errors from; its numbers are the "
                "scene's. Without it the finest run is what the others are compared with.",
    .keys = reference_keys,
    .key_count = LENGTH_OF(reference_keys)};

static const ShvChoice variation_choices[] = {
    {"height", SHV_SURVIVAL_HEIGHT}, {"speed", SHV_SURVIVAL_SPEED}, {NULL, 0}};
static const ShvKey survival_keys[] = {
    {"object", SHV_KEY_TEXT, .offset = SCENE(survival.object), .absent = "the scene's only one",
     .sentence = "Name of the object that is dropped or thrown."},
    {"broken", SHV_KEY_NUMBER, .range = &open_share, .offset = SCENE(survival.broken),
     .sentence = "It has broken when its largest piece has less than this share of its mass."},
    {"vary", SHV_KEY_CHOICE, .choices = variation_choices, .offset = SCENE(survival.vary),
     .sentence = "`height`: it starts where the scene has it, with the speed of a fall from that height along gravity. "
                 "`speed`: with the speed of such a fall along the velocity that it has in the scene."},
    {"turn", SHV_KEY_BOOLEAN, .offset = SCENE(survival.turn),
     .sentence = "Each specimen falls in an orientation of its own, at random, with its foremost point where the "
                 "scene's is; else all fall as the scene has them."},
};
static const ShvTable survival_table = {
    .name = "survival",
    .sentence = "From what height it breaks: what `shiver survive` varies and calls broken. Other commands do not look "
                "at it.",
    .keys = survival_keys,
    .key_count = LENGTH_OF(survival_keys)};

static const ShvChoice overlap_choices[] = {{"refuse", SHV_OVERLAPS_REFUSE}, {"keep", SHV_OVERLAPS_KEEP}, {NULL, 0}};

#define ITEMS(member) offsetof(ShvSceneItem, member)
static const ShvKey scene_keys[] = {
    {"shiver", SHV_KEY_INT32, .flags = SHV_KEY_REQUIRED, .range = &version, .offset = offsetof(ShvSceneItem, version),
     .absent = "", .sentence = "Version of the scene format."},
    {"name", SHV_KEY_TEXT, .offset = SCENE(name), .absent = "the name of the scene file",
     .sentence = "Name of the scene."},
    {"duration", SHV_KEY_NUMBER, SHV_DIMENSION_TIME, SHV_KEY_REQUIRED, &positive, .offset = SCENE(duration),
     .sentence = "Simulated time."},
    {"gravity", SHV_KEY_VECTOR, SHV_DIMENSION_ACCELERATION, .offset = SCENE(gravity), .sentence = "Gravity."},
    {"seed", SHV_KEY_UINT64, .offset = SCENE(seed), .sentence = "Seed of the strengths that scatter."},
    {"threads", SHV_KEY_INT32, .range = &threads, .offset = SCENE(threads),
     .sentence = "Threads; 0: as many processors as other programs leave free and as have 2,048 tets each in fracture "
                 "mode. Results do not depend on it."},
    {"materials", SHV_KEY_NAMED, .flags = SHV_KEY_REQUIRED, .table = &material_table, .offset = ITEMS(materials),
     .sentence = "Materials by name."},
    {"objects", SHV_KEY_NAMED, .flags = SHV_KEY_REQUIRED, .table = &object_table, .offset = ITEMS(objects),
     .sentence = "Objects by name."},
    {"obstacles", SHV_KEY_NAMED, .table = &obstacle_table, .offset = ITEMS(obstacles),
     .sentence = "Obstacles by name."},
    {"overlaps", SHV_KEY_CHOICE, .choices = overlap_choices, .offset = SCENE(overlaps),
     .sentence =
         "What to do when objects stand in each other or in obstacles at the start, or free obstacles in others. "
         "`refuse`: nothing runs, and the "
         "message says which, how deep, and what parts them. `keep`: they start as they are, and `shiver check` and "
         "`run` warn and say what becomes of it; that depends on `rigid.engine`. Bodies that touch do not overlap: a "
         "depth below a millionth of the smaller one is rounding."},
    {"supports", SHV_KEY_NAMED, .table = &support_table, .offset = ITEMS(supports), .sentence = "Supports by name."},
    {"imposed_velocities", SHV_KEY_NAMED, .table = &velocity_table, .offset = ITEMS(velocities),
     .sentence = "Imposed velocities by name."},
    {"tractions", SHV_KEY_NAMED, .table = &traction_table, .offset = ITEMS(tractions),
     .sentence = "Tractions by name."},
    {"events", SHV_KEY_LIST, .table = &event_table, .offset = ITEMS(events),
     .sentence = "Events in the order of their times."},
    {"probes", SHV_KEY_NAMED, .table = &probe_table, .offset = ITEMS(probes), .sentence = "Probes by name."},
    {"rigid", SHV_KEY_MAPPING, .table = &rigid_table, .sentence = "Flight between impacts."},
    {"pbd", SHV_KEY_MAPPING, .table = &pbd_table, .sentence = "Bars and damping of position based dynamics."},
    {"bullet", SHV_KEY_MAPPING, .table = &bullet_table, .sentence = "Overrides of Bullet."},
    {"bullet_plain", SHV_KEY_MAPPING, .table = &bullet_plain_table, .sentence = "Overrides of plain Bullet."},
    {"fracture", SHV_KEY_MAPPING, .table = &fracture_table, .sentence = "Deformation and fracture."},
    {"audit", SHV_KEY_MAPPING, .table = &audit_table, .sentence = "Bounds on mode switches."},
    {"output", SHV_KEY_MAPPING, .table = &output_table, .sentence = "The run file."},
    {"reference", SHV_KEY_MAPPING, .table = &reference_table, .sentence = "The exact motion, where one is known."},
    {"survival", SHV_KEY_MAPPING, .table = &survival_table, .sentence = "From what height something breaks."},
};
static void start_scene(void *item)
{
    *(ShvSceneItem *)item = (ShvSceneItem){.definition = shv_scene_default()};
}
const ShvTable shv_scene_table = {.name = "the scene",
                                  .sentence = "The top level.",
                                  .keys = scene_keys,
                                  .key_count = LENGTH_OF(scene_keys),
                                  .size = sizeof(ShvSceneItem),
                                  .start = start_scene};
