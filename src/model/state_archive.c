#include "model/state_archive.h"

bool shv_state_archive(ShvState *state, ShvArchive *archive)
{
#define NODE_FIELD(type, name, components) SHV_FIELD_OF(ShvState, name, SHV_FIELD_BLOCK),
    static const ShvField fields[] = {
        SHV_NODE_ARRAYS(NODE_FIELD)
        /* elements */
        SHV_FIELD_OF(ShvState, connectivity, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvState, element_mass, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvState, element_fragment, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvState, corners, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvState, memory, SHV_FIELD_KEPT),
    };
#undef NODE_FIELD
    return SHV_ARCHIVE_STRUCT(archive, state, fields);
}
