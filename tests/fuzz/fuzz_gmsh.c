#include "fuzz.h"

#include "mesh/generate.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvMesh mesh;
    ShvError error = {SHV_OK, ""};
    const char *path = fuzz_path(".msh");
    fuzz_write(path, data, size);
    const ShvStatus status = shv_mesh_read_gmsh(&mesh, NULL, path, &error);
    fuzz_judge(status, &error);
    if (status == SHV_OK) shv_mesh_release(&mesh);
    unlink(path);
    return 0;
}
