#include "record/types.h"

#include <stdbool.h>
#include <stddef.h>

#include "base/ledger_fields.h"

typedef enum FieldKind { FIELD_INT, FIELD_LONG, FIELD_DOUBLE } FieldKind;

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
    FIELD(ShvEventView, kind, 1, FIELD_INT),
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
    FIELD(ShvEventView, reason, 1, FIELD_INT),
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

#define NUMBER(member) FIELD(ShvLedgerView, member, 1, FIELD_DOUBLE),
#define VECTOR(member) FIELD(ShvLedgerView, member, 3, FIELD_DOUBLE),
static const Field LEDGER_FIELDS[] = {NUMBER(time) SHV_LEDGER_FIELDS(NUMBER, VECTOR)};
#undef NUMBER
#undef VECTOR

static const Field PROGRESS_FIELDS[] = {
    FIELD(ShvProgressView, steps, 1, FIELD_LONG),     FIELD(ShvProgressView, step, 1, FIELD_DOUBLE),
    FIELD(ShvProgressView, courant, 1, FIELD_DOUBLE), FIELD(ShvProgressView, worst_overshoot, 1, FIELD_DOUBLE),
    FIELD(ShvProgressView, alive, 1, FIELD_INT),      FIELD(ShvProgressView, inserted, 1, FIELD_INT),
    FIELD(ShvProgressView, failed, 1, FIELD_INT),     FIELD(ShvProgressView, pieces, 3, FIELD_INT),
};

#define ROW(fields, type)                                                                                              \
    {                                                                                                                  \
        fields, (int)(sizeof fields / sizeof fields[0]), sizeof(type)                                                  \
    }
static const RowKind ROWS[] = {
    [SHV_ROW_FRAGMENT] = ROW(FRAGMENT_FIELDS, ShvFragmentView),
    [SHV_ROW_EVENT] = ROW(EVENT_FIELDS, ShvEventView),
    [SHV_ROW_LEDGER] = ROW(LEDGER_FIELDS, ShvLedgerView),
    [SHV_ROW_PROGRESS] = ROW(PROGRESS_FIELDS, ShvProgressView),
};

static hid_t scalar_type(FieldKind kind, bool file)
{
    switch (kind) {
    case FIELD_INT:
        return file ? H5T_STD_I32LE : H5T_NATIVE_INT32;
    case FIELD_LONG:
        return file ? H5T_STD_I64LE : H5T_NATIVE_INT64;
    case FIELD_DOUBLE:
        break;
    }
    return file ? H5T_IEEE_F64LE : H5T_NATIVE_DOUBLE;
}

static bool insert_field(hid_t compound, const Field *field, size_t offset, bool file)
{
    const hid_t scalar = scalar_type(field->kind, file);
    if (field->count == 1) return H5Tinsert(compound, field->name, offset, scalar) >= 0;
    const hsize_t count = (hsize_t)field->count;
    const hid_t array = H5Tarray_create2(scalar, 1, &count);
    if (array < 0) return false;
    const bool good = H5Tinsert(compound, field->name, offset, array) >= 0;
    H5Tclose(array);
    return good;
}

static size_t field_size(const Field *field)
{
    return (size_t)field->count * (field->kind == FIELD_INT ? 4 : 8);
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

size_t shv_row_size(ShvRow row)
{
    return ROWS[row].size;
}
