#include "shape/obstacle_archive.h"

static bool obstacle_archive(ShvObstacle *obstacle, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvObstacle, definition, SHV_FIELD_KEPT), SHV_FIELD_OF(ShvObstacle, name, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvObstacle, surface, SHV_FIELD_KEPT),    SHV_FIELD_OF(ShvObstacle, tree, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvObstacle, features, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, obstacle, fields);
}

/* Room for contacts among them holds nothing between steps. */
bool shv_obstacles_archive(ShvObstacles *obstacles, ShvArchive *archive)
{
    bool good = true;
    for (int32_t i = 0; good && i < obstacles->count; i++) good = obstacle_archive(&obstacles->items[i], archive);
    return good;
}
