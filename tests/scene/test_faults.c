/* Scenes with faults: each is reported where it stands, with what was expected. */
#include "check.h"

#include "parse.h"

/* Added to the small scene, so that line 7 is the first line of `text`. */
typedef struct Fault {
    const char *text, *message;
} Fault;

static void check_one(const char *text, const char *expected)
{
    Parsed parsed = parse_bytes(text, strlen(text), NULL, 0);
    const int32_t count = shv_diagnostics_count(parsed.diagnostics);
    if (count != 1 || strcmp(message(&parsed, 0), expected) != 0)
        fail_msg("%d messages, the first: %s\nexpected: %s\nin: %s", (int)count, message(&parsed, 0), expected, text);
    const bool is_error = strstr(expected, ": error: ") != NULL;
    assert_int_equal(parsed.status, is_error ? SHV_BAD_INPUT : SHV_OK);
    assert_int_equal(parsed.scene == NULL, is_error);
    if (is_error) assert_string_equal(parsed.error.message, expected);
    release(&parsed);
}

static void check_added(const Fault *faults, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        char text[4000];
        snprintf(text, sizeof text, "%s%s", SMALL_SCENE, faults[i].text);
        check_one(text, faults[i].message);
    }
}
#define CHECK_ADDED(faults) check_added(faults, sizeof(faults) / sizeof *(faults))

static void values_of_a_wrong_kind(void **state)
{
    (void)state;
    static const Fault faults[] = {
        {"gravitiy: 3\n", "s.yaml:7:1: error: unknown key 'gravitiy' in the scene; did you mean 'gravity'?"},
        {"output: {qqq: 3}\n", "s.yaml:7:10: error: unknown key 'qqq' in output; known are file, rate, fracture_every, "
                               "nodes, nodes_within, probe_every or "
                               "probe_interval"},
        {"threads: 1.5\n",
         "s.yaml:7:10: error: threads is '1.5'; expected a whole number, at least 0 and at most 1024"},
        {"threads: 99999999999\n",
         "s.yaml:7:10: error: threads is '99999999999'; expected a whole number, at least 0 and at most 1024"},
        {"seed: -1\n", "s.yaml:7:7: error: seed is '-1'; expected a whole number, at least 0"},
        {"seed: 18446744073709551616\n",
         "s.yaml:7:7: error: seed is '18446744073709551616'; expected a whole number, at least 0"},
        {"output:\n", "s.yaml:7:1: error: output has no value; expected a mapping with keys file, rate, "
                      "fracture_every, nodes, nodes_within, "
                      "probe_every or probe_interval"},
        {"output: [1]\n", "s.yaml:7:9: error: output is a list of 1; expected a mapping with keys file, rate, "
                          "fracture_every, nodes, nodes_within, "
                          "probe_every or probe_interval"},
        {"output: {probe_every: 0}\n", "s.yaml:7:23: error: probe_every is '0'; expected a whole number, at least 1"},
        {"probes: {tip: {}}\n",
         "s.yaml:7:15: error: probes.tip has none of point, nodes or obstacle; give exactly one"},
        {"probes: {tip: {point: [0, 0]}}\n",
         "s.yaml:7:23: error: point is a list of 2; expected a list [x, y, z], each a length in m (or "
         "cm, mm, um, \xC2\xB5m, km)"},
        {"probes: {tip: {point: [0, 0, 0], object: plat}}\n",
         "s.yaml:7:42: error: object 'plat' is no object of the scene; did you mean 'plate'?"},
        {"probes: {tip: {nodes: {object: plat}}}\n",
         "s.yaml:7:32: error: object 'plat' is no object of the scene; did you mean 'plate'?"},
        {"probes: {tip: {obstacle: plate}}\n", "s.yaml:7:26: error: plate is an object; watch it with point or nodes"},
        {"probes: {tip: {obstacle: flor}}\n",
         "s.yaml:7:26: error: obstacle 'flor' is no obstacle of the scene; there are none"},
        {"obstacles: {floor: {plane: {normal: [0, 0, 1]}}}\nprobes: {tip: {obstacle: flor}}\n",
         "s.yaml:8:26: error: obstacle 'flor' is no obstacle of the scene; did you mean 'floor'?"},
        {"obstacles: {w: {sphere: {radius: 1}, mass: 2}}\nsupports: {left: {object: w}}\n",
         "s.yaml:8:27: error: object 'w' is no object of the scene; there is plate"},
        {"probes: {tip: {nodes: {object: plate}, object: plate}}\n",
         "s.yaml:7:48: error: object goes with point alone; remove it"},
        {"output: {nodes: yes}\n", "s.yaml:7:17: error: nodes is 'yes'; expected true or false"},
        {"output: {file: ''}\n", "s.yaml:7:16: error: file is ''; expected a text"},
        {"name: {a: 1}\n", "s.yaml:7:7: error: name is a mapping; expected a text"},
        {"name: ~\n", "s.yaml:7:7: error: name has no value; expected a text"},
        {"rigid: {wake: touch}\n", "s.yaml:7:15: error: wake is 'touch'; expected stress or contact"},
        {"rigid: {engine: newton}\n",
         "s.yaml:7:17: error: engine is 'newton'; expected bullet, bullet_plain, analytic or pbd"},
        {"rigid: {friction: -0.1}\n", "s.yaml:7:19: error: friction is '-0.1'; expected a number, at least 0"},
        {"rigid: {restitution: 1.1}\n",
         "s.yaml:7:22: error: restitution is '1.1'; expected a number, at least 0 and at most 1"},
        {"rigid: {dust: burn}\n", "s.yaml:7:15: error: dust is 'burn'; expected keep, particles or bin"},
        {"rigid: {dust_size: -1 mm}\n",
         "s.yaml:7:20: error: dust_size is '-1 mm'; expected a length in m (or cm, mm, um, \xC2\xB5m, km), at least 0"},
        {"fracture: {deformation: lose}\n", "s.yaml:7:25: error: deformation is 'lose'; expected drop or keep"},
        {"audit: {hull_error: 0}\n",
         "s.yaml:7:21: error: hull_error is '0'; expected a number, greater than 0, or .inf"},
        {"audit: {impulse: 1}\n",
         "s.yaml:7:9: error: unknown key 'impulse' in audit; known are momentum, dropped_share or hull_error"},
        {"fracture: {stabiliser: glue}\n", "s.yaml:7:24: error: stabiliser is 'glue'; expected none or bars"},
        {"pbd: {stiffness: 1.1}\n",
         "s.yaml:7:18: error: stiffness is '1.1'; expected a number, at least 0 and at most 1"},
        {"pbd: {stiffness: -0.1}\n",
         "s.yaml:7:18: error: stiffness is '-0.1'; expected a number, at least 0 and at most 1"},
        {"pbd: {damping: 2}\n", "s.yaml:7:16: error: damping is '2'; expected a number, at least 0 and at most 1"},
        {"pbd: {iterations: 0}\n", "s.yaml:7:19: error: iterations is '0'; expected a whole number, at least 1"},
        {"pbd: {form: edges}\n", "s.yaml:7:13: error: form is 'edges'; expected edge or element"},
        {"pbd: {exact_rotation: 1}\n", "s.yaml:7:23: error: exact_rotation is '1'; expected true or false"},
        {"gravity: [0, 0]\n", "s.yaml:7:10: error: gravity is a list of 2; expected a list [x, y, z], each an "
                              "acceleration in m/s2 (or mm/s2)"},
        {"gravity: -9.81\n",
         "s.yaml:7:10: error: gravity is '-9.81'; expected a list [x, y, z], each an acceleration in m/s2 (or mm/s2)"},
        {"gravity: [0, .nan, 0]\n",
         "s.yaml:7:14: error: gravity is '.nan'; expected an acceleration in m/s2 (or mm/s2)"},
        {"gravity: [0, 0, -.inf]\n",
         "s.yaml:7:17: error: gravity is '-.inf'; expected an acceleration in m/s2 (or mm/s2)"},
        {"gravity: [0, 0, 9 mm]\n",
         "s.yaml:7:17: error: gravity has unit 'mm', which is no unit of acceleration; use one of m/s2, mm/s2"},
        {"rigid: {wake_factor: 6 s}\n",
         "s.yaml:7:22: error: wake_factor has unit 's'; it is a plain number without a unit"},
        {"fracture: {safety: 0}\n",
         "s.yaml:7:20: error: safety is '0'; expected a number, greater than 0 and at most 1"},
        {"fracture: {safety: 1.5}\n",
         "s.yaml:7:20: error: safety is '1.5'; expected a number, greater than 0 and at most 1"},
        {"fracture: {time_step: 1e999}\n", "s.yaml:7:23: error: time_step is '1e999'; expected a time in s (or ms, us, "
                                           "\xC2\xB5s, ns, min), greater than 0, or auto"},
        {"fracture: {check_every: automatic}\n",
         "s.yaml:7:25: error: check_every is 'automatic'; expected a whole number, at least 0, or auto"},
        {"fracture: {time_step: 2}\n", "s.yaml:7:23: error: time_step is longer than the whole run, see duration"},
        {"events: {at: 1}\n",
         "s.yaml:7:9: error: events is a mapping; expected a list of mappings with keys at, release, "
         "set_velocity, impulse or gravity"},
        {"events: [1]\n", "s.yaml:7:10: error: events.<index> is a value; expected a mapping with keys at, release, "
                          "set_velocity, impulse or gravity"},
        {"obstacles: {a b: {sphere: {radius: 1}}}\n",
         "s.yaml:7:13: error: 'a b' is no name; use letters, digits, '_' and '-', at most 63 of them"},
        {"duration: 2\n", "s.yaml:7:1: error: key 'duration' is given twice, before at line 6; keep one"},
    };
    CHECK_ADDED(faults);
}

static void references_and_fits(void **state)
{
    (void)state;
    static const Fault faults[] = {
        {"supports: {a: {object: plat}}\n",
         "s.yaml:7:24: error: object 'plat' is no object of the scene; did you mean 'plate'?"},
        {"supports: {a: {object: xyz}}\n",
         "s.yaml:7:24: error: object 'xyz' is no object of the scene; there is plate"},
        {"supports: {a: {object: plate, axes: [x, w]}}\n",
         "s.yaml:7:41: error: axes is 'w'; expected a list of some of x, y, z"},
        {"supports: {a: {object: plate, axes: []}}\n",
         "s.yaml:7:37: error: axes is a list of 0; expected a list of some of x, y, z"},
        {"supports: {a: {object: plate, axes: [x, x]}}\n",
         "s.yaml:7:41: error: axes is 'x'; expected a list of some of x, y, z"},
        {"pbd: {iterations: 8}\n", "s.yaml:7:6: warning: nothing uses pbd; give 'rigid: {engine: pbd}' or 'fracture: "
                                   "{stabiliser: bars}'"},
        {"pbd: {damping: 0.5}\nfracture: {stabiliser: bars}\n",
         "s.yaml:7:16: warning: damping acts in rigid mode alone; give 'rigid: {engine: pbd}'"},
        {"rigid: {engine: pbd}\npbd: {stiffness: 0}\n",
         "s.yaml:8:18: warning: with stiffness 0 the bars hold nothing together"},
        {"rigid: {engine: bullet_plain}\n",
         "s.yaml:7:17: warning: bodies that fly in bullet_plain go through those in fracture mode; give 'engine: "
         "bullet' for what breaks"},
        {"rigid: {dust: bin}\n",
         "s.yaml:7:15: error: nothing is dust without a size; give dust_size, the diameter below "
         "which a piece is, or 'dust: keep'"},
        {"rigid: {dust_size: 1 mm}\n",
         "s.yaml:7:20: warning: dust is kept, so that its size says nothing; give 'dust: particles' or 'dust: bin'"},
        {"supports: {a: {object: plate, start: 0.5, end: 0.5}}\n", "s.yaml:7:48: error: end must be after start"},
        {"supports: {a: {object: plate, start: 2}}\n",
         "s.yaml:7:38: warning: start is not before the end of the run; a never acts"},
        {"supports: {a: {object: plate, on: {}}}\n",
         "s.yaml:7:35: error: supports.a.on has none of box or plane; give exactly one"},
        {"supports: {a: {object: plate, on: {box: {min: [0, 0, 0], max: [1, -1, 1]}}}}\n",
         "s.yaml:7:63: error: max is below min along y; no node lies in such a box"},
        {"output: {nodes_within: {every: 2}}\n",
         "s.yaml:7:24: error: node positions are not recorded at all; give 'nodes: true' beside it, or leave it out"},
        {"output: {nodes: true, nodes_within: {from: 2, to: 1}}\n",
         "s.yaml:7:51: error: it is before 'from'; no frame lies between"},
        {"output: {nodes: true, nodes_within: {box: {min: [0, 0, 0], max: [1, -1, 1]}}}\n",
         "s.yaml:7:65: error: max is below min along y; no node lies in such a box"},
        {"supports: {a: {object: plate}}\ntractions: {a: {object: plate, traction: [1, 1, 1]}}\n",
         "s.yaml:8:13: error: name 'a' stands for two conditions, before at line 7; rename one"},
        {"obstacles: {plate: {sphere: {radius: 1}}}\n",
         "s.yaml:7:13: error: name 'plate' stands for two bodies, before at line 5; rename one"},
        {"obstacles: {a: {friction: 1}}\n",
         "s.yaml:7:16: error: obstacles.a has none of plane, sphere, box or mesh; give exactly one"},
        {"obstacles: {a: {sphere: {radius: 1}, box: {size: [1, 1, 1]}}}\n",
         "s.yaml:7:38: error: box stands beside sphere; obstacles.a takes exactly one of plane, sphere, box or mesh"},
        {"obstacles: {a: {plane: {normal: [0, 0, 0]}}}\n",
         "s.yaml:7:33: error: normal is zero, which is no direction; give one such as [0, 0, 1]"},
        {"obstacles: {a: {plane: {normal: [0, 0, 1]}, position: [0, 0, 1]}}\n",
         "s.yaml:7:55: error: a plane is fixed where its normal and offset say; remove position"},
        {"obstacles: {a: {plane: {normal: [0, 0, 1]}, mass: 1}}\n",
         "s.yaml:7:51: error: a plane is fixed where its normal and offset say; remove mass"},
        {"obstacles: {a: {sphere: {radius: 1}, velocity: [0, 0, 1]}}\n",
         "s.yaml:7:48: error: a fixed obstacle has no velocity; remove velocity, or give mass or motion"},
        {"obstacles: {a: {sphere: {radius: 1}, mass: 1, motion: [{time: 0, position: [0, 0, 0]}]}}\n",
         "s.yaml:7:44: error: mass makes a free body, motion a scripted one; keep one of them"},
        {"obstacles: {a: {sphere: {radius: 1}, motion: []}}\n",
         "s.yaml:7:46: error: motion has no keyframes; give at least one, or leave it out"},
        {"obstacles: {a: {sphere: {radius: 1}, position: [0, 0, 0], motion: [{time: 0, position: [0, 0, 0]}]}}\n",
         "s.yaml:7:48: error: the keyframes of motion say where the obstacle is; remove position"},
        {"obstacles: {a: {sphere: {radius: 1}, motion: [{time: 1, position: [0, 0, 0]}, {time: 1, position: [0, 0, "
         "1]}]}}\n",
         "s.yaml:7:86: error: time must be later than that of the keyframe before"},
        {"obstacles: {a: {mesh: {file: none.stl}}}\n",
         "s.yaml:7:30: error: file 'none.stl' cannot be read; relative names start from scene"},
        {"obstacles: {a: {mesh: {file: ../build/meshes/none.obj}}}\n",
         "s.yaml:7:30: error: file '../build/meshes/none.obj' cannot be read; ./bootstrap meshes makes it; relative "
         "names "
         "start from scene"},
        {"obstacles: {a: {sphere: {radius: 1}, rotation: {angle: 3, axis: [0, 0, 0]}}}\n",
         "s.yaml:7:65: error: axis is zero, which is no direction; give one such as [0, 0, 1]"},
        {"events: [{at: 0.5, gravity: [0, 0, 0]}, {at: 0.25, gravity: [0, 0, 0]}]\n",
         "s.yaml:7:46: error: 'at' lies before the event above it; put events in the order of their times"},
        {"events: [{at: 2, gravity: [0, 0, 0]}]\n",
         "s.yaml:7:15: warning: 'at' lies after the end of the run; the event never happens"},
        {"events: [{at: 0}]\n",
         "s.yaml:7:10: error: events.<index> has none of release, set_velocity, impulse or gravity; give exactly one"},
        {"events: [{at: 0, release: a}]\n",
         "s.yaml:7:27: error: release 'a' is no support, imposed velocity or traction of the scene; there are none"},
        {"events: [{at: 0, impulse: {target: plat, impulse: [0, 0, 1]}}]\n",
         "s.yaml:7:36: error: target 'plat' is no object or free obstacle of the scene; did you mean 'plate'?"},
        {"events: [{at: 0, set_velocity: {target: a, velocity: [0, 0, 1]}}]\nobstacles: {a: {sphere: {radius: 1}}}\n",
         "s.yaml:7:41: error: target 'a' is not free to move; an event acts on an object or an obstacle with mass"},
    };
    CHECK_ADDED(faults);
}

#define WITH_MATERIAL(material)                                                                                        \
    "shiver: 1\n"                                                                                                      \
    "materials:\n"                                                                                                     \
    "  m: {" material "}\n"                                                                                            \
    "objects: {o: {mesh: {ball: {radius: 1, edge: 0.1}}, material: m}}\n"                                              \
    "duration: 1\n"

static void materials(void **state)
{
    (void)state;
    check_one(WITH_MATERIAL("youngs_modulus: 1e9, breakable: false"),
              "s.yaml:3:6: error: materials.m lacks what it must have: density, poissons_ratio");
    check_one(WITH_MATERIAL("density: 1, youngs_modulus: 1e9, poissons_ratio: 0.5, breakable: false"),
              "s.yaml:3:56: error: poissons_ratio is '0.5'; expected a number, greater than -1 and less than 0.5");
    check_one(WITH_MATERIAL("density: 1 kg, youngs_modulus: 1e9, poissons_ratio: 0.2, breakable: false"),
              "s.yaml:3:16: error: density has unit 'kg', which is no unit of density; use one of kg/m3, g/cm3, t/m3");
    check_one(WITH_MATERIAL("density: 1, youngs_modulus: 1e9, poissons_ratio: 0.2, fracture_energy: 1"),
              "s.yaml:3:6: error: m can break but has no cohesive_strength; give it, or 'breakable: false'");
    check_one(WITH_MATERIAL("density: 1, youngs_modulus: 1e9, poissons_ratio: 0.2, cohesive_strength: 1e6"),
              "s.yaml:3:6: error: m can break but has no fracture_energy; give it, or 'breakable: false'");
    check_one(WITH_MATERIAL(
                  "density: 1, youngs_modulus: 1e9, poissons_ratio: 0.2, fracture_energy: .inf, cohesive_strength: 1"),
              "s.yaml:3:78: error: fracture_energy is '.inf'; expected a surface energy in J/m2 (or N/m, kJ/m2, mJ/m2, "
              "N/mm), at least 0");
    check_one(
        WITH_MATERIAL(
            "density: 1, youngs_modulus: 1 GPa, poissons_ratio: 0.2, fracture_energy: 1, cohesive_strength: 210 MPa"),
        "s.yaml:3:102: warning: cohesive_strength is above a fifth of youngs_modulus, more than any solid bears; check "
        "the units");
    Parsed parsed = parse_good(
        WITH_MATERIAL("density: 1, youngs_modulus: 1e9, poissons_ratio: 0.2, cohesive_strength: .inf"), NULL, 0);
    assert_true(isinf(shv_scene_definition(parsed.scene)->materials[0].cohesive_strength));
    release(&parsed);
}

#define WITH_OBJECT(object)                                                                                            \
    "shiver: 1\n"                                                                                                      \
    "materials: {m: {density: 1, youngs_modulus: 1e9, poissons_ratio: 0.2, breakable: false}}\n"                       \
    "objects:\n"                                                                                                       \
    "  o: {" object "}\n"                                                                                              \
    "duration: 1\n"
#define WITH_MESH(mesh) WITH_OBJECT("material: m, mesh: {" mesh "}")

static void objects(void **state)
{
    (void)state;
    check_one(WITH_OBJECT("material: m, mesh: {box: {size: [1, 1, 1], edge: 1}}, plane_strain: true"),
              "s.yaml:4:75: error: plane_strain is 'true'; expected none, x, y or z");
    check_one(WITH_MESH("jitter: 0.1"),
              "s.yaml:4:26: error: objects.o.mesh has none of box, ball, hollow_ball, cylinder, "
              "notched_beam, gmsh, tetgen, shell, stl, turned or memory; give exactly one");
    check_one(
        WITH_MESH("ball: {radius: 1, edge: 1}, shell: {}"),
        "s.yaml:4:55: error: shell stands beside ball; objects.o.mesh takes exactly one of box, ball, hollow_ball, "
        "cylinder, notched_beam, gmsh, tetgen, shell, stl, turned or memory");
    check_one(WITH_MESH("box: {size: [1, 1, 0], edge: 1}"),
              "s.yaml:4:46: error: size is '0'; expected a length in m (or cm, mm, um, \xC2\xB5m, km), greater than 0");
    check_one(WITH_MESH("hollow_ball: {radius: 1, thickness: 1, edge: 1}"),
              "s.yaml:4:63: error: thickness must be less than the radius; use ball for a solid one");
    check_one(WITH_MESH("cylinder: {radius: 1, inner_radius: 2, height: 1, edge: 1}"),
              "s.yaml:4:63: error: inner_radius must be less than radius");
    check_one(WITH_MESH("notched_beam: {size: [4, 1, 1], edge: 0.1, notch_depth: 1}"),
              "s.yaml:4:83: error: notch_depth must be less than the height, size[2]");
    check_one(WITH_MESH("notched_beam: {size: [4, 1, 1], edge: 0.1, notch_depth: 0.5, notch_offset: -2}"),
              "s.yaml:4:102: error: notch_offset must be less than half the length, size[0]");
    check_one(WITH_MESH("notched_beam: {size: [4, 1, 1], edge: 0.1, notch_depth: 0.5, notch_edge: 1}"),
              "s.yaml:4:100: error: notch_edge must be at most edge: it refines the mesh at the notch");
    check_one(WITH_MESH("gmsh: {file: none.msh}"),
              "s.yaml:4:40: error: file 'none.msh' cannot be read; relative names start from scene");
    check_one(WITH_MESH("tetgen: {file: none}"),
              "s.yaml:4:42: error: file 'none' cannot be read; relative names start from scene");
    check_one(WITH_MESH("shell: {surface: none.obj, thickness: 1}"),
              "s.yaml:4:44: error: file 'none.obj' cannot be read; relative names start from scene");
    check_one(WITH_OBJECT("material: n, mesh: {ball: {radius: 1, edge: 1}}"),
              "s.yaml:4:17: error: material 'n' is no material of the scene; there is m");
    check_one(WITH_OBJECT("material: granite, mesh: {ball: {radius: 1, edge: 1}}"),
              "s.yaml:4:17: error: material 'granite' is of the library; add it to the scene: 'materials: {granite: "
              "{library: granite}}'");
    check_one(WITH_OBJECT("material: m, mesh: {ball: {radius: 1, edge: 1}}, groups: [{name: a, material: m}]"),
              "s.yaml:4:64: error: only a mesh from a gmsh file has groups: mesh: {gmsh: …}");
    check_one(WITH_OBJECT("material: m, mesh: {gmsh: {file: /dev/null}}, groups: [{name: a, material: n}]"),
              "s.yaml:4:82: error: material 'n' is no material of the scene; there is m");
    check_one(
        WITH_OBJECT("material: m, mesh: {gmsh: {file: /dev/null, improve: true}}, cracks: [{plane: {normal: [0, 0, 1], "
                    "tolerance: 1}}]"),
        "s.yaml:4:76: error: 'improve' may take away facets that 'cracks' open: leave out one of them, and better the "
        "mesh where it is made");
    check_one(WITH_OBJECT("material: m, mesh: {ball: {radius: 1, edge: 1}}, repeat: {count: 0, offset: [0, 0, 0]}"),
              "s.yaml:4:72: error: count is '0'; expected a whole number, at least 1 and at most 65535");
    check_one(WITH_OBJECT("material: m, mesh: {ball: {radius: 1, edge: 1}}, repeat: {count: 2, offset: [0, 0, 0]}}\n"
                          "  o_2: {material: m, mesh: {ball: {radius: 1, edge: 1}}"),
              "s.yaml:5:3: error: name 'o_2' stands for two bodies, before at line 4; rename one");
    check_one(WITH_OBJECT("material: m, mesh: {ball: {radius: 1, edge: 1}}, repeat: {count: 2, offset: [0, 0, 9]}}\n"
                          "rigid: {engine: analytic"),
              "s.yaml:5:17: warning: objects that fly under analytic go through one another; give 'engine: bullet' "
              "where they can meet");
}
#define REPEATED(name)                                                                                                 \
    name ": {material: m, mesh: {ball: {radius: 1, edge: 1}}, repeat: {count: 40000, offset: [0, 0, 1]}}"

static void whole_scenes(void **state)
{
    (void)state;
    check_one("", "s.yaml:1:1: error: the file is empty; a scene begins with 'shiver: 1'");
    check_one("# nothing\n", "s.yaml:1:1: error: the file is empty; a scene begins with 'shiver: 1'");
    check_one("- 1\n", "s.yaml:1:1: error: the scene is a list; expected a mapping that begins with 'shiver: 1'");
    check_one("{}", "s.yaml:1:1: error: the scene lacks what it must have: shiver, duration, materials, objects");
    check_one("shiver: 1\nmaterials: {}\nobjects: {}\nduration: 1\n",
              "s.yaml:3:10: error: the scene has no objects; give at least one");
    check_one(SMALL_SCENE "--- 1\n", "s.yaml:7:1: error: a second document begins here; a scene is a single one");
    check_one("a: [1, 2\n", "s.yaml:2:1: error: not valid YAML: flow sequence without a closing bracket");
    check_one("a: 1\n b: 2\n", "s.yaml:1:4: error: not valid YAML: invalid multiline plain key");
    check_one("a: !!float 3\n", "s.yaml:1:4: error: a tag (!...) stands here; scenes use none, remove it");
    check_one("? [a]\n: 3\n", "s.yaml:1:3: error: a list stands where a key was expected; keys are plain words");
    check_one("a: *b\n", "s.yaml:1:4: error: alias *b has no complete anchor &b before it");
    check_one("a: &b [*b]\n", "s.yaml:1:8: error: alias *b has no complete anchor &b before it");
    check_one("a: \"x\\0y\"\n", "s.yaml:1:4: error: the text contains a zero byte, which no value may");
    check_one(
        WITH_OBJECT(
            "material: m, mesh: {ball: {radius: 1, edge: 1}}, repeat: {count: 40000, offset: [0, 0, 1]}}\n  " REPEATED(
                "p") "\n  q: {material: m, mesh: {ball: {radius: 1, edge: 1}}"),
        "s.yaml:4:3: error: 80001 objects with all repeats; at most 65535 are possible");
}

static void bytes_that_are_no_text(void **state)
{
    (void)state;
    static const struct {
        const char *bytes;
        size_t length;
        const char *message;
    } cases[] = {
        {"a: \0 1", 6, "s.yaml:1:4: error: byte 0x00 is not text; a scene is YAML in UTF-8"},
        {"a: 1\nb\x07", 7, "s.yaml:2:2: error: byte 0x07 is not text; a scene is YAML in UTF-8"},
        {"\xC3\xA9\xC3", 3, "s.yaml:1:2: error: byte 0xC3 is not text; a scene is YAML in UTF-8"},
        {"\xED\xA0\x80", 3, "s.yaml:1:1: error: byte 0xED is not text; a scene is YAML in UTF-8"},
        {"\xF5\x80\x80\x80", 4, "s.yaml:1:1: error: byte 0xF5 is not text; a scene is YAML in UTF-8"},
        {"\xC0\x80", 2, "s.yaml:1:1: error: byte 0xC0 is not text; a scene is YAML in UTF-8"},
        {"\xE0\x9F\xBF", 3, "s.yaml:1:1: error: byte 0xE0 is not text; a scene is YAML in UTF-8"},
        {"\xFF\xFE s\0h", 6, "s.yaml:1:1: error: byte 0xFF is not text; a scene is YAML in UTF-8"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Parsed parsed = parse_bytes(cases[i].bytes, cases[i].length, NULL, 0);
        assert_int_equal(parsed.status, SHV_BAD_INPUT);
        assert_string_equal(message(&parsed, 0), cases[i].message);
        release(&parsed);
    }
}

static void faults_of_overrides(void **state)
{
    (void)state;
    static const struct {
        const char *override, *message;
    } cases[] = {
        {"duration", "--set duration: error: 'duration' is no assignment; expected a.b.c=value"},
        {"=3", "--set : error: '=3' is no assignment; expected a.b.c=value"},
        {"durations=3", "--set durations: error: unknown key 'durations' in the scene; did you mean 'duration'?"},
        {"output.fil=x", "--set output.fil: error: unknown key 'fil' in output; did you mean 'file'?"},
        {"materials.glass.desity=3",
         "--set materials.glass.desity: error: unknown key 'desity' in materials.glass; did you mean 'density'?"},
        {"materials.glas.density=3",
         "--set materials.glas.density: error: materials has no 'glas'; did you mean 'glass'?"},
        {"obstacles.floor.friction=3",
         "--set obstacles.floor.friction: error: obstacles has no 'floor'; add it as a whole: "
         "--set obstacles.floor={...}"},
        {"duration.x=3", "--set duration.x: error: 'duration' is a value; it has no key 'x' below it"},
        {"gravity.0=3", "--set gravity.0: error: '0' is no element of gravity, which has 0, counted from 0"},
        {"events.x.at=3", "--set events.x.at: error: 'x' is no element of events, which has 0, counted from 0"},
        {"duration=-3", "--set duration: error: duration is '-3'; expected a time in s (or ms, us, \xC2\xB5s, ns, "
                        "min), greater than 0"},
        {"duration=", "--set duration: error: duration has no value; expected a time in s (or ms, us, \xC2\xB5s, ns, "
                      "min), greater than 0"},
        {"duration=[", "--set duration: error: not valid YAML: flow sequence without a closing bracket"},
        {"duration=3 kg",
         "--set duration: error: duration has unit 'kg', which is no unit of time; use one of s, ms, us, "
         "\xC2\xB5s, ns, min"},
        {"output.=3", "--set output.: error: unknown key '' in output; known are file, rate, fracture_every, nodes, "
                      "nodes_within, probe_every or "
                      "probe_interval"},
        {"objects.plate.material=glas",
         "--set objects.plate.material: error: material 'glas' is no material of the scene; did you mean 'glass'?"},
        {"materials.glass.cohesive_strength=.nan", "--set materials.glass.cohesive_strength: error: cohesive_strength "
                                                   "is '.nan'; expected a stress in Pa (or kPa, MPa, "
                                                   "GPa, N/mm2), at least 0, or .inf"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *override = cases[i].override;
        Parsed parsed = parse_bytes(SMALL_SCENE, strlen(SMALL_SCENE), &override, 1);
        assert_int_equal(parsed.status, SHV_BAD_INPUT);
        assert_string_equal(message(&parsed, 0), cases[i].message);
        assert_int_equal(shv_diagnostics_get(parsed.diagnostics, 0)->line, 0);
        release(&parsed);
    }
    static const char *const below_list[] = {"gravity=[0, 0, 1]", "gravity.0.x=3"};
    Parsed parsed = parse_bytes(SMALL_SCENE, strlen(SMALL_SCENE), below_list, 2);
    assert_string_equal(message(&parsed, 0),
                        "--set gravity.0.x: error: an element of gravity is a value; it has no key 'x' below it");
    release(&parsed);
    static const char *const wrong_kind[] = {"materials=3", "materials.glass.density=3"};
    parsed = parse_bytes(SMALL_SCENE, strlen(SMALL_SCENE), wrong_kind, 2);
    const int32_t last = shv_diagnostics_count(parsed.diagnostics) - 1;
    assert_string_equal(message(&parsed, last),
                        "--set materials.glass.density: error: 'materials' is a value in the scene, so nothing "
                        "below it can be set");
    release(&parsed);
}

/* All faults at once, in the order of the file, overrides last; warnings among them. */
static void all_faults_are_listed(void **state)
{
    (void)state;
    static const char text[] =
        "shiver: 2\n"
        "materials:\n"
        "  glass: {density: 0, youngs_modulos: 70e9, poissons_ratio: 0.22, breakable: false}\n"
        "  clay: {density: 1, youngs_modulus: 1, poissons_ratio: 0, fracture_energy: 1, cohesive_strength: 1}\n"
        "objects:\n"
        "  plate: {mesh: {ball: {radius: 1, edge: 0.1}}, material: glss}\n"
        "duration: 1 m\n";
    static const char *const expected[] = {"s.yaml:1:9: error: shiver is '2'",
                                           "s.yaml:3:10: error: materials.glass lacks",
                                           "s.yaml:3:20: error: density is '0'",
                                           "s.yaml:3:23: error: unknown key 'youngs_modulos'",
                                           "s.yaml:4:99: warning: cohesive_strength is above",
                                           "s.yaml:6:59: error: material 'glss'",
                                           "s.yaml:7:11: error: duration has unit 'm'",
                                           "--set seed: error: seed is 'x'"};
    static const char *const override = "seed=x";
    Parsed parsed = parse_bytes(text, strlen(text), &override, 1);
    assert_int_equal(shv_diagnostics_count(parsed.diagnostics), 8);
    for (int32_t i = 0; i < 8; i++)
        if (strncmp(message(&parsed, i), expected[i], strlen(expected[i])) != 0)
            fail_msg("message %d: %s\nexpected %s", (int)i, message(&parsed, i), expected[i]);
    assert_int_equal(shv_diagnostics_errors(parsed.diagnostics), 7);
    assert_int_equal(shv_diagnostics_warnings(parsed.diagnostics), 1);
    assert_int_equal(shv_diagnostics_get(parsed.diagnostics, 5)->line, 6);
    assert_int_equal(shv_diagnostics_get(parsed.diagnostics, 5)->column, 59);
    assert_int_equal(parsed.status, SHV_BAD_INPUT);
    assert_non_null(strstr(parsed.error.message, "7 errors"));
    release(&parsed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_of_a_wrong_kind),
        cmocka_unit_test(references_and_fits),
        cmocka_unit_test(materials),
        cmocka_unit_test(objects),
        cmocka_unit_test(whole_scenes),
        cmocka_unit_test(bytes_that_are_no_text),
        cmocka_unit_test(faults_of_overrides),
        cmocka_unit_test(all_faults_are_listed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
