/* PLY: a head that describes elements and their properties, then the elements as text or bytes of either order. Of
   "vertex" the properties x, y, z are used, of "face" the list of corners; everything else is stepped over. */
#include <math.h>
#include <string.h>

#include "mesh/soup.h"

enum { MOST_ELEMENTS = 16, MOST_PROPERTIES = 64 };

typedef enum Type { NO_TYPE, INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64 } Type;
static const int type_bytes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};

typedef enum Role { ROLE_NONE, ROLE_X, ROLE_Y, ROLE_Z, ROLE_CORNERS } Role;
typedef struct Property {
    Type type, count_type; /* count_type: of a list, else NO_TYPE */
    Role role;
} Property;
typedef enum ElementKind { ELEMENT_OTHER, ELEMENT_VERTEX, ELEMENT_FACE } ElementKind;
typedef struct Element {
    ElementKind kind;
    int64_t count;
    int property_count;
    Property properties[MOST_PROPERTIES];
} Element;
typedef struct Ply {
    ShvScan *scan;
    ShvSoup *soup;
    bool big_endian; /* binary files */
    int element_count;
    Element elements[MOST_ELEMENTS];
    int64_t vertices; /* announced */
} Ply;

/* ---- head ----------------------------------------------------------------------------------------------- */

static Type type_of(ShvWord word)
{
    static const struct {
        const char *name;
        Type type;
    } names[] = {{"char", INT8},     {"int8", INT8},       {"uchar", UINT8},    {"uint8", UINT8},
                 {"short", INT16},   {"int16", INT16},     {"ushort", UINT16},  {"uint16", UINT16},
                 {"int", INT32},     {"int32", INT32},     {"uint", UINT32},    {"uint32", UINT32},
                 {"float", FLOAT32}, {"float32", FLOAT32}, {"double", FLOAT64}, {"float64", FLOAT64}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (shv_word_is(word, names[i].name)) return names[i].type;
    return NO_TYPE;
}

static ShvStatus head_word(ShvScan *scan, const char *what, ShvWord *word, ShvError *error)
{
    if (shv_scan_word(scan, word)) return SHV_OK;
    return shv_scan_fail(scan, error, "expected %s, but the line ends", what);
}

static ShvStatus read_type(ShvScan *scan, Type *type, ShvError *error)
{
    ShvWord word = {0};
    SHV_TRY(head_word(scan, "a type", &word, error));
    *type = type_of(word);
    if (*type != NO_TYPE) return SHV_OK;
    return shv_scan_fail(scan, error, "unknown type '%s'", shv_word_show(word).text);
}

static ShvStatus read_format(Ply *ply, bool *binary, ShvError *error)
{
    ShvWord word = {0};
    SHV_TRY(head_word(ply->scan, "a format", &word, error));
    *binary = !shv_word_is(word, "ascii");
    ply->big_endian = shv_word_is(word, "binary_big_endian");
    if (*binary && !ply->big_endian && !shv_word_is(word, "binary_little_endian"))
        return shv_scan_fail(ply->scan, error, "unknown format '%s'", shv_word_show(word).text);
    return SHV_OK;
}

static ShvStatus read_element(Ply *ply, ShvError *error)
{
    ShvWord word = {0};
    if (ply->element_count == MOST_ELEMENTS)
        return shv_scan_fail(ply->scan, error, "more than %d kinds of elements", MOST_ELEMENTS);
    Element *element = &ply->elements[ply->element_count];
    SHV_TRY(head_word(ply->scan, "the name of an element", &word, error));
    if (shv_word_is(word, "vertex")) element->kind = ELEMENT_VERTEX;
    if (shv_word_is(word, "face")) element->kind = ELEMENT_FACE;
    SHV_TRY(shv_scan_whole(ply->scan, "the number of elements", 0, INT32_MAX, &element->count, error));
    for (int i = 0; element->kind != ELEMENT_OTHER && i < ply->element_count; i++)
        if (ply->elements[i].kind == element->kind)
            return shv_scan_fail(ply->scan, error, "element '%s' is given twice", shv_word_show(word).text);
    if (element->kind == ELEMENT_VERTEX) ply->vertices = element->count;
    ply->element_count++;
    return shv_scan_end_line(ply->scan, error);
}

static Role role_of(const Element *element, const Property *property, ShvWord name)
{
    if (element->kind == ELEMENT_VERTEX && property->count_type == NO_TYPE) {
        if (shv_word_is(name, "x")) return ROLE_X;
        if (shv_word_is(name, "y")) return ROLE_Y;
        if (shv_word_is(name, "z")) return ROLE_Z;
    }
    if (element->kind == ELEMENT_FACE && property->count_type != NO_TYPE &&
        (shv_word_is(name, "vertex_indices") || shv_word_is(name, "vertex_index")))
        return ROLE_CORNERS;
    return ROLE_NONE;
}

/* "property type name" or "property list count-type type name" */
static ShvStatus read_property(Ply *ply, ShvError *error)
{
    ShvWord word = {0};
    if (ply->element_count == 0) return shv_scan_fail(ply->scan, error, "a property stands before the first element");
    Element *element = &ply->elements[ply->element_count - 1];
    if (element->property_count == MOST_PROPERTIES)
        return shv_scan_fail(ply->scan, error, "more than %d properties of an element", MOST_PROPERTIES);
    Property *property = &element->properties[element->property_count];
    SHV_TRY(head_word(ply->scan, "a type", &word, error));
    if (shv_word_is(word, "list")) {
        SHV_TRY(read_type(ply->scan, &property->count_type, error));
        SHV_TRY(read_type(ply->scan, &property->type, error));
        if (property->count_type >= FLOAT32) return shv_scan_fail(ply->scan, error, "a list's count must be whole");
    } else {
        property->type = type_of(word);
        if (property->type == NO_TYPE)
            return shv_scan_fail(ply->scan, error, "unknown type '%s'", shv_word_show(word).text);
    }
    SHV_TRY(head_word(ply->scan, "the name of a property", &word, error));
    property->role = role_of(element, property, word);
    for (int i = 0; property->role != ROLE_NONE && i < element->property_count; i++)
        if (element->properties[i].role == property->role)
            return shv_scan_fail(ply->scan, error, "property '%s' is given twice", shv_word_show(word).text);
    element->property_count++;
    return shv_scan_end_line(ply->scan, error);
}

static ShvStatus require_roles(const Ply *ply, ShvError *error)
{
    unsigned seen = 0;
    for (int i = 0; i < ply->element_count; i++)
        for (int k = 0; k < ply->elements[i].property_count; k++) seen |= 1u << ply->elements[i].properties[k].role;
    if (!(seen & 1u << ROLE_X) || !(seen & 1u << ROLE_Y) || !(seen & 1u << ROLE_Z))
        return shv_scan_fail(ply->scan, error, "element 'vertex' with properties x, y and z is missing");
    if (!(seen & 1u << ROLE_CORNERS))
        return shv_scan_fail(ply->scan, error,
                             "element 'face' with a list 'vertex_indices' is missing (triangle strips "
                             "are not supported)");
    return SHV_OK;
}

static ShvStatus read_head(Ply *ply, ShvError *error)
{
    ShvWord word = {0};
    bool binary = false, has_format = false;
    if (!shv_scan_record(ply->scan) || !shv_scan_word(ply->scan, &word) || !shv_word_is(word, "ply"))
        return shv_scan_fail(ply->scan, error, "a PLY file begins with 'ply'");
    while (shv_scan_record(ply->scan) && shv_scan_word(ply->scan, &word) && !shv_word_is(word, "end_header")) {
        if (shv_word_is(word, "format")) {
            has_format = true;
            SHV_TRY(read_format(ply, &binary, error));
        } else if (shv_word_is(word, "element"))
            SHV_TRY(read_element(ply, error));
        else if (shv_word_is(word, "property"))
            SHV_TRY(read_property(ply, error));
        else if (!shv_word_is(word, "comment") && !shv_word_is(word, "obj_info"))
            return shv_scan_fail(ply->scan, error, "unknown keyword '%s' in the head", shv_word_show(word).text);
    }
    if (!shv_word_is(word, "end_header")) return shv_scan_fail(ply->scan, error, "the head does not end; cut off?");
    if (!has_format) return shv_scan_fail(ply->scan, error, "the head names no format");
    SHV_TRY(require_roles(ply, error));
    shv_scan_leave_line(ply->scan);
    ply->scan->binary = binary;
    return SHV_OK;
}

/* ---- values ----------------------------------------------------------------------------------------------- */

static uint64_t gather_bytes(const unsigned char *bytes, int count, bool big_endian)
{
    uint64_t bits = 0;
    for (int i = 0; i < count; i++) bits |= (uint64_t)bytes[big_endian ? count - 1 - i : i] << 8 * i;
    return bits;
}

static double value_of(Type type, uint64_t bits)
{
    const uint32_t half = (uint32_t)bits;
    float single;
    double value;
    switch (type) {
    case INT8:
        return bits < 0x80 ? (double)bits : (double)bits - 0x100;
    case INT16:
        return bits < 0x8000 ? (double)bits : (double)bits - 0x10000;
    case INT32:
        return bits < 0x80000000 ? (double)bits : (double)bits - 4294967296.0;
    case FLOAT32:
        memcpy(&single, &half, sizeof single);
        return (double)single;
    case FLOAT64:
        memcpy(&value, &bits, sizeof value);
        return value;
    case NO_TYPE:
    case UINT8:
    case UINT16:
    case UINT32:
        break;
    }
    return (double)bits;
}

/* Every type's values are doubles without loss. */
static ShvStatus read_value(Ply *ply, Type type, double *value, ShvError *error)
{
    if (!ply->scan->binary) return shv_scan_number(ply->scan, "a number", value, error);
    const unsigned char *bytes = shv_scan_bytes(ply->scan, (size_t)type_bytes[type]);
    if (!bytes) return shv_scan_fail(ply->scan, error, "the file ends within an element; it is cut off");
    *value = value_of(type, gather_bytes(bytes, type_bytes[type], ply->big_endian));
    return SHV_OK;
}

static ShvStatus read_corner(Ply *ply, Type type, int32_t *corner, ShvError *error)
{
    double value;
    SHV_TRY(read_value(ply, type, &value, error));
    if (!(value >= 0.0 && value < (double)ply->vertices && value == floor(value)))
        return shv_scan_fail(ply->scan, error, "a face uses vertex %.17g, but vertices run from 0 to %lld", value,
                             (long long)ply->vertices - 1);
    *corner = (int32_t)value;
    return SHV_OK;
}

static ShvStatus read_polygon(Ply *ply, Type type, int64_t count, ShvError *error)
{
    int32_t first = 0, previous = 0, corner = 0;
    if (count < 3)
        return shv_scan_fail(ply->scan, error, "a face needs at least three vertices, not %lld", (long long)count);
    SHV_TRY(read_corner(ply, type, &first, error));
    SHV_TRY(read_corner(ply, type, &previous, error));
    for (int64_t i = 2; i < count; i++) {
        SHV_TRY(read_corner(ply, type, &corner, error));
        SHV_TRY(shv_soup_add_triangle(ply->soup, ply->scan, first, previous, corner, error));
        previous = corner;
    }
    return SHV_OK;
}

static ShvStatus read_list(Ply *ply, const Property *property, ShvError *error)
{
    double count, ignored;
    SHV_TRY(read_value(ply, property->count_type, &count, error));
    if (!(count >= 0.0 && count <= INT32_MAX && count == floor(count)))
        return shv_scan_fail(ply->scan, error, "a list cannot have %.17g entries", count);
    if (property->role == ROLE_CORNERS) return read_polygon(ply, property->type, (int64_t)count, error);
    for (int64_t i = 0; i < (int64_t)count; i++) SHV_TRY(read_value(ply, property->type, &ignored, error));
    return SHV_OK;
}

static ShvStatus read_entry(Ply *ply, const Element *element, ShvError *error)
{
    double value, x[3] = {0};
    for (int i = 0; i < element->property_count; i++) {
        const Property *property = &element->properties[i];
        if (property->count_type != NO_TYPE) {
            SHV_TRY(read_list(ply, property, error));
            continue;
        }
        SHV_TRY(read_value(ply, property->type, &value, error));
        if (property->role >= ROLE_X && property->role <= ROLE_Z) x[property->role - ROLE_X] = value;
    }
    if (element->kind == ELEMENT_VERTEX) return shv_soup_add_vertex(ply->soup, ply->scan, shv_load3(x), error);
    return SHV_OK;
}

/* As text every entry has its own line. An element without properties takes no place in the file. */
static ShvStatus read_entries(Ply *ply, const Element *element, ShvError *error)
{
    if (element->property_count == 0) return SHV_OK;
    SHV_TRY(shv_scan_check_count(ply->scan, element->count, 1, "elements", error));
    for (int64_t i = 0; i < element->count; i++) {
        if (!ply->scan->binary && !shv_scan_record(ply->scan))
            return shv_scan_fail(ply->scan, error, "the file ends after %lld of %lld elements", (long long)i,
                                 (long long)element->count);
        SHV_TRY(read_entry(ply, element, error));
        if (!ply->scan->binary) SHV_TRY(shv_scan_end_line(ply->scan, error));
    }
    return SHV_OK;
}

static ShvStatus read_file(Ply *ply, ShvError *error)
{
    SHV_TRY(read_head(ply, error));
    for (int i = 0; i < ply->element_count; i++) SHV_TRY(read_entries(ply, &ply->elements[i], error));
    if (ply->scan->binary ? ply->scan->at < ply->scan->size : shv_scan_record(ply->scan))
        return shv_scan_fail(ply->scan, error,
                             "the file goes on after its last element; are the counts of the head right?");
    return SHV_OK;
}

ShvStatus shv_read_ply(ShvSoup *soup, ShvScan *scan, ShvError *error)
{
    Ply *ply = shv_allocate(soup->memory, SHV_PART_GENERAL, 1, sizeof *ply);
    if (!ply) return shv_fail_memory(error, "a PLY file", sizeof *ply);
    ply->scan = scan;
    ply->soup = soup;
    const ShvStatus status = read_file(ply, error);
    shv_release(ply);
    return status;
}
