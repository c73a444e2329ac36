#include "rigid/bullet_archive.h"

/* Bodies of obstacles stay in Bullet's world. */
static void remove_all(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (flyer->gone) continue;
        if (flyer->fragment >= 0) shv_bullet_world_remove(bullet->bullet, flyer->number);
        shv_impact_shape_release(flyer->impact);
        shv_convex_pieces_release(&flyer->pieces);
    }
    bullet->flyer_count = 0;
}

static ShvStatus join(const ShvBullet *bullet, const ShvBulletFlyer *flyer, ShvError *error)
{
    ShvBodyShape body;
    if (flyer->fragment >= 0) {
        SHV_TRY(shv_body_shape_of_pieces(&body, &flyer->pieces, &flyer->rotation.axes, flyer->dust, error));
        const ShvStatus status = shv_bullet_world_add(bullet->bullet, flyer->number, &body.shape, 1.0 / flyer->mass,
                                                      flyer->rotation.inverse, error);
        shv_body_shape_release(&body);
        SHV_TRY(status);
    }
    if (!flyer->settled) return SHV_OK;
    shv_bullet_flyer_place(flyer, bullet->bullet, flyer->position, flyer->orientation);
    return shv_bullet_reach(bullet, flyer, bullet->step, error);
}

static bool archive_flyer(ShvBullet *bullet, ShvBulletFlyer *flyer, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvBulletFlyer, pieces.vertex_begin, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBulletFlyer, pieces.vertices, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBulletFlyer, pieces.volumes, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBulletFlyer, pieces.memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBulletFlyer, impact, SHV_FIELD_KEPT), /* made anew when it is needed */
    };
    ShvError error;
    if (!SHV_ARCHIVE_STRUCT(archive, flyer, fields)) return false;
    if (!shv_archive_reads(archive)) return true;
    flyer->pieces.memory = bullet->backend.world.fragments->memory;
    const ShvStatus status = flyer->gone ? SHV_OK : join(bullet, flyer, &error);
    return status == SHV_OK || shv_archive_fail(archive, status, &error);
}

static bool archive_flyers(ShvBullet *bullet, ShvArchive *archive)
{
    int32_t count = bullet->flyer_count;
    if (shv_archive_reads(archive)) remove_all(bullet);
    bool good = shv_archive_room(archive, (void **)&bullet->flyers) && shv_archive_bytes(archive, &count, sizeof count);
    for (int32_t i = 0; good && i < count; i++) {
        good = archive_flyer(bullet, &bullet->flyers[i], archive);
        if (!shv_archive_reads(archive)) continue;
        if (good)
            bullet->flyer_count = i + 1;
        else
            shv_convex_pieces_release(&bullet->flyers[i].pieces);
    }
    return good;
}

bool shv_bullet_archive(ShvRigidBackend *backend, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvBullet, places, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, meetings, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, last_meetings, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, contacts, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, traces, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, last_traces, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, order, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvBullet, motions, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvBullet, gathered, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvBullet, heaps, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvBullet, flyers, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBullet, flyer_count, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBullet, bullet, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBullet, backend.functions, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBullet, backend.world, SHV_FIELD_KEPT),
    };
    ShvBullet *bullet = (ShvBullet *)backend;
    return SHV_ARCHIVE_STRUCT(archive, bullet, fields) && archive_flyers(bullet, archive);
}
