#include "record/types.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

typedef enum FieldKind {
    FIELD_INT,
    FIELD_LONG,
    FIELD_DOUBLE,
    FIELD_EVENT,
    FIELD_REASON,
    FIELD_SHAPE,
    FIELD_MOTION
} FieldKind;

typedef struct Field {
    const char *name;
    size_t offset;
    int count; /* above 1: an array */
    FieldKind kind;
} Field;

typedef struct RowKind {
    const Field *fields;
    int count;
    size_t size;
} RowKind;

#define FIELD(type, member, count, kind)                                                                               \
    {                                                                                                                  \
#member, offsetof(type, member), count, kind                                                                   \
    }

static const Field FRAGMENT_FIELDS[] = {
    FIELD(ShvFragmentView, id, 1, FIELD_INT),         FIELD(ShvFragmentView, parent, 1, FIELD_INT),
    FIELD(ShvFragmentView, object, 1, FIELD_INT),     FIELD(ShvFragmentView, birth, 1, FIELD_DOUBLE),
    FIELD(ShvFragmentView, death, 1, FIELD_DOUBLE),   FIELD(ShvFragmentView, tets, 1, FIELD_INT),
    FIELD(ShvFragmentView, mass, 1, FIELD_DOUBLE),    FIELD(ShvFragmentView, volume, 1, FIELD_DOUBLE),
    FIELD(ShvFragmentView, inertia, 6, FIELD_DOUBLE), FIELD(ShvFragmentView, reference_centre, 3, FIELD_DOUBLE),
};

static const Field EVENT_FIELDS[] = {
    FIELD(ShvEventView, time, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, kind, 1, FIELD_EVENT),
    FIELD(ShvEventView, fragment, 1, FIELD_INT),
    FIELD(ShvEventView, obstacle, 1, FIELD_INT),
    FIELD(ShvEventView, value, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, kinetic_before, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, kinetic_after, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, strain_before, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, strain_after, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, momentum_before, 3, FIELD_DOUBLE),
    FIELD(ShvEventView, momentum_after, 3, FIELD_DOUBLE),
    FIELD(ShvEventView, angular_before, 3, FIELD_DOUBLE),
    FIELD(ShvEventView, angular_after, 3, FIELD_DOUBLE),
    FIELD(ShvEventView, reason, 1, FIELD_REASON),
    FIELD(ShvEventView, hulls, 1, FIELD_INT),
    FIELD(ShvEventView, mass, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, momentum_scale, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, angular_scale, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, cohesive_before, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, cohesive_after, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, dropped_vibration, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, dropped_strain, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, dropped_cohesive, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, hull_outside, 1, FIELD_DOUBLE),
    FIELD(ShvEventView, hull_missing, 1, FIELD_DOUBLE),
};
_Static_assert(sizeof(ShvRunEvent) == sizeof(int), "the kind of an event is stored as an int");
_Static_assert(sizeof(ShvSwitchReason) == sizeof(int), "the reason of a switch is stored as an int");

#define NUMBER(member, unit) FIELD(ShvLedgerView, member, 1, FIELD_DOUBLE),
#define VECTOR(member, unit) FIELD(ShvLedgerView, member, 3, FIELD_DOUBLE),
static const Field LEDGER_FIELDS[] = {NUMBER(time, "s") SHV_LEDGER_COLUMNS(NUMBER, NUMBER, VECTOR) NUMBER(residual, "J")
                                          NUMBER(largest, "J")};
#undef NUMBER
#undef VECTOR

static const Field PROGRESS_FIELDS[] = {
    FIELD(ShvProgressView, steps, 1, FIELD_LONG),     FIELD(ShvProgressView, step, 1, FIELD_DOUBLE),
    FIELD(ShvProgressView, courant, 1, FIELD_DOUBLE), FIELD(ShvProgressView, worst_overshoot, 1, FIELD_DOUBLE),
    FIELD(ShvProgressView, alive, 1, FIELD_INT),      FIELD(ShvProgressView, inserted, 1, FIELD_INT),
    FIELD(ShvProgressView, failed, 1, FIELD_INT),     FIELD(ShvProgressView, pieces, 3, FIELD_INT),
};

static const Field SUM_FIELDS[] = {
    FIELD(ShvFrameSum, fragments, 1, FIELD_LONG),
    FIELD(ShvFrameSum, events, 1, FIELD_LONG),
    FIELD(ShvFrameSum, probe_rows, 1, FIELD_LONG),
    FIELD(ShvFrameSum, checksum, 1, FIELD_LONG),
};

static const Field OBSTACLE_FIELDS[] = {
    FIELD(ShvObstacleRow, shape, 1, FIELD_SHAPE),        FIELD(ShvObstacleRow, motion, 1, FIELD_MOTION),
    FIELD(ShvObstacleRow, normal, 3, FIELD_DOUBLE),      FIELD(ShvObstacleRow, offset, 1, FIELD_DOUBLE),
    FIELD(ShvObstacleRow, radius, 1, FIELD_DOUBLE),      FIELD(ShvObstacleRow, size, 3, FIELD_DOUBLE),
    FIELD(ShvObstacleRow, mass, 1, FIELD_DOUBLE),        FIELD(ShvObstacleRow, friction, 1, FIELD_DOUBLE),
    FIELD(ShvObstacleRow, restitution, 1, FIELD_DOUBLE), FIELD(ShvObstacleRow, nodes, 2, FIELD_INT),
    FIELD(ShvObstacleRow, triangles, 2, FIELD_INT),
};
_Static_assert(sizeof(ShvObstacleShape) == sizeof(int), "the shape of an obstacle is stored as an int");
_Static_assert(sizeof(ShvObstacleMotion) == sizeof(int), "the motion of an obstacle is stored as an int");

#define ROW(fields, type)                                                                                              \
    {                                                                                                                  \
        fields, (int)(sizeof fields / sizeof fields[0]), sizeof(type)                                                  \
    }
static const RowKind ROWS[] = {
    [SHV_ROW_FRAGMENT] = ROW(FRAGMENT_FIELDS, ShvFragmentView),
    [SHV_ROW_EVENT] = ROW(EVENT_FIELDS, ShvEventView),
    [SHV_ROW_LEDGER] = ROW(LEDGER_FIELDS, ShvLedgerView),
    [SHV_ROW_PROGRESS] = ROW(PROGRESS_FIELDS, ShvProgressView),
    [SHV_ROW_SUM] = ROW(SUM_FIELDS, ShvFrameSum),
    [SHV_ROW_OBSTACLE] = ROW(OBSTACLE_FIELDS, ShvObstacleRow),
};

/* ---- names of numbers ---- */

typedef struct Name {
    const char *name;
    int value;
} Name;

static const Name EVENT_NAMES[] = {{"wake", SHV_RUN_WAKE},
                                   {"sleep", SHV_RUN_SLEEP},
                                   {"split", SHV_RUN_SPLIT},
                                   {"insertion", SHV_RUN_INSERTION},
                                   {"inversion", SHV_RUN_INVERSION},
                                   {"scene", SHV_RUN_SCENE},
                                   {"bin", SHV_RUN_BIN},
                                   {"squeeze", SHV_RUN_SQUEEZE}};
static const Name REASON_NAMES[] = {
    {"none", SHV_REASON_NONE},   {"contact", SHV_REASON_CONTACT}, {"impact", SHV_REASON_IMPACT},
    {"load", SHV_REASON_LOAD},   {"spin", SHV_REASON_SPIN},       {"audit", SHV_REASON_AUDIT},
    {"quiet", SHV_REASON_QUIET}, {"checks", SHV_REASON_CHECKS},   {"longest", SHV_REASON_LONGEST}};
static const Name SHAPE_NAMES[] = {{"plane", SHV_OBSTACLE_PLANE},
                                   {"sphere", SHV_OBSTACLE_SPHERE},
                                   {"box", SHV_OBSTACLE_BOX},
                                   {"mesh", SHV_OBSTACLE_MESH}};
static const Name MOTION_NAMES[] = {
    {"fixed", SHV_OBSTACLE_FIXED}, {"scripted", SHV_OBSTACLE_SCRIPTED}, {"free", SHV_OBSTACLE_FREE}};
enum {
    SHAPE_NAME_COUNT = sizeof SHAPE_NAMES / sizeof SHAPE_NAMES[0],
    MOTION_NAME_COUNT = sizeof MOTION_NAMES / sizeof MOTION_NAMES[0],
    EVENT_NAME_COUNT = sizeof EVENT_NAMES / sizeof EVENT_NAMES[0],
    REASON_NAME_COUNT = sizeof REASON_NAMES / sizeof REASON_NAMES[0]
};

static const char *name_of(const Name *names, int count, int value)
{
    for (int i = 0; i < count; i++)
        if (names[i].value == value) return names[i].name;
    return "unknown";
}

const char *shv_run_event_name(ShvRunEvent kind)
{
    return name_of(EVENT_NAMES, EVENT_NAME_COUNT, (int)kind);
}

const char *shv_switch_reason_name(ShvSwitchReason reason)
{
    return name_of(REASON_NAMES, REASON_NAME_COUNT, (int)reason);
}

/* HDF5's enum type: readers see the names. */
static hid_t enum_type(const Name *names, int count, bool file)
{
    const hid_t type = H5Tenum_create(file ? H5T_STD_I32LE : H5T_NATIVE_INT32);
    for (int i = 0; type >= 0 && i < count; i++) {
        const int32_t value = names[i].value;
        if (H5Tenum_insert(type, names[i].name, &value) >= 0) continue;
        H5Tclose(type);
        return -1;
    }
    return type;
}

/* Closed by the caller. */
static hid_t scalar_type(FieldKind kind, bool file)
{
    switch (kind) {
    case FIELD_INT:
        return H5Tcopy(file ? H5T_STD_I32LE : H5T_NATIVE_INT32);
    case FIELD_LONG:
        return H5Tcopy(file ? H5T_STD_I64LE : H5T_NATIVE_INT64);
    case FIELD_EVENT:
        return enum_type(EVENT_NAMES, EVENT_NAME_COUNT, file);
    case FIELD_REASON:
        return enum_type(REASON_NAMES, REASON_NAME_COUNT, file);
    case FIELD_SHAPE:
        return enum_type(SHAPE_NAMES, SHAPE_NAME_COUNT, file);
    case FIELD_MOTION:
        return enum_type(MOTION_NAMES, MOTION_NAME_COUNT, file);
    case FIELD_DOUBLE:
        break;
    }
    return H5Tcopy(file ? H5T_IEEE_F64LE : H5T_NATIVE_DOUBLE);
}

static hid_t field_type(const Field *field, bool file)
{
    const hid_t scalar = scalar_type(field->kind, file);
    if (scalar < 0 || field->count == 1) return scalar;
    const hsize_t count = (hsize_t)field->count;
    const hid_t array = H5Tarray_create2(scalar, 1, &count);
    H5Tclose(scalar);
    return array;
}

static bool insert_field(hid_t compound, const Field *field, size_t offset, bool file)
{
    const hid_t type = field_type(field, file);
    if (type < 0) return false;
    const bool good = H5Tinsert(compound, field->name, offset, type) >= 0;
    H5Tclose(type);
    return good;
}

static size_t field_size(const Field *field)
{
    return (size_t)field->count * (field->kind == FIELD_LONG || field->kind == FIELD_DOUBLE ? 8 : 4);
}

static size_t packed_size(const RowKind *row)
{
    size_t size = 0;
    for (int i = 0; i < row->count; i++) size += field_size(&row->fields[i]);
    return size;
}

static hid_t make_type(ShvRow which, bool file)
{
    const RowKind *row = &ROWS[which];
    const hid_t compound = H5Tcreate(H5T_COMPOUND, file ? packed_size(row) : row->size);
    if (compound < 0) return compound;
    size_t packed = 0;
    for (int i = 0; i < row->count; i++) {
        const Field *field = &row->fields[i];
        if (!insert_field(compound, field, file ? packed : field->offset, file)) {
            H5Tclose(compound);
            return -1;
        }
        packed += field_size(field);
    }
    return compound;
}

hid_t shv_row_memory_type(ShvRow row)
{
    return make_type(row, false);
}

hid_t shv_row_file_type(ShvRow row)
{
    return make_type(row, true);
}

void shv_row_pack(ShvRow which, const void *rows, size_t count, unsigned char *packed)
{
    const RowKind *row = &ROWS[which];
    const unsigned char *source = rows;
    for (size_t i = 0; i < count; i++, source += row->size)
        for (int k = 0; k < row->count; k++) {
            const size_t size = field_size(&row->fields[k]);
            memcpy(packed, source + row->fields[k].offset, size);
            packed += size;
        }
}
