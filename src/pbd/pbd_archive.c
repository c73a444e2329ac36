#include "pbd/pbd_archive.h"

bool shv_bars_archive(ShvBars *bars, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvBars, chunks, SHV_FIELD_BLOCK),      SHV_FIELD_OF(ShvBars, colour_start, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBars, chunk_order, SHV_FIELD_BLOCK), SHV_FIELD_OF(ShvBars, ends, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBars, rest, SHV_FIELD_BLOCK),        SHV_FIELD_OF(ShvBars, awake, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBars, dirty, SHV_FIELD_BLOCK),       SHV_FIELD_OF(ShvBars, met, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBars, seen, SHV_FIELD_BLOCK),        SHV_FIELD_OF(ShvBars, items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBars, item_colour, SHV_FIELD_BLOCK), SHV_FIELD_OF(ShvBars, memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBars, model, SHV_FIELD_KEPT),        SHV_FIELD_OF(ShvBars, corner_start, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBars, corner_list, SHV_FIELD_KEPT),  SHV_FIELD_OF(ShvBars, own_start, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBars, own_list, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, bars, fields);
}

bool shv_relax_archive(ShvRelax *relax, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvRelax, anchors, SHV_FIELD_BLOCK),     SHV_FIELD_OF(ShvRelax, shifts, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvRelax, predicted, SHV_FIELD_BLOCK),   SHV_FIELD_OF(ShvRelax, before, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvRelax, reactions, SHV_FIELD_BLOCK),   SHV_FIELD_OF(ShvRelax, clear, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvRelax, first_touch, SHV_FIELD_BLOCK), SHV_FIELD_OF(ShvRelax, touched, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvRelax, touches, SHV_FIELD_BLOCK),     SHV_FIELD_OF(ShvRelax, force, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvRelax, slips.items, SHV_FIELD_BLOCK), SHV_FIELD_OF(ShvRelax, past.items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvRelax, unmoved, SHV_FIELD_BLOCK),     SHV_FIELD_OF(ShvRelax, yielded, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvRelax, works, SHV_FIELD_BLOCK),       SHV_FIELD_OF(ShvRelax, memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvRelax, threads, SHV_FIELD_KEPT),      SHV_FIELD_OF(ShvRelax, later, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, relax, fields);
}

bool shv_ties_archive(ShvTies *ties, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvTies, items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvTies, memory, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, ties, fields);
}

bool shv_pbd_body_archive(ShvPbdBody *body, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvPbdBody, touched, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvPbdBody, fastest, SHV_FIELD_BLOCK),
    };
    return SHV_ARCHIVE_STRUCT(archive, body, fields);
}
