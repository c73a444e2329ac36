#include "rigid/backend.h"

ShvStatus shv_backend_reserve(const ShvRigidBackend *backend, void **block, int32_t *room, int64_t wanted, size_t size,
                              const char *what, ShvError *error)
{
    if (wanted <= *room) return SHV_OK;
    int64_t larger = wanted + wanted / 2 + 16;
    if (larger > INT32_MAX) larger = INT32_MAX;
    if (wanted > larger) return shv_fail(error, SHV_UNSUPPORTED, "Too many %s: use fewer fragments.", what);
    void *grown = shv_reallocate(backend->world.fragments->memory, SHV_PART_RIGID, *block, (size_t)larger, size);
    if (!grown) return shv_fail_memory(error, what, (size_t)larger * size);
    *block = grown;
    *room = (int32_t)larger;
    return SHV_OK;
}
