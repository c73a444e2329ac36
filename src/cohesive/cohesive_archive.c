#include "cohesive/cohesive_archive.h"

static const ShvField fields[] = {
    SHV_FIELD_OF(ShvCohesive, facet_cohesive, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, facet_strength, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, facet, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, partner, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, sides, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, area, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, law, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, internal, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, overdrawn, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, force, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, phase, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, bonded, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, born, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, opened, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, front.ahead, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, front.slit, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, initiation.faces, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, failed, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, live, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, rotations, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, couple, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, gaps, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, apart, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, chunks, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, points, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, cluster, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, cluster_corner, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, corners, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, budget, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, pulled_velocity, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, node_news, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, corner_nodes, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, origin_fill, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, facet_value, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, facet_watch, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, face_weight, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, faces, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, search.nodes, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, search.ratio, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, search.mark, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, search.value, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, search.held, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, search.left, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, search.facet_along, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, asked, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, stress_known, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, watched, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, watched_nodes, SHV_FIELD_BLOCK),
    SHV_FIELD_OF(ShvCohesive, node_value, SHV_FIELD_BLOCK),
    /* made by each pull and closing */
    SHV_FIELD_OF(ShvCohesive, closed, SHV_FIELD_ROOM),
    SHV_FIELD_OF(ShvCohesive, struck, SHV_FIELD_ROOM),
    SHV_FIELD_OF(ShvCohesive, kicked_clusters, SHV_FIELD_ROOM),
    SHV_FIELD_OF(ShvCohesive, rotated_clusters, SHV_FIELD_ROOM),
    /* made from the scene, and scratch of a fixed size */
    SHV_FIELD_OF(ShvCohesive, memory, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, model, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, settings, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, list_awake, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, corner_label, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, corner_queue, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, corner_copy, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, solves, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, search.stars, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, initiation.strength, SHV_FIELD_KEPT),
    SHV_FIELD_OF(ShvCohesive, initiation.tension, SHV_FIELD_KEPT),
};

bool shv_cohesive_archive(ShvCohesive *cohesive, const uint8_t *awake, ShvArchive *archive)
{
    /* The lists hold for these flags, wherever they lie. */
    bool listed = cohesive->list_awake == awake;
    if (!shv_archive_bytes(archive, &listed, sizeof listed) || !SHV_ARCHIVE_STRUCT(archive, cohesive, fields))
        return false;
    if (shv_archive_reads(archive)) cohesive->list_awake = listed ? awake : NULL;
    return true;
}
