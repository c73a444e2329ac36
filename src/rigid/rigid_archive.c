#include "rigid/rigid_archive.h"

bool shv_fragments_archive(ShvFragments *fragments, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvFragments, items, SHV_FIELD_BLOCK),   SHV_FIELD_OF(ShvFragments, elements, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvFragments, nodes, SHV_FIELD_BLOCK),   SHV_FIELD_OF(ShvFragments, root, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvFragments, label, SHV_FIELD_BLOCK),   SHV_FIELD_OF(ShvFragments, found, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvFragments, memory, SHV_FIELD_KEPT),   SHV_FIELD_OF(ShvFragments, bonds, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvFragments, boundary, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, fragments, fields);
}

bool shv_flight_body_archive(ShvFlightBody *body, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvFlightBody, offsets, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvFlightBody, facets, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvFlightBody, touched, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvFlightBody, touching, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvFlightBody, arms.offsets, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvFlightBody, arms.facets, SHV_FIELD_KEPT),
    };
    const bool good = SHV_ARCHIVE_STRUCT(archive, body, fields);
    body->arms.offsets = body->offsets;
    body->arms.facets = body->facets;
    return good;
}
