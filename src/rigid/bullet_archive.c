#include "rigid/bullet_archive.h"

/* Bodies of obstacles stay in Bullet's world. */
static void remove_all(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        if (body->gone) continue;
        if (body->fragment >= 0) shv_bullet_world_remove(bullet->bullet, body->number);
        shv_impact_shape_release(body->impact);
        shv_convex_pieces_release(&body->pieces);
    }
    bullet->body_count = 0;
}

static ShvStatus join(const ShvBullet *bullet, const ShvBulletRigidBody *body, ShvError *error)
{
    if (body->fragment >= 0) SHV_TRY(shv_bullet_body_add_pieces(body, bullet->bullet, error));
    if (!body->settled) return SHV_OK;
    shv_bullet_body_place(body, bullet->bullet, body->position, body->orientation);
    return shv_bullet_reach(bullet, body, bullet->step, error);
}

static bool archive_body(ShvBullet *bullet, ShvBulletRigidBody *body, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvBulletRigidBody, pieces.vertex_begin, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBulletRigidBody, pieces.vertices, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBulletRigidBody, pieces.volumes, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBulletRigidBody, pieces.memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBulletRigidBody, impact, SHV_FIELD_KEPT), /* made anew when it is needed */
    };
    ShvError error;
    if (!SHV_ARCHIVE_STRUCT(archive, body, fields)) return false;
    if (!shv_archive_reads(archive)) return true;
    body->pieces.memory = bullet->backend.world.fragments->memory;
    const ShvStatus status = body->gone ? SHV_OK : join(bullet, body, &error);
    return status == SHV_OK || shv_archive_fail(archive, status, &error);
}

static bool archive_bodies(ShvBullet *bullet, ShvArchive *archive)
{
    int32_t count = bullet->body_count;
    if (shv_archive_reads(archive)) remove_all(bullet);
    bool good = shv_archive_room(archive, (void **)&bullet->bodies) && shv_archive_bytes(archive, &count, sizeof count);
    for (int32_t i = 0; good && i < count; i++) {
        good = archive_body(bullet, &bullet->bodies[i], archive);
        if (!shv_archive_reads(archive)) continue;
        if (good)
            bullet->body_count = i + 1;
        else
            shv_convex_pieces_release(&bullet->bodies[i].pieces);
    }
    return good;
}

bool shv_bullet_archive(ShvRigidBackend *backend, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvBullet, places, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, contact_pairs, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, last_contact_pairs, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, contacts, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, cached_impulses, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, last_cached_impulses, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvBullet, order, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvBullet, motions, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvBullet, active_contacts, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvBullet, heaps, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvBullet, bodies, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBullet, body_count, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBullet, bullet, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBullet, backend.functions, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvBullet, backend.world, SHV_FIELD_KEPT),
    };
    ShvBullet *bullet = (ShvBullet *)backend;
    return SHV_ARCHIVE_STRUCT(archive, bullet, fields) && archive_bodies(bullet, archive);
}
