#include "conditions/condition_archive.h"

static bool condition_archive(ShvImposedCondition *condition, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvImposedCondition, nodes, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvImposedCondition, before, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvImposedCondition, impulse, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvImposedCondition, facets, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvImposedCondition, definition, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvImposedCondition, origins, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvImposedCondition, origin_count, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, condition, fields);
}

bool shv_imposed_archive(ShvImposed *imposed, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvImposed, memory, SHV_FIELD_KEPT), SHV_FIELD_OF(ShvImposed, items, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvImposed, count, SHV_FIELD_KEPT),  SHV_FIELD_OF(ShvImposed, model, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvImposed, held, SHV_FIELD_BLOCK),
    };
    bool good = SHV_ARCHIVE_STRUCT(archive, imposed, fields);
    for (int32_t i = 0; good && i < imposed->count; i++) good = condition_archive(&imposed->items[i], archive);
    return good;
}
