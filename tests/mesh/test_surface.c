#include "check.h"

#include "files.h"
#include "mesh/surface.h"

/* ---- a box of 1 × 2 × 3 with a corner at the origin, in every format ------------------------------------- */

static const double box_points[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0},
                                        {0, 0, 3}, {1, 0, 3}, {1, 2, 3}, {0, 2, 3}};
static const int box_faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

/* A growing text or binary file. */
typedef struct Draft {
    char data[8192];
    size_t size;
} Draft;

static void put_text(Draft *draft, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(draft->data + draft->size, sizeof draft->data - draft->size, format, arguments);
    va_end(arguments);
    assert_in_range(length, 0, (int)(sizeof draft->data - draft->size) - 1);
    draft->size += (size_t)length;
}

static void put_bytes(Draft *draft, const void *value, size_t size, bool big_endian)
{
    const unsigned char *bytes = value;
    /* The machine that runs this may be of either order. */
    const uint16_t one = 1;
    const bool own_little = *(const unsigned char *)&one == 1;
    assert_true(draft->size + size <= sizeof draft->data);
    for (size_t i = 0; i < size; i++)
        draft->data[draft->size++] = (char)bytes[own_little == big_endian ? size - 1 - i : i];
}

static void put_float(Draft *draft, double value, bool big_endian)
{
    const float single = (float)value;
    put_bytes(draft, &single, sizeof single, big_endian);
}

static Draft box_obj(void)
{
    /* All ways to name a corner; a face of four and two of three; forward numbers and backward ones. */
    Draft draft = {.size = 0};
    put_text(&draft, "# box\nmtllib none.mtl\no box\n");
    for (int v = 0; v < 8; v++) put_text(&draft, "v %g %g %g\n", box_points[v][0], box_points[v][1], box_points[v][2]);
    put_text(&draft, "v 9 9 9\nvt 0 0\nvn 0 0 1\ns off\n");
    put_text(&draft, "f 1 4 3 2\nf 5/1 6/1 7/1 8/1\r\nf 1//1 2//1 6//1 5//1\nf 2/1/1 3/1/1 7/1/1 6/1/1\n");
    put_text(&draft, "f -7 -6 -2\nf -7 -2 -3 # split by hand\ng last\nf 4 1 5 8\n");
    return draft;
}

static Draft box_stl_text(void)
{
    Draft draft = {.size = 0};
    put_text(&draft, "SOLID box\n");
    for (int f = 0; f < 12; f++) {
        const int *face = box_faces[f / 2];
        const int corners[3] = {face[0], face[1 + f % 2], face[2 + f % 2]};
        put_text(&draft, "  facet normal 0 0 0\n    outer loop\n");
        for (int k = 0; k < 3; k++) {
            const double *x = box_points[corners[k]];
            put_text(&draft, "      vertex %.6e %.6e %.6e\n", x[0], x[1], x[2]);
        }
        put_text(&draft, "    endloop\n  endfacet\n");
    }
    put_text(&draft, "endsolid");
    return draft;
}

static Draft box_stl_binary(void)
{
    Draft draft = {.size = 0};
    /* A head that begins as text files do. */
    put_text(&draft, "solid %-74s", "box");
    const uint32_t count = 12;
    const uint16_t attribute = 0x8000;
    put_bytes(&draft, &count, 4, false);
    for (int f = 0; f < 12; f++) {
        const int *face = box_faces[f / 2];
        const int corners[3] = {face[0], face[1 + f % 2], face[2 + f % 2]};
        for (int k = 0; k < 3; k++) put_float(&draft, (double)NAN, false); /* some writers leave normals undefined */
        for (int k = 0; k < 9; k++) put_float(&draft, box_points[corners[k / 3]][k % 3], false);
        put_bytes(&draft, &attribute, 2, false);
    }
    return draft;
}

static Draft box_ply_text(void)
{
    Draft draft = {.size = 0};
    put_text(&draft, "ply\nformat ascii 1.0\ncomment box\nelement vertex 8\nproperty float32 z\nproperty float x\n"
                     "property uchar red\nproperty double y\nelement face 6\nproperty int group\n"
                     "property list uchar int vertex_index\nend_header\n");
    for (int v = 0; v < 8; v++)
        put_text(&draft, "%g %g 255 %g\n", box_points[v][2], box_points[v][0], box_points[v][1]);
    for (int f = 0; f < 6; f++)
        put_text(&draft, "7 4 %d %d %d %d\n", box_faces[f][0], box_faces[f][1], box_faces[f][2], box_faces[f][3]);
    return draft;
}

/* Faces first, lists to be stepped over, every width of number. */
static Draft box_ply_binary(bool big_endian)
{
    Draft draft = {.size = 0};
    put_text(&draft,
             "ply\nformat binary_%s_endian 1.0\nelement face 6\nproperty list uint8 float texcoord\n"
             "property list ushort uint vertex_indices\nelement extra 1\nproperty list int short values\n"
             "element vertex 8\nproperty char mark\nproperty double x\nproperty float y\nproperty short z\n"
             "end_header\n",
             big_endian ? "big" : "little");
    for (int f = 0; f < 6; f++) {
        const uint8_t two = 2;
        const uint16_t four = 4;
        put_bytes(&draft, &two, 1, big_endian);
        put_float(&draft, 0.5, big_endian);
        put_float(&draft, 0.25, big_endian);
        put_bytes(&draft, &four, 2, big_endian);
        for (int k = 0; k < 4; k++) {
            const uint32_t corner = (uint32_t)box_faces[f][k];
            put_bytes(&draft, &corner, 4, big_endian);
        }
    }
    const int32_t one = 1;
    const int16_t value = -5;
    put_bytes(&draft, &one, 4, big_endian);
    put_bytes(&draft, &value, 2, big_endian);
    for (int v = 0; v < 8; v++) {
        const int8_t mark = -1;
        const int16_t z = (int16_t)box_points[v][2];
        put_bytes(&draft, &mark, 1, big_endian);
        put_bytes(&draft, &box_points[v][0], 8, big_endian);
        put_float(&draft, box_points[v][1], big_endian);
        put_bytes(&draft, &z, 2, big_endian);
    }
    return draft;
}

typedef struct Format {
    const char *name;
    Draft draft;
    size_t complete; /* bytes without which the file must be refused */
} Format;
enum { FORMATS = 6 };

static void make_formats(Format formats[FORMATS])
{
    formats[0] = (Format){.name = "a.obj", .draft = box_obj()};
    formats[1] = (Format){.name = "b.STL", .draft = box_stl_text()};
    formats[2] = (Format){.name = "c.stl", .draft = box_stl_binary()};
    formats[3] = (Format){.name = "d.Ply", .draft = box_ply_text()};
    formats[4] = (Format){.name = "e.ply", .draft = box_ply_binary(false)};
    formats[5] = (Format){.name = "f.ply", .draft = box_ply_binary(true)};
    for (int i = 0; i < FORMATS; i++) formats[i].complete = formats[i].draft.size;
    /* The last face of the text files can lose its line's end, and nothing else. */
    formats[0].complete -= 1;
    formats[3].complete -= 1;
}

static ShvSurface read_surface(const char *name, const void *data, size_t size, double scale)
{
    ShvError error;
    ShvSurface surface;
    const TemporaryFile file = temporary_file(name);
    write_bytes(file.path, data, size);
    check_ok(shv_surface_read(&surface, NULL, SHV_PART_SHAPE, file.path, scale, &error), error);
    remove_temporary_file(&file);
    return surface;
}

static ShvSurface text_surface(const char *name, const char *text)
{
    return read_surface(name, text, strlen(text), 1.0);
}

/* Mass properties of a homogeneous box; the terms of a sum are at most `size` times the result. */
static void check_box_mass(const ShvSurface *surface, double scale)
{
    const double a = scale, b = 2.0 * scale, c = 3.0 * scale, volume = a * b * c;
    const ShvMassProperties mass = shv_surface_mass(surface);
    check_near(mass.mass, volume, 1e-14 * volume);
    check_near(mass.centre.x, 0.5 * a, 1e-14 * c);
    check_near(mass.centre.y, 0.5 * b, 1e-14 * c);
    check_near(mass.centre.z, 0.5 * c, 1e-14 * c);
    const double diagonal[3] = {(b * b + c * c) / 12.0, (c * c + a * a) / 12.0, (a * a + b * b) / 12.0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            check_near(mass.inertia.m[i][j], i == j ? volume * diagonal[i] : 0.0, 1e-13 * volume * c * c);
}

static void reads_every_format(void **state)
{
    (void)state;
    Format formats[FORMATS];
    make_formats(formats);
    for (int i = 0; i < FORMATS; i++) {
        ShvError error;
        ShvSurface surface = read_surface(formats[i].name, formats[i].draft.data, formats[i].draft.size, 0.001);
        assert_int_equal(surface.node_count, 8);
        assert_int_equal(surface.triangle_count, 12);
        check_ok(shv_surface_require_closed(&surface, formats[i].name, &error), error);
        check_box_mass(&surface, 0.001);
        shv_surface_release(&surface);
    }
}

/* Only whole, closed surfaces count as read: a text that ends after a face is a file too. */
static ShvStatus read_once(ShvMemory *memory, const char *path, ShvError *error)
{
    ShvSurface surface;
    ShvStatus status = shv_surface_read(&surface, memory, SHV_PART_SHAPE, path, 1.0, error);
    if (status != SHV_OK) {
        assert_null(surface.positions);
        return status;
    }
    status = shv_surface_require_closed(&surface, path, error);
    if (status == SHV_OK) assert_true(shv_surface_mass(&surface).mass > 0.0);
    shv_surface_release(&surface);
    return status;
}

static void refuses_cut_off_files(void **state)
{
    (void)state;
    Format formats[FORMATS];
    make_formats(formats);
    for (int i = 0; i < FORMATS; i++) {
        const Bytes bytes = {formats[i].draft.data, formats[i].draft.size};
        check_truncations(read_once, bytes, formats[i].name, formats[i].complete);
    }
}

static void survives_corrupted_files(void **state)
{
    (void)state;
    Format formats[FORMATS];
    make_formats(formats);
    for (int i = 0; i < FORMATS; i++) {
        const Bytes bytes = {formats[i].draft.data, formats[i].draft.size};
        check_corruptions(read_once, bytes, formats[i].name, 1000);
    }
}

/* ---- refinement ---------------------------------------------------------------------------------------------- */

/* An irregular tetrahedron: no two edges are equally long. */
static const char tetrahedron[] =
    "v 0 0 0\nv 1.3 0.1 0\nv 0.2 1.1 -0.1\nv 0.3 0.4 1.7\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

static double edge_length(const ShvSurface *s, int32_t a, int32_t b)
{
    return shv_norm(shv_sub(shv_surface_position(s, a), shv_surface_position(s, b)));
}

static double longest_edge(const ShvSurface *s)
{
    double longest = 0.0;
    for (int32_t i = 0; i < 3 * s->triangle_count; i++)
        longest = fmax(longest, edge_length(s, s->triangles[i], s->triangles[i / 3 * 3 + (i + 1) % 3]));
    return longest;
}

static double smallest_angle(const ShvSurface *s)
{
    double smallest = 4.0;
    for (int32_t i = 0; i < 3 * s->triangle_count; i++) {
        const int32_t *t = s->triangles + i / 3 * 3;
        const ShvVec3 here = shv_surface_position(s, t[i % 3]);
        const ShvVec3 a = shv_sub(shv_surface_position(s, t[(i + 1) % 3]), here);
        const ShvVec3 b = shv_sub(shv_surface_position(s, t[(i + 2) % 3]), here);
        smallest = fmin(smallest, atan2(shv_norm(shv_cross(a, b)), shv_dot(a, b)));
    }
    return smallest;
}

/* The plain method: look for the longest edge among all, split its two triangles, again. */
enum { NAIVE_MOST = 256 };
static void naive_split(double points[][3], int *point_count, int triangles[][3], int *triangle_count)
{
    double longest = -1.0;
    int a = 0, b = 0;
    for (int i = 0; i < 3 * *triangle_count; i++) {
        const int p = triangles[i / 3][i % 3], q = triangles[i / 3][(i + 1) % 3];
        const double length = shv_norm(shv_sub(shv_load3(points[p]), shv_load3(points[q])));
        if (length <= longest) continue;
        longest = length;
        a = p;
        b = q;
    }
    const int middle = (*point_count)++;
    for (int k = 0; k < 3; k++) points[middle][k] = 0.5 * (points[a][k] + points[b][k]);
    for (int t = *triangle_count - 1; t >= 0; t--) {
        int at_a = -1, at_b = -1;
        for (int k = 0; k < 3; k++) {
            if (triangles[t][k] == a) at_a = k;
            if (triangles[t][k] == b) at_b = k;
        }
        if (at_a < 0 || at_b < 0) continue;
        memcpy(triangles[*triangle_count], triangles[t], sizeof triangles[t]);
        triangles[t][at_a] = middle;
        triangles[(*triangle_count)++][at_b] = middle;
    }
}

static void splits_the_longest_edges_first(void **state)
{
    (void)state;
    double points[NAIVE_MOST][3];
    int triangles[2 * NAIVE_MOST][3], point_count = 4, triangle_count = 4;
    const ShvSurface start = text_surface("a.obj", tetrahedron);
    memcpy(points, start.positions, 12 * sizeof(double));
    for (int i = 0; i < 12; i++) triangles[i / 3][i % 3] = start.triangles[i];
    for (int target = 6; target <= 240; target += 2) {
        ShvError error;
        ShvSurface surface = text_surface("a.obj", tetrahedron);
        naive_split(points, &point_count, triangles, &triangle_count);
        check_ok(shv_surface_refine(&surface, target, &error), error);
        assert_int_equal(surface.triangle_count, target);
        assert_int_equal(surface.node_count, point_count);
        double longest = 0.0;
        for (int i = 0; i < 3 * triangle_count; i++)
            longest = fmax(longest, shv_norm(shv_sub(shv_load3(points[triangles[i / 3][i % 3]]),
                                                     shv_load3(points[triangles[i / 3][(i + 1) % 3]]))));
        /* Equal halves may be split in either order: what is longest then does not depend on it. */
        check_near(longest_edge(&surface), longest, 0.0);
        shv_surface_release(&surface);
    }
    ShvSurface done = start;
    shv_surface_release(&done);
}

static void keeps_shape_and_angles(void **state)
{
    (void)state;
    ShvError error;
    ShvSurface surface = text_surface("a.obj", tetrahedron);
    const double angle = smallest_angle(&surface);
    const ShvMassProperties before = shv_surface_mass(&surface);
    check_ok(shv_surface_refine(&surface, 4, &error), error);
    assert_int_equal(surface.triangle_count, 4);
    check_ok(shv_surface_refine(&surface, 9999, &error), error);
    assert_int_equal(surface.triangle_count, 10000);
    assert_int_equal(surface.node_count, 5002); /* Euler: V = T/2 + 2 */
    check_ok(shv_surface_require_closed(&surface, "refined", &error), error);
    const ShvMassProperties after = shv_surface_mass(&surface);
    /* 1e4 terms and midpoints, each rounded once. */
    check_near(after.mass, before.mass, 1e-12 * before.mass);
    check_near(shv_norm(shv_sub(after.centre, before.centre)), 0.0, 1e-12);
    assert_true(smallest_angle(&surface) >= 0.5 * angle - 1e-12);
    shv_surface_release(&surface);
}

static void refuses_to_refine(void **state)
{
    (void)state;
    ShvError error;
    ShvSurface surface = text_surface("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    check_fails(shv_surface_refine(&surface, 10, &error), SHV_BAD_INPUT, error, "only a closed surface");
    assert_int_equal(surface.triangle_count, 1);
    check_fails(shv_surface_refine(&surface, INT64_MAX, &error), SHV_BAD_INPUT, error, "at most");
    shv_surface_release(&surface);
}

/* ---- closedness ------------------------------------------------------------------------------------------------ */

static void turns_an_inside_out_surface(void **state)
{
    (void)state;
    ShvError error;
    ShvSurface surface = text_surface("a.obj", tetrahedron);
    const double volume = shv_surface_mass(&surface).mass;
    assert_true(volume > 0.0);
    for (int t = 0; t < 4; t++) {
        const int32_t kept = surface.triangles[3 * t];
        surface.triangles[3 * t] = surface.triangles[3 * t + 2];
        surface.triangles[3 * t + 2] = kept;
    }
    check_ok(shv_surface_require_closed(&surface, "a", &error), error);
    check_near(shv_surface_mass(&surface).mass, volume, 1e-15 * volume);
    shv_surface_release(&surface);
}

static void check_not_closed(const char *text, const char *part)
{
    ShvError error;
    ShvSurface surface = text_surface("a.obj", text);
    check_fails(shv_surface_require_closed(&surface, "thing.obj", &error), SHV_BAD_INPUT, error, part);
    assert_ptr_equal(strstr(error.message, "thing.obj: "), error.message);
    shv_surface_release(&surface);
}

#define POINTS "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 2 0 0\n"
static void refuses_what_is_not_closed(void **state)
{
    (void)state;
    check_not_closed(POINTS "f 1 3 2\nf 1 2 4\nf 2 3 4\n", "triangle 0 with corners (0, 0, 0), (0, 1, 0)");
    check_not_closed(POINTS "f 1 3 2\nf 1 2 4\nf 2 3 4\n", "has an edge without a neighbour");
    check_not_closed(POINTS "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 3 4\n", "in the same direction as triangle");
    check_not_closed(POINTS "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 4 3\n", "triangle 4");
    check_not_closed(POINTS "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 2 5\n", "has no area");
    check_not_closed(POINTS "f 1 2 3\nf 1 3 2\n", "encloses no volume");
}

static void merges_and_drops(void **state)
{
    (void)state;
    /* Zero and minus zero are one place; node 5 is one with node 2; the last face collapses; node 6 is unused. */
    ShvError error;
    ShvSurface surface = text_surface("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 0 1\nv 1 -0 0\nv 7 7 7\nv 0 -0.0 0\n"
                                               "f 1 3 2\nf 7 5 4\nf 2 3 4\nf 1 4 3\nf 2 3 5\n");
    assert_int_equal(surface.node_count, 4);
    assert_int_equal(surface.triangle_count, 4);
    check_ok(shv_surface_require_closed(&surface, "a", &error), error);
    check_near(shv_surface_mass(&surface).mass, 1.0 / 6.0, 1e-16);
    shv_surface_release(&surface);
}

/* A regular tetrahedron far from the origin keeps the digits that its coordinates have. */
static void far_away_mass_is_exact(void **state)
{
    (void)state;
    ShvSurface surface =
        text_surface("a.obj", "v 1048577 1048577 1048577\nv 1048577 1048575 1048575\nv 1048575 1048577 1048575\n"
                              "v 1048575 1048575 1048577\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
    const ShvMassProperties mass = shv_surface_mass(&surface);
    check_near(mass.mass, 8.0 / 3.0, 1e-15);
    check_near(mass.centre.x, 1048576.0, 2e-10); /* its last digit */
    /* Second moments of four points at distance √3, each axis: V/20 × 4. */
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) check_near(mass.inertia.m[i][j], i == j ? 8.0 / 3.0 * 8.0 / 20.0 : 0.0, 1e-14);
    shv_surface_release(&surface);
}

/* ---- bad files ------------------------------------------------------------------------------------------------ */

#define PLY      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACE "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define STL      "solid a\nfacet normal 0 0 1\nouter loop\n"

static void names_what_is_wrong(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text, *part;
    } cases[] = {
        {"a.off", "OFF", "a.off: a surface file must end in .obj, .stl or .ply"},
        {"obj", "v 0 0 0", "must end in"},
        {"a.obj", "", "no triangles"},
        {"a.obj", "v 0 0\n", "a.obj:1: expected a coordinate, but the line ends"},
        {"a.obj", "v 0 0 nan\n", "a.obj:1: expected a coordinate, a finite number, not 'nan'"},
        {"a.obj", "v 0 0 0\n\nf 1 1 2\n", "a.obj:3: vertex 2 is not among the 1 vertices so far"},
        {"a.obj", "v 0 0 0\nf 0 1 1\n", "a.obj:2: vertex 0"},
        {"a.obj", "v 0 0 0\nf 1 -2 1\n", "a.obj:2: vertex -2"},
        {"a.obj", "v 0 0 0\nf 1 1 99999999999999999999\n", "a.obj:2: expected the number of a vertex"},
        {"a.obj", "v 0 0 0\nf 1 1 a\n", "not 'a'"},
        {"a.obj", "v 0 0 0\nf 1 1\n", "a.obj:2: a face needs at least three"},
        {"a.stl", "solid\nfacet\nouter\nvertex 0 0 0\nvertex 0 0 0\nendloop\n",
         "a.stl:6: expected 'vertex', not 'endloop'"},
        {"a.stl", STL "vertex 0 0\n", "a.stl:4: expected a coordinate"},
        {"a.stl", STL "vertex 0 0 0 0\n", "expected the end of the line"},
        {"a.stl", "solid a\nendsolid a\nfacet\n", "a.stl:3: expected 'solid', not 'facet'"},
        {"a.stl", "solid a\n", "the file ends without 'endsolid'"},
        {"a.stl", "solid a\nendsolid a\n", "no triangles"},
        {"a.stl", "something else", "neither text"},
        {"a.ply", "plyx\n", "a.ply:1: a PLY file begins with 'ply'"},
        {"a.ply", "ply\nend_header\n", "names no format"},
        {"a.ply", "ply\nformat utf8 1.0\n", "a.ply:2: unknown format 'utf8'"},
        {"a.ply", "ply\nproperty float x\n", "before the first element"},
        {"a.ply", "ply\nelement vertex 1\nproperty quad x\n", "a.ply:3: unknown type 'quad'"},
        {"a.ply", "ply\nelement vertex 1\nelement vertex 1\n", "'vertex' is given twice"},
        {"a.ply", "ply\nelement vertex 1\nproperty float x\nproperty float x\n", "'x' is given twice"},
        {"a.ply", "ply\nelement face 1\nproperty list float int vertex_indices\n", "count must be whole"},
        {"a.ply", "ply\nelement vertex -1\n", "must lie between 0"},
        {"a.ply", "ply\nnonsense\n", "unknown keyword 'nonsense'"},
        {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n", "x, y and z is missing"},
        {"a.ply", PLY "end_header\n", "strips"},
        {"a.ply", PLY "element", "expected the name of an element, but the line ends"},
        {"a.ply", PLY "comment", "the head does not end"},
        {"a.ply", PLY PLY_FACE "0 0 0\n0 0 1\n0 1\n", "a.ply:12: expected a number, but the line ends"},
        {"a.ply", PLY PLY_FACE "0 0 0\n0 0 1\n0 1 0\n3 0 1 3\n", "a.ply:13: a face uses vertex 3"},
        {"a.ply", PLY PLY_FACE "0 0 0\n0 0 1\n0 1 0\n3 0 1 1.5\n", "a face uses vertex 1.5"},
        {"a.ply", PLY PLY_FACE "0 0 0\n0 0 1\n0 1 0\n2 0 1\n", "at least three vertices, not 2"},
        {"a.ply", PLY PLY_FACE "0 0 0\n0 0 1\n0 1 0\n-3 0 1\n", "a list cannot have -3 entries"},
        {"a.ply", PLY PLY_FACE "0 0 0\n0 0 1\n0 1 0\n3 0 1 2\n3 0 1 2\n", "a.ply:14: the file goes on"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n",
         "2000000000 elements are announced"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_text_fails(read_once, cases[i].name, cases[i].text, cases[i].part);
}

static void checks_the_scale(void **state)
{
    (void)state;
    ShvError error;
    ShvSurface surface;
    const TemporaryFile file = temporary_file("a.obj");
    write_bytes(file.path, tetrahedron, strlen(tetrahedron));
    static const double scales[] = {0.0, -1.0, HUGE_VAL, (double)NAN};
    for (int i = 0; i < 4; i++)
        check_fails(shv_surface_read(&surface, NULL, SHV_PART_SHAPE, file.path, scales[i], &error), SHV_BAD_INPUT,
                    error, "scale must be a positive number");
    check_fails(shv_surface_read(&surface, NULL, SHV_PART_SHAPE, file.path, 1.7e308, &error), SHV_BAD_INPUT, error,
                "a.obj:2: a scaled coordinate is not finite");
    remove_temporary_file(&file);
    check_fails(shv_surface_read(&surface, NULL, SHV_PART_SHAPE, file.path, 1.0, &error), SHV_FILE_ERROR, error,
                "a.obj");
}

static ShvStatus read_and_refine(ShvMemory *memory, const char *path, ShvError *error)
{
    ShvSurface surface;
    SHV_TRY(shv_surface_read(&surface, memory, SHV_PART_SHAPE, path, 1.0, error));
    assert_true(shv_memory_bytes(memory, SHV_PART_SHAPE) > 0);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_GENERAL), 0);
    ShvStatus status = shv_surface_require_closed(&surface, path, error);
    if (status == SHV_OK) {
        status = shv_surface_refine(&surface, 100, error);
        /* A failed refinement leaves the surface as it was. */
        if (status != SHV_OK) assert_int_equal(surface.triangle_count, 12);
    }
    shv_surface_release(&surface);
    return status;
}

static void survives_failing_allocations(void **state)
{
    (void)state;
    Format formats[FORMATS];
    make_formats(formats);
    for (int i = 0; i < FORMATS; i++) {
        const TemporaryFile file = temporary_file(formats[i].name);
        write_bytes(file.path, formats[i].draft.data, formats[i].draft.size);
        check_allocation_failures(read_and_refine, file.path);
        remove_temporary_file(&file);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_every_format),
        cmocka_unit_test(refuses_cut_off_files),
        cmocka_unit_test(survives_corrupted_files),
        cmocka_unit_test(splits_the_longest_edges_first),
        cmocka_unit_test(keeps_shape_and_angles),
        cmocka_unit_test(refuses_to_refine),
        cmocka_unit_test(turns_an_inside_out_surface),
        cmocka_unit_test(refuses_what_is_not_closed),
        cmocka_unit_test(merges_and_drops),
        cmocka_unit_test(far_away_mass_is_exact),
        cmocka_unit_test(names_what_is_wrong),
        cmocka_unit_test(checks_the_scale),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
