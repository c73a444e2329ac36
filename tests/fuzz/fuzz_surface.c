/* Surfaces of one format; its ending (FUZZ_ENDING) is said by the build. */
#include "fuzz.h"

#include "mesh/surface.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvSurface surface;
    ShvError error = {SHV_OK, ""};
    const char *path = fuzz_path(FUZZ_ENDING);
    fuzz_write(path, data, size);
    ShvStatus status = shv_surface_read(&surface, NULL, SHV_PART_MESH, path, 1.0, &error);
    if (status == SHV_OK) {
        status = shv_surface_require_closed(&surface, "it", &error);
        shv_surface_release(&surface);
    }
    fuzz_judge(status, &error);
    unlink(path);
    return 0;
}
